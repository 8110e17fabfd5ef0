// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Meshes and brute-force answers for the tests of the contact room.

#include "contact/broad_phase.hpp"
#include "exec/arena.hpp"
#include "exec/cpu.hpp"
#include "geometry/closest_feature.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace noli::contact_test {

struct Shape {
    CollisionMesh mesh;
    std::vector<Vec3d> x;

    [[nodiscard]] View<const Vec3d> view() const { return {x.data(), int(x.size())}; }
};

inline View<const Vec3d> view_of(const std::vector<Vec3d>& v) {
    return {v.data(), int(v.size())};
}

/// Fills in everything that follows from x, triangles and (if given) extra edges and
/// points.
inline void complete(Shape& shape,
                     const std::vector<Int2>& more_edges = {},
                     const std::vector<int>& more_points = {}) {
    CollisionMesh& m = shape.mesh;
    std::set<std::pair<int, int>> edges;
    std::set<int> vertices(more_points.begin(), more_points.end());
    for (const Int3& t : m.triangles)
        for (int k = 0; k < 3; ++k)
            edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
    for (const Int2& e : more_edges)
        edges.insert(std::minmax(e[0], e[1]));
    for (const auto& [a, b] : edges) {
        m.edges.push_back({{a, b}});
        m.edge_rest_sq.push_back(
            norm_sq(shape.x[std::size_t(a)] - shape.x[std::size_t(b)]));
        vertices.insert({a, b});
    }
    m.vertices.assign(vertices.begin(), vertices.end());
    m.num_vertices = int(shape.x.size());
    m.body.resize(shape.x.size(), 0);
    m.kinematic.resize(shape.x.size(), 0);
    m.num_bodies =
        1 + (m.body.empty() ? 0 : *std::max_element(m.body.begin(), m.body.end()));
    m.pair_enabled.assign(std::size_t(m.num_bodies * m.num_bodies), 1);
    m.wall_enabled.assign(m.walls.size() * std::size_t(m.num_bodies), 1);
}

inline Vec3d random_vector(std::mt19937& rng, double size) {
    std::uniform_real_distribution<double> u(-size, size);
    const double a = u(rng);
    const double b = u(rng);
    return {a, b, u(rng)};
}

/// n separate triangles with edges of about `size` in a box of half-width 1; body =
/// triangle % bodies.
inline Shape soup(int n, double size, unsigned seed, int bodies = 3) {
    std::mt19937 rng(seed);
    Shape s;
    for (int i = 0; i < n; ++i) {
        const Vec3d c = random_vector(rng, 1.0);
        for (int k = 0; k < 3; ++k) {
            s.x.push_back(c + random_vector(rng, size));
            s.mesh.body.push_back(i % bodies);
        }
        s.mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
    }
    complete(s);
    return s;
}

/// Appends a sphere of n x 2n cells as a new body.
inline void add_sphere(Shape& s, const Vec3d& centre, double radius, int n) {
    const int first = int(s.x.size());
    const int body = s.mesh.body.empty() ? 0 : s.mesh.body.back() + 1;
    const int around = 2 * n;
    const double kPi = 3.14159265358979323846;
    s.x.push_back(centre + Vec3d{0, 0, radius});
    for (int i = 1; i < n; ++i)
        for (int j = 0; j < around; ++j) {
            const double theta = kPi * i / n;
            const double phi = 2 * kPi * (j + 0.5 * (i % 2)) / around;
            s.x.push_back(centre
                          + radius
                                * Vec3d{std::sin(theta) * std::cos(phi),
                                        std::sin(theta) * std::sin(phi),
                                        std::cos(theta)});
        }
    s.x.push_back(centre - Vec3d{0, 0, radius});
    const auto id = [&](int i, int j) {
        return first + 1 + (i - 1) * around + j % around;
    };
    const int last = int(s.x.size()) - 1;
    for (int j = 0; j < around; ++j) {
        s.mesh.triangles.push_back({{first, id(1, j), id(1, j + 1)}});
        s.mesh.triangles.push_back({{last, id(n - 1, j + 1), id(n - 1, j)}});
        for (int i = 1; i + 1 < n; ++i) {
            s.mesh.triangles.push_back({{id(i, j), id(i + 1, j), id(i + 1, j + 1)}});
            s.mesh.triangles.push_back({{id(i, j), id(i + 1, j + 1), id(i, j + 1)}});
        }
    }
    s.mesh.body.resize(s.x.size(), body);
}

/// Two spheres `gap` apart along x, slightly turned against each other by their different
/// resolution.
inline Shape two_spheres(double gap, int n) {
    Shape s;
    add_sphere(s, {-1.0 - 0.5 * gap, 0.0, 0.0}, 1.0, n);
    add_sphere(s, {1.0 + 0.5 * gap, 0.03, 0.01}, 1.0, n + 1);
    complete(s);
    return s;
}

