# SPDX-License-Identifier: Apache-2.0
"""--device: what a program with and without CUDA says on a machine with and without a GPU."""
import os
import shutil
import subprocess
import unittest

from noli_program import ProgramTest, noli, record_of

HAVE_CUDA = os.environ.get("NOLI_HAVE_CUDA", "") in ("1", "ON", "TRUE")
REASONS_WITH_CUDA = ("no NVIDIA driver is installed", "the NVIDIA driver is too old", "no NVIDIA GPU was found",
                     "the NVIDIA driver does not work", "compute capability", "not enough memory",
                     "the GPU does not answer")


def has_gpu():
    if shutil.which("nvidia-smi") is None:
        return False
    return subprocess.run(["nvidia-smi", "-L"], capture_output=True).returncode == 0


class DeviceTest(ProgramTest):
    def reasons(self):
        return REASONS_WITH_CUDA if HAVE_CUDA else ("this program was built without CUDA",)

    def test_cuda_without_a_gpu_ends_with_code_2_and_the_reason(self):
        if HAVE_CUDA and has_gpu():
            self.skipTest("this machine has a GPU")
        run = self.folder / "run"
        result = self.expect(noli("run", self.scene, "--device", "cuda", "-o", run), 2, "--device cuda", "--device cpu")
        self.assertTrue(any(reason in result.stderr for reason in self.reasons()), result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1)
        self.assertFalse(run.exists(), "a run that cannot start leaves nothing behind")

    def test_auto_says_in_one_line_why_it_takes_the_cpu(self):
        result = self.expect(noli("run", self.scene, "--steps", "1", "-o", self.folder / "run"), 0)
        line = next(line for line in result.stdout.splitlines() if line.startswith("CPU, "))
        reasons = self.reasons() + (("has not been checked on a GPU yet",) if HAVE_CUDA else ())
        self.assertTrue(any(reason in line for reason in reasons), line)
        self.assertTrue(record_of(self.folder / "run")["device"].startswith("CPU, "))

    def test_cpu_gives_no_reason(self):
        result = self.expect(noli("run", self.scene, "--steps", "1", "--device", "cpu", "-o", self.folder / "run"), 0)
        self.assertNotIn("auto:", result.stdout)


if __name__ == "__main__":
    unittest.main()
