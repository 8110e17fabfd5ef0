#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every script of this folder and joins their tables: `make paper` (a subset, under 20 minutes on two
cores) and `make paper FULL=1` (hours). Ends with 1 if a check that should hold fails."""
import argparse
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
FORMULAS = ("sec1_constructions", "sec2_change_of_basis", "sec3_eigenvalues", "errata", "sec4_mollified",
            "sec5_friction")
QUICK = {"fig6_7": [], "mollified_counts": [], "newton_counts": ["--nudges", "0"], "table5": [], "tables1_4": ["--steps", "15"],
         "fig9_10": []}
FULL = {"table5": ["--full", "--workers", "2", "--timeout", "7200"], "fig6_7": [],
        "mollified_counts": ["--nudges", "4"], "newton_counts": ["--nudges", "1", "--timeout", "400"],
        "tables1_4": ["--size", "reduced", "--steps", "15", "--timeout", "3600"],
        "fig9_10": ["--timeout", "3600"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=HERE.parent / "out/paper")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--only", nargs="*", help="names of scripts")
    arguments = parser.parse_args()
    arguments.build, arguments.out = arguments.build.resolve(), arguments.out.resolve()
    arguments.out.mkdir(parents=True, exist_ok=True)

    jobs = {name: ["--formulas", arguments.build / "paper/noli_paper_formulas"] for name in FORMULAS}
    for name, options in (FULL if arguments.full else QUICK).items():
        jobs[name] = ["--noli", arguments.build / "noli", "--work", arguments.out / "runs", *options]
    failed = []
    for name, options in jobs.items():
        if arguments.only and name not in arguments.only:
            continue
        start = time.monotonic()
        print(f"--- {name}", flush=True)
        done = subprocess.run([sys.executable, HERE / f"{name}.py", "--out", arguments.out, *options])
        print(f"--- {name}: {'ok' if done.returncode == 0 else 'FAILED'}, "
              f"{time.monotonic() - start:.0f} s", flush=True)
        if done.returncode:
            failed.append(name)

    tables = [path.read_text() for name in jobs if (path := arguments.out / f"{name}.md").exists()]
    (arguments.out / "README.md").write_text("\n".join(tables))
    print(f"tables and plots: {arguments.out}" + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
