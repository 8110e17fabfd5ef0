#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement sections 2-4, 8: does the Gauss-Newton barrier lower Newton counts, and does it stall?

Runs every scene of study_scenes.py with each contact Hessian, barrier exponent and linear solver, and
again with the time step changed in its 8th digit, which shows how much of a difference is noise.
Writes newton_counts.csv (one row per run) and newton_counts.md.
"""
import argparse
import csv
import math
import os
import pathlib

import runs
import study_scenes

MODELS = {
    "ipc": {"model": "ipc"},
    "exact r1": {"hessian": "exact", "mollifier": "exact", "barrier_exponent": 1},
    "gn r1": {"hessian": "gn", "barrier_exponent": 1},
    "gn+ r1": {"hessian": "gn+", "barrier_exponent": 1},
    "exact r2": {"hessian": "exact", "mollifier": "exact"},
    "gn r2": {"hessian": "gn"},
    "gn+ r2": {"hessian": "gn+"},
}
SOLVERS = {"direct": {"linear": "cholmod"}, "pcg": {"linear": "pcg", "pcg_tolerance": 1e-4}}
FRESH_CONTACT = {key: None for key in ("model", "hessian", "mollifier", "barrier_exponent")}


def variant(scene, model, solver, nudge):
    """The scene under one model; plain gn must show its stalls, so nothing strengthens it."""
    scene = runs.merged(scene, {"contact": FRESH_CONTACT})
    return runs.merged(scene, {
        "contact": {**MODELS[model], "strengthen": False},
        "solver": {**SOLVERS[solver], "max_newton": 2000},
        "dt": float_of(scene.get("dt", 0.025)) * (1.0 + 1e-8 * nudge)})


def float_of(quantity):
    if isinstance(quantity, str):
        raise ValueError(f"a plain number of seconds expected, not {quantity}")
    return quantity


def study(noli, folder, names, nudges, timeout, workers):
    jobs = []
    for name in names:
        make, steps, kind = study_scenes.SCENES[name]
        scene = make(noli)
        if scene is None:
            print(f"{name}: skipped, the shared scenes are not there")
            continue
        for solver in SOLVERS:
            for model in MODELS:
                for nudge in range(nudges + 1):
                    label = f"{name}-{model.replace(' ', '_')}-{solver}-{nudge}"
                    jobs.append((name, kind, steps, model, solver, nudge, label,
                                 variant(scene, model, solver, nudge)))

    def execute(job):
        name, kind, steps, model, solver, nudge, label, scene = job
        done = runs.run(noli, runs.as_in_paper(scene), label, folder, steps, timeout)
        return {"scene": name, "class": kind, "steps": steps, "model": model, "solver": solver,
                "nudge": nudge, "newton": done.newton, "pcg": done.pcg, "ended": done.ended,
                "contacts": done.contacts, "min_gap": done.min_gap, "wall_s": round(done.wall_s, 3),
                "limiting": done.limiting}

    return runs.run_all([lambda job=job: execute(job) for job in jobs], workers)


def pick(table, **wanted):
    return [row for row in table if all(row[key] == value for key, value in wanted.items())]


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values)) if values else float("nan")


def cell(rows):
    """All counts of one scene and model: the run as it is, then the nudged ones."""
    return " / ".join(row["ended"] or str(row["newton"]) for row in sorted(rows, key=lambda r: r["nudge"]))


def count_table(table, solver):
    names = list(dict.fromkeys(row["scene"] for row in table))
    lines = ["| scene (steps) | " + " | ".join(MODELS) + " |", "| --- " * (len(MODELS) + 1) + "|"]
    for name in names:
        steps = pick(table, scene=name)[0]["steps"]
        cells = [cell(pick(table, scene=name, model=model, solver=solver)) for model in MODELS]
        lines.append(f"| {name} ({steps}) | " + " | ".join(cells) + " |")
    return lines


def ratios(table, model, baseline, solver):
    """Count of `model` over that of `baseline`, per scene and nudge, where both finished."""
    out = []
    for row in pick(table, model=model, solver=solver):
        base = pick(table, scene=row["scene"], model=baseline, solver=solver, nudge=row["nudge"])
        if base and not row["ended"] and not base[0]["ended"]:
            out.append(row["newton"] / base[0]["newton"])
    return out


def summary_table(table):
    lines = ["| model | solver | runs | ended early | scenes with an early end | geometric mean of the "
             "count to ipc | range |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for solver in SOLVERS:
        for model in MODELS:
            mine = pick(table, model=model, solver=solver)
            early = [row for row in mine if row["ended"]]
            shares = ratios(table, model, "ipc", solver)
            spread = f"{min(shares):.2f}-{max(shares):.2f}" if shares else ""
            lines.append(f"| {model} | {solver} | {len(mine)} | {len(early)} | "
                         f"{len({row['scene'] for row in early})} | {geometric_mean(shares):.3f} | {spread} |")
    return lines


def noise(table):
    """Typical change of a count by a nudge: geometric mean and largest of max/min over the nudges."""
    spreads = []
    for name in {row["scene"] for row in table}:
        for model in MODELS:
            for solver in SOLVERS:
                counts = [row["newton"] for row in pick(table, scene=name, model=model, solver=solver)
                          if not row["ended"]]
                if len(counts) > 1:
                    spreads.append(max(counts) / min(counts))
    return geometric_mean(spreads), max(spreads, default=float("nan"))


def early_ends(table):
    lines = ["| scene | model | solver | nudge | ended | limited by |", "| --- | --- | --- | --- | --- | --- |"]
    lines += [f"| {r['scene']} | {r['model']} | {r['solver']} | {r['nudge']} | {r['ended']} | {r['limiting']} |"
              for r in table if r["ended"]]
    return lines


def write(table, out):
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "newton_counts.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    typical, largest = noise(table)
    lines = ["# Newton counts", "", *summary_table(table), "",
             f"Noise: dt changed in the 8th digit changes a count by a factor {typical:.3f} (geometric mean), "
             f"{largest:.2f} at most.", ""]
    for solver in SOLVERS:
        lines += [f"## {solver}", "", *count_table(table, solver), ""]
    lines += ["## Early ends", "", *early_ends(table), ""]
    (out / "newton_counts.md").write_text("\n".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(runs.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=runs.ROOT / "out/paper")
    parser.add_argument("--work", type=pathlib.Path, default=runs.ROOT / "out/paper/runs")
    parser.add_argument("--scenes", nargs="*", default=list(study_scenes.SCENES))
    parser.add_argument("--nudges", type=int, default=1, help="further runs with dt changed in its 8th digit")
    parser.add_argument("--timeout", type=float, default=60, help="seconds per run")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    table = study(arguments.noli, arguments.work, arguments.scenes, arguments.nudges, arguments.timeout,
                  arguments.workers)
    write(table, arguments.out)
    print("\n".join(summary_table(table)))


if __name__ == "__main__":
    main()
