# SPDX-License-Identifier: Apache-2.0
"""Supplement 2: how large is the second term of Eq. (4), which "has been observed to be negligible"?"""
import sys

import common
from sec1_constructions import PAIRS

QUANTITIES = {
    "second_gradient": "gradient",
    "second_kept_mode": "kept mode",
    "second_dropped_modes": "dropped modes",
    "second_tensor": "whole tensor",
}
ROUNDING = 1e-7


def check(report, rows):
    for quantity in ("second_gradient", "second_kept_mode"):
        for pair in PAIRS:
            worst = max(common.column(common.select(rows, pair=pair, quantity=quantity), "max"))
            report.claim(f"the second term is negligible in the {QUANTITIES[quantity]}, {pair}", worst < ROUNDING,
                         f"at most {worst:.1e} of the first term: zero up to rounding")
    for pair in PAIRS:
        median = min(common.column(common.select(rows, pair=pair, quantity="second_tensor"), "median"))
        report.claim(f"the second term is negligible as a tensor, {pair}", median < 0.01,
                     f"median at least {median:.2g} of the first term", expected=pair == "PP")


def write_table(report, rows):
    report.text("Size of the second term relative to the first, edges 10 dhat (median / largest):")
    body = []
    for pair in PAIRS:
        for s in (0.01, 0.1, 0.5, 0.9):
            cells = []
            for quantity in QUANTITIES:
                (row,) = common.select(rows, pair=pair, edge_over_dhat=10.0, s=s, quantity=quantity)
                cells.append(f"{row['median']:.1e} / {row['max']:.1e}")
            body.append((pair, s, *cells))
    report.table(("pair", "d/dhat", *QUANTITIES.values()), body)
    report.text(
        "Why: the ideal shape keeps its height dhat along n, so dEbar has no part that lies along the normal on both "
        "sides, and both the stress 2 b' F n n^T and the kept eigenmatrix F n n^T / sqrt(g) see only that part. In the "
        "eigenmatrices t n^T that are dropped the second term is as large as the first and nearly cancels it: what is "
        "left is (1 - s) t . dn, the turning of the normal. A method that kept lambda_2,3, or the second derivative of "
        "F, could not leave the second term out.")


def draw(report, rows):
    figure, axis = common.axes(2)
    for axes, quantity in ((axis[0][0], "second_kept_mode"), (axis[0][1], "second_tensor")):
        for color, pair in enumerate(PAIRS):
            for size, style in ((2.0, "-"), (10.0, "--"), (100.0, ":")):
                these = common.select(rows, pair=pair, edge_over_dhat=size, quantity=quantity)
                axes.loglog(common.column(these, "s"), common.column(these, "median").clip(1e-17),
                            f"C{color}{style}o", ms=6 - color, lw=3.5 - 0.8 * color, label=pair if style == "-" else None)
        axes.set(xlabel=r"$s = d/\hat d$", ylabel="|second term| / |first term|, median", ylim=(3e-18, 1e3),
                 title=QUANTITIES[quantity])
        axes.legend(fontsize=8)
    report.plot(figure, "sec2_second_term",
                "The second term of Eq. (4) beside the first; edges of 2 (solid), 10 (dashed), 100 dhat (dotted).")


def main():
    args = common.formula_options(__doc__, samples=1000).parse_args()
    rows = common.formulas(args, "constructions")
    report = common.Report("sec2_change_of_basis", "Section 2: the change-of-basis tensor", args)
    check(report, rows)
    write_table(report, rows)
    draw(report, rows)
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
