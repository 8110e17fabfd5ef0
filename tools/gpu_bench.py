#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times scenes on the CPU and on the GPU of this machine, phase by phase, and writes gpu.csv and gpu.md.

Run by tools/gpu_check.sh. Scenes: scenes/demo.json, a twisted mat and falling blocks of 10^4, 10^5 and 10^6
tetrahedra from bench/families.py, and the field's scenes where NOLI_SHARED_DIR (or ../shared) has them. Both devices run the
same steps of the same scene, one after the other; a run that fails is a row with its outcome.
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
PHASES = ["t_pairs", "t_assemble", "t_solve", "t_ccd", "t_search", "wall_s"]
STEPS = 10


def scenes(folder):
    """(name, file, steps) of what is timed."""
    found = [("demo", ROOT / "scenes/demo.json", 20)]
    try:
        import families
        for maker in (families.mat_twist, families.falling_blocks):
            for tets, steps in ((10_000, STEPS), (100_000, STEPS), (1_000_000, 3)):
                path = folder / f"{maker.__name__}_{tets}.json"
                path.write_text(json.dumps(maker(tets)))
                found.append((path.stem, path, steps))
    except Exception as trouble:  # a family that changed must not cost the whole table
        print(f"gpu_bench: no scenes of bench/families.py: {trouble}", file=sys.stderr)
    shared = pathlib.Path(os.environ.get("NOLI_SHARED_DIR", ROOT.parent / "shared")) / "ipc-scenes"
    for name in ("timed/mat40x40_twist_100", "timed/dolphinFunnel_50"):
        path = shared / f"{name}.txt"
        if path.exists():
            found.append((path.stem, path, STEPS))
    return found


def run(noli, path, steps, device, folder):
    """Sums of the phases over the steps, or the reason why there are none."""
    out = folder / f"run_{device}"
    done = subprocess.run([noli, "run", path, "--device", device, "--steps", str(steps), "-o", out, "--overwrite",
                           "--frames-every", "0", "--checkpoint-seconds", "1e9", "--quiet"],
                          capture_output=True, text=True)
    try:
        rows = list(csv.DictReader((out / "stats.csv").open()))
    except OSError:
        return {"outcome": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit {done.returncode}"}
    sums = {phase: sum(float(row[phase]) for row in rows[1:]) for phase in PHASES}  # the first step warms up
    count = max(1, len(rows) - 1)
    return {"outcome": rows[-1]["outcome"] if rows else "none", "steps": count,
            "newton": sum(int(row["newton"]) for row in rows[1:]), "pcg": sum(int(row["pcg"]) for row in rows[1:]),
            **{phase: value / count for phase, value in sums.items()}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--devices", default="cpu,cuda", help="for a dry run: cpu")
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    arguments = parser.parse_args()
    noli = next(p for p in (arguments.build / "noli", arguments.build / "apps/cli/noli") if p.exists())
    arguments.out.mkdir(parents=True, exist_ok=True)
    devices = arguments.devices.split(",")
    with tempfile.TemporaryDirectory(prefix="noli_gpu_") as temporary:
        folder = pathlib.Path(temporary)
        chosen = [scene for scene in scenes(folder) if arguments.only in scene[0]]
        rows = [{"scene": name, "device": device, **run(noli, path, steps, device, folder)}
                for name, path, steps in chosen for device in devices]
        figures = []
        gpu = arguments.build / "bench/noli_bench_gpu"
        if "cuda" in devices:
            json_scenes = [word for _, path, steps in chosen if path.suffix == ".json" for word in (str(path), str(steps))]
            text = subprocess.run([gpu, *json_scenes], capture_output=True, text=True, check=True).stdout
            figures = list(csv.DictReader(text.splitlines()))

    columns = ["scene", "device", "outcome", "steps", "newton", "pcg", *PHASES]
    with (arguments.out / "gpu.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)
    with (arguments.out / "gpu_figures.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, ["figure", "subject", "value", "unit"])
        writer.writeheader()
        writer.writerows(figures)
    lines = ["| " + " | ".join(columns) + " |", "|" + " --- |" * len(columns)]
    for row in rows:
        cells = [f"{row[c]:.4g}" if isinstance(row.get(c), float) else str(row.get(c, "")) for c in columns]
        lines.append("| " + " | ".join(cells) + " |")
    lines += ["", "Seconds per step, the first step left out.", "", "| figure | subject | value | unit |", "| --- | --- | --- | --- |"]
    lines += [f"| {f['figure']} | {f['subject']} | {f['value']} | {f['unit']} |" for f in figures]
    (arguments.out / "gpu.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return any(row["outcome"] != "converged" for row in rows)


if __name__ == "__main__":
    sys.exit(main())
