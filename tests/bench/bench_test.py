# SPDX-License-Identifier: Apache-2.0
"""Runs the scene benchmark on tiny members of its families: every promised column is there and filled, the
baseline ran beside ours, nothing intersects. No time is asserted."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]
noli = pathlib.Path(os.environ["NOLI_BINARY"])
COLUMNS = """date commit cpu cores memory_gb blas simd scene family variant threads repeat tets vertices dt_s steps newton
    pcg newton_tolerance_m_per_s pcg_tolerance contacts_mean contacts_max min_gap_m unconverged_steps ended peak_mb
    bytes_per_tet s_per_step s_per_newton wall_s process_s t_pairs t_assemble t_solve t_ccd t_search t_output
    t_elastic t_barrier t_friction state_hash intersections inversions residual_max_m_per_s
    tested_same_state""".split()
STEPS = 2
failures = []


def expect(holds, message):
    if not holds:
        failures.append(message)


def read(path):
    return list(csv.DictReader(open(path)))


with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder)
    done = subprocess.run([sys.executable, "-B", root / "bench/scenes.py", "--noli", noli, "--out", out, "--only",
                           "families", "stiff", "parallel", "--tets", "300", "1300", "--steps", str(STEPS),
                           "--repeats", "1", "--threads", "2"])
    expect(done.returncode == 0, f"scenes.py ended with {done.returncode}")
    rows = read(out / "scenes.csv")
    text = "".join(path.read_text() for path in out.glob("*.csv"))
    growth, parallel = read(out / "growth.csv"), read(out / "parallel.csv")
    summary = (out / "scenes.md").read_text()
    expect(str(root) not in text and folder not in text, "a CSV holds a path of this machine")

    solvers = subprocess.run([sys.executable, "-B", root / "bench/solvers.py", "--noli", noli, "--out", out,
                              "--scenes", "2cubesFall|falling_blocks.*10000", "--limit", "60"])
    if os.environ.get("NOLI_HAVE_CHOLMOD") == "1":
        expect(solvers.returncode == 0, f"solvers.py ended with {solvers.returncode}")
        table = read(out / "solvers.csv")
        expect({row["solver"] for row in table} == {"chosen", "block Jacobi", "CHOLMOD"}, "a solver is missing")
        expect(all(int(row["steps"]) > 0 and float(row["solve_s"]) > 0 for row in table), "a solver did nothing")

for column in COLUMNS:
    expect(column in rows[0], f"scenes.csv has no column {column}")
scenes = {row["scene"] for row in rows}
expect(len(scenes) == 8, f"8 scenes expected, found {sorted(scenes)}")
for row in rows:
    where = f"{row['scene']} {row['variant']}"
    if row["variant"] == "baseline" and not os.environ.get("NOLI_HAVE_CHOLMOD") == "1":
        continue
    expect(int(row["steps"]) == STEPS and row["unconverged_steps"] == "0", f"{where}: {row['ended']}")
    expect(float(row["wall_s"]) > 0 and float(row["peak_mb"]) > 0, f"{where}: no time or no memory")
    expect(int(row["newton"]) > 0 and int(row["tets"]) > 0, f"{where}: no counts")
compared = [row for row in rows if row["intersections"]]
expect({row["scene"] for row in compared} == scenes, "a scene was not tested for intersections")
for row in compared:
    expect(row["intersections"] == "0" and row["inversions"] == "0", f"{row['scene']}: intersections or inversions")
    expect(row["tested_same_state"] == "1", f"{row['scene']}: a second run ended in another state")
    expect(float(row["residual_max_m_per_s"]) <= float(row["newton_tolerance_m_per_s"]),
           f"{row['scene']}: the last Newton residual is above the tolerance")
    if os.environ.get("NOLI_HAVE_CHOLMOD") == "1":
        expect(int(row["compared_steps"]) == STEPS and float(row["times_faster"]) > 0, f"{row['scene']}: no ratio")
expect(any(int(row["contacts_max"]) > 0 for row in rows), "no scene has contacts")
expect({row["family"] for row in growth} == {"mat_twist", "falling_blocks"}, "a family has no growth exponent")
expect(len(parallel) == 4 and all(row["same_state"] == "1" for row in parallel),
       "the state depends on the number of threads, or parallel.csv lacks a scene")
expect(all(name in summary for name in scenes), "the summary lacks a scene")

print("\n".join(failures) if failures else "bench: every column is there, the baseline and the exact test ran")
sys.exit(bool(failures))
