# SPDX-License-Identifier: Apache-2.0
"""Supplement 3: Eqs. (5) to (10) symbolically, the library's eigenvalues, Figs. 2a, 2b and 3."""
import sys

import numpy as np
import sympy as sp

import common

g = sp.symbols("g", positive=True)
L = sp.log(g)


def barrier(r):
    """b(g) of MATH 1.2 with kappa dhat^4 = 1."""
    return (-1) ** r * (g - 1) ** 2 * L**r


def lambda1(r):
    b = barrier(r)
    return 2 * (sp.diff(b, g) + 2 * g * sp.diff(b, g, 2))


def lambda23(r):
    return 2 * sp.diff(barrier(r), g)


# As printed, dhat = 1.
EQ5 = 2 * (6 * g + 2 * g * L - 7 * g**2 - 6 * g**2 * L + 1) / g
EQ6 = -2 * (g - 1) * (g + 2 * g * L - 1) / g**2
EQ9 = -2 * (13 * g**2 - 2 * g + 6 * g**2 * L + 1) / g**2
EQ10 = g + 2 * g * L - 1


def same(a, b):
    return sp.simplify(sp.expand(a - b)) == 0


def check_identities(report):
    s = sp.symbols("s", positive=True)
    for r in (1, 2):
        in_s = barrier(r).subs(g, s**2)
        report.claim(f"lambda_1 is the second derivative of the barrier in s = d/dhat (r = {r})",
                     same(sp.diff(in_s, s, 2), lambda1(r).subs(g, s**2)), "symbolic")
        report.claim(f"lambda_2,3 is (1/s) times its first derivative (r = {r})",
                     same(sp.diff(in_s, s) / s, lambda23(r).subs(g, s**2)), "symbolic")
    report.claim("Eq. (5) is lambda_1", same(EQ5, lambda1(1)), "symbolic")
    ratio = sp.simplify(EQ6 / lambda23(1))
    report.claim("Eq. (6) as printed is lambda_2,3", same(EQ6, lambda23(1)),
                 f"printed / true = {ratio}", expected=False)
    report.claim("Eq. (6) with denominator g is lambda_2,3", same(g * EQ6, lambda23(1)), "symbolic")
    report.claim("Eq. (9) is the derivative of Eq. (5)", same(EQ9, sp.diff(EQ5, g)), "symbolic")


def check_limits(report):
    for r in (1, 2):
        report.claim(f"Eq. (7): lambda_1 grows without bound as g -> 0 (r = {r})",
                     sp.limit(lambda1(r), g, 0, "+") == sp.oo, "symbolic")
        report.claim(f"Eq. (8): lambda_1 -> 0 as g -> 1 (r = {r})", sp.limit(lambda1(r), g, 1) == 0, "symbolic")


def only_zero(f, low, high):
    """The zero of f, which changes its sign once between low and high."""
    return sp.nsolve(f, g, (low, high), solver="bisect", verify=False)


def check_signs(report):
    """The sign statements, proved with one zero of a derivative each.

    h, the bracket of Eq. (9), has h'' = 44 + 12 ln g with one zero, so h' falls and then rises;
    h'(0+) = -2 and h'(1) > 0, so h' has one zero and h its smallest value there. The factor of
    Eq. (10) falls, then rises, so that its largest values are at the ends.
    """
    h = 13 * g**2 - 2 * g + 6 * g**2 * L + 1
    dh = sp.diff(h, g)
    shape = same(sp.diff(dh, g), 44 + 12 * L) and sp.limit(dh, g, 0, "+") == -2 and dh.subs(g, 1) > 0
    lowest = only_zero(dh, sp.Float(1e-3), sp.Float(0.999))
    value = h.subs(g, lowest)
    report.claim("Eq. (9) is negative on (0, 1), so lambda_1 falls to 0 and is positive", shape and value > 0,
                 f"smallest bracket {float(value):.4f} at g = {float(lowest):.4f}")
    shape = same(sp.diff(EQ10, g), 3 + 2 * L)
    ends = (sp.limit(EQ10, g, 0, "+"), EQ10.subs(g, 1))
    report.claim("Eq. (10): g + 2 g ln g - 1 < 0 on (0, 1), so lambda_2,3 < 0", shape and max(ends) <= 0,
                 f"end values {ends[0]} and {ends[1]}, falling then rising between")


