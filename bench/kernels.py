#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the kernel benchmarks and writes kernels.csv (a row per benchmark and pack width, medians of the
repetitions), contact_products.csv and kernels.md; see bench/README.md."""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import tempfile

import machine

# Fields of Google Benchmark that are no counters of ours.
FRAME = {"name", "run_name", "run_type", "repetitions", "repetition_index", "threads", "iterations", "real_time",
         "cpu_time", "time_unit", "aggregate_name", "aggregate_unit", "family_index",
         "per_family_instance_index", "label"}
NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
ELASTIC_WIDTHS = (2, 4, 8)
PRODUCTS_QUICK = ["1000", "10000", "100000"]


def arguments_of(name):
    """"read/mb:8/threads:2/real_time" -> ("read", {"mb": "8", "threads": "2"})"""
    words, found = [], {}
    for part in name.split("/"):
        key, colon, value = part.partition(":")
        if colon:
            found[key] = value
        elif part not in ("real_time", "manual_time"):
            words.append(part)
    return "/".join(words), found


def run(program, folder, options, simd=None):
    """The medians that one program finds, as rows."""
    result = pathlib.Path(folder) / "result.json"
    environment = dict(os.environ, **({"NOLI_SIMD": str(simd)} if simd else {}))
    command = [program, f"--benchmark_out={result}", "--benchmark_out_format=json", *options]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{program.name} ended with {done.returncode}\n{done.stderr[-2000:]}")
    rows = []
    for entry in json.loads(result.read_text())["benchmarks"]:
        if entry.get("aggregate_name", "median") != "median":
            continue
        name, found = arguments_of(entry["run_name"])
        counters = {key: value for key, value in entry.items() if key not in FRAME}
        rows.append({"program": program.name.removeprefix("noli_bench_"), "benchmark": name,
                     "simd_width": simd or "widest", "size": " ".join(f"{k} {v}" for k, v in found.items()
                                                                      if k not in ("threads", "iterations")),
                     "threads": int(found.get("threads", 1)),
                     "time_ns": entry["real_time"] * NANOSECONDS[entry["time_unit"]], **counters})
    return rows


def measure(folder, quick):
    """Rows of all programs."""
    options = ["--benchmark_repetitions=3" if quick else "--benchmark_repetitions=9",
               "--benchmark_report_aggregates_only=true",
               "--benchmark_min_time=" + ("0.05" if quick else "0.3")]
    sized = [*options, "--benchmark_filter=-tets:1000000/"] if quick else options
    jobs = [("memory", options, None), *(("elastic", options, width) for width in ELASTIC_WIDTHS),
            ("assembly", sized, None), ("product", sized, None), ("contact", options, None)]
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for name, chosen, simd in jobs:
            print(f"{name}{f', packs of {simd}' if simd else ''}", flush=True)
            rows += run(folder / f"noli_bench_{name}", scratch, chosen, simd)
    return rows


def contact_products(folder, quick):
    done = subprocess.run([folder / "noli_bench_warp_product", *(PRODUCTS_QUICK if quick else [])],
                          stdout=subprocess.PIPE, text=True, check=True)
    return list(csv.DictReader(done.stdout.splitlines()))


def scaled(key, factor):
    return lambda row: factor * row[key] if key in row else ""


def page(rows, identity):
    def of(program):
        return [row for row in rows if row["program"] == program]
    return "\n".join([
        "## Kernels", "",
        f"{identity['cpu']}, {identity['cores']} cores, commit {identity['commit']}, {identity['date']}. Medians.", "",
        "Memory:", "",
        machine.table([row for row in of("memory") if "bytes_per_second" in row], {"": "benchmark", "size": "size", "threads": "threads",
                                     "GB/s": scaled("bytes_per_second", 1e-9)}),
        *(f"A word goes to another core and back in {row['time_ns']:.0f} ns."
          for row in of("memory") if row["benchmark"] == "there_and_back"), "",
        "Energy, gradient and projected Hessian of a tetrahedron, one thread, in cache; `resisting` is what the "
        "engine uses:", "",
        machine.table(of("elastic"), {"": "benchmark", "pack width": "simd_width", "ns/tet": scaled("per_tet", 1e9)}),
        "Assembly of a box, matrix included:", "",
        machine.table(of("assembly"), {"tets": "num_tets", "threads": "threads", "ns/tet": scaled("per_tet", 1e9),
                                       "elements": scaled("elastic_per_tet", 1e9)}),
        "Products and PCG iterations; percent of the read bandwidth over the same matrix, in turns with it:", "",
        machine.table(of("product"), {"": "benchmark", "tets": "num_tets", "threads": "threads",
                                      "us": scaled("time_ns", 1e-3), "MB a product": scaled("bytes_per_product", 1e-6),
                                      "GB/s": "product_gb_s", "read GB/s": "read_gb_s",
                                      "% of read": "percent_of_read", "setup ms": scaled("setup_s", 1e3)}),
        "Contacts of a pile:", "",
        machine.table(of("contact"), {"": "benchmark", "tets": "num_tets", "pairs": "pairs", "threads": "threads",
                                      "ns/pair": scaled("per_pair", 1e9)})])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=machine.ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=machine.ROOT / "out/bench")
    parser.add_argument("--full", action="store_true", help="a million tetrahedra too, and more repetitions")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    folder = arguments.build.resolve() / "bench"
    identity = machine.identity()
    rows = measure(folder, not arguments.full)
    machine.write_csv(arguments.out / "kernels.csv", [{**identity, **row} for row in rows])
    machine.write_csv(arguments.out / "contact_products.csv",
                      [{**identity, **row} for row in contact_products(folder, not arguments.full)])
    (arguments.out / "kernels.md").write_text(page(rows, identity))
    print(f"tables: {arguments.out}")


if __name__ == "__main__":
    main()
