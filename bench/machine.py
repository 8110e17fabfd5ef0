# SPDX-License-Identifier: Apache-2.0
"""What every row says of the machine and the program: no host names, no paths."""
import csv
import ctypes
import datetime
import functools
import json
import math
import os
import pathlib
import platform
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def cpu_model():
    try:
        for line in open("/proc/cpuinfo"):
            if line.startswith("model name"):
                return " ".join(line.split(":", 1)[1].split())
    except OSError:
        pass
    return platform.processor() or platform.machine()


def memory_gb():
    return round(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e9, 1)


def commit():
    """The commit of the sources, "-dirty" with uncommitted changes; empty outside of git."""
    done = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty", "--exclude", "*"],
                          capture_output=True, text=True)
    return done.stdout.strip()


def blas():
    """Which BLAS the dynamic linker gives to CHOLMOD: the plain one makes the baseline several times slower."""
    try:
        ctypes.CDLL("libblas.so.3")
        found = {line.split("/")[-1].strip() for line in open("/proc/self/maps") if "blas" in line.split("/")[-1]}
    except OSError:
        return ""
    return "OpenBLAS" if any("openblas" in name for name in found) else " ".join(sorted(found))


def there_and_back_us(build):
    """How long a word takes to another core and back, microseconds; NaN where the benchmark has not been built.
    The least of five: now and then both threads are on one core."""
    program = pathlib.Path(build) / "bench/noli_bench_memory"
    if not program.exists():
        return math.nan
    done = subprocess.run([program, "--benchmark_filter=there_and_back", "--benchmark_min_time=0.02",
                           "--benchmark_repetitions=5", "--benchmark_format=json"], capture_output=True, text=True)
    found = json.loads(done.stdout)["benchmarks"] if done.stdout else []
    return min((row["real_time"] for row in found if row.get("run_type") == "iteration" and "real_time" in row),
               default=math.nan) / 1e3


@functools.cache
def identity():
    """The first columns of every row."""
    return {"date": datetime.date.today().isoformat(), "commit": commit(), "cpu": cpu_model(),
            "cores": os.cpu_count(), "memory_gb": memory_gb(), "blas": blas()}


def write_csv(path, rows):
    """All rows, with the union of their columns in order of appearance."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: text(value) for key, value in row.items()})


def text(value):
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def table(rows, columns):
    """Rows (dicts) as a Markdown table; `columns` maps headings to keys or functions of a row."""
    lines = ["| " + " | ".join(columns) + " |", "| " + " | ".join("---" for _ in columns) + " |"]
    for row in rows:
        cells = [key(row) if callable(key) else row.get(key, "") for key in columns.values()]
        lines.append("| " + " | ".join(short(cell) for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def short(value):
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if 1000 <= abs(value) < 1e9 else f"{value:.3g}"
