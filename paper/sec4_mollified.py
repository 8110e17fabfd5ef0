#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement 4: the three Hessians of nearly parallel edges against the projected exact one.
Eqs. (11)-(15) against finite differences are C++ tests (tests/unit/paper/mollified_space_test.cpp)."""
import sys

import common

VARIANTS = ("two-mode", "four-mode", "exact")
SUBCASES = ("PP", "PE", "EE")


def curve(rows, variant):
    """Median error over the range of gamma / eps, all gaps together: (middle of the range, largest median)."""
    ranges = sorted({(row["gamma_over_eps_lo"], row["gamma_over_eps_hi"]) for row in rows})
    medians = [max(row["median"] for row in common.select(rows, variant=variant, gamma_over_eps_lo=low))
               for low, _ in ranges]
    return [(low * high) ** 0.5 for low, high in ranges], medians


def main():
    args = common.formula_options(__doc__, samples=200).parse_args()
    rows = common.select(common.formulas(args, "mollified"), quantity="error")
    report = common.Report("sec4_mollified", "Section 4: Hessians of nearly parallel edges", args)
    figure, axis = common.axes(len(SUBCASES), width=3.4)
    for column, subcase in enumerate(SUBCASES):
        of = common.select(rows, subcase=subcase, r=2.0)
        worst = {v: max(row["max"] for row in common.select(of, variant=v)) for v in VARIANTS}
        typical = {v: (min(c), max(c)) for v in VARIANTS for c in [curve(of, v)[1]]}
        report.claim(f"{subcase}: ours (exact) is the numeric projection", worst["exact"] < 1e-9,
                     f"largest error {worst['exact']:.1e}, rounding of the 12x12 eigenproblem")
        report.claim(f"{subcase}: the supplement's two modes are the projected Hessian", typical["two-mode"][1] < 0.05,
                     f"median errors {typical['two-mode'][0]:.2f} to {typical['two-mode'][1]:.2f}", expected=False)
        near = {v: max(row["median"] for row in common.select(of, variant=v) if row["gamma_over_eps_hi"] <= 1e-2)
                for v in VARIANTS}
        report.claim(f"{subcase}: all four modes are better towards parallel edges", near["four-mode"] < near["two-mode"],
                     f"gamma < eps / 100: median error up to {near['four-mode']:.2g}, two modes {near['two-mode']:.2g}; "
                     f"over all angles {typical['four-mode'][0]:.2g} to {typical['four-mode'][1]:.2f}")
        for variant in VARIANTS[:2]:
            axis[0][column].loglog(*curve(of, variant), marker="o", ms=3, label=variant)
        axis[0][column].set(title=subcase, xlabel=r"$\gamma / \epsilon$", ylim=(1e-6, 3))
    axis[0][0].set_ylabel("relative error, largest median")
    axis[0][0].legend()
    report.plot(figure, "mollified", "Frobenius error to the projected exact Hessian, barrier exponent 2.")
    report.table(("sub-case", "r", "d / dhat", "gamma / eps from", "to", "variant", "median", "q90", "largest"),
                 [[row[k] for k in ("subcase", "r", "s", "gamma_over_eps_lo", "gamma_over_eps_hi", "variant", "median",
                                    "q90", "max")] for row in rows if row["variant"] != "exact" and row["s"] == 0.5])
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
