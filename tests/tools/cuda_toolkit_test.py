#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/cuda_toolkit.sh with a made-up pip: what it makes of the wheels, when it makes it again, how it fails."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]

# Answers `-m pip` as Python would, counts the installations in calls.txt. BROKEN names what goes wrong.
PYTHON = r"""#!/bin/bash
[ "$BROKEN" != no_pip ] || { echo "No module named pip" >&2; exit 1; }
[ "$3" = install ] || { echo "pip 23.0"; exit 0; }
echo "$@" >>"$(dirname "$0")/calls.txt"
[ "$BROKEN" != pip ] || { echo "No matching distribution found for nvidia-nvvm" >&2; exit 1; }
while [ "$1" != --target ]; do shift; done
wheels=$2
mkdir -p "$wheels/nvidia_cuda_nvcc-13.dist-info"
[ "$BROKEN" != layout ] || exit 0
mkdir -p "$wheels/nvidia/cu13/bin" "$wheels/nvidia/cu13/lib"
touch "$wheels/nvidia/cu13/lib/libcudart.so.13"
cat >"$wheels/nvidia/cu13/bin/nvcc" <<'NVCC'
#!/bin/bash
[ "$BROKEN" != nvcc ] || { echo "nvcc fatal: cicc not found" >&2; exit 1; }
while [ "$1" != -o ]; do shift; done
printf '#!/bin/sh\n[ "$BROKEN" != start ] || { echo "exec format error" >&2; exit 1; }\necho 13000\n' >"$2"
chmod +x "$2"
NVCC
chmod +x "$wheels/nvidia/cu13/bin/nvcc"
"""


class CudaToolkit(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.toolkit = self.root / "build/cuda-toolkit"
        self.script = self.root / "tools/cuda_toolkit.sh"
        self.script.parent.mkdir()
        shutil.copy(SOURCE / "tools/cuda_toolkit.sh", self.script)
        self.executable("python", PYTHON)

    def executable(self, name, text):
        (self.root / name).write_text(text)
        (self.root / name).chmod(0o755)
        return str(self.root / name)

    def run_script(self, *arguments, broken="nothing", **environment):
        done = subprocess.run(["bash", str(self.script), *arguments], capture_output=True, text=True, cwd=self.root,
                              env=dict(os.environ, PYTHON=str(self.root / "python"), BROKEN=broken, **environment))
        return done.returncode, done.stdout, done.stderr

    def make(self, **options):
        """Also where an nvcc is installed."""
        return self.run_script(str(self.toolkit), **options)

    def installations(self):
        calls = self.root / "calls.txt"
        return calls.read_text().splitlines() if calls.exists() else []

    def test_makes_the_layout_of_a_toolkit_and_says_where(self):
        code, said, errors = self.make()
        self.assertEqual(code, 0, errors)
        self.assertEqual(said.splitlines(), [f"cuda-toolkit: {self.toolkit} (made from wheels, CUDA runtime 13000)"])
        self.assertTrue(os.access(self.toolkit / "bin/nvcc", os.X_OK))
        self.assertTrue((self.toolkit / "lib64/libcudart.so").exists())
        self.assertEqual([path.name for path in self.toolkit.parent.iterdir()], ["cuda-toolkit"])

    def test_pins_every_wheel(self):
        self.make()
        wheels = [word for word in self.installations()[0].split() if word.startswith("nvidia-")]
        self.assertEqual(sorted(wheel.split("==")[0] for wheel in wheels),
                         ["nvidia-cuda-cccl", "nvidia-cuda-crt", "nvidia-cuda-nvcc", "nvidia-cuda-runtime", "nvidia-nvvm"])
        releases = {".".join(wheel.split("==")[1].split(".")[:2]) for wheel in wheels}
        self.assertEqual(len(releases), 1, "parts of several releases")

    def test_makes_it_once_per_set_of_versions(self):
        self.make()
        code, said, _ = self.make()
        self.assertEqual((code, said), (0, f"cuda-toolkit: {self.toolkit}\n"))
        self.assertEqual(len(self.installations()), 1)
        self.script.write_text(self.script.read_text().replace("nvidia-nvvm==", "nvidia-nvvm==1"))
        self.make()
        self.assertEqual(len(self.installations()), 2)

    def test_failures_have_a_name_and_leave_nothing(self):
        for broken, name, error in (("no_pip", "no Python with pip", "python3-pip"),
                                    ("pip", "pip did not install nvidia-cuda-nvcc==", "No matching distribution found"),
                                    ("layout", "do not have their parts", "nvidia/cu"),
                                    ("nvcc", "does not compile and link", "cicc not found"),
                                    ("start", "does not start", "exec format error")):
            with self.subTest(broken):
                code, said, errors = self.make(broken=broken)
                self.assertEqual((code, said), (1, ""))
                self.assertIn(f"cuda-toolkit: FAILED: ", errors)
                self.assertIn(name, errors)
                self.assertIn(error, errors)
                self.assertEqual(list(self.toolkit.parent.iterdir()), [])

    def test_a_failure_keeps_the_toolkit_that_is_there(self):
        self.make()
        self.script.write_text(self.script.read_text().replace("nvidia-nvvm==", "nvidia-nvvm==1"))
        self.assertEqual(self.make(broken="nvcc")[0], 1)
        self.assertTrue((self.toolkit / "bin/nvcc").exists())

    def test_an_installed_nvcc_is_enough(self):
        nvcc = self.executable("installed-nvcc", "#!/bin/sh\n")
        code, said, errors = self.run_script(CUDACXX=f"{nvcc} -ccbin g++")
        self.assertEqual((code, said), (0, f"cuda-toolkit: {nvcc} is installed\n"), errors)
        self.assertEqual(self.installations(), [])

    @unittest.skipIf(shutil.which("nvcc") or os.path.exists("/usr/local/cuda/bin/nvcc"), "nvcc is installed")
    def test_cmake_takes_what_it_makes(self):
        """Without CUDACXX: the default folder of the script is that of the configuration."""
        environment = {name: value for name, value in os.environ.items() if name not in ("CUDACXX", "CUDA_PATH", "CUDAToolkit_ROOT")}
        subprocess.run(["bash", str(self.script)], env=dict(environment, PYTHON=str(self.root / "python")), check=True,
                       capture_output=True)
        (self.root / "cmake").mkdir()
        shutil.copy(SOURCE / "cmake/find_cuda.cmake", self.root / "cmake")
        done = subprocess.run(["cmake", "-DNOLI_CUDA=ON", "-P", self.root / "cmake/find_cuda.cmake"], env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = done.stdout.split("CUDA engine: yes, ")[1].strip()
        self.assertEqual(os.path.realpath(found), str(self.toolkit / "bin/nvcc"))


if __name__ == "__main__":
    unittest.main()
