// SPDX-License-Identifier: Apache-2.0
#include "sim/verify.hpp"

#include "contact/intersections.hpp"
#include "energy/barrier.hpp"
#include "exec/cpu.hpp"
#include "model/origin.hpp"
#include "sim/beyond_walls.hpp"
#include "step/collision.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace noli {

namespace {

constexpr std::size_t kMaxListed = 1000;

View<const Vec3d> view_of(const std::vector<Vec3d>& x) {
    return {x.data(), static_cast<int>(x.size())};
}

}  // namespace

struct Verifier::Impl {
    const Model& model;
    CpuExec exec;
    IntersectionCheck<CpuExec> check;
    Collision<CpuExec> collision;
    PairSet<CpuExec> pairs;

    explicit Impl(const Model& from) : model(from) {
        check.set_mesh(exec, collision_mesh(from, from.obstacle));
    }

    [[nodiscard]] const std::string& body(int vertex) const {
        return model.body_names[static_cast<std::size_t>(
            model.body[static_cast<std::size_t>(vertex)])];
    }

    void find_pairs(const std::vector<Vec3d>& x) {
        collision.begin_step(exec, model, model.obstacle);
        collision.find_candidates_along(exec, view_of(x), {}, 0.0, model.dhat);
        collision.find_pairs_at(exec, view_of(x), model.dhat, pairs);
    }

    /// Two bodies in ascending order and -1; or a body, -1 and the half-space.
    [[nodiscard]] std::array<int, 3> bodies_of(const MinGap& pair) const {
        const auto of = [&](int v) { return model.body[static_cast<std::size_t>(v)]; };
        const Int4& v = pair.vertices;
        const int a = of(v[0]);
        if (pair.kind == MinGap::Kind::Wall) return {a, -1, v[1]};
        const bool edges =
            pair.kind == MinGap::Kind::EdgeEdge || pair.kind == MinGap::Kind::Mollified;
        const int b = of(v[edges ? 2 : 1]);
        return {std::min(a, b), std::max(a, b), -1};
    }

    MinGap closest(const std::vector<Vec3d>& x) {
        find_pairs(x);
        return collision.closest_at(exec, pairs, view_of(x));
    }

    void look_for_too_close(const std::vector<Vec3d>& x, VerifyReport& report) {
        const MinGap pair = closest(x);
        if (pair.gap > model.min_separation) return;
        ++report.num_intersections;
        report.too_close = describe_too_close(model, pair);
    }

    void list(VerifyReport& report,
              const Int2& edge,
              const Int3& triangle,
              const Vec3d& place,
              const std::string& other) const {
        ++report.num_intersections;
        if (report.intersections.size() == kMaxListed) return;
        const Vec3d at = in_world(model, place);
        report.intersections.push_back({{edge[0], edge[1]},
                                        {triangle[0], triangle[1], triangle[2]},
                                        {at.x, at.y, at.z},
                                        body(edge[0]),
                                        other});
    }
};

Verifier::Verifier(const Model& model) : impl_(std::make_unique<Impl>(model)) {}
Verifier::~Verifier() = default;

VerifyReport Verifier::run(const std::vector<Vec3d>& x) {
    Impl& in = *impl_;
    VerifyReport report;
    const Intersections found = in.check.run(in.exec, view_of(x));
    for (const EdgeTriangleIntersection& hit : found.edge_triangle)
        in.list(report, hit.edge, hit.triangle, hit.place, in.body(hit.triangle[0]));
    for (const VertexOnTriangle& hit : found.vertex_triangle)
        in.list(report,
                {{hit.vertex, hit.vertex}},
                hit.triangle,
                hit.place,
                in.body(hit.triangle[0]));
    report.beyond_walls = beyond_walls(in.model, found.vertex_wall, x);
    report.num_intersections += static_cast<int>(found.vertex_wall.size());
    if (in.model.min_separation > 0.0) in.look_for_too_close(x, report);

    const View<const Int4> tets{in.model.tets.data(), in.model.num_tets()};
    report.num_inversions = count_inverted(in.exec, tets, view_of(x)).count;
    for (int t = 0; report.num_inversions > 0 && t < tets.size; ++t) {
        const auto at = [&](int k) { return x[static_cast<std::size_t>(tets[t][k])]; };
        if (orient3d_sign(at(0), at(1), at(2), at(3)) <= 0
            && report.inverted_tets.size() < kMaxListed)
            report.inverted_tets.push_back(
                in.model.tet_source[static_cast<std::size_t>(t)]);
    }
    return report;
}

double Verifier::min_gap(const std::vector<Vec3d>& x) {
    return impl_->closest(x).gap;
}

std::vector<BodyGap> Verifier::gaps(const std::vector<Vec3d>& x, int exponent) {
    Impl& in = *impl_;
    in.find_pairs(x);
    const detail::PairSetReader pairs = in.collision.reader(in.pairs);
    std::vector<double> distances(static_cast<std::size_t>(pairs.size()));
    detail::pair_distances<Doubles::First>(
        in.exec, pairs, view_of(x), {distances.data(), pairs.size()});
    const double dhat_sq = in.model.dhat * in.model.dhat;
    const auto square = [&](double distance) {
        const double gap = distance - in.model.min_separation;
        return gap * gap;
    };
    std::map<std::array<int, 3>, BodyGap> found;
    for (int i = 0; i < pairs.size(); ++i) {
        MinGap pair = pairs.name(i);
        pair.gap = distances[static_cast<std::size_t>(i)];
        const std::array<int, 3> who = in.bodies_of(pair);
        BodyGap& gap = found[who];
        if (gap.a < 0) gap = {who[0], who[1], who[2], pair, 0.0};
        if (pair.gap < gap.closest.gap) gap.closest = pair;
        if (pair.kind != MinGap::Kind::Mollified)
            gap.barrier += barrier(exponent, square(pair.gap), dhat_sq).value;
    }
    std::vector<BodyGap> out;
    for (const auto& [who, gap] : found)
        out.push_back(gap);
    return out;
}

std::vector<ExactIntersection> Verifier::obstacle_overlaps(const std::vector<Vec3d>& x) {
    const Impl& in = *impl_;
    const auto is_obstacle = [&](int v) {
        return in.model.obstacle[static_cast<std::size_t>(v)] != 0;
    };
    CollisionMesh mesh =
        collision_mesh(in.model, std::vector<std::uint8_t>(in.model.obstacle.size(), 0));
    std::erase_if(mesh.vertices, [&](int v) { return !is_obstacle(v); });
    std::erase_if(mesh.edges, [&](const Int2& e) { return !is_obstacle(e[0]); });
    std::erase_if(mesh.triangles, [&](const Int3& t) { return !is_obstacle(t[0]); });
    mesh.edge_rest_sq.resize(mesh.edges.size());
    mesh.walls.clear();
    const std::size_t n = static_cast<std::size_t>(mesh.num_bodies);
    for (std::size_t b = 0; b < n; ++b)
        mesh.pair_enabled[b * n + b] = 0;
    CpuExec exec;
    IntersectionCheck<CpuExec> check;
    check.set_mesh(exec, mesh);
    VerifyReport report;
    for (const EdgeTriangleIntersection& hit : check.run(exec, view_of(x)).edge_triangle)
        in.list(report, hit.edge, hit.triangle, hit.place, in.body(hit.triangle[0]));
    return report.intersections;
}

}  // namespace noli
