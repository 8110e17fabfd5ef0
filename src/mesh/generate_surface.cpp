// SPDX-License-Identifier: Apache-2.0
/// Triangle surfaces for obstacles: grids, a subdivided icosahedron, and outlines turned
/// about y.
#include "mesh/generate.hpp"
#include "mesh/parameters.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <utility>

namespace noli {

namespace {

using detail::ParameterCheck;

constexpr double kPi = std::numbers::pi;

int rounded(double value, int at_least) {
    return std::max(at_least, static_cast<int>(std::lround(value)));
}

/// A point (radius, height) of an outline.
using Outline = std::vector<Vec2d>;

/// Adds the way from the last point to `to` in steps of about `edge`.
void line_to(Outline& outline, Vec2d to, double edge) {
    const Vec2d from = outline.back();
    const int steps = rounded(std::hypot(to.x - from.x, to.y - from.y) / edge, 1);
    for (int i = 1; i < steps; ++i) {
        const double s = static_cast<double>(i) / steps;
        outline.push_back({from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)});
    }
    outline.push_back(to);
}

/// Adds an arc about the height `centre` from one angle to another, both measured from
/// straight down.
void arc_to(
    Outline& outline, double centre, double radius, double from, double to, double edge) {
    const int steps = rounded(radius * std::fabs(to - from) / edge, 2);
    for (int i = 0; i <= steps; ++i) {
        const double s = static_cast<double>(i) / steps;
        const double angle = (1.0 - s) * from + s * to;  // exactly 0 at the axis
        const double r = angle == 0.0 ? 0.0 : radius * std::sin(angle);
        outline.push_back({r, centre - radius * std::cos(angle)});
    }
}

/// Turns an outline about the y axis; where it climbs, triangles turn outwards. Points on
/// the axis become one vertex.
Mesh revolved(const Outline& outline, bool closed, double edge) {
    double widest = 0.0;
    for (const Vec2d& q : outline)
        widest = std::max(widest, q.x);
    const int around = rounded(2.0 * kPi * widest / edge, 6);
    Mesh mesh;
    std::vector<int> first;
    for (const Vec2d& q : outline) {
        first.push_back(static_cast<int>(mesh.x.size()));
        for (int j = 0; j < (q.x == 0.0 ? 1 : around); ++j) {
            const double angle = 2.0 * kPi * j / around;
            mesh.x.push_back({q.x * std::cos(angle), q.y, q.x * std::sin(angle)});
        }
    }
    const auto count = outline.size();
    for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i) {
        const std::size_t next = (i + 1) % count;
        const auto vertex = [&](std::size_t k, int j) {
            return first[k] + (outline[k].x == 0.0 ? 0 : j % around);
        };
        for (int j = 0; j < around; ++j) {
            const Int3 lower{vertex(i, j), vertex(next, j), vertex(i, j + 1)};
            const Int3 upper{vertex(next, j), vertex(next, j + 1), vertex(i, j + 1)};
            if (outline[i].x != 0.0) mesh.triangles.push_back(lower);
            if (outline[next].x != 0.0) mesh.triangles.push_back(upper);
        }
    }
    return mesh;
}

/// Grids of nu x nv cells from `corner` along u and v, turned along u x v, in the cube
/// [-1, 1]^3 (scaled by the caller): there, equal points are found safely.
class GridBuilder {
  public:
    void add(Vec3d corner, Vec3d u, Vec3d v, int nu, int nv) {
        const auto vertex = [&](int i, int j) {
            return find(corner + (static_cast<double>(i) / nu) * u
                        + (static_cast<double>(j) / nv) * v);
        };
        for (int j = 0; j < nv; ++j)
            for (int i = 0; i < nu; ++i) {
                const int a = vertex(i, j), b = vertex(i + 1, j),
                          c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            }
    }

    Mesh mesh;

  private:
    /// Sides meet in the same points up to rounding.
    int find(const Vec3d& x) {
        const auto snap = [](double s) { return std::llround(s * 1e9); };
        const auto [it, is_new] = index_.try_emplace({snap(x.x), snap(x.y), snap(x.z)},
                                                     static_cast<int>(mesh.x.size()));
        if (is_new) mesh.x.push_back(x);
        return it->second;
    }

    std::map<std::array<long long, 3>, int> index_;
};

