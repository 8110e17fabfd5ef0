// SPDX-License-Identifier: Apache-2.0
#include "mesh/quality.hpp"

#include "mesh/topology.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <utility>

namespace noli {

namespace {

double triangle_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return 0.5 * norm(cross(b - a, c - a));
}

/// Heron's product (a+b+c)(-a+b+c)(a-b+c)(a+b-c), at least 0.
double heron(double a, double b, double c) {
    return std::max(0.0, (a + b + c) * (-a + b + c) * (a - b + c) * (a + b - c));
}

/// Shapes are measured at longest edge 1: tiny and huge meshes neither under- nor
/// overflow. 0 if all edges are.
double inverse_longest_edge(std::initializer_list<Vec3d> edges) {
    double longest_sq = 0.0;
    for (const Vec3d& e : edges)
        longest_sq = std::max(longest_sq, norm_sq(e));
    return longest_sq > 0.0 ? 1.0 / std::sqrt(longest_sq) : 0.0;
}

struct Stats {
    double lo = std::numeric_limits<double>::infinity(), hi = 0, sum = 0;
    int count = 0, worst = -1;

    void add(double value) {
        if (value < lo) worst = count;
        lo = std::min(lo, value);
        hi = std::max(hi, value);
        sum += value;
        ++count;
    }
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0.0; }
    [[nodiscard]] double min() const { return count > 0 ? lo : 0.0; }
};

}  // namespace

double radius_ratio(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const double s = inverse_longest_edge({b - a, c - a, d - a, c - b, d - b, d - c});
    const Vec3d o{0, 0, 0}, u = s * (b - a), v = s * (c - a), w = s * (d - a);
    // r = 3 V / A and R = sqrt(heron(products of opposite edges)) / (24 V), so that
    // 3 r / R = 216 V^2 / (A sqrt(heron))
    const double area = triangle_area(o, u, v) + triangle_area(o, u, w)
                      + triangle_area(o, v, w) + triangle_area(u, v, w);
    const double products = std::sqrt(
        heron(norm(u) * norm(w - v), norm(v) * norm(w - u), norm(w) * norm(v - u)));
    const double volume = tet_volume(o, u, v, w);
    const double denominator = area * products;
    return denominator > 0.0 ? 216.0 * volume * std::fabs(volume) / denominator : 0.0;
}

double radius_ratio(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    // r = 2 A / p and R = la lb lc / (4 A), so that 2 r / R = heron / (p la lb lc)
    const double s = inverse_longest_edge({c - b, a - c, b - a});
    const double la = s * norm(c - b), lb = s * norm(a - c), lc = s * norm(b - a);
    const double denominator = (la + lb + lc) * la * lb * lc;
    return denominator > 0.0 ? heron(la, lb, lc) / denominator : 0.0;
}

double relative_volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const double s = inverse_longest_edge({b - a, c - a, d - a, c - b, d - b, d - c});
    return std::numbers::sqrt2 * dot(cross(s * (b - a), s * (c - a)), s * (d - a));
}

AngleRange dihedral_angles(const Vec3d& a,
                           const Vec3d& b,
                           const Vec3d& c,
                           const Vec3d& d) {
    const Vec3d x[4] = {a, b, c, d};
    Vec3d normal[4];
    for (int k = 0; k < 4; ++k) {
        const auto& f = kTetFaces[k];
        normal[k] = cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]]);
    }
    AngleRange range{180.0, 0.0};
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) {
            const double angle =
                std::atan2(norm(cross(normal[i], normal[j])), -dot(normal[i], normal[j]))
                * 180.0 / std::numbers::pi;
            range = {std::min(range.lo, angle), std::max(range.hi, angle)};
        }
    return range;
}

MeshQuality mesh_quality(const Mesh& mesh) {
    MeshQuality q;
    if (mesh.x.empty()) return q;
    const auto at = [&](int i) -> const Vec3d& {
        return mesh.x[static_cast<std::size_t>(i)];
    };
    const std::vector<std::uint8_t> used = referenced_vertices(mesh);
    bool first = true;
    for (std::size_t v = 0; v < mesh.x.size(); ++v) {
        if (used[v] == 0) continue;
        if (std::exchange(first, false)) q.lo = q.hi = mesh.x[v];
        for (int k = 0; k < 3; ++k) {
            q.lo[k] = std::min(q.lo[k], mesh.x[v][k]);
            q.hi[k] = std::max(q.hi[k], mesh.x[v][k]);
        }
    }
    const MeshRole role = natural_role(mesh);
    Stats edges, ratios;
    for (const Int2 e : role == MeshRole::Solid     ? unique_edges(mesh.tets)
                        : role == MeshRole::Surface ? unique_edges(mesh.triangles)
                                                    : mesh.segments)
        edges.add(norm(at(e[1]) - at(e[0])));
    if (role == MeshRole::Solid) {
        q.min_dihedral = 180.0;
        for (const Int4& t : mesh.tets) {
            const AngleRange angles =
                dihedral_angles(at(t[0]), at(t[1]), at(t[2]), at(t[3]));
            q.min_dihedral = std::min(q.min_dihedral, angles.lo);
            q.max_dihedral = std::max(q.max_dihedral, angles.hi);
            q.volume += tet_volume(at(t[0]), at(t[1]), at(t[2]), at(t[3]));
            ratios.add(radius_ratio(at(t[0]), at(t[1]), at(t[2]), at(t[3])));
        }
    }
    for (const Int3& t :
         role == MeshRole::Solid ? boundary_triangles(mesh.tets) : mesh.triangles) {
        q.area += triangle_area(at(t[0]), at(t[1]), at(t[2]));
        if (role == MeshRole::Surface)
            ratios.add(radius_ratio(at(t[0]), at(t[1]), at(t[2])));
    }
    q.min_edge = edges.min();
    q.mean_edge = edges.mean();
    q.max_edge = edges.hi;
    q.min_radius_ratio = ratios.min();
    q.mean_radius_ratio = ratios.mean();
    q.worst_element = ratios.worst;
    return q;
}

}  // namespace noli
