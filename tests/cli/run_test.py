# SPDX-License-Identifier: Apache-2.0
"""`noli run` from the first step to the last: the run directory, what is said, failures."""
import json
import math
import os
import pty
import resource
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from noli_program import BINARY, SCENE, STATS_COLUMNS, ProgramTest, noli, record_of, rows_of, start, wait_for_rows
from vtu_reader import read_vtu


class RunDirectory(ProgramTest):
    def test_holds_what_the_documentation_says(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 6, "--frames-every", 2, "--verify",
                         "--iteration-log"), 0, "done:", str(run))
        self.assertEqual(sorted(p.name for p in run.iterdir()),
                         ["checkpoints", "frames", "frames.pvd", "iterations.jsonl", "log.txt", "run.json",
                          "scene.json", "stats.csv"])
        self.assertEqual(sorted(p.name for p in (run / "frames").iterdir()),
                         [f"frame_{step:06}.vtu" for step in (0, 2, 4, 6)])
        record = record_of(run)
        self.assertEqual((record["format"], record["status"], record["steps_done"]), (1, "finished", 6))
        self.assertEqual(record["bodies"], ["lower", "upper"])

        rows = rows_of(run)
        self.assertEqual(list(rows[0])[:len(STATS_COLUMNS)], STATS_COLUMNS)
        self.assertEqual([int(row["step"]) for row in rows], [1, 2, 3, 4, 5, 6])
        for row in rows:
            self.assertEqual((row["outcome"], row["intersections"], row["inversions"]), ("converged", "0", "0"))
            self.assertAlmostEqual(float(row["t"]), 0.01 * int(row["step"]))
            self.assertGreater(float(row["min_gap"]), 0)
            self.assertGreater(float(row["peak_mb"]), 1)
        lines = [json.loads(line) for line in (run / "iterations.jsonl").read_text().splitlines()]
        self.assertEqual({line["step"] for line in lines}, {1, 2, 3, 4, 5, 6})

    def test_tells_the_threads_of_each_step(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 3, "--threads", 1), 0)
        self.assertEqual([row["threads"] for row in rows_of(run)], ["1", "1", "1"])
        self.assertNotIn("steps on one", self.expect(noli("info", run), 0).stdout)
        table = run / "stats.csv"
        *rows, last = table.read_text().splitlines()
        cells = last.split(",")
        cells[rows[0].split(",").index("threads")] = "2"  # as on two threads
        table.write_text("\n".join([*rows, ",".join(cells)]) + "\n")
        self.expect(noli("info", run), 0, "2; 2 of 3 steps on one")

    def test_frames_hold_the_motion(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 4), 0)
        entries = ElementTree.parse(run / "frames.pvd").getroot().find("Collection").findall("DataSet")
        self.assertEqual(len(entries), 5)
        frames = []
        for entry in entries:
            frames.append(read_vtu(run / entry.get("file")))
            self.assertAlmostEqual(frames[-1]["time"], float(entry.get("timestep")))
        first, last = frames[0], frames[-1]
        self.assertEqual(len(first["points"]), 686)
        self.assertEqual({kind for kind, _ in first["cells"]}, {10})
        self.assertEqual(set(first["point_data"]["body_id"]), {0, 1})
        self.assertTrue(all(v == (0.1, -2.0, 0.0) for v, b in
                            zip(first["point_data"]["velocity"], first["point_data"]["body_id"]) if b == 1))
        for start_x, x, d in zip(first["points"], last["points"], last["point_data"]["displacement"]):
            for k in range(3):
                self.assertEqual(d[k], x[k] - start_x[k])
        self.assertTrue(all(math.isfinite(c) for s in last["cell_data"]["stress"] for c in s))

    def test_writes_obj_and_ply_on_request_and_no_frames_with_0(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 1, "--format", "obj,ply"), 0)
        self.assertEqual(sorted(p.name for p in (run / "frames").iterdir()),
                         ["frame_000000.obj", "frame_000000.ply", "frame_000001.obj", "frame_000001.ply"])
        self.assertEqual(noli("info", run / "frames/frame_000001.ply").returncode, 0)
        self.expect(noli("run", self.scene, "-o", run, "--steps", 1, "--frames-every", 0, "--overwrite"), 0)
        self.assertEqual(list((run / "frames").iterdir()), [])

    def test_scene_json_runs_again_from_anywhere(self):
        run, again = self.folder / "run", self.folder / "again"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 3, "--dt", "0.005"), 0)
        self.expect(noli("run", run / "scene.json", "-o", again, "--steps", 3, cwd="/"), 0)
        self.assertEqual(record_of(run)["state_hash"], record_of(again)["state_hash"])

    def test_is_not_written_over(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, "--steps", 2), 0)
        before = (run / "stats.csv").read_text()
        self.expect(noli("run", self.scene, "-o", run, "--steps", 2), 2, "--resume", "--overwrite", "-o")
        self.assertEqual((run / "stats.csv").read_text(), before)
        (run / "notes.txt").write_text("mine")
        self.expect(noli("run", self.scene, "-o", run, "--steps", 1, "--overwrite"), 0)
        self.assertEqual(len(rows_of(run)), 1)
        self.assertEqual((run / "notes.txt").read_text(), "mine")

    def test_foreign_folders_are_left_alone(self):
        foreign = self.folder / "foreign"
        foreign.mkdir()
        (foreign / "thesis.tex").write_text("x")
        for option in ((), ("--resume",), ("--overwrite",)):
            self.expect(noli("run", self.scene, "-o", foreign, *option), 2, "neither empty nor a run")
        self.assertEqual([p.name for p in foreign.iterdir()], ["thesis.tex"])

    def test_belongs_to_one_process_at_a_time(self):
        run = self.folder / "run"
        first = start("run", self.scene, "-o", run)
        wait_for_rows(first, run, 1)
        self.assertIsNone(first.poll(), "the run ended too early for this test")
        self.expect(noli("run", self.scene, "-o", run, "--overwrite"), 2, "another noli run")
        self.assertIn("status        running", noli("info", run).stdout)
        self.assertEqual(first.wait(), 0, first.communicate()[1])


