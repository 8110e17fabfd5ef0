# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command line share: starting the program and reading what a run left."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

BINARY = pathlib.Path(os.environ["NOLI_BINARY"]).resolve()
TIMING_COLUMNS = {"wall_s", "t_pairs", "t_assemble", "t_solve", "t_ccd", "t_search", "t_output", "peak_mb", "threads",
                  "t_elastic", "t_barrier", "t_friction"}
STATS_COLUMNS = ("step,t,wall_s,newton,pcg,contacts,min_gap,kappa,intersections,inversions,outcome,"
                 "t_pairs,t_assemble,t_solve,t_ccd,t_search,t_output,peak_mb").split(",")

# A block that falls onto another one on a floor: elastic contact and friction within a few steps.
SCENE = {
    "format_version": 1,
    "duration": 0.5,
    "dt": 0.01,
    "bodies": [
        {"name": "lower", "mesh": {"generator": "box", "cells": [6, 6, 6]}, "friction": 0.3},
        {"name": "upper", "mesh": {"generator": "box", "cells": [6, 6, 6]}, "velocity": [0.1, -2, 0],
         "transform": {"translate": [0.05, 1.03, 0.02]}, "friction": 0.3},
    ],
    "half_spaces": [{"name": "floor", "point": [0, -0.51, 0], "friction": 0.3}],
}


def noli(*arguments, **options):
    """Runs the program to its end; stdout and stderr as text."""
    options.setdefault("timeout", 300)
    return subprocess.run([BINARY, *map(str, arguments)], stdout=options.pop("stdout", subprocess.PIPE),
                          stderr=subprocess.PIPE, text=True, **options)


def start(*arguments, **options):
    """Starts the program and goes on."""
    return subprocess.Popen([BINARY, *map(str, arguments)], stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, text=True, **options)


def rows_of(run):
    """Whole rows of a stats.csv as dictionaries; none if it is not there yet."""
    try:
        text = (run / "stats.csv").read_text()
    except FileNotFoundError:
        return []
    return list(csv.DictReader(text[:text.rfind("\n") + 1].splitlines()))


def wait_for_rows(process, run, count):
    """Waits until the run in progress has that many rows, or has ended."""
    deadline = time.monotonic() + 120
    while len(rows_of(run)) < count and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.002)


def record_of(run):
    return json.loads((run / "run.json").read_text())


def physics_of(run):
    """Everything in a run that must not depend on how often it was stopped: file name -> content."""
    out = {p.name: p.read_bytes() for p in sorted((run / "frames").iterdir())}
    out["frames.pvd"] = (run / "frames.pvd").read_bytes()
    out["stats.csv"] = [{k: v for k, v in row.items() if k not in TIMING_COLUMNS} for row in rows_of(run)]
    if (run / "iterations.jsonl").exists():
        out["iterations.jsonl"] = (run / "iterations.jsonl").read_bytes()
    record = record_of(run)
    out["state"] = (record["status"], record["steps_done"], record["state_hash"])
    return out


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, which holds the scene drop.json."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="noli_cli_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = self.write_scene("drop.json")

    def write_scene(self, file_name, **changes):
        path = self.folder / file_name
        path.write_text(json.dumps({**SCENE, **changes}))
        return path

    def expect(self, result, code, *parts):
        """Asserts the exit code and that each part occurs in what was said."""
        said = (result.stdout or "") + result.stderr
        self.assertEqual(result.returncode, code, said)
        for part in parts:
            self.assertIn(part, said)
        return result

    def assert_same_physics(self, run, reference):
        got, expected = physics_of(run), physics_of(reference)
        self.assertEqual(sorted(got), sorted(expected))
        for name in expected:
            self.assertTrue(got[name] == expected[name], f"{name} differs")
