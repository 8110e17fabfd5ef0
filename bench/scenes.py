#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whole scenes through the program: the field's reference scenes, two families of any size, a stiff pile.

Each is run as it is by default and, where small enough, right after that as a baseline: the contact model
of Li et al. 2020 with CHOLMOD. So every speed is also a ratio of two runs of one program, one after the other.
A last run of each tests every step exactly for intersections and takes no part in the timing.
Writes scenes.csv (a row per run), growth.csv, parallel.csv and scenes.md; see bench/README.md.
"""
import argparse
import dataclasses
import json
import math
import os
import pathlib
import re
import statistics
import sys
import time

import families
import machine

sys.path.insert(0, str(machine.ROOT / "paper"))
import runs  # noqa: E402

BASELINE = {"contact": {"model": "ipc", "friction_hessian": "newton"},
            "solver": {"linear": "cholmod", "projection": "always", "start": "last"}}
OWN_CONTACT = dict.fromkeys(("hessian", "mollifier", "barrier_exponent", "strengthen"))
BASELINE_TETS = 40_000  # larger scenes have no baseline
MANY_TETS = 100_000     # larger scenes are run once and on all threads only
STEPS = {"mat_twist": 20, "falling_blocks": 5}
QUIETLY = ("--checkpoint-seconds", "1e9", "--quiet")
REFERENCE_ROW = re.compile(r"^\| *((?:timed|tutorialExamples|paperExamples)/\w+)")


@dataclasses.dataclass
class Job:
    """A scene to time. `family` is set for the members of a family, reference_* for scenes that the field's
    CPU program was timed on."""
    name: str
    scene: dict
    steps: int
    family: str = ""
    reference_steps: int = 0
    reference_wall_s: float = 0.0
    reference_newton: int = 0


def reference_jobs(noli):
    """The scenes of the table in REFERENCE.md, all their steps; says why when there are none."""
    page = runs.SHARED / "REFERENCE.md"
    if not page.exists():
        print("reference scenes: skipped, no ipc-scenes/REFERENCE.md (NOLI_SHARED_DIR says where to look)")
        return []
    jobs = []
    for line in page.read_text().splitlines():
        if not REFERENCE_ROW.match(line):
            continue
        cells = [cell.strip().rstrip("*") for cell in line.strip("| ").split("|")]
        path = cells[0].split()[0]
        scene = runs.script_scene((path if path.startswith("timed/") else f"input/{path}") + ".txt", noli)
        if scene is None:
            print(f"{path}: skipped, the script is not there")
            continue
        jobs.append(Job(path.split("/")[-1], scene, int(cells[5]), reference_steps=int(cells[5]),
                        reference_newton=int(cells[6]), reference_wall_s=float(cells[7])))
    return jobs


def family_jobs(sizes, steps):
    return [Job(f"{family}_{tets}", make(tets), steps[family], family=family)
            for family, make in families.FAMILIES.items() for tets in sizes]


def stiff_jobs(sizes, steps):
    return [Job(f"stiff_{family}_{tets}", make(tets, **families.STIFF), steps[family])
            for family, make in families.FAMILIES.items() for tets in sizes]


def setting(scene, section, key):
    """What the scene says, or the default of the format."""
    schema = json.loads((machine.ROOT / "docs/scene.schema.json").read_text())
    default = schema["properties"][section]["properties"][key].get("default", "")
    return scene.get(section, {}).get(key, default)


def as_baseline(scene):
    return runs.merged(runs.merged(scene, {"contact": OWN_CONTACT}), BASELINE)


class Bench:
    """Runs jobs and collects their rows."""

    def __init__(self, arguments, limits):
        self.noli = arguments.noli
        self.work = arguments.work
        self.out = arguments.out
        self.threads = arguments.threads or os.cpu_count()
        self.limits = limits
        self.identity = machine.identity()
        self.rows = []
        self.compared = []  # one of ours per scene, with its ratios and tests
        self.failures = []

    def run(self, job, variant, threads, repeat=0, limit=None, options=()):
        """One run; its row is kept and returned together with the run."""
        scene = as_baseline(job.scene) if variant == "baseline" else job.scene
        label = f"{job.name}_{variant}"
        start = time.monotonic()
        try:
            done = runs.run(self.noli, scene, label, self.work, job.steps, limit or self.limits["ours"],
                            threads=threads, options=(*QUIETLY, *options))
        except RuntimeError as error:
            print(f"{label}: failed: {error}", flush=True)
            if variant != "baseline":  # a build without CHOLMOD has no baseline
                self.failures.append(label)
            return None, None
        process_s = time.monotonic() - start
        row = self.row(job, scene, variant, threads, repeat, done, process_s)
        print(f"{label}: {threads} threads, {done.steps} steps, newton {done.newton}, pcg {done.pcg}, "
              f"{done.wall_s:.2f} s {done.ended}", flush=True)
        return row, done

    def row(self, job, scene, variant, threads, repeat, done, process_s):
        record = runs.record(self.work / done.name)
        tets = record["num_tets"]
        finished = [row for row in done.rows if row["outcome"] == "converged"]
        contacts = [int(row["contacts"]) for row in done.rows] or [0]
        peak = max((float(row["peak_mb"]) for row in done.rows), default=0.0)
        phases = {key: sum(float(row[key]) for row in done.rows) for key in (done.rows or [{}])[0]
                  if key.startswith("t_")}
        return {
            **self.identity, "simd": record["device"].split(", ")[-1], "scene": job.name,
            "family": job.family, "variant": variant, "threads": threads, "repeat": repeat, "tets": tets,
            "vertices": record["num_vertices"], "dt_s": record["dt_s"], "steps": done.steps,
            "newton": done.newton, "pcg": done.pcg,
            "newton_tolerance_m_per_s": float(record["tolerance_m_per_s"]),
            "pcg_tolerance": setting(scene, "solver", "pcg_tolerance") if variant == "ours" else "",
            "contacts_mean": statistics.fmean(contacts), "contacts_max": max(contacts),
            "min_gap_m": done.min_gap, "unconverged_steps": len(done.rows) - len(finished),
            "ended": done.ended, "peak_mb": peak, "bytes_per_tet": peak * 2**20 / tets if tets else 0.0,
            "s_per_step": done.wall_s / max(len(done.rows), 1),
            "s_per_newton": done.wall_s / max(done.newton, 1), "wall_s": done.wall_s,
            "process_s": process_s, **phases, "state_hash": record.get("state_hash", "")}

    def save(self):
        machine.write_csv(self.out / "scenes.csv", self.rows)

    def compare(self, job, repeats):
        """Our runs, the baseline's, and the test of every step, one after the other."""
        ours = None
        for repeat in range(repeats):
            row, done = self.run(job, "ours", self.threads, repeat)
            if row is None:
                return
            self.rows.append(row)
            ours = ours or (row, done)
            if row["tets"] > 1.1 * MANY_TETS:
                break
        row, done = ours
        self.compared.append(row)
        if row["tets"] <= BASELINE_TETS:
            base_row, base = self.run(job, "baseline", self.threads, limit=self.limits["baseline"])
            if base_row is not None:
                self.rows.append(base_row)
                row.update(times_faster(done, base))
        if job.reference_steps and done.complete and job.steps == job.reference_steps:
            row.update({"reference_wall_s": job.reference_wall_s, "reference_newton": job.reference_newton})
        self.check(job, row)
        self.save()

    def check(self, job, row):
        """What only a slower run tells: exact intersections, the last Newton residuals, the same bits."""
        tested, done = self.run(job, "tested", self.threads, limit=4 * self.limits["ours"],
                                options=("--verify", "--iteration-log"))
        if tested is None or not done.rows:
            return
        row["intersections"] = sum(int(step["intersections"]) for step in done.rows)
        row["inversions"] = sum(int(step["inversions"]) for step in done.rows)
        row["residual_max_m_per_s"] = largest_last_direction(
            self.work / done.name / "run/iterations.jsonl") / row["dt_s"]
        row["tested_same_state"] = int(tested["state_hash"] == row["state_hash"])

    def parallel(self, job, repeats):
        """One thread against all, in turns; a row of parallel.csv."""
        if self.threads < 2:
            print("parallel efficiency: skipped, one core only")
            return None
        found = {1: [], self.threads: []}
        distances = []
        for repeat in range(repeats):
            distances.append(machine.there_and_back_us(pathlib.Path(self.noli).parent))
            for threads, rows in found.items():
                row, _ = self.run(job, "ours", threads, repeat)
                if row is None:
                    return None
                rows.append(row)
                self.rows.append(row)
        self.save()
        one, many = found[1], found[self.threads]

        def efficiency(key):
            times = [statistics.median(row[key] for row in rows) for rows in (one, many)]
            return times[0] / (self.threads * times[1]) if times[1] > 0 else math.nan
        phases = [key for key in one[0] if key.startswith("t_") and statistics.median(r[key] for r in one) > 1e-3]
        return {**self.identity, "scene": job.name, "tets": one[0]["tets"], "threads": self.threads,
                "repeats": repeats, "there_and_back_us_min": min(distances),
                "there_and_back_us_max": max(distances), "wall_s_one": statistics.median(row["wall_s"] for row in one),
                "wall_s_all": statistics.median(row["wall_s"] for row in many),
                "efficiency": efficiency("wall_s"),
                "same_state": int(len({row["state_hash"] for row in one + many}) == 1),
                **{f"efficiency_{key}": efficiency(key) for key in phases}}


