# SPDX-License-Identifier: Apache-2.0
"""The table of docs/accuracy.md says what the suite's lines say: the worst case, what was wrong, what did not finish."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = ROOT / "tests" / "accuracy" / "table.py"


def line(preset, found, error, verdict, moved="-"):
    return "\t".join(["ACCURACY", "fall", "v = g t", "none", preset, "0.1", "0.01", "bdf2", "8", "velocity", "-1", found,
                      error, "0", moved, "2", "5", "0.01", verdict])


LINES = ["[ RUN      ] Flight.FreeFall", line("steel", "-1.001", "0.1", "ok", "0.02"), line("foam", "-1.2", "20", "FAIL"),
         line("cork", "nan", "nan", "FAIL"), "ACCURACY-FAILED\tfall\tglass/0.1/0.01/bdf2/0\tstalled"]


def run(args, lines):
    return subprocess.run([sys.executable, "-B", str(TABLE), *args], input="\n".join(lines), capture_output=True, text=True)


class AccuracyTable(unittest.TestCase):
    def test_says_the_worst_case_and_counts_what_is_wrong(self):
        row = run([], LINES[:3]).stdout.splitlines()[-1]
        self.assertIn("| 20 | velocity; foam, 0.1 m, 10 ms, bdf2 | 0.02 |", row)
        self.assertTrue(row.endswith("| 1 |"), row)

    def test_nothing_is_worse_than_no_number(self):
        row = run([], LINES).stdout.splitlines()[-1]
        self.assertIn("cork", row)
        self.assertIn("2, 1 unfinished", row)
        self.assertIn("| 4 | 8 |", row)

    def test_replaces_the_table_of_a_page(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("before\n<!-- accuracy table: begin -->\nold\n<!-- accuracy table: end -->\nafter\n")
            self.assertEqual(run(["--write", str(page)], LINES[:2]).returncode, 0)
            text = page.read_text()
            self.assertNotIn("old", text)
            self.assertTrue(text.startswith("before\n") and text.endswith("after\n"))
            self.assertIn("| fall | v = g t |", text)

    def test_a_page_without_markers_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text("nothing here\n")
            refused = run(["--write", str(page)], LINES[:2])
            self.assertNotEqual(refused.returncode, 0)
            self.assertIn("markers", refused.stderr)


if __name__ == "__main__":
    unittest.main()
