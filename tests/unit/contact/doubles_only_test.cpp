// SPDX-License-Identifier: Apache-2.0
/// A device computes in doubles only, and repeats with exact stages where these do not
/// suffice: the same pairs, gap and step bound as on the CPU, either way.

#include "contact/min_gap.hpp"
#include "contact/step_bound.hpp"
#include "contact_shapes.hpp"
#include "support/device_like_exec.hpp"

namespace noli {
namespace {

using namespace contact_test;
using test::DeviceLikeExec;

/// Turns by no simple angle, so that edges that are parallel are so up to rounding.
Vec3d turned(const Vec3d& a) {
    const double c = std::cos(0.7);
    const double s = std::sin(0.7);
    const Vec3d b{c * a.x + s * a.y, c * a.y - s * a.x, a.z};
    return {b.x, c * b.y + s * b.z, c * b.z - s * b.y};
}

void add_tetrahedron(Shape& s, const Vec3d& corner, double height) {
    const int first = int(s.x.size());
    const int body = s.mesh.body.empty() ? 0 : s.mesh.body.back() + 1;
    for (const Vec3d& a :
         {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0.2, 0.3, height}})
        s.x.push_back(turned(corner + a));
    for (const Int3& t :
         {Int3{{0, 1, 2}}, Int3{{0, 1, 3}}, Int3{{1, 2, 3}}, Int3{{2, 0, 3}}})
        s.mesh.triangles.push_back({{first + t[0], first + t[1], first + t[2]}});
    s.mesh.body.resize(s.x.size(), body);
}

/// Two tetrahedra base to base, 0.03 apart, one 0.1 beside the other.
Shape parallel_bases() {
    Shape s;
    add_tetrahedron(s, {0, 0, 0}, -1.0);
    add_tetrahedron(s, {0.1, 0.05, 0.03}, 1.0);
    complete(s);
    return s;
}

/// Both bodies move towards each other.
std::vector<Vec3d> closing(const Shape& s, const Vec3d& way) {
    std::vector<Vec3d> p;
    for (std::size_t i = 0; i < s.x.size(); ++i)
        p.push_back(s.mesh.body[i] == 0 ? 0.5 * way : -0.5 * way);
    return p;
}

struct Found {
    std::vector<int> ids;
    std::vector<double> numbers;
    Doubles doubles = Doubles::First;
};

template <class Exec, class Item>
void append(Exec& exec, const typename Exec::template Buffer<Item>& list, Found& out) {
    std::vector<Item> items;
    exec.download(View<const Item>(list.view()), items);
    out.ids.push_back(int(items.size()));
    for (const Item& item : items)
        out.ids.insert(out.ids.end(), std::begin(item.v), std::end(item.v));
}

template <class Exec>
Found found_on(const Shape& s, const std::vector<Vec3d>& p) {
    constexpr double kDhat = 0.1;
    Exec exec;
    DeviceCollisionMesh<Exec> mesh;
    mesh.upload(exec, s.mesh);
    typename Exec::template Buffer<Vec3d> x;
    typename Exec::template Buffer<Vec3d> way;
    exec.upload(s.x, x);
    exec.upload(p, way);
    BroadPhase<Exec> broad_phase;
    Candidates<Exec> candidates;
    find_candidates(
        exec, mesh, broad_phase, {x.view(), way.view(), 1.0}, kDhat, candidates);
    Found out;
    PairSet<Exec> pairs;
    FindPairsWork<Exec> work;
    find_pairs(exec, mesh, candidates, x.view(), kDhat, work, pairs);
    append<Exec, Int2>(exec, pairs.pp, out);
    append<Exec, Int3>(exec, pairs.pe, out);
    append<Exec, Int4>(exec, pairs.pt, out);
    append<Exec, Int4>(exec, pairs.ee, out);
    out.ids.push_back(pairs.mollified.size());
    out.doubles = pairs.doubles;

    MinGapWork<Exec> gap_work;
    const MinGap gap = min_gap(exec, mesh, pairs, x.view(), gap_work);
    StepBoundWork<Exec> bound_work;
    const StepBound bound =
        step_bound(exec, mesh, candidates, x.view(), way.view(), 1.0, {}, bound_work);
    out.ids.insert(out.ids.end(), std::begin(gap.vertices.v), std::end(gap.vertices.v));
    out.ids.insert(
        out.ids.end(), std::begin(bound.vertices.v), std::end(bound.vertices.v));
    out.ids.push_back(int(bound.reason));
    out.numbers = {gap.gap, bound.alpha};
    return out;
}

void expect_same(const Shape& s, const Vec3d& way, Doubles expected) {
    const std::vector<Vec3d> p = closing(s, way);
    const Found host = found_on<SerialExec>(s, p);
    const Found device = found_on<DeviceLikeExec>(s, p);
    EXPECT_EQ(host.doubles, Doubles::First);
    EXPECT_EQ(device.doubles, expected);
    EXPECT_EQ(device.ids, host.ids);
    EXPECT_EQ(device.numbers, host.numbers);
    EXPECT_GT(host.numbers[0], 0.0);
    EXPECT_LT(host.numbers[1], 1.0);  // the bodies do meet
}

TEST(DoublesOnly, SufficesForSpheres) {
    expect_same(two_spheres(0.02, 6), {1, 0, 0}, Doubles::Only);
}
TEST(DoublesOnly, GivesWayToExactStagesForParallelEdges) {
    expect_same(parallel_bases(), turned({0, 0, 1}), Doubles::First);
}

}  // namespace
}  // namespace noli