def check_library(report, rows):
    gap = common.column(rows, "g")
    for name, printed, ours in (("Eq. (5)", "eq5", "lambda1_r1"), ("corrected Eq. (6)", "eq6_corrected", "lambda23_r1"),
                                ("Eq. (9)", "eq9", "slope_r1")):
        a, b = common.column(rows, printed), common.column(rows, ours)
        keep = gap < 0.99  # beyond, the printed terms cancel
        error = np.abs(a / b - 1)[keep].max()
        limit = 1e-8 if ours == "slope_r1" else 1e-11
        report.claim(f"the library computes {name}", error < limit, f"largest relative difference {error:.1e}, g < 0.99")
    for r in (1, 2):
        first, rest, slope = (common.column(rows, f"{k}_r{r}") for k in ("lambda1", "lambda23", "slope"))
        report.claim(f"exactly one eigenvalue is positive, and it decreases (library, r = {r})",
                     (first > 0).all() and (rest < 0).all() and (slope < 0).all(),
                     f"{gap.size} gaps from {gap[0]:.1e} to {gap[-1]:.5f}")


def draw_figure_2(report, rows):
    figure, axis = common.axes(2)
    gap = common.column(rows, "g")
    for axes, ours, printed, label in ((axis[0][0], "lambda1", "eq5", r"$\lambda_1$"),
                                       (axis[0][1], "slope", "eq9", r"$\partial\lambda_1/\partial g$")):
        axes.plot(gap, common.column(rows, ours + "_r1"), "C0", lw=2.5, alpha=0.6, label="r = 1, library")
        axes.plot(gap, common.column(rows, printed), "k--", lw=1, label=f"Eq. ({printed[2:]}) as printed")
        axes.plot(gap, common.column(rows, ours + "_r2"), "C1", lw=1.5, label="r = 2, library")
        axes.axhline(0, color="0.6", lw=0.8)
        axes.set(xlabel=r"gap $g = (d/\hat d)^2$", ylabel=label + r"  ($\hat d = 1$)", xlim=(0, 1))
        axes.legend()
    axis[0][0].set(ylim=(-5, 120), title="Fig. 2a")
    axis[0][1].set(ylim=(-600, 30), title="Fig. 2b")
    report.plot(figure, "fig2", "Fig. 2a and 2b redrawn: the kept eigenvalue and its derivative.")


def draw_figure_3(report, rows):
    figure, axis = common.axes()
    gap = common.column(rows, "g")
    axes = axis[0][0]
    axes.plot(gap, common.column(rows, "lambda23_r1"), "C0", lw=2.5, alpha=0.6, label="r = 1, library")
    axes.plot(gap, common.column(rows, "eq6_corrected"), "k--", lw=1, label="Eq. (6), denominator g")
    axes.plot(gap, common.column(rows, "eq6_printed"), "C3:", lw=1.5, label="Eq. (6) as printed")
    axes.plot(gap, common.column(rows, "lambda23_r2"), "C1", lw=1.5, label="r = 2, library")
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set(xlabel=r"gap $g = (d/\hat d)^2$", ylabel=r"$\lambda_{2,3}$  ($\hat d = 1$)", xlim=(0, 1), ylim=(-80, 5),
             title="Fig. 3")
    axes.legend(loc="lower right")
    report.plot(figure, "fig3", "Fig. 3 redrawn: the dropped eigenvalues, with the printed and the corrected Eq. (6).")


def main():
    args = common.formula_options(__doc__, samples=400).parse_args()
    rows = common.formulas(args, "eigenvalues")
    report = common.Report("sec3_eigenvalues", "Section 3: eigenvalues of the barrier", args)
    check_identities(report)
    check_limits(report)
    check_signs(report)
    check_library(report, rows)
    draw_figure_2(report, rows)
    draw_figure_3(report, rows)
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