/// A sheet of n x 2n cells folded once, its halves `gap` apart.
inline Shape folded_sheet(int n, double gap) {
    Shape s;
    for (int j = 0; j <= 2 * n; ++j)
        for (int i = 0; i <= n; ++i) {
            const double u = double(i) / n;
            const double v = double(j) / n;
            const bool upper = j > n;
            const double y = upper ? 2.0 - v : v;
            const double z = upper ? gap : 0.0;
            s.x.push_back({u + 0.003 * std::sin(7 * v),
                           y,
                           z + 0.1 * gap * std::sin(13 * u + 5 * v)});
        }
    const auto id = [&](int i, int j) { return j * (n + 1) + i; };
    for (int j = 0; j < 2 * n; ++j)
        for (int i = 0; i < n; ++i) {
            s.mesh.triangles.push_back({{id(i, j), id(i + 1, j), id(i + 1, j + 1)}});
            s.mesh.triangles.push_back({{id(i, j), id(i + 1, j + 1), id(i, j + 1)}});
        }
    complete(s);
    return s;
}

inline Stencil<4> vertex_triangle_stencil(const Shape& s,
                                          int vertex,
                                          int triangle,
                                          const std::vector<Vec3d>& x) {
    const Int3& t = s.mesh.triangles[std::size_t(triangle)];
    return {{x[std::size_t(vertex)],
             x[std::size_t(t[0])],
             x[std::size_t(t[1])],
             x[std::size_t(t[2])]}};
}
inline Stencil<4> edge_edge_stencil(const Shape& s,
                                    int a,
                                    int b,
                                    const std::vector<Vec3d>& x) {
    const Int2& ea = s.mesh.edges[std::size_t(a)];
    const Int2& eb = s.mesh.edges[std::size_t(b)];
    return {{x[std::size_t(ea[0])],
             x[std::size_t(ea[1])],
             x[std::size_t(eb[0])],
             x[std::size_t(eb[1])]}};
}

inline std::vector<Vec3d> moved(const Shape& s, const std::vector<Vec3d>& p, double t) {
    std::vector<Vec3d> out = s.x;
    for (std::size_t i = 0; i < out.size() && i < p.size(); ++i)
        out[i] += t * p[i];
    return out;
}

inline CollisionMeshView host_view(const CollisionMesh& m) {
    const auto v = [](const auto& list) {
        using T = typename std::decay_t<decltype(list)>::value_type;
        return View<const T>{list.data(), int(list.size())};
    };
    return {v(m.vertices),
            v(m.edges),
            v(m.edge_rest_sq),
            v(m.triangles),
            v(m.body),
            v(m.kinematic),
            m.num_bodies,
            v(m.pair_enabled),
            v(m.walls),
            v(m.wall_enabled)};
}

using PairsOfIds = std::vector<std::pair<int, int>>;

/// All pairs that may collide and that `keep` accepts.
template <class Keep>
PairsOfIds brute_vertex_triangle(const Shape& s, Keep keep) {
    const CollisionMeshView m = host_view(s.mesh);
    PairsOfIds out;
    for (const int v : m.vertices)
        for (int t = 0; t < m.triangles.size; ++t)
            if (m.may_collide(v, m.triangles[t]) && keep(v, t)) out.emplace_back(v, t);
    return out;
}
template <class Keep>
PairsOfIds brute_edge_edge(const Shape& s, Keep keep) {
    const CollisionMeshView m = host_view(s.mesh);
    PairsOfIds out;
    for (int a = 0; a < m.edges.size; ++a)
        for (int b = a + 1; b < m.edges.size; ++b)
            if (m.may_collide(m.edges[a], m.edges[b]) && keep(a, b))
                out.emplace_back(a, b);
    return out;
}

inline PairsOfIds to_vector(View<const Int2> pairs) {
    PairsOfIds out;
    for (const Int2& p : pairs)
        out.emplace_back(p[0], p[1]);
    return out;
}

/// Is every item of `small` in `large` (both ascending)?
inline bool is_subset(const PairsOfIds& small, const PairsOfIds& large) {
    return std::includes(large.begin(), large.end(), small.begin(), small.end());
}

struct CandidateLists {
    PairsOfIds vertex_triangle;
    PairsOfIds edge_edge;
    PairsOfIds vertex_wall;
    friend bool operator==(const CandidateLists&, const CandidateLists&) = default;
};

template <class Exec>
CandidateLists candidates_of(Exec& exec,
                             const Shape& s,
                             const std::vector<Vec3d>& p,
                             double alpha,
                             double inflation,
                             const std::vector<Vec3d>* sort_at = nullptr) {
    DeviceCollisionMesh<Exec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<Exec> broad_phase;
    if (sort_at != nullptr) broad_phase.sort(exec, mesh.view(), view_of(*sort_at));
    Candidates<Exec> out;
    find_candidates(
        exec, mesh, broad_phase, {s.view(), view_of(p), alpha}, inflation, out);
    return {to_vector(out.vertex_triangle.view()),
            to_vector(out.edge_edge.view()),
            to_vector(out.vertex_wall.view())};
}

/// Calls check(result, name) for the result of run(exec) on every executor and 1 to 4
/// threads.
template <class Run, class Check>
void on_all_executors(Run run, Check check) {
    SerialExec serial;
    check(run(serial), "serial");
    ShuffledExec shuffled;
    check(run(shuffled), "shuffled");
    for (const int threads : {1, 2, 3, 4}) {
        Arena arena(threads);
        arena.run([&] {
            CpuExec cpu;
            check(run(cpu), "cpu");
        });
    }
}

}  // namespace noli::contact_test
