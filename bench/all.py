#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds and runs all benchmarks: `make bench` (about ten minutes on two cores) and `make bench FULL=1` (hours).
Tables: out/bench. Ends with 1 if a run failed or the exact test found an intersection."""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

import machine

HERE = pathlib.Path(__file__).resolve().parent
RESULTS = ("kernels.csv", "contact_products.csv", "scenes.csv", "growth.csv", "parallel.csv", "solvers.csv",
           "README.md")


def build(folder, jobs):
    subprocess.run(["cmake", "--build", folder, "-j", str(jobs), "--target", "noli_cli", "noli_benchmarks"], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=machine.ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=machine.ROOT / "out/bench")
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--commit-results", action="store_true", help="copy the tables to bench/results")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    build(arguments.build, arguments.jobs)
    common = ["--out", arguments.out, *(["--full"] if arguments.full else [])]
    failed = False
    program = ["--noli", arguments.build / "noli"]
    for name, options in (("kernels", ["--build", arguments.build]), ("scenes", program), ("solvers", program)):
        print(f"--- {name}", flush=True)
        failed |= subprocess.run([sys.executable, HERE / f"{name}.py", *options, *common]).returncode != 0

    pages = [path.read_text() for name in ("kernels", "scenes", "solvers") if (path := arguments.out / f"{name}.md").exists()]
    (arguments.out / "README.md").write_text("# Benchmark results\n\n" + "\n".join(pages))
    if arguments.commit_results and not failed:
        (HERE / "results").mkdir(exist_ok=True)
        for name in RESULTS:
            if (arguments.out / name).exists():
                shutil.copy(arguments.out / name, HERE / "results" / name)
        print("copied to bench/results")
    print(f"tables: {arguments.out}" + ("; something FAILED" if failed else ""))
    return int(failed)


if __name__ == "__main__":
    raise SystemExit(main())
