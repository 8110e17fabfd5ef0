# SPDX-License-Identifier: Apache-2.0
"""Runs that are stopped, killed or damaged, and go on as if nothing had happened, bit for bit."""
import json
import pathlib
import random
import shutil
import signal
import tempfile
import time
import unittest

from noli_program import SCENE, ProgramTest, noli, record_of, rows_of, start, wait_for_rows

OPTIONS = ("--steps", 40, "--checkpoint-every", 3, "--frames-every", 4, "--iteration-log")


def setUpModule():
    """One run that nobody disturbs, for all tests to compare with."""
    global reference_folder, reference
    reference_folder = tempfile.TemporaryDirectory(prefix="noli_cli_")
    folder = pathlib.Path(reference_folder.name)
    (folder / "drop.json").write_text(json.dumps(SCENE))
    reference = folder / "run"
    result = noli("run", folder / "drop.json", "-o", reference, *OPTIONS)
    assert result.returncode == 0, result.stderr


def tearDownModule():
    reference_folder.cleanup()


class Resume(ProgramTest):
    def run_until(self, run, rows, stop_signal, *more):
        """Starts or resumes the run and stops it once it has that many rows; exit code and stderr."""
        process = start("run", self.scene, "-o", run, *OPTIONS, *more)
        wait_for_rows(process, run, rows)
        process.send_signal(stop_signal)
        _, stderr = process.communicate(timeout=120)
        return process.returncode, stderr

    def finish(self, run, *more):
        return self.expect(noli("run", self.scene, "-o", run, *OPTIONS, "--resume", *more), 0)

    def test_after_kills_at_any_moment_gives_the_same_bits(self):
        dice = random.Random(2)
        run = self.folder / "run"
        kills = 0
        for rows in (0, 2, 9, 17, 30):
            process = start("run", self.scene, "-o", run, *OPTIONS, "--resume")
            wait_for_rows(process, run, rows)
            time.sleep(dice.uniform(0, 0.03))
            process.kill()
            process.communicate()
            kills += process.returncode == -signal.SIGKILL
            if rows == 9:
                self.assertIn("killed", noli("info", run).stdout)
        self.assertGreaterEqual(kills, 3, "the run ended before it could be killed")
        self.assertNotEqual(record_of(run)["status"], "finished")
        result = self.finish(run)
        self.assertIn("resuming after step", result.stderr)
        self.assert_same_physics(run, reference)
        self.assertFalse(list(run.rglob("*.part")))

    def test_after_sigterm_goes_on_where_it_stopped(self):
        run = self.folder / "run"
        code, stderr = self.run_until(run, 7, signal.SIGTERM)
        self.assertEqual(code, 128 + signal.SIGTERM, stderr)
        self.assertIn(f"noli run {run} --resume", stderr)
        record = record_of(run)
        self.assertEqual(record["status"], "interrupted")
        self.assertEqual(record["steps_done"], len(rows_of(run)))
        result = self.finish(run)
        self.assertIn(f"resuming after step {record['steps_done']} ", result.stderr)
        self.assert_same_physics(run, reference)

    def test_after_ctrl_c_with_the_directory_alone_and_other_threads(self):
        run = self.folder / "run"
        code, stderr = self.run_until(run, 5, signal.SIGINT, "--threads", 1)
        self.assertEqual(code, 128 + signal.SIGINT, stderr)
        self.scene.unlink()
        self.expect(noli("run", run, "--resume", "--steps", 40, "--iteration-log", "--threads", 2), 0)
        self.assert_same_physics(run, reference)

    def test_after_ctrl_c_in_a_step_that_never_ends(self):
        """Step 4 cannot reach its tolerance: only giving it up ends the run."""
        scene = self.write_scene("endless.json", solver={"tolerance_per_step": [1e-2, 1e-2, 1e-2, 1e-300],
                                                         "max_newton": 1000000000})
        run = self.folder / "run"
        process = start("run", scene, "-o", run)
        wait_for_rows(process, run, 3)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        try:
            _, stderr = process.communicate(timeout=120)
        finally:
            process.kill()
        self.assertEqual(process.returncode, 128 + signal.SIGINT, stderr)
        self.assertIn(f"noli run {run} --resume", stderr)
        self.assertIn("step 4 given up on request after ", (run / "log.txt").read_text())
        record = record_of(run)
        self.assertEqual((record["status"], record["outcome"], record["steps_done"]), ("interrupted", "converged", 3))
        self.assertFalse(list(run.glob("repro*")))
        self.expect(noli("run", scene, "-o", self.folder / "whole", "--steps", 3), 0)
        self.expect(noli("run", run, "--resume", "--steps", 3), 0)
        self.assertEqual(record_of(run)["state_hash"], record_of(self.folder / "whole")["state_hash"])

    def test_after_steps_given_up_gives_the_same_bits(self):
        long_steps = ("--steps", 16, "--tolerance", 1e-9, "--iteration-log")
        whole, run = self.folder / "whole", self.folder / "run"
        self.expect(noli("run", self.scene, "-o", whole, *long_steps), 0)
        for rows in (4, 7, 10, 13):
            process = start("run", self.scene, "-o", run, *long_steps, "--resume")
            wait_for_rows(process, run, rows)
            time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=120)
        self.expect(noli("run", self.scene, "-o", run, *long_steps, "--resume"), 0)
        self.assertIn("given up on request after", (run / "log.txt").read_text())
        self.assert_same_physics(run, whole)

    def test_skips_damaged_checkpoints_and_says_so(self):
        run = self.folder / "run"
        self.run_until(run, 14, signal.SIGTERM)
        newest = sorted((run / "checkpoints").iterdir())
        self.assertEqual(len(newest), 3)
        data = bytearray(newest[2].read_bytes())
        newest[2].write_bytes(data[:len(data) // 2])
        data = bytearray(newest[1].read_bytes())
        data[len(data) // 3] ^= 4
        newest[1].write_bytes(data)
        self.expect(noli("info", run), 0, newest[2].name, newest[1].name)
        result = self.finish(run)
        for path in newest[1:]:
            self.assertIn(path.name, result.stderr)
        self.assertIn(f"resuming after step {int(newest[0].stem[5:])} ", result.stderr)
        self.assert_same_physics(run, reference)

    def test_refuses_when_no_checkpoint_is_whole(self):
        run = self.folder / "run"
        shutil.copytree(reference, run)
        for path in (run / "checkpoints").iterdir():
            path.write_bytes(b"x")
        self.expect(noli("run", self.scene, "-o", run, "--resume", "--steps", 45), 2, "no checkpoint is whole",
                    "--overwrite")
        self.assertEqual(len(rows_of(run)), 40)

    def test_of_a_finished_run_changes_nothing(self):
        run = self.folder / "run"
        shutil.copytree(reference, run)
        before = {p: p.read_bytes() for p in run.rglob("*") if p.is_file()}
        for steps in (40, 20):
            self.expect(noli("run", self.scene, "-o", run, "--resume", "--steps", steps), 0)
        self.assertEqual({p: p.read_bytes() for p in run.rglob("*") if p.is_file()}, before)

    def test_goes_beyond_the_steps_asked_for_at_first(self):
        run = self.folder / "run"
        self.expect(noli("run", self.scene, "-o", run, *OPTIONS, "--steps", 8), 0)
        self.finish(run)
        self.assert_same_physics(run, reference)

    def test_starts_where_there_is_nothing_yet(self):
        result = self.finish(self.folder / "run")
        self.assertIn("nothing to resume", result.stderr)
        self.assert_same_physics(self.folder / "run", reference)

    def test_refuses_another_scene(self):
        run = self.folder / "run"
        shutil.copytree(reference, run)
        before = {p: p.read_bytes() for p in run.rglob("*") if p.is_file()}
        other = self.write_scene("other.json", dt=0.02)
        self.expect(noli("run", other, "-o", run, "--resume"), 2, "another scene", "--overwrite", "-o")
        self.expect(noli("run", self.scene, "-o", run, "--resume", "--tolerance", "0.1"), 2, "another scene")
        self.assertEqual({p: p.read_bytes() for p in run.rglob("*") if p.is_file()}, before)

    def test_accepts_other_output_settings_names_and_a_longer_duration(self):
        run = self.folder / "run"
        shutil.copytree(reference, run)
        other = self.write_scene("other.json", name="renamed", duration=0.43, output={"formats": ["ply"]})
        self.expect(noli("run", other, "-o", run, "--resume"), 0)
        self.assertEqual(record_of(run)["steps_done"], 43)
        self.assertTrue((run / "frames/frame_000043.ply").exists())

    def test_refuses_a_mesh_that_changed(self):
        mesh = self.folder / "two.mesh"
        text = ("MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 {} 0\n"
                "Tetrahedra\n1\n1 2 3 4 0\nEnd\n")
        mesh.write_text(text.format(1))
        scene = self.write_scene("file.json", bodies=[{"mesh": {"file": "two.mesh"}}], half_spaces=[])
        run = self.folder / "run"
        self.expect(noli("run", scene, "-o", run, "--steps", 2), 0)
        mesh.write_text(text.format(2))
        self.expect(noli("run", scene, "-o", run, "--steps", 4, "--resume"), 2, "another scene")

    def test_refuses_a_run_of_another_format(self):
        run = self.folder / "run"
        shutil.copytree(reference, run)
        record = record_of(run)
        record["format"] = 99
        (run / "run.json").write_text(json.dumps(record))
        self.expect(noli("run", self.scene, "-o", run, "--resume"), 2, "format 99")


if __name__ == "__main__":
    unittest.main()
