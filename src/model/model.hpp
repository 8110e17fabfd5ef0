// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A Scene with its meshes, flattened into immutable arrays: what the solver reads.

#include "noli/result.hpp"
#include "noli/scene.hpp"

#include "core/vec.hpp"
#include "geometry/wall.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace noli {

/// Number of elastic models; tetrahedra are ordered by Material::Model.
inline constexpr int kNumElasticModels = 3;

/// One boundary condition with its vertices found.
struct ModelCondition {
    BoundaryCondition what;
    int body = 0;
    std::string where;               ///< "body 'ball', condition 2", for messages
    std::vector<int> vertices;       ///< global, ascending
    std::vector<int> body_vertices;  ///< all of the body that have elements (for `until`)
    Vec3d start_center{};  ///< bounding-box centre of the selection in the initial
                           ///< placement
    std::vector<std::vector<Vec3d>>
        sequence;  ///< positions per step, in the order of `vertices`
};

/// All arrays are per vertex, tetrahedron, edge ... of all bodies together, bodies one
/// after the other, each in the order of its mesh file (tetrahedra excepted: see
/// tet_source).
struct Model {
    Vec3d origin{0, 0, 0};  ///< that all places count from, in the world (origin.hpp), m
    int num_vertices = 0;
    std::vector<std::string> body_names;
    std::vector<int> body;               ///< per vertex
    std::vector<Vec3d> x0;               ///< initial positions, m; also the rest shape
    std::vector<Vec3d> v0;               ///< initial velocities, m/s
    std::vector<double> mass;            ///< lumped, kg; 0 for obstacles
    std::vector<std::uint8_t> obstacle;  ///< per vertex: 1 = not part of an elastic body
    std::vector<int> unreferenced;       ///< vertices without an element, ascending: they
                                         ///< keep their numbers and nothing else

    std::vector<Int4> tets;      ///< ordered by elastic model
    std::vector<Mat3d> dm_inv;   ///< inverse rest edge matrix, 1/m
    std::vector<double> volume;  ///< rest volume, m^3
    std::vector<double> mu,
        lambda;  ///< Lame constants in the convention of the tet's model, Pa
    std::array<int, kNumElasticModels + 1>
        model_begin{};  ///< range of tets per elastic model
    std::vector<int>
        tet_source;  ///< tets[k] is tetrahedron tet_source[k] in mesh-file order

    std::vector<int>
        surface_vertices;  ///< of contact: surfaces, segments and points, ascending
    std::vector<Int2> edges;
    std::vector<double> edge_rest_sq;  ///< m^2
    std::vector<Int3> triangles;
    std::vector<Int2> segments;  ///< those edges that belong to no triangle

    struct NamedWall {
        std::string name;
        Wall wall;
    };
    std::vector<NamedWall> walls;            ///< half-spaces, then containers
    std::vector<std::uint8_t> pair_enabled;  ///< bodies x bodies
    std::vector<double> pair_friction;       ///< bodies x bodies
    std::vector<std::uint8_t> wall_enabled;  ///< walls x bodies
    std::vector<double> wall_friction;       ///< walls x bodies

    std::vector<ModelCondition> conditions;

    double diagonal = 0.0;        ///< length scale of relative settings, m
    double dhat = 0.0;            ///< m
    double min_separation = 0.0;  ///< m
    double epsv = 0.0;            ///< m/s
    double mean_mass = 0.0;       ///< over vertices with mass, kg
    double total_mass = 0.0;

    [[nodiscard]] int num_bodies() const { return static_cast<int>(body_names.size()); }
    [[nodiscard]] int num_tets() const { return static_cast<int>(tets.size()); }
    /// x0, with vertices without an element at the place of one that has some: for who
    /// orders vertices by place.
    [[nodiscard]] std::vector<Vec3d> places() const;
    /// Newton tolerance of step k (0 = first), in m/s.
    [[nodiscard]] double tolerance(const SolverSettings& solver, int k) const;
};

/// The walls alone, as kernels take them.
std::vector<Wall> walls_of(const Model& model);

/// "half-space "floor"" or "container "drum"", for messages.
std::string describe_wall(const Model& model, int wall);

/// Loads and checks all meshes, places the bodies, resolves relative settings.
/// Errors name the body; `warnings` receives what was odd but harmless.
Result<Model> build_model(const Scene& scene,
                          std::vector<SceneWarning>* warnings = nullptr);

}  // namespace noli
