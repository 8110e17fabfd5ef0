// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the kernel benchmarks compute on: a box of about so many tetrahedra, assembled,
/// and a pile of boxes about to touch.

#include "exec/arena.hpp"
#include "exec/cpu.hpp"
#include "model/model.hpp"
#include "objective/objective.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace noli::bench {

/// Seconds of f().
template <class F>
double seconds(F f) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    f();
    return std::chrono::duration<double>(Clock::now() - start).count();
}

inline int all_threads() {
    return Arena(0).threads();
}

/// A cube of edge 1 m with cells^3 cells of five tetrahedra, turned about y.
inline Body box(int cells, double turn_deg = 0.0) {
    Body body;
    body.mesh.generator = "box";
    const double n = cells;
    body.mesh.parameters = {{"size", {1, 1, 1}}, {"cells", {n, n, n}}};
    const double turn = turn_deg * 3.14159265358979 / 180.0;
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    body.transform.rows = {{{c, 0, s, 0}, {0, 1, 0, 0.5}, {-s, 0, c, 0}}};
    body.material = {.density = 1000.0, .young = 1e5, .poisson = 0.4};
    return body;
}

inline Model model_of(const Scene& scene) {
    Result<Model> model = build_model(scene);
    if (!model) {
        std::cerr << model.error().message << '\n';
        std::exit(1);
    }
    return std::move(model.value());
}

inline View<const Vec3d> view(const std::vector<Vec3d>& a) {
    return {a.data(), static_cast<int>(a.size())};
}

inline std::vector<Vec3d> noise(int count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> by(-size, size);
    std::vector<Vec3d> out(static_cast<std::size_t>(count));
    for (Vec3d& v : out)
        v = {by(random), by(random), by(random)};
    return out;
}

/// A rattled box of about num_tets tetrahedra, one face held, with everything that a
/// Newton iteration without contacts needs.
struct BoxProblem {
    CpuExec exec;
    Model model;
    BlockPattern pattern;
    std::unique_ptr<Objective<CpuExec>> objective;
    PairSet<CpuExec> no_pairs;
    ContactLaw law;
    std::vector<Vec3d> x, b;
    std::vector<double> weight;  ///< of inertia
    std::vector<std::uint8_t> fixed;

    explicit BoxProblem(int num_tets) {
        const int cells = static_cast<int>(std::lround(std::cbrt(num_tets / 5.0)));
        Scene scene;
        scene.bodies = {box(cells)};
        model = model_of(scene);
        pattern = build_block_pattern(model.num_vertices, model.tets);
        objective = std::make_unique<Objective<CpuExec>>(exec, model, pattern);
        x = noise(model.num_vertices, 0.05 / cells, 1);
        fixed.resize(x.size());
        for (std::size_t v = 0; v < x.size(); ++v) {
            fixed[v] = model.x0[v].x < -0.499 ? 1 : 0;
            x[v] = fixed[v] != 0 ? model.x0[v] : model.x0[v] + x[v];
        }
        b = noise(model.num_vertices, 1.0, 2);
        weight.assign(model.x0.size(), 1.0);
        objective->begin_step(exec,
                              StepScales{.h_sq = 1e-4},
                              view(model.x0),
                              view(model.x0),
                              {weight.data(), model.num_vertices},
                              {fixed.data(), model.num_vertices});
        assemble(exec);
    }

    void assemble(CpuExec& on) { objective->assemble(on, view(x), no_pairs, law); }
};

/// The box of that size; the last one is kept, as building a large one takes seconds.
inline BoxProblem& box_problem(int num_tets) {
    static int last = 0;
    static std::unique_ptr<BoxProblem> problem;
    if (last != num_tets) {
        problem.reset();
        problem = std::make_unique<BoxProblem>(num_tets);
        last = num_tets;
    }
    return *problem;
}

inline constexpr double kPileDhat = 1e-3;  ///< m

/// side^3 boxes of 4^3 cells in columns, half a dhat above each other, layers turned in
/// turns so that edges cross.
inline Model pile(int side) {
    Scene scene;
    scene.contact.dhat = kPileDhat;
    scene.contact.dhat_absolute = true;
    for (int layer = 0; layer < side; ++layer) {
        Body body = box(4, layer % 2 == 0 ? 5.0 : -5.0);
        body.name = "layer" + std::to_string(layer);
        body.transform.rows[1][3] += (1.0 + 0.5 * kPileDhat) * layer;
        body.grid = {side, 1, side};
        body.grid_spacing = {1.3, 0.0, 1.3};
        scene.bodies.push_back(body);
    }
    return model_of(scene);
}

}  // namespace noli::bench