/// The icosahedron with corners on the unit sphere.
Mesh icosahedron() {
    const double g = std::numbers::phi, s = 1.0 / std::sqrt(1.0 + g * g);
    Mesh mesh;
    for (const double a : {-1.0, 1.0})
        for (const double b : {-g, g}) {
            mesh.x.push_back(s * Vec3d{0, a, b});
            mesh.x.push_back(s * Vec3d{a, b, 0});
            mesh.x.push_back(s * Vec3d{b, 0, a});
        }
    const double side = 2.0 * s * 1.01;
    const auto near = [&](int i, int j) {
        return norm(mesh.x[static_cast<std::size_t>(i)]
                    - mesh.x[static_cast<std::size_t>(j)])
             < side;
    };
    for (int i = 0; i < 12; ++i)
        for (int j = i + 1; j < 12; ++j)
            for (int k = j + 1; k < 12; ++k) {
                if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
                const Vec3d a = mesh.x[static_cast<std::size_t>(i)],
                            b = mesh.x[static_cast<std::size_t>(j)],
                            c = mesh.x[static_cast<std::size_t>(k)];
                const bool outwards = dot(cross(b - a, c - a), a) > 0.0;
                mesh.triangles.push_back(outwards ? Int3{i, j, k} : Int3{i, k, j});
            }
    return mesh;
}

/// Each triangle becomes n x n; vertices on shared edges are found again by their
/// weights.
Mesh subdivided_sphere(const Mesh& base, int n, double radius) {
    Mesh out;
    std::map<std::array<std::pair<int, int>, 3>, int> index;
    const auto vertex = [&](const Int3& t, int i, int j) {
        std::array<std::pair<int, int>, 3> key = {
            std::pair{t[0], n - i - j}, {t[1], i}, {t[2], j}};
        Vec3d x{0, 0, 0};
        std::sort(key.begin(), key.end());  // the same sum from either side of an edge
        for (auto& [corner, weight] : key) {
            x += static_cast<double>(weight) * base.x[static_cast<std::size_t>(corner)];
            if (weight == 0) corner = -1;
        }
        std::sort(key.begin(), key.end());
        const auto [it, is_new] = index.try_emplace(key, static_cast<int>(out.x.size()));
        if (is_new) out.x.push_back(radius * normalized(x));
        return it->second;
    };
    for (const Int3& t : base.triangles)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i + j < n; ++i) {
                const int a = vertex(t, i, j), b = vertex(t, i + 1, j),
                          c = vertex(t, i, j + 1);
                out.triangles.push_back({a, b, c});
                if (i + j + 1 < n)
                    out.triangles.push_back({b, vertex(t, i + 1, j + 1), c});
            }
    return out;
}

}  // namespace

