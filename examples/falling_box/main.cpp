// SPDX-License-Identifier: Apache-2.0
// A box falls on the ground: the whole library in one small program.
#include <cstdio>
#include <noli/simulator.hpp>

int main() {
    noli::Scene scene;
    scene.name = "falling box";
    scene.dt = 0.01;

    noli::Body box;
    box.name = "box";
    box.mesh.generator = "box";
    box.transform.rows[1][3] = 0.7;  // 0.7 m up
    scene.bodies.push_back(box);
    scene.half_spaces.push_back({.name = "ground"});

    noli::Result<noli::Simulator> made = noli::Simulator::create(scene);
    if (!made) {
        std::fprintf(
            stderr, "%s: %s\n", made.error().where.c_str(), made.error().message.c_str());
        return 2;
    }
    noli::Simulator& simulator = made.value();
    for (int k = 0; k < 50; ++k) {
        const noli::StepReport report = simulator.step();
        std::printf("t = %.2f s: %d contacts, gap %g m\n",
                    report.time,
                    report.contacts,
                    report.min_gap);
        if (report.outcome != noli::Outcome::Converged) return 3;
    }
    return simulator.verify().num_intersections == 0 ? 0 : 1;
}
