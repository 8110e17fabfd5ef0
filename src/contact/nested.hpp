// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Solids that lie wholly inside other solids: no surface crosses another one, yet the
/// volumes overlap. Contact can never tell, for it only sees surfaces that come near.
///
/// A surface is cut into pieces that edges connect. Where no surfaces cross, a piece is
/// inside a solid with all of its vertices or with none, so one vertex decides: a ray
/// from it counts how often the solid's surface goes round it. A cavity is a piece of
/// negative volume that turns the count back to 0, so what lies in a cavity is not
/// inside.
///
/// Rays go in a skew direction, through positions that are sheared one by one, in
/// doubles: rounding moves vertices, but the surface stays closed, so the count is that
/// of a surface within rounding of the given one.

#include "contact/collision_mesh.hpp"
#include "geometry/aabb.hpp"
#include "geometry/ray.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace noli {

struct Nested {
    int inner;   ///< body
    int outer;   ///< body
    int vertex;  ///< of the inner one, inside the outer one
};

namespace detail {

struct SurfacePiece {
    int body = -1;
    int vertex = -1;  ///< first one
    int num_triangles = 0;
    double volume = 0.0;  ///< m^3, negative for a cavity
    Aabb box = empty_aabb();
};

/// Pieces of the surface that edges connect; vertices without edges are left out.
class SurfacePieces {
  public:
    SurfacePieces(const CollisionMesh& mesh, View<const Vec3d> x)
        : root_(static_cast<std::size_t>(mesh.num_vertices)) {
        std::iota(root_.begin(), root_.end(), 0);
        std::vector<int> piece(root_.size(), -1);
        for (const Int2& e : mesh.edges) {
            const int a = find(e[0]);
            const int b = find(e[1]);
            root_[at(std::max(a, b))] = std::min(a, b);
        }
        for (const Int2& e : mesh.edges)
            for (const int v : e.v) {
                int& k = piece[at(find(v))];
                if (k < 0) {
                    k = static_cast<int>(pieces_.size());
                    pieces_.push_back({.body = mesh.body[at(v)], .vertex = v});
                }
                pieces_[at(k)].box = merged(pieces_[at(k)].box, x[v]);
            }
        for (const Int3& t : mesh.triangles) {
            SurfacePiece& p = pieces_[at(piece[at(find(t[0]))])];
            const Vec3d& o = x[p.vertex];
            p.volume += dot(x[t[0]] - o, cross(x[t[1]] - o, x[t[2]] - o)) / 6.0;
            ++p.num_triangles;
        }
    }

    [[nodiscard]] const std::vector<SurfacePiece>& all() const { return pieces_; }
    /// Whether two vertices are of one piece.
    [[nodiscard]] bool same(int a, int b) { return find(a) == find(b); }

  private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    int find(int v) {
        while (root_[at(v)] != v) {
            root_[at(v)] = root_[at(root_[at(v)])];
            v = root_[at(v)];
        }
        return v;
    }
    std::vector<int> root_;
    std::vector<SurfacePiece> pieces_;
};

inline Vec3d sheared(const Vec3d& p, double skew) {
    return {p.x, p.y - skew * p.x, p.z - 0.618034 * skew * p.x};
}

/// How often the surface of a body, without the piece itself, goes round the piece: range
/// are the body's triangles. Another direction is tried where a ray meets an edge.
inline int turns_round(const CollisionMesh& mesh,
                       View<const Vec3d> x,
                       SurfacePieces& pieces,
                       int vertex,
                       std::array<int, 2> range) {
    const auto body = [&](int v) { return mesh.body[static_cast<std::size_t>(v)]; };
    for (const double skew : {0.1372, 0.2291, -0.1753, 0.3119, -0.2717, 0.0871}) {
        const Vec3d p = sheared(x[vertex], skew);
        int turns = 0;
        bool clear = true;
        for (int k = range[0]; clear && k < range[1]; ++k) {
            const Int3& t = mesh.triangles[static_cast<std::size_t>(k)];
            if (body(t[0]) == body(vertex) && pieces.same(t[0], vertex)) continue;
            const RayCrossing found = cross_ray(p,
                                                sheared(x[t[0]], skew),
                                                sheared(x[t[1]], skew),
                                                sheared(x[t[2]], skew));
            clear = found.is_clear;
            turns += found.turns;
        }
        if (clear) return turns;
    }
    return 0;
}

/// [first, last) triangle of each body; they lie one body after the other.
inline std::vector<std::array<int, 2>> triangles_of_bodies(const CollisionMesh& mesh) {
    std::vector<std::array<int, 2>> range(static_cast<std::size_t>(mesh.num_bodies));
    for (int k = 0; k < static_cast<int>(mesh.triangles.size()); ++k) {
        const int v = mesh.triangles[static_cast<std::size_t>(k)][0];
        auto& [first, last] =
            range[static_cast<std::size_t>(mesh.body[static_cast<std::size_t>(v)])];
        if (last == 0) first = k;
        last = k + 1;
    }
    return range;
}

inline bool lies_in(const Aabb& inner, const Aabb& outer) {
    for (int k = 0; k < 3; ++k)
        if (inner.lo[k] < outer.lo[k] || inner.hi[k] > outer.hi[k]) return false;
    return true;
}

}  // namespace detail

/// Bodies with a piece of their surface inside a solid, in the order of the pieces.
///
/// In:   mesh      its surfaces must not cross; triangles of one body after the other
///       is_solid  (num_bodies) has volume; its triangles are closed and face outwards
///       x         (num_vertices) m
inline std::vector<Nested> nested_bodies(const CollisionMesh& mesh,
                                         const std::vector<bool>& is_solid,
                                         View<const Vec3d> x) {
    detail::SurfacePieces pieces(mesh, x);
    const auto range = detail::triangles_of_bodies(mesh);
    std::vector<Aabb> box(is_solid.size(), empty_aabb());
    for (const detail::SurfacePiece& piece : pieces.all()) {
        Aabb& around = box[static_cast<std::size_t>(piece.body)];
        around = merged(merged(around, piece.box.lo), piece.box.hi);
    }
    std::vector<Nested> found;
    for (const detail::SurfacePiece& piece : pieces.all()) {
        const std::size_t inner = static_cast<std::size_t>(piece.body);
        if (is_solid[inner] && !(piece.volume > 0.0)) continue;
        for (std::size_t outer = 0; outer < is_solid.size(); ++outer) {
            if (!is_solid[outer] || !detail::lies_in(piece.box, box[outer])) continue;
            if (!mesh.pair_enabled[inner * is_solid.size() + outer]) continue;
            if (detail::turns_round(mesh, x, pieces, piece.vertex, range[outer]) > 0)
                found.push_back({piece.body, static_cast<int>(outer), piece.vertex});
        }
    }
    return found;
}

}  // namespace noli