def times_faster(ours, base):
    """Ratios over the steps that both finished."""
    steps = min(ours.steps, base.steps)
    if steps == 0:
        return {"compared_steps": 0}

    def total(run, key):
        return sum(float(row[key]) for row in run.rows[:steps])
    per_newton = [total(run, "wall_s") / max(total(run, "newton"), 1) for run in (ours, base)]
    return {"compared_steps": steps, "times_faster": total(base, "wall_s") / total(ours, "wall_s"),
            "times_faster_per_newton": per_newton[1] / per_newton[0]}


def largest_last_direction(path):
    """Largest over the steps of what the last iteration of a step would still move a vertex, m."""
    last = {}
    for line in open(path):
        record = json.loads(line)
        last[record["step"]] = record["direction"]
    return max(last.values(), default=math.nan)


def exponent(points):
    """Slope of log y over log x."""
    points = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len({x for x, _ in points}) < 2:
        return math.nan
    return statistics.linear_regression(*zip(*points)).slope


def growth(rows, threads):
    """How costs grow with the number of tetrahedra in each family: cost ~ tets^exponent."""
    found = []
    for family in families.FAMILIES:
        members = [row for row in rows if row["family"] == family and row["variant"] == "ours"
                   and row["threads"] == threads and not row["ended"]]
        sizes = sorted({row["tets"] for row in members})
        quantities = {
            "s_per_newton": lambda row: row["s_per_newton"], "s_per_step": lambda row: row["s_per_step"],
            "newton_per_step": lambda row: row["newton"] / row["steps"],
            "pcg_per_newton": lambda row: row["pcg"] / max(row["newton"], 1),
            "contacts_mean": lambda row: row["contacts_mean"], "peak_mb": lambda row: row["peak_mb"]}
        for quantity, value in quantities.items():
            points = [(size, statistics.median(value(row) for row in members if row["tets"] == size))
                      for size in sizes]
            slope = exponent(points)
            if not math.isnan(slope):
                found.append({**machine.identity(), "family": family, "quantity": quantity, "exponent": slope,
                              "threads": threads, "tets": " ".join(str(size) for size in sizes)})
    return found


