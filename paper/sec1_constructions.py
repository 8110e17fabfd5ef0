# SPDX-License-Identifier: Apache-2.0
"""Supplement 1: F = E Ebar^-1 of every pair type measures the distance, and the library's
closed forms are what follows from it."""
import sys

import numpy as np

import common

PAIRS = {"PP": "point-point", "PE": "point-edge", "PT": "point-triangle", "EE": "edge-edge"}
ERRORS = {
    "error_gap": ("|F n|^2 = (d/dhat)^2", 1e-9),
    "error_stretch": ("F^T F = I + (s^2 - 1) n n^T: stretched along n only", 1e-9),
    "error_gradient": ("the gradient through F is the library's", 1e-7),
    "error_hessian": ("the kept eigenpair through F is the library's Gauss-Newton Hessian", 1e-7),
}


def draw(report, rows):
    figure, axis = common.axes(2)
    for axes, quantity in ((axis[0][0], "error_gradient"), (axis[0][1], "error_hessian")):
        for color, pair in enumerate(PAIRS):
            for size, style in ((2.0, "-"), (10.0, "--"), (100.0, ":")):
                these = common.select(rows, pair=pair, edge_over_dhat=size, quantity=quantity)
                axes.loglog(common.column(these, "s"), common.column(these, "max"), f"C{color}{style}",
                            label=f"{pair}, edges {size:g} dhat" if quantity == "error_hessian" else None)
        axes.axhline(ERRORS[quantity][1], color="0.5", lw=0.8)
        axes.set(xlabel=r"$s = d/\hat d$", ylabel="largest relative difference", title=quantity.replace("error_", ""))
    axis[0][1].legend(fontsize=6, ncol=2)
    report.plot(figure, "sec1_closed_forms",
                "Closed forms against the explicit construction, largest over random pairs (grey: tolerance).")


def main():
    args = common.formula_options(__doc__, samples=1000).parse_args()
    rows = common.formulas(args, "constructions")
    report = common.Report("sec1_constructions", "Section 1: explicit Jacobians", args)
    for quantity, (statement, limit) in ERRORS.items():
        worst = max(common.column(common.select(rows, quantity=quantity), "max"))
        report.claim(statement, worst < limit, f"largest error {worst:.1e}, {args.samples} pairs per row, all types")
    report.text("Largest error over edge lengths of 2, 10, 100 dhat and s = 0.01 to 0.9:")
    report.table(("pair", *(key.replace("error_", "") for key in ERRORS)),
                 [(PAIRS[pair], *(float(np.max(common.column(common.select(rows, pair=pair, quantity=key), "max")))
                                  for key in ERRORS)) for pair in PAIRS])
    draw(report, rows)
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
