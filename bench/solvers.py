#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Seconds of linear solving, by solver, in one run: the reference scenes as they are and at E = 1e7 Pa, nu = 0.49,
and the stiff families, each with the solver that the program chooses, with block Jacobi and with CHOLMOD, one right
after the other. Sums are over the steps that all three finished. Writes solvers.csv and solvers.md."""
import argparse
import os
import pathlib
import re
import sys

import families
import machine
import scenes

sys.path.insert(0, str(machine.ROOT / "paper"))
import runs  # noqa: E402

SOLVERS = {"chosen": {}, "block Jacobi": {"linear": "block_jacobi"}, "CHOLMOD": {"linear": "cholmod"}}
STEPS = {"2cubesFall": 200, "10_cubeStack": 200, "rodsTwist_120": 40, "mat40x40_twist_100": 30,
         "sphere1K_rollers_25": 8, "dolphinFunnel_50": 18}
STIFF_STEPS = {"rodsTwist_120": 20, "mat40x40_twist_100": 15, "dolphinFunnel_50": 10}
FAMILY_STEPS = 5
CHOSEN = re.compile(r"linear solver: (.*)")


def stiffer(scene):
    """The scene with all its elastic bodies at E = 1e7 Pa, nu = 0.49."""
    bodies = [runs.merged(body, {"material": families.STIFF}) if "material" in body else body
              for body in scene["bodies"]]
    return {**scene, "bodies": bodies}


def jobs_of(noli, full):
    """(name, scene, steps)"""
    jobs = []
    reference = {job.name: job.scene for job in scenes.reference_jobs(noli)}
    jobs += [(name, reference[name], steps) for name, steps in STEPS.items() if name in reference]
    jobs += [(f"{name} E 1e7", stiffer(reference[name]), steps) for name, steps in STIFF_STEPS.items()
             if name in reference]
    jobs += [(f"{name} {tets} E 1e7", make(tets, **families.STIFF), FAMILY_STEPS)
             for name, make in families.FAMILIES.items() for tets in ([10_000, 30_000] if full else [10_000])]
    return jobs


def first_steps(run, steps, key):
    return sum(float(row[key]) for row in run.rows[:steps])


def compare(arguments, name, scene, steps):
    """One row per solver."""
    found = {}
    for solver, settings in SOLVERS.items():
        changed = runs.merged(scene, {"solver": {"linear": None, **settings}})
        label = f"{name}_{solver}".replace(" ", "_")
        found[solver] = runs.run(arguments.noli, changed, label, arguments.work, steps, arguments.limit,
                                 threads=os.cpu_count(), options=scenes.QUIETLY[:2])
        print(f"{label}: {found[solver].steps} steps, {found[solver].newton} newton {found[solver].ended}", flush=True)
    common = min(run.steps for run in found.values())
    rows = []
    for solver, run in found.items():
        said = CHOSEN.search((arguments.work / run.name / "log.txt").read_text())
        newton, solve = (first_steps(run, common, key) for key in ("newton", "t_solve"))
        rows.append({**machine.identity(), "scene": name, "solver": solver, "chosen": said.group(1) if said else "",
                     "steps": common, "newton": int(newton), "pcg": int(first_steps(run, common, "pcg")),
                     "solve_s": solve, "ms_per_solve": 1e3 * solve / max(newton, 1),
                     "wall_s": first_steps(run, common, "wall_s"), "ended": run.ended})
    for row in rows:
        row["slower_than_chosen"] = row["solve_s"] / rows[0]["solve_s"] if rows[0]["solve_s"] > 0 else ""
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(machine.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=machine.ROOT / "out/bench")
    parser.add_argument("--work", type=pathlib.Path, help="where the runs go; default: OUT/runs")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--scenes", help="only scenes whose name matches this regular expression")
    parser.add_argument("--limit", type=float, help="seconds per run")
    arguments = parser.parse_args()
    arguments.work = arguments.work or arguments.out / "runs"
    arguments.limit = arguments.limit or (600 if arguments.full else 15)
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, scene, steps in jobs_of(arguments.noli, arguments.full):
        if arguments.scenes is None or re.search(arguments.scenes, name):
            rows += compare(arguments, name, scene, steps)
            machine.write_csv(arguments.out / "solvers.csv", rows)
    columns = {"scene": "scene", "solver": "solver", "steps": "steps", "newton": "newton", "pcg": "pcg",
               "solve s": "solve_s", "ms/solve": "ms_per_solve", "wall s": "wall_s",
               "slower than chosen": "slower_than_chosen"}
    (arguments.out / "solvers.md").write_text(
        "## Linear solvers\n\nSteps that all three finished; \"chosen\" is what the program takes by itself.\n\n"
        + machine.table(rows, columns))
    return 0 if rows else 1


if __name__ == "__main__":
    raise SystemExit(main())
