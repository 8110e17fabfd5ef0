# SPDX-License-Identifier: Apache-2.0
"""What the scripts of this folder share: options, running a program, a report of claims.

A script collects claims, tables and plots in a Report and ends with sys.exit(report.write()):
the Markdown page OUT/<name>.md, one verdict line per claim on the terminal, and exit status
1 if a claim that should hold does not.
"""
import argparse
import csv
import io
import pathlib
import subprocess

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent


def options(description, **extra):
    """The parser that every script starts from: --out, --plots; extra adds --key DEFAULT."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "paper", help="folder of the results")
    parser.add_argument("--plots", choices=("svg", "png"), default="svg", help="format of the plots")
    for key, default in extra.items():
        parser.add_argument("--" + key, type=type(default), default=default)
    return parser


def formula_options(description, samples):
    """options() of the scripts that run noli_paper_formulas."""
    return options(description, samples=samples, seed=1,
                   formulas=ROOT / "build" / "release" / "paper" / "noli_paper_formulas")


def run(command):
    """Standard output of a program; ends the script with what it said if it fails."""
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    except OSError as error:
        raise SystemExit(f"cannot run {command[0]}: {error.strerror}")
    if done.returncode:
        raise SystemExit(f"{' '.join(str(c) for c in command)}: exit status {done.returncode}\n{done.stderr}")
    return done.stdout


def formulas(args, table):
    """Rows of one table of noli_paper_formulas, numbers as floats."""
    text = run([args.formulas, table, args.samples, args.seed])
    return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(io.StringIO(text))]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def column(rows, key):
    return np.array([row[key] for row in rows])


def select(rows, **values):
    """The rows whose columns have the given values."""
    return [row for row in rows if all(row[key] == value for key, value in values.items())]


def show(value):
    """A table cell: floats with three significant digits."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return f"{value:.3g}"
    return str(value).replace("|", "\\|")


class Report:
    """A page of claims, tables and plots, and whether every claim held."""

    def __init__(self, name, title, args):
        self.name, self.args = name, args
        self.lines = [f"# {title}", ""]
        self.claims = []
        args.out.mkdir(parents=True, exist_ok=True)

    def text(self, text):
        self.lines += [text, ""]

    def table(self, header, rows):
        self.lines.append("| " + " | ".join(header) + " |")
        self.lines.append("|" + "---|" * len(header))
        self.lines += ["| " + " | ".join(show(cell) for cell in row) + " |" for row in rows]
        self.lines.append("")

    def claim(self, statement, holds, measured="", expected=True):
        """A statement of the supplement and whether it held when measured. A statement that is
        known to be wrong is expected not to hold: the script then fails if it does."""
        holds = bool(holds)
        verdict = ("holds" if holds else "does not hold") + ("" if holds == expected else " (unexpected)")
        self.claims.append((statement, verdict, measured, holds == expected))
        print(f"{self.name}: {verdict}: {statement}" + (f" [{measured}]" if measured else ""))

    def plot(self, figure, name, caption):
        """Saves a figure as OUT/<name>.svg (or .png) and puts it on the page."""
        import matplotlib

        matplotlib.rcParams["svg.hashsalt"] = "noli"  # the same file from the same numbers
        path = self.args.out / f"{name}.{self.args.plots}"
        figure.tight_layout()
        figure.savefig(path, dpi=110, metadata={"Date": None} if self.args.plots == "svg" else None)
        self.lines += [f"![{caption}]({path.name})", "", caption, ""]

    def write(self):
        """Writes the page; 0 if every claim came out as expected, else 1."""
        page, self.lines = self.lines, []
        self.table(("statement", "verdict", "measured"), [claim[:3] for claim in self.claims])
        verdicts, self.lines = self.lines, page
        (self.args.out / f"{self.name}.md").write_text("\n".join(page[:2] + verdicts + page[2:]))
        return int(not all(claim[3] for claim in self.claims))


def axes(columns=1, width=4.6, height=3.4):
    """A figure without a window and its axes."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    return plt.subplots(1, columns, figsize=(width * columns, height), squeeze=False)
