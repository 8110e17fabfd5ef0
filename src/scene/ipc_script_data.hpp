// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An IPC script as it stands in the file, before conversion into a Scene.

#include "noli/scene.hpp"

#include "core/vec.hpp"
#include "scene/ipc_lines.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace noli {

struct ScriptMaterial {
    double density = 1000.0;  ///< kg/m^3
    double young = 1e5;       ///< Pa
    double poisson = 0.4;
};

/// Box in units of the untransformed mesh's bounding box, and what happens to its surface
/// vertices.
struct ScriptCondition {
    Vector3 box_min{}, box_max{};
    Vector3 linear{};       ///< velocity (DBC, m/s) or acceleration (NBC, m/s^2)
    Vector3 angular_deg{};  ///< DBC, deg/s
    double t_begin = 0.0;
    double t_end = kForever;
};

struct ScriptShape {
    ScriptWords place;  ///< for messages
    std::string path;
    Vector3 translation{}, rotation_deg{}, scale{1, 1, 1};
    std::array<int, 3> grid{1, 1, 1};
    Vector3 spacing{};  ///< of the grid, before `size`
    std::optional<ScriptMaterial> material;
    Vector3 velocity{}, angular_velocity_deg{};  ///< initVel
    std::optional<Vector3> linear, angular_deg;  ///< of the whole, kinematic shape
    std::vector<ScriptCondition> dirichlet, neumann;
    std::string sequence_folder;
};

struct ScriptObstacle {  // meshCO
    ScriptWords place;
    std::string path;
    Vector3 origin{};
    double scale = 1.0;  ///< largest extent, m
    double friction = 0.0;
    Vector3 rotation_deg{};
    double right_end = 0.0;  ///< largest x once placed, m
};

struct ScriptTimeRange {
    double begin = 0.0;
    double end = kForever;
};

struct ScriptRotation {
    Vector3 axis{0, 0, 1};
    double degrees = 0.0;
};

struct Script {
    std::string file;
    Material::Model energy = Material::Model::NeoHookean;
    Integrator integrator = Integrator::ImplicitEuler;
    double newmark_beta = 0.25, newmark_gamma = 0.5;
    double duration = 5.0, dt = 0.025;
    double size = -1.0;
    ScriptMaterial material;
    bool gravity = true;
    double damping_stiff = 0.0;
    std::optional<double> damping_ratio;
    std::string animation = "null";
    ScriptWords animation_words;  ///< after the name
    double handle_ratio = 0.01;
    ScriptTimeRange dirichlet_range, neumann_range;
    std::vector<ScriptShape> shapes;
    std::vector<ScriptObstacle> obstacles;
    std::vector<HalfSpace> half_spaces;
    std::optional<ScriptRotation> rotation;
    bool self_collision = true;
    double self_friction = 0.0;
    /// kappa, dHat start and target, tiny distance, epsv start and target.
    std::array<double, 6> tuning{0, 1e-3, 1e-3, 1e-9, 1e-3, 1e-3};
    std::vector<double> tolerances{SolverSettings{}.tolerance};
    bool absolute = false;
    int friction_iterations = kFrictionAsNeeded;
    double kappa_min_multiplier = 1e11;
    std::vector<SceneWarning> warnings;
};

/// Throws ScriptFailure.
Script parse_script(const std::string& file, const std::string& text);

/// The shape that a line describes: mesh, placement, and what may follow them. Throws
/// ScriptFailure.
ScriptShape read_shape(ScriptWords words);

/// Throws ScriptFailure, at the place of `words`, unless the constants make sense.
void check_material(const ScriptWords& words, const ScriptMaterial& material);

/// A shape with its mesh, placed as at the start of the simulation.
struct PlacedShape {
    const ScriptShape* shape = nullptr;
    std::size_t body = 0;  ///< index in scene.bodies
    bool elastic = false;
    std::vector<Vec3d> x;  ///< vertices of the first copy, m
    Vector3 lo{}, hi{};    ///< bounding box of all copies, m
    [[nodiscard]] int copies() const {
        return shape->grid[0] * shape->grid[1] * shape->grid[2];
    }
};

/// Time steps and damping.
void apply_time(const Script& script, Scene& scene);

/// Contact settings of the scene, whose bodies are there already; what they leave out
/// becomes a warning of the script. Throws ScriptFailure.
void apply_contact(Script& script, const std::vector<PlacedShape>& shapes, Scene& scene);

/// Time integration and tolerances. Throws ScriptFailure.
void apply_solver(const Script& script, Scene& scene);

/// Adds the boundary conditions and velocities of the script's animation to the bodies of
/// the scene, which are placed already; what it leaves out becomes a warning of the
/// script. Throws ScriptFailure.
void apply_animation(Script& script,
                     const std::vector<PlacedShape>& shapes,
                     Scene& scene);

/// Whether the animation lifts all shapes by half their diagonal at the start.
bool animation_lifts(const std::string& animation);

}  // namespace noli