def share(key):
    return lambda row: f"{100 * row[key] / row['wall_s']:.0f} %" if row.get("wall_s") and key in row else ""


def against_reference(row):
    wall = row.get("reference_wall_s")
    return "" if not wall else f"{wall / row['wall_s']:.3g}"


def page(bench, growth_rows, parallel_rows):
    ours = bench.compared
    base = {row["scene"]: row for row in bench.rows if row["variant"] == "baseline"}
    columns = {
        "scene": "scene", "tets": "tets", "steps": "steps", "newton": "newton", "pcg": "pcg",
        "contacts, mean": "contacts_mean", "s/step": "s_per_step", "s/newton": "s_per_newton",
        "wall s": "wall_s", "peak MB": "peak_mb", "bytes/tet": "bytes_per_tet",
        "times faster than baseline": "times_faster", "over steps": "compared_steps",
        "per newton": "times_faster_per_newton", "than the reference": against_reference,
        "intersections": "intersections", "unconverged": "unconverged_steps", "ended early": "ended"}
    phases = ["t_pairs", "t_assemble", "t_solve", "t_ccd", "t_search"]
    text = ["## Scenes", "",
            f"{bench.identity['cpu']}, {bench.threads} threads, commit {bench.identity['commit']}, "
            f"{bench.identity['date']}. The baseline is this program with `contact.model = \"ipc\"` and CHOLMOD, "
            "run right after ours; ratios count the steps that both finished. \"Than the reference\" compares "
            "whole runs with times taken on another machine of this kind.", "",
            machine.table(ours, columns), "Share of the wall time, ours and baseline:", "",
            machine.table([row for scene in ours for row in (scene, base.get(scene["scene"])) if row],
                          {"scene": "scene", "variant": "variant", **{key[2:]: share(key) for key in phases}})]
    if growth_rows:
        text += ["Growth in the families, cost ~ tets^exponent:", "", machine.table(growth_rows, {
            "family": "family", "quantity": "quantity", "exponent": "exponent", "tets": "tets"})]
    if parallel_rows:
        text += ["Parallel efficiency, medians of runs in turns:", "", machine.table(parallel_rows, {
            "scene": "scene", "tets": "tets", "threads": "threads", "s, one thread": "wall_s_one",
            "s, all": "wall_s_all", "there and back, us": "there_and_back_us_max",
            "efficiency": "efficiency", "same state": "same_state"})]
    return "\n".join(text)


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(machine.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=machine.ROOT / "out/bench")
    parser.add_argument("--work", type=pathlib.Path, help="where the runs go; default: OUT/runs")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--quick", action="store_true", help="the default: a few minutes on two cores")
    size.add_argument("--full", action="store_true", help="up to a million tetrahedra: hours")
    parser.add_argument("--only", nargs="*", choices=["reference", "families", "stiff", "parallel"])
    parser.add_argument("--scenes", help="only scenes whose name matches this regular expression")
    parser.add_argument("--tets", type=int, nargs="*", help="sizes of the families")
    parser.add_argument("--steps", type=int, help="steps of families and stiff scenes")
    parser.add_argument("--repeats", type=int, help="of our runs")
    parser.add_argument("--threads", type=int, default=0, help="0 = all cores")
    arguments = parser.parse_args()
    arguments.work = arguments.work or arguments.out / "runs"
    return arguments


