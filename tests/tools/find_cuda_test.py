#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""When the build includes the CUDA engine: cmake/find_cuda.cmake with made-up compilers and GPUs."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

MODULE = pathlib.Path(__file__).resolve().parents[2] / "cmake/find_cuda.cmake"
INSTALLED = pathlib.Path("/usr/local/cuda/bin/nvcc")  # looked at before any other place that a test can name


class FindCuda(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, name, text=""):
        path = pathlib.Path(self.folder.name) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
        return path

    def nvcc(self, release, name="nvcc"):
        return self.file(name, f"#!/bin/sh\necho 'Cuda compilation tools, release {release}, V{release}.1'\n")

    def choose(self, wish, nvcc, gpu):
        """(whether CUDA is built, what the configuration says)"""
        script = self.file("choose.cmake", f'include("{MODULE}")\nmessage(STATUS "with cuda: ${{NOLI_WITH_CUDA}} ${{CMAKE_CUDA_ARCHITECTURES}}")\n')
        done = subprocess.run(["cmake", f"-DNOLI_CUDA={wish}", f"-DNOLI_GPU_DEVICE={gpu}", "-P", script],
                              env=dict(os.environ, CUDACXX=str(nvcc)), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return "with cuda: ON" in done.stdout, done.stdout

    def test_auto_takes_it_where_both_are(self):
        built, said = self.choose("AUTO", self.nvcc("13.0"), self.file("gpu"))
        self.assertTrue(built)
        self.assertIn("CUDA engine: yes", said)
        self.assertIn("with cuda: ON 80-real;90", said)

    def test_options_of_the_compiler_do_no_harm(self):
        self.assertTrue(self.choose("AUTO", f"{self.nvcc('12.4')} -ccbin g++", self.file("gpu"))[0])

    def test_auto_goes_without_a_gpu(self):
        built, said = self.choose("AUTO", self.nvcc("13.0"), "/nowhere/gpu")
        self.assertFalse(built)
        self.assertIn("no NVIDIA GPU", said)

    def test_auto_goes_without_a_new_nvcc(self):
        for nvcc in (self.nvcc("11.8"), "/nowhere/nvcc"):
            built, said = self.choose("AUTO", nvcc, self.file("gpu"))
            self.assertFalse(built)
            self.assertIn("no nvcc 12", said)

    def test_on_and_off_need_no_gpu(self):
        self.assertTrue(self.choose("ON", self.nvcc("13.0"), "/nowhere/gpu")[0])
        self.assertFalse(self.choose("OFF", self.nvcc("13.0"), self.file("gpu"))[0])

    def search(self, toolkit, **places):
        """What the configuration says with NOLI_CUDA = ON, no CUDACXX and nothing on the search path."""
        done = subprocess.run([shutil.which("cmake"), "-DNOLI_CUDA=ON", f"-DNOLI_CUDA_TOOLKIT={toolkit}", "-P", MODULE],
                              env=dict(PATH=self.folder.name, **places), capture_output=True, text=True)
        return done.returncode, " ".join((done.stdout + done.stderr).split())

    @unittest.skipIf(INSTALLED.exists(), f"there is {INSTALLED}")
    def test_a_toolkit_made_here_is_taken_where_none_is_installed(self):
        nvcc = self.nvcc("13.0", "made/bin/nvcc")
        code, said = self.search(nvcc.parents[1])
        self.assertEqual(code, 0, said)
        self.assertIn(f"CUDA engine: yes, {nvcc}", said)

    def test_an_installed_toolkit_comes_first(self):
        made, installed = (self.nvcc("13.0", f"{name}/bin/nvcc") for name in ("made", "installed"))
        code, said = self.search(made.parents[1], CUDA_PATH=str(installed.parents[1]))
        self.assertEqual(code, 0, said)
        self.assertIn(f"CUDA engine: yes, {installed}", said)

    @unittest.skipIf(INSTALLED.exists(), f"there is {INSTALLED}")
    def test_without_any_it_says_how_to_get_one(self):
        code, said = self.search("/nowhere")
        self.assertEqual(code, 1, said)
        self.assertIn("NOLI_CUDA needs nvcc", said)
        self.assertIn("tools/cuda_toolkit.sh", said)
        self.assertTrue((MODULE.parents[1] / "tools/cuda_toolkit.sh").exists())


if __name__ == "__main__":
    unittest.main()
