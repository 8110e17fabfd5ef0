# SPDX-License-Identifier: Apache-2.0
"""Runs the scripts of paper/ that check the supplement's formulas, and one short study.
Ends with 77 (skipped) where numpy, matplotlib or sympy is missing: `make paper` installs them."""
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import matplotlib  # noqa: F401
    import numpy  # noqa: F401
    import sympy  # noqa: F401
except ImportError as missing:
    print(f"paper: skipped, {missing}")
    sys.exit(77)

root = pathlib.Path(__file__).resolve().parents[2]
build = pathlib.Path(os.environ["NOLI_BUILD"])
formulas = ["sec1_constructions", "sec2_change_of_basis", "sec3_eigenvalues", "errata", "sec4_mollified",
            "sec5_friction"]
with tempfile.TemporaryDirectory() as folder:
    done = subprocess.run([sys.executable, root / "paper/all.py", "--build", build, "--out", folder,
                           "--only", *formulas])
    study = subprocess.run([sys.executable, root / "paper/newton_counts.py", "--noli", build / "noli", "--out",
                            folder, "--work", folder, "--scenes", "stack_1e7", "--nudges", "0"])
    pages = [name for name in [*formulas, "newton_counts"] if not (pathlib.Path(folder) / f"{name}.md").exists()]
print(f"paper: no page of {', '.join(pages)}" if pages else "paper: every page was written")
sys.exit(bool(pages) or done.returncode or study.returncode)
