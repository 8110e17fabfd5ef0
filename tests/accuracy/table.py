# SPDX-License-Identifier: Apache-2.0
"""Turns the lines that the accuracy suite prints into the table of docs/accuracy.md.

    build/release/tests/accuracy | python3 tests/accuracy/table.py            print the table
    ... | python3 tests/accuracy/table.py --write docs/accuracy.md            put it into the page

The table goes between the page's markers "accuracy table: begin" and "end"."""
import argparse
import pathlib
import re
import sys
from collections import OrderedDict

FIELDS = ("scene answer own preset size dt integrator vertices what expected found error own_error moved newton pcg "
          "seconds verdict").split()
NUMBERS = ("size", "dt", "expected", "found", "error", "own_error", "newton", "pcg", "seconds")
BEGIN, END = "<!-- accuracy table: begin -->", "<!-- accuracy table: end -->"


def read(lines):
    """Rows by scene, and the scenes' runs that did not finish."""
    scenes, unfinished = OrderedDict(), {}
    for line in lines:
        parts = line.rstrip("\n").split("\t")
        if parts[0] == "ACCURACY-FAILED":
            unfinished.setdefault(parts[1], []).append(parts[2])
            scenes.setdefault(parts[1], [])
        if parts[0] != "ACCURACY":
            continue
        row = dict(zip(FIELDS, parts[1:]))
        for key in NUMBERS:
            row[key] = float(row[key])
        row["vertices"] = int(row["vertices"])
        row["moved"] = None if row["moved"] == "-" else float(row["moved"])
        scenes.setdefault(row["scene"], []).append(row)
    return scenes, unfinished


def percent(x):
    return "0" if x < 1e-6 else f"{x:.2g}" if x < 1000 else f"{x:.0f}"


def place(row):
    return f"{row['what']}; {row['preset']}, {row['size']:g} m, {row['dt'] * 1e3:g} ms, {row['integrator']}"


def spread(rows, key, form="{:g}"):
    low, high = min(r[key] for r in rows), max(r[key] for r in rows)
    return form.format(low) if low == high else form.format(low) + " to " + form.format(high)


def table(scenes, unfinished):
    out = ["| scene | answer | model's own error | cases | vertices | worst error, % | where | tighter moves it by, % "
           "| Newton a step | wrong |", "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for name, rows in scenes.items():
        lost = len(set(unfinished.get(name, [])))
        if not rows:
            out.append(f"| {name} | | | {lost} | | | | | | {lost} unfinished |")
            continue
        cases = {(r["preset"], r["size"], r["dt"], r["integrator"], r["vertices"]) for r in rows}
        wrong = {(r["preset"], r["size"], r["dt"], r["integrator"], r["vertices"]) for r in rows if r["verdict"] != "ok"}
        worst = max(rows, key=lambda r: r["error"] - r["own_error"] if r["error"] == r["error"] else float("inf"))
        moved = [r["moved"] for r in rows if r["moved"] is not None]
        newton = sum(r["newton"] for r in rows) / len(rows)
        verdict = (f"{len(wrong)}" if wrong else "none") + (f", {lost} unfinished" if lost else "")
        out.append(f"| {name} | {rows[0]['answer']} | {rows[0]['own']} | {len(cases) + lost} | "
                   f"{spread(rows, 'vertices', '{}')} | {percent(worst['error'])} | {place(worst)} | "
                   f"{percent(max(moved)) if moved else '-'} | {newton:.1f} | {verdict} |")
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="logs; default: standard input")
    parser.add_argument("--write", metavar="PAGE", help="replace the table of this page")
    args = parser.parse_args()
    lines = [line for f in args.files for line in pathlib.Path(f).read_text().splitlines()] if args.files else sys.stdin
    text = table(*read(lines))
    if not args.write:
        print(text)
        return
    page = pathlib.Path(args.write)
    old = page.read_text()
    if BEGIN not in old or END not in old:
        sys.exit(f"{page}: found no markers {BEGIN} and {END}, expected both; add them where the table belongs")
    page.write_text(re.sub(re.escape(BEGIN) + ".*?" + re.escape(END), lambda _: f"{BEGIN}\n{text}\n{END}", old, flags=re.S))


if __name__ == "__main__":
    main()