Result<Mesh> make_plane_surface(const PlaneSurfaceParams& p) {
    ParameterCheck check("plane surface");
    check.above("width", p.width, 0.0).above("depth", p.depth, 0.0);
    check.range("nx", p.nx, 1, 1e6).range("nz", p.nz, 1, 1e6);
    check.elements(2.0 * p.nx * p.nz, kMaxGeneratedElements);
    if (check.error()) return *check.error();
    GridBuilder grid;
    grid.add({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, p.nz, p.nx);
    for (Vec3d& q : grid.mesh.x)
        q = {0.5 * p.width * q.x, 0.0, 0.5 * p.depth * q.z};
    return std::move(grid.mesh);
}

Result<Mesh> make_box_surface(const BoxSurfaceParams& p) {
    ParameterCheck check("box surface");
    for (int k = 0; k < 3; ++k)
        check.above("size", p.size[k], 0.0);
    check.range("nx", p.nx, 1, 1e6).range("ny", p.ny, 1, 1e6).range("nz", p.nz, 1, 1e6);
    const double x = p.nx, y = p.ny, z = p.nz;
    check.elements(4.0 * (x * y + y * z + z * x), kMaxGeneratedElements);
    if (check.error()) return *check.error();
    GridBuilder grid;
    const Vec3d u{2, 0, 0}, v{0, 2, 0}, w{0, 0, 2};
    grid.add({-1, -1, -1}, v, u, p.ny, p.nx);
    grid.add({-1, -1, 1}, u, v, p.nx, p.ny);
    grid.add({-1, -1, -1}, u, w, p.nx, p.nz);
    grid.add({-1, 1, -1}, w, u, p.nz, p.nx);
    grid.add({-1, -1, -1}, w, v, p.nz, p.ny);
    grid.add({1, -1, -1}, v, w, p.ny, p.nz);
    for (Vec3d& q : grid.mesh.x)
        q = {0.5 * p.size.x * q.x, 0.5 * p.size.y * q.y, 0.5 * p.size.z * q.z};
    return std::move(grid.mesh);
}

Result<Mesh> make_sphere_surface(const SphereSurfaceParams& p) {
    ParameterCheck check("sphere surface");
    check.above("radius", p.radius, 0.0).above("edge_length", p.edge_length, 0.0);
    constexpr double kMeanEdge =
        1.15;  // of the undivided icosahedron blown up to the unit sphere
    const double n = std::max(1.0, kMeanEdge * p.radius / p.edge_length);
    check.elements(20.0 * n * n, kMaxGeneratedElements);
    if (check.error()) return *check.error();
    return subdivided_sphere(icosahedron(), rounded(n, 1), p.radius);
}

Result<Mesh> make_tube_surface(const TubeSurfaceParams& p) {
    ParameterCheck check("tube surface");
    check.above("radius", p.radius, 0.0)
        .above("height", p.height, 0.0)
        .above("edge_length", p.edge_length, 0.0);
    check.range("wall", p.wall, 0.0, 0.999 * p.radius);
    check.require(
        !p.capped || p.wall == 0.0, "wall", p.wall, "0 for a tube with \"capped\": true");
    check.elements(
        40.0 * p.radius * (p.height + p.radius) / (p.edge_length * p.edge_length),
        kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const double lo = -0.5 * p.height, hi = 0.5 * p.height, inner = p.radius - p.wall;
    Outline outline;
    if (p.capped) {
        outline = {{0, lo}};
        line_to(outline, {p.radius, lo}, p.edge_length);
    } else {
        outline = {{p.radius, lo}};
    }
    line_to(outline, {p.radius, hi}, p.edge_length);
    if (p.capped) line_to(outline, {0, hi}, p.edge_length);
    if (p.wall > 0.0) {
        line_to(outline, {inner, hi}, p.edge_length);
        line_to(outline, {inner, lo}, p.edge_length);
        line_to(outline, {p.radius, lo}, p.edge_length);
        outline.pop_back();
    }
    return revolved(outline, p.wall > 0.0, p.edge_length);
}

Result<Mesh> make_funnel_surface(const FunnelSurfaceParams& p) {
    ParameterCheck check("funnel surface");
    check.above("top_radius", p.top_radius, 0.0)
        .range("bottom_radius", p.bottom_radius, 0.0, 1e9);
    check.above("height", p.height, 0.0).range("spout_height", p.spout_height, 0.0, 1e9);
    check.require(p.bottom_radius > 0.0 || (p.spout_height == 0.0 && p.wall == 0.0),
                  "bottom_radius",
                  p.bottom_radius,
                  "more than 0 with a spout or a wall");
    check.range("wall", p.wall, 0.0, 1e9).above("edge_length", p.edge_length, 0.0);
    const double side =
        p.height + p.spout_height + p.top_radius + p.bottom_radius + p.wall;
    check.elements(80.0 * side * side / (p.edge_length * p.edge_length),
                   kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const double lo = -0.5 * (p.height + p.spout_height), neck = lo + p.spout_height,
                 hi = neck + p.height;
    Outline outline = {{p.bottom_radius + p.wall, lo}};
    if (p.spout_height > 0.0)
        line_to(outline, {p.bottom_radius + p.wall, neck}, p.edge_length);
    line_to(outline, {p.top_radius + p.wall, hi}, p.edge_length);
    if (p.wall > 0.0) {
        line_to(outline, {p.top_radius, hi}, p.edge_length);
        line_to(outline, {p.bottom_radius, neck}, p.edge_length);
        if (p.spout_height > 0.0) line_to(outline, {p.bottom_radius, lo}, p.edge_length);
        line_to(outline, {p.bottom_radius + p.wall, lo}, p.edge_length);
        outline.pop_back();
    }
    return revolved(outline, p.wall > 0.0, p.edge_length);
}

Result<Mesh> make_bowl_surface(const BowlSurfaceParams& p) {
    ParameterCheck check("bowl surface");
    check.above("radius", p.radius, 0.0).above("angle", p.angle, 0.0, 170.0);
    check.range("wall", p.wall, 0.0, 0.999 * p.radius)
        .above("edge_length", p.edge_length, 0.0);
    check.elements(80.0 * p.radius * p.radius / (p.edge_length * p.edge_length),
                   kMaxGeneratedElements);
    if (check.error()) return *check.error();
    const double rim = p.angle * kPi / 180.0;
    Outline outline;
    arc_to(outline, 0.0, p.radius, 0.0, rim, p.edge_length);
    if (p.wall > 0.0) arc_to(outline, 0.0, p.radius - p.wall, rim, 0.0, p.edge_length);
    return revolved(outline, false, p.edge_length);
}

}  // namespace noli
