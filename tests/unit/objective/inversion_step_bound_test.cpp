// SPDX-License-Identifier: Apache-2.0
/// The step bound over all tetrahedra is the least of the bounds of each, to the bit.

#include "exec/cpu.hpp"
#include "objective/elastic_terms.hpp"
#include "random_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace noli {
namespace {

using namespace test;

constexpr double kKeep = 0.2;

std::vector<Vec3d> motion(const RandomMesh& mesh, double size) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> by(-size, size);
    std::vector<Vec3d> p(mesh.x.size());
    for (Vec3d& v : p)
        v = {by(random), by(random), by(random)};
    return p;
}

double bound_of(const RandomMesh& mesh, const std::vector<Vec3d>& p, int t) {
    Stencil<4> at;
    Stencil<4> move;
    for (int c = 0; c < 4; ++c) {
        const auto v =
            static_cast<std::size_t>(mesh.model.tets[static_cast<std::size_t>(t)][c]);
        at.x[c] = mesh.model.x0[v];
        move.x[c] = p[v];
    }
    return inversion_bound(at, move, kKeep);
}

template <class Exec>
void expect_bounds_of_each(const RandomMesh& mesh, double size) {
    Exec exec;
    DeviceModel<Exec> device;
    device.upload(exec, mesh.model);
    const std::vector<Vec3d> p = motion(mesh, size);
    HostBuffer<double> per_tet;
    const InversionBound got =
        inversion_step_bound(
            exec, device, view_of(mesh.model.x0), view_of(p), kKeep, per_tet)
            .value(exec);
    double least = 1.0;
    for (int t = 0; t < mesh.model.num_tets(); ++t) {
        EXPECT_EQ(per_tet.view()[t], bound_of(mesh, p, t)) << size << ' ' << t;
        least = std::fmin(least, bound_of(mesh, p, t));
    }
    EXPECT_EQ(got.alpha, least);
    if (least < 1.0) {
        EXPECT_EQ(bound_of(mesh, p, got.tet), least);
    } else {
        EXPECT_EQ(got.tet, -1);
    }
}

TEST(InversionStepBound, IsTheLeastOfTheTetrahedraToTheBit) {
    for (const RandomMesh& mesh : meshes())
        for (const double size : {0.0, 1e-3, 0.1, 0.5, 3.0}) {
            expect_bounds_of_each<SerialExec>(mesh, size);
            expect_bounds_of_each<ShuffledExec>(mesh, size);
            expect_bounds_of_each<CpuExec>(mesh, size);
        }
}

}  // namespace
}  // namespace noli
