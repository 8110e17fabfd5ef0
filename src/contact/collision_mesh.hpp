// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the contact room knows of a scene: the surface's vertices, edges and triangles,
/// who may touch whom, and the walls. Positions are never stored here.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "geometry/wall.hpp"

#include <cstdint>
#include <vector>

namespace noli {

/// Collision surface of the whole scene, on the host.
struct CollisionMesh {
    int num_vertices = 0;       ///< of all vertices, inner ones too
    std::vector<int> vertices;  ///< surface vertices and obstacle points, ascending
    std::vector<Int2> edges;    ///< vertex ids
    std::vector<double> edge_rest_sq;  ///< squared rest length of each edge, m^2
    std::vector<Int3> triangles;       ///< vertex ids
    std::vector<int> body;             ///< (num_vertices) body of each vertex
    /// (num_vertices) 1 = moved by script only; pairs of such vertices alone are ignored.
    std::vector<std::uint8_t> kinematic;
    int num_bodies = 0;
    std::vector<std::uint8_t>
        pair_enabled;  ///< (num_bodies, num_bodies) symmetric; 1 = collide
    std::vector<Wall> walls;
    std::vector<std::uint8_t> wall_enabled;  ///< (walls, num_bodies); 1 = collide
};

/// The mesh as kernels see it; captured by value.
struct CollisionMeshView {
    View<const int> vertices;
    View<const Int2> edges;
    View<const double> edge_rest_sq;
    View<const Int3> triangles;
    View<const int> body;
    View<const std::uint8_t> kinematic;
    int num_bodies;
    View<const std::uint8_t> pair_enabled;
    View<const Wall> walls;
    View<const std::uint8_t> wall_enabled;

    [[nodiscard]] NOLI_HD bool bodies_collide(int vertex_a, int vertex_b) const {
        return pair_enabled[body[vertex_a] * num_bodies + body[vertex_b]] != 0;
    }
    [[nodiscard]] NOLI_HD bool wall_collides(int wall, int vertex) const {
        return wall_enabled[wall * num_bodies + body[vertex]] != 0;
    }
    /// May this vertex and this triangle ever form a pair?
    [[nodiscard]] NOLI_HD bool may_collide(int vertex, const Int3& t) const {
        if (vertex == t[0] || vertex == t[1] || vertex == t[2]) return false;
        if (kinematic[vertex] && kinematic[t[0]] && kinematic[t[1]] && kinematic[t[2]])
            return false;
        return bodies_collide(vertex, t[0]);
    }
    /// May these two edges ever form a pair?
    [[nodiscard]] NOLI_HD bool may_collide(const Int2& a, const Int2& b) const {
        if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) return false;
        if (kinematic[a[0]] && kinematic[a[1]] && kinematic[b[0]] && kinematic[b[1]])
            return false;
        return bodies_collide(a[0], b[0]);
    }
};

/// Copy of a CollisionMesh where the executor's kernels run.
template <class Exec>
class DeviceCollisionMesh {
  public:
    void upload(Exec& exec, const CollisionMesh& mesh) {
        num_vertices_ = mesh.num_vertices;
        num_bodies_ = mesh.num_bodies;
        exec.upload(mesh.vertices, vertices_);
        exec.upload(mesh.edges, edges_);
        exec.upload(mesh.edge_rest_sq, edge_rest_sq_);
        exec.upload(mesh.triangles, triangles_);
        exec.upload(mesh.body, body_);
        exec.upload(mesh.kinematic, kinematic_);
        exec.upload(mesh.pair_enabled, pair_enabled_);
        exec.upload(mesh.walls, walls_);
        exec.upload(mesh.wall_enabled, wall_enabled_);
    }

    [[nodiscard]] int num_vertices() const { return num_vertices_; }
    [[nodiscard]] CollisionMeshView view() const {
        return {vertices_.view(),
                edges_.view(),
                edge_rest_sq_.view(),
                triangles_.view(),
                body_.view(),
                kinematic_.view(),
                num_bodies_,
                pair_enabled_.view(),
                walls_.view(),
                wall_enabled_.view()};
    }

  private:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    int num_vertices_ = 0;
    int num_bodies_ = 0;
    Buffer<int> vertices_;
    Buffer<Int2> edges_;
    Buffer<double> edge_rest_sq_;
    Buffer<Int3> triangles_;
    Buffer<int> body_;
    Buffer<std::uint8_t> kinematic_;
    Buffer<std::uint8_t> pair_enabled_;
    Buffer<Wall> walls_;
    Buffer<std::uint8_t> wall_enabled_;
};

}  // namespace noli
