#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement section 8, Table 5: the model of Li et al. 2020 against the Gauss-Newton barrier, same
program, same direct solver (CHOLMOD), same everything else.

(a) soft_drop.py at E = 1e4 ... 1e7, nu 0.49, dt 0.01; (b) the dolphin in the funnel at several dt.
Writes table5.csv and table5.md: the printed columns, ours beside the printed average iterations.
"""
import argparse
import csv
import os
import pathlib

import runs
import soft_drop

MODELS = {
    "cpu-Li": {"model": "ipc"},
    "gn+ r2": {"hessian": "gn+"},
    "gn r2": {"hessian": "gn"},
    "gn+ r1": {"hessian": "gn+", "barrier_exponent": 1},
    "exact r2": {"hessian": "exact", "mollifier": "exact"},
}
# Average iterations per step as printed: cpu-Li, cpu-Our.
PRINTED_DROP = {1e4: (33.2, 24.4), 1e5: (26.5, 16.5), 1e6: (24.8, 12.7), 1e7: None}
PRINTED_DOLPHIN = {0.01: (22.7, 20.1), 0.02: (29.6, 23.2), 0.03: (36.8, 28.4), 0.04: (38.4, 28.6),
                   0.05: (43.6, 32.7)}
DOLPHIN = "timed/dolphinFunnel_50.txt"
DOLPHIN_SECONDS = 1.0
PAPER_MODELS = ("cpu-Li", "gn r2")  # those that the paper has
# (size, steps, models): what --full runs of scene (a), and what is run without.
QUICK_DROPS = (("small", 60, tuple(MODELS)),)
FULL_DROPS = (("full", 16, PAPER_MODELS), *QUICK_DROPS)


def cases_of(noli, full):
    """(name, scene, steps, models, printed average iterations) of each case."""
    cases = []
    for size, steps, models in FULL_DROPS if full else QUICK_DROPS:
        for young, printed in PRINTED_DROP.items():
            cases.append((f"drop {size} E {young:g}", soft_drop.soft_drop(young, size), steps, models, printed))
    dolphin = runs.script_scene(DOLPHIN, noli)
    if dolphin is None:
        print("dolphin: skipped, the shared scenes are not there")
        return cases
    for dt, printed in PRINTED_DOLPHIN.items():
        if full or dt == 0.05:
            cases.append((f"dolphin dt {dt:g}", runs.merged(dolphin, {"dt": dt, "duration": DOLPHIN_SECONDS}),
                          round(DOLPHIN_SECONDS / dt), tuple(MODELS), printed))
    return cases


def under(model, scene):
    """The scene with one of MODELS and CHOLMOD; nothing strengthens a Hessian that stalls."""
    fresh = runs.merged(scene, {"contact": dict.fromkeys(("model", "hessian", "mollifier", "barrier_exponent"))})
    return runs.merged(fresh, {"contact": {**MODELS[model], "strengthen": False}, "solver": {"linear": "cholmod"}})


def row_of(case, model, done, printed):
    p = done.phases
    known = p["t_pairs"] + p["t_assemble"] + p["t_solve"] + p["t_ccd"]
    return {
        "case": case, "model": model, "steps": done.steps, "ended": done.ended,
        "buildCP": p["t_pairs"], "buildGH": p["t_assemble"], "solve": p["t_solve"], "CCD": p["t_ccd"],
        "#i": done.newton / max(done.steps, 1), "misc": done.wall_s - known, "timeTot": done.wall_s,
        "barrier": p["t_barrier"], "min_gap": done.min_gap,
        "printed #i": "" if printed is None or model not in PAPER_MODELS
        else printed[PAPER_MODELS.index(model)]}


def measure(arguments, case, scene, steps, models, printed):
    """All models on one case, next to each other in time, so that their times can be compared. A direct
    solver gains nothing from a second core here, so `workers` runs go at a time."""
    threads = 1 if arguments.workers > 1 else os.cpu_count()

    def execute(model):
        label = f"{case} {model}".replace(" ", "_")
        done = runs.run(arguments.noli, runs.as_in_paper(under(model, scene)), label, arguments.work, steps,
                        arguments.timeout, threads=threads)
        row = row_of(case, model, done, printed)
        print(f"{label}: #i {row['#i']:.2f} {done.ended} {done.wall_s:.1f} s", flush=True)
        return row

    rows = runs.run_all([lambda model=model: execute(model) for model in models], arguments.workers)
    for row in rows:
        row["iterations to cpu-Li"] = row["#i"] / rows[0]["#i"]
        row["speed-up"] = rows[0]["timeTot"] / row["timeTot"]
    return rows


def text(value):
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(runs.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=runs.ROOT / "out/paper")
    parser.add_argument("--work", type=pathlib.Path, default=runs.ROOT / "out/paper/runs")
    parser.add_argument("--full", action="store_true", help="full sizes and all time steps: hours")
    parser.add_argument("--timeout", type=float, default=600, help="seconds per run")
    parser.add_argument("--workers", type=int, default=1, help="runs at a time, one thread each if more than one")
    arguments = parser.parse_args()
    table = []
    for case in cases_of(arguments.noli, arguments.full):
        table += measure(arguments, *case)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with open(arguments.out / "table5.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    lines = ["| " + " | ".join(table[0]) + " |", "| --- " * len(table[0]) + "|"]
    lines += ["| " + " | ".join(text(value) for value in row.values()) + " |" for row in table]
    (arguments.out / "table5.md").write_text("# Table 5\n\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