class Said(ProgramTest):
    def test_in_a_pipe_are_plain_lines(self):
        result = self.expect(noli("run", self.scene, "-o", self.folder / "run", "--steps", 3), 0)
        self.assertNotIn("\033", result.stdout)
        self.assertNotIn("\r", result.stdout)
        lines = [line for line in result.stdout.splitlines() if line.startswith("step ")]
        self.assertEqual(len(lines), 3)
        for word in ("t 0.03", "wall", "newton", "pcg", "contacts", "gap", "kappa", "mem"):
            self.assertIn(word, lines[2])

    def test_is_nothing_when_quiet(self):
        result = self.expect(noli("run", self.scene, "-o", self.folder / "run", "--steps", 2, "--quiet"), 0)
        self.assertEqual(result.stdout, "")

    def test_before_the_first_step_are_a_few_warnings(self):
        bodies = [{"name": f"b{k}", "mesh": {"generator": "box"}, "transform": {"translate": [2 * k, 0, 0]},
                   "material": {"young": 2, "density": density}} for k, density in enumerate((1000, 1000, 1.5))]
        scene = self.write_scene("units.json", bodies=bodies)
        result = self.expect(noli("run", scene, "-o", self.folder / "run", "--steps", 0, "--quiet"), 0)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 4, result.stderr)
        self.assertTrue(lines[0].startswith("warning: /bodies/0/material/young: "), result.stderr)
        self.assertIn("squashed by its own weight", lines[0])
        self.assertEqual(lines[3], f"warning: scene: 1 more warnings: noli check {scene}")
        self.assertIn("lighter than foam", (self.folder / "run/log.txt").read_text())

    def on_terminal(self, name, **environment):
        """What the program writes to a terminal."""
        try:
            main, terminal = pty.openpty()
        except OSError as why:
            self.skipTest(f"no terminal to be had: {why}")
        process = subprocess.Popen([BINARY, "run", self.scene, "-o", self.folder / name, "--steps", "3"],
                                   stdout=terminal, stderr=terminal, env={**os.environ, **environment})
        os.close(terminal)
        said = b""
        while True:
            try:
                chunk = os.read(main, 65536)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            said += chunk
        os.close(main)
        self.assertEqual(process.wait(), 0, said)
        return said.decode()

    def test_on_a_terminal_is_a_bar_with_the_time_left(self):
        said = self.on_terminal("a", NO_COLOR="")
        self.assertIn("\r\033[K", said)
        self.assertIn("ETA", said)
        self.assertIn("3/3  100%", said)
        self.assertIn("\033[32m", said)
        self.assertEqual(sum(line.lstrip("\r\033[K").startswith("step ") for line in said.splitlines()), 3)

    def test_has_no_colours_with_no_color(self):
        said = self.on_terminal("b", NO_COLOR="1")
        self.assertIn("ETA", said)
        self.assertNotIn("\033[32m", said)

    def test_to_a_reader_that_went_away_does_not_end_the_run(self):
        run = self.folder / "run"
        process = subprocess.Popen([BINARY, "run", self.scene, "-o", run, "--steps", "5"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.stdout.close()
        self.assertEqual(process.wait(timeout=120), 0, process.stderr.read())
        process.stderr.close()
        self.assertEqual(record_of(run)["status"], "finished")


class Failures(ProgramTest):
    def test_numbers_that_give_up_end_with_3_and_a_bundle_that_repeats_it(self):
        run = self.folder / "run"
        good = self.expect(noli("run", self.scene, "-o", run, "--steps", 3, "--checkpoint-every", 1), 0)
        self.assertIn("done", good.stdout)
        shutil.rmtree(run)
        # Too few iterations for any step.
        self.expect(noli("run", self.scene, "-o", run, "--max-newton", 1), 3, "error: step", "max_iterations",
                    "repeat.sh")
        record = record_of(run)
        self.assertEqual((record["status"], record["outcome"]), ("failed", "max_iterations"))
        (bundle,) = run.glob("repro_step_*")
        report = json.loads((bundle / "report.json").read_text())
        self.assertEqual(report["outcome"], "max_iterations")
        self.assertEqual(report["step"], record["steps_done"] + 1)
        read_vtu(bundle / "failed_state.vtu")

        moved = self.folder / "elsewhere"
        shutil.move(bundle, moved)
        shutil.rmtree(run)
        self.scene.unlink()
        path = f"{BINARY.parent}:{os.environ['PATH']}"
        repeated = subprocess.run(["sh", moved / "repeat.sh"], env={**os.environ, "PATH": path},
                                  capture_output=True, text=True)
        self.assertEqual(repeated.returncode, 3, repeated.stderr)
        self.assertIn(f"step {report['step']}: max_iterations", repeated.stderr)
        self.assertIn("status        failed", noli("info", moved / "run").stdout)

    def test_a_full_disk_ends_the_run_with_1_and_it_goes_on_when_there_is_room(self):
        whole, run = self.folder / "whole", self.folder / "run"
        options = ("--steps", 40, "--frames-every", 20, "--format", "ply", "--checkpoint-every", 5,
                   "--iteration-log", "--quiet")
        bodies = [{**body, "mesh": {"generator": "box", "cells": [2, 2, 2]}} for body in SCENE["bodies"]]
        scene = self.write_scene("coarse.json", bodies=bodies)
        self.expect(noli("run", scene, "-o", whole, *options), 0)
        # Room for every frame and checkpoint of a coarse scene, but not for the whole iteration log.
        sizes = {p.name: p.stat().st_size for p in whole.rglob("*") if p.is_file()}
        log_size = sizes.pop("iterations.jsonl")
        room = max(sizes.values()) + 1000
        self.assertGreater(log_size, room)
        result = noli("run", scene, "-o", run, *options,
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))
        self.expect(result, 1, "error: ", "iterations.jsonl: cannot write: File too large", "--resume")
        self.assertLess(len(rows_of(run)), 40)
        self.assertEqual(record_of(run)["status"], "failed")
        self.assertFalse(list(run.rglob("*.part")))
        self.expect(noli("run", scene, "-o", run, *options, "--resume"), 0)
        self.assertEqual(record_of(run)["state_hash"], record_of(whole)["state_hash"])
        self.assertEqual((run / "iterations.jsonl").read_bytes(), (whole / "iterations.jsonl").read_bytes())

    def test_a_directory_that_cannot_be_made_ends_with_1(self):
        self.expect(noli("run", self.scene, "-o", self.scene / "below"), 1, "cannot create the folder", "-o")

    @unittest.skipIf(shutil.which("nvidia-smi"), "this machine may have a GPU")
    def test_a_device_that_is_not_there_ends_with_2(self):
        result = self.expect(noli("run", self.scene, "-o", self.folder / "run", "--device", "cuda"), 2, "error: ")
        self.assertRegex(result.stderr.lower(), "cuda|gpu")


if __name__ == "__main__":
    unittest.main()
