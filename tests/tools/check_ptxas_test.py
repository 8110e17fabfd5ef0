# SPDX-License-Identifier: Apache-2.0
"""tools/check_ptxas.py: fails on spills of hot kernels and on hot kernels that are gone."""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import check_ptxas  # noqa: E402

KERNEL = """ptxas info    : Compiling entry function '{name}' for 'sm_90'
ptxas info    : Function properties for {name}
    {stack} bytes stack frame, {stores} bytes spill stores, {loads} bytes spill loads
ptxas info    : Used {registers} registers, used 0 barriers, {stack} bytes cumulative stack size, 380 bytes cmem[0]
"""


def log(spills=None):
    """What ptxas says of all hot kernels; `spills`: name -> bytes."""
    text = ""
    for name in check_ptxas.HOT:
        functor = name.endswith("Kernel")
        function, *values = name.split()  # "f Enum 2": f made for value 2 of Enum
        arguments = "".join(f"(noli::{kind}){value}, " for kind, value in zip(values[::2], values[1::2]))
        arguments += "noli::CudaExec"
        entry = (f"void noli::detail::run_lane_kernel<noli::detail::{name}>(int)" if functor else
                 f"void noli::detail::run_kernel<noli::detail::{function}<{arguments}>(int)"
                 "::{lambda(int)#1}>(int)")
        bytes_ = (spills or {}).get(name, 0)
        text += KERNEL.format(name=entry, stack=bytes_, stores=bytes_, loads=bytes_, registers=40)
    return text


class CheckPtxasTest(unittest.TestCase):
    def run_on(self, text):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "a.o.ptxas").write_text(text)
            out = io.StringIO()
            with mock.patch.object(sys, "argv", ["check_ptxas", folder]), contextlib.redirect_stdout(out), \
                    contextlib.redirect_stderr(out):
                return check_ptxas.main(), out.getvalue()

    def test_passes_without_spills(self):
        self.assertFalse(self.run_on(log())[0])

    def test_fails_on_a_spill(self):
        failed, said = self.run_on(log({"device_update": 8}))
        self.assertTrue(failed)
        self.assertIn("device_update (sm_90) spills 8/8 bytes", said)

    def test_tells_the_loops_with_exact_stages_from_those_without(self):
        hot = "classify_candidates Doubles 1"
        other = KERNEL.format(name="void noli::detail::run_kernel<noli::detail::classify_candidates<(noli::Doubles)0, "
                              "noli::CudaExec>(int)::{lambda(int)#1}>(int)",
                              stack=8, stores=8, loads=8, registers=255)
        self.assertFalse(self.run_on(log() + other)[0])
        self.assertTrue(self.run_on(log({hot: 8}) + other)[0])

    def test_fails_when_a_hot_kernel_is_gone(self):
        failed, said = self.run_on(log().replace("apply_inverse", "renamed"))
        self.assertTrue(failed)
        self.assertIn("apply_inverse: not among the kernels", said)


if __name__ == "__main__":
    unittest.main()
