// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What scene tests share: small scenes in code, and the invariants that every step must
/// keep.

#include "noli/simulator.hpp"

#include "mesh/write.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace noli::test {

inline Affine placed(double x, double y, double z, double scale = 1.0) {
    Affine at;
    at.rows = {{{scale, 0, 0, x}, {0, scale, 0, y}, {0, 0, scale, z}}};
    return at;
}

/// A folder of this test run that is empty at the start.
inline std::string scratch_folder(const std::string& name) {
    const auto folder = std::filesystem::temp_directory_path() / ("noli_scene_" + name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder.string();
}

/// A body whose mesh is given by its tets, through a file as a user's would be.
inline Body body_of_tets(const std::string& folder,
                         const std::string& name,
                         const std::vector<Vec3d>& x,
                         const std::vector<Int4>& tets) {
    Body body;
    body.name = name;
    body.mesh.file = folder + "/" + name + ".msh";
    body.mesh.fix_orientation = true;
    Mesh mesh;
    mesh.x = x;
    mesh.tets = tets;
    const std::optional<Error> failed = write_mesh(body.mesh.file, mesh);
    EXPECT_FALSE(failed) << failed->message;
    return body;
}

inline Body generated(
    const std::string& name,
    const std::string& generator,
    std::vector<std::pair<std::string, std::vector<double>>> parameters = {}) {
    Body body;
    body.name = name;
    body.mesh.generator = generator;
    body.mesh.parameters = std::move(parameters);
    return body;
}

inline BoundaryCondition fixed_everywhere() {
    BoundaryCondition fixed;
    fixed.kind = BoundaryCondition::Kind::Fixed;
    return fixed;
}

inline HalfSpace ground(double friction = 0.0, double y = 0.0) {
    HalfSpace plane;
    plane.name = "ground";
    plane.point = {0, y, 0};
    plane.friction = friction;
    return plane;
}

/// The CPU, or the GPU where NOLI_TEST_DEVICE=cuda asks for it (`make gpu-check`).
inline Device device_under_test() {
    const char* asked = std::getenv("NOLI_TEST_DEVICE");
    return asked != nullptr && std::string(asked) == "cuda" ? Device::Cuda : Device::Cpu;
}

inline SimulatorOptions checked_options(int threads = 2) {
    SimulatorOptions options;
    options.device = device_under_test();
    options.threads = threads;
    options.verify = true;
    options.record_iterations = true;
    return options;
}

inline Simulator start(const Scene& scene, const SimulatorOptions& options) {
    Result<Simulator> made = Simulator::create(scene, options);
    if (!made) throw std::runtime_error(made.error().where + ": " + made.error().message);
    return std::move(made.value());
}

/// No intersection, no inversion, a positive gap, converged, and an energy that never
/// rises in a line search (but where prescribed vertices move, and within the recorded
/// rounding).
inline void expect_clean(const StepReport& report) {
    EXPECT_EQ(report.outcome, Outcome::Converged)
        << "step " << report.step << ": " << report.message;
    EXPECT_EQ(report.intersections, 0) << "step " << report.step;
    EXPECT_EQ(report.inversions, 0) << "step " << report.step;
    EXPECT_GT(report.min_gap, 0.0) << "step " << report.step;
    for (const IterationRecord& it : report.iterations) {
        if (it.boundary_moved || it.noise_accepted) continue;
        EXPECT_LE(it.energy_after, it.energy)
            << "step " << report.step << " iteration " << it.iteration;
    }
}

/// Runs and checks `steps` steps; returns the reports.
inline std::vector<StepReport> run_clean(Simulator& simulator, int steps) {
    std::vector<StepReport> reports;
    for (int k = 0; k < steps; ++k) {
        reports.push_back(simulator.step());
        expect_clean(reports.back());
        if (::testing::Test::HasFailure()) break;
    }
    return reports;
}

inline double smallest_gap(const std::vector<StepReport>& reports) {
    double gap = HUGE_VAL;
    for (const StepReport& report : reports)
        gap = std::min(gap, report.min_gap);
    return gap;
}

inline int most_contacts(const std::vector<StepReport>& reports) {
    int most = 0;
    for (const StepReport& report : reports)
        most = std::max(most, report.contacts);
    return most;
}

/// Mass-weighted means would need masses; for equal bodies the plain mean serves.
inline Vector3 mean(const std::vector<Vector3>& items) {
    Vector3 sum{};
    for (const Vector3& item : items)
        for (std::size_t k = 0; k < 3; ++k)
            sum[k] += item[k] / static_cast<double>(items.size());
    return sum;
}

}  // namespace noli::test
