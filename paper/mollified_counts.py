#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement section 4 in use: Newton iterations with the three Hessians of nearly parallel edges, on
scenes of stacked, aligned and crossing edges; each also with dt changed in the 8th digit.
Writes mollified_counts.md."""
import argparse
import os
import pathlib

import newton_counts
import runs
import study_scenes

SCENES = ("stack_1e5", "cube_stack", "combs", "crossing_1e6", "mats_1e4", "rings_1e6")
VARIANTS = ("two_mode", "four_mode", "exact")
HESSIANS = ("gn", "gn+")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(runs.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=runs.ROOT / "out/paper")
    parser.add_argument("--work", type=pathlib.Path, default=runs.ROOT / "out/paper/runs")
    parser.add_argument("--nudges", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=60, help="seconds per run")
    arguments = parser.parse_args()
    jobs = []
    for name in SCENES:
        make, steps, _ = study_scenes.SCENES[name]
        scene = make(arguments.noli)
        if scene is None:
            continue
        scene = runs.merged(scene, {"contact": newton_counts.FRESH_CONTACT})
        for hessian in HESSIANS:
            for variant in VARIANTS:
                for nudge in range(arguments.nudges + 1):
                    changed = runs.merged(scene, {
                        "contact": {"hessian": hessian, "mollifier": variant, "strengthen": False},
                        "dt": newton_counts.float_of(scene.get("dt", 0.025)) * (1 + 1e-8 * nudge)})
                    jobs.append((name, steps, hessian, variant, nudge, changed))

    def execute(job):
        name, steps, hessian, variant, nudge, scene = job
        done = runs.run(arguments.noli, runs.as_in_paper(scene), f"mollified-{name}-{hessian}-{variant}-{nudge}",
                        arguments.work, steps, arguments.timeout)
        return (name, hessian, variant), done.ended or str(done.newton)

    cells = {}
    for key, text in runs.run_all([lambda job=job: execute(job) for job in jobs], os.cpu_count()):
        cells.setdefault(key, []).append(text)
    heads = [(hessian, variant) for hessian in HESSIANS for variant in VARIANTS]
    lines = ["# Newton counts by the mollified Hessian", "", "Barrier exponent 2, PCG; counts of the run and of "
             "those with dt changed in the 8th digit.", "",
             "| scene | " + " | ".join(f"{h}, {v}" for h, v in heads) + " |", "| --- " * (len(heads) + 1) + "|"]
    for name in dict.fromkeys(key[0] for key in cells):
        lines.append(f"| {name} | " + " | ".join(" / ".join(cells[name, h, v]) for h, v in heads) + " |")
    arguments.out.mkdir(parents=True, exist_ok=True)
    (arguments.out / "mollified_counts.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