def plan(arguments):
    """The jobs to compare and those to run on one thread and on all."""
    full = arguments.full
    steps, stiff_steps, parallel_steps = (dict(STEPS, mat_twist=mat) for mat in (20, 8, 20 if full else 15))
    if arguments.steps:
        steps = stiff_steps = parallel_steps = dict.fromkeys(STEPS, arguments.steps)
    sizes = arguments.tets or ([10_000, 30_000, 100_000, 300_000, 1_000_000] if full else [10_000, 30_000])
    stiff = arguments.tets or ([10_000, 100_000] if full else [10_000])
    wanted = arguments.only or ["reference", "families", "stiff", "parallel"]
    jobs = []
    if "reference" in wanted:
        jobs += reference_jobs(arguments.noli)
    if "families" in wanted:
        jobs += family_jobs(sizes, steps)
    if "stiff" in wanted:
        jobs += stiff_jobs(stiff, stiff_steps)
    parallel = []
    if "parallel" in wanted:
        parallel = family_jobs(arguments.tets or [size for size in sizes if size <= MANY_TETS], parallel_steps)
    if arguments.scenes:
        jobs, parallel = ([job for job in some if re.search(arguments.scenes, job.name)]
                          for some in (jobs, parallel))
    return jobs, parallel


def main():
    arguments = parse()
    arguments.out.mkdir(parents=True, exist_ok=True)
    full = arguments.full
    repeats = arguments.repeats or (3 if full else 1)
    bench = Bench(arguments, {"ours": 7200, "baseline": 3600} if full else {"ours": 60, "baseline": 12})
    jobs, parallel = plan(arguments)
    for job in jobs:
        bench.compare(job, repeats)
    parallel_rows = [row for job in parallel if (row := bench.parallel(job, arguments.repeats or (5 if full else 3)))]
    growth_rows = growth(bench.rows, bench.threads)
    bench.save()
    machine.write_csv(arguments.out / "growth.csv", growth_rows)
    machine.write_csv(arguments.out / "parallel.csv", parallel_rows)
    (arguments.out / "scenes.md").write_text(page(bench, growth_rows, parallel_rows))
    bad = [row["scene"] for row in bench.compared if row.get("intersections", 0) or row.get("inversions", 0)]
    print(f"tables: {arguments.out}" + (f"; INTERSECTIONS in {', '.join(bad)}" if bad else "")
          + (f"; FAILED: {', '.join(bench.failures)}" if bench.failures else ""))
    return 1 if bad or bench.failures or not bench.rows else 0


if __name__ == "__main__":
    raise SystemExit(main())
