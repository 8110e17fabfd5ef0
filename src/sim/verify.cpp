// SPDX-License-Identifier: Apache-2.0
#include "sim/verify.hpp"

#include "contact/intersections.hpp"
#include "exec/cpu.hpp"
#include "step/collision.hpp"

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

    void list(VerifyReport& report,
              const Int2& edge,
              const Int3& triangle,
              const Vec3d& place,
              const std::string& other) const {
        ++report.num_intersections;
        if (report.intersections.size() == kMaxListed) return;
        report.intersections.push_back({{edge[0], edge[1]},
                                        {triangle[0], triangle[1], triangle[2]},
                                        {place.x, place.y, place.z},
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
    for (const VertexBehindPlane& hit : found.vertex_plane)
        in.list(report,
                {{hit.vertex, hit.vertex}},
                {{-1, -1, -1}},
                x[static_cast<std::size_t>(hit.vertex)],
                in.model.planes[static_cast<std::size_t>(hit.plane)].name);

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
    Impl& in = *impl_;
    in.collision.begin_step(in.exec, in.model, in.model.obstacle);
    in.collision.find_candidates_along(in.exec, view_of(x), {}, 0.0, in.model.dhat);
    in.collision.find_pairs_at(in.exec, view_of(x), in.model.dhat, in.pairs);
    return in.exec.value(in.collision.gap_at(in.exec, in.pairs, view_of(x)));
}

}  // namespace noli
