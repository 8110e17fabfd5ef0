# SPDX-License-Identifier: Apache-2.0
"""Supplement 5: Eqs. (16) to (20); the 2 x 2 friction block is never indefinite."""
import sys

import numpy as np
import sympy as sp

import common

y, eps, a, b = sp.symbols("y epsilon a b", positive=True)
STICKING = -(y**2) / eps**2 + 2 * y / eps  # f_1 of Eq. (17) below eps = eps_v dt
SLIDING = sp.Integer(1)


def block(f1):
    """Eq. (20) at u = (a, b)."""
    u = sp.Matrix([a, b])
    size = sp.sqrt(a**2 + b**2)
    first = ((sp.diff(f1, y) * y - f1) / y**3).subs(y, size)
    return first * u * u.T + (f1 / y).subs(y, size) * sp.eye(2)


def check_law(report):
    ends = [STICKING.subs(y, 0), sp.simplify(STICKING.subs(y, eps)), sp.diff(STICKING, y).subs(y, eps)]
    report.claim("Eq. (17): f_1 rises from 0 to 1 and meets 1 with slope 0", ends == [0, 1, 0], "symbolic")
    slope = sp.diff(STICKING, y)
    report.claim("Eq. (17): f_1 is monotonic", sp.simplify(slope - 2 * (eps - y) / eps**2) == 0,
                 "f_1' = 2 (eps - y) / eps^2 >= 0 below eps, 0 above")
    f0 = sp.integrate(STICKING, y)
    f0 += eps - f0.subs(y, eps)
    report.claim("Eq. (18): f_0' = f_1 and f_0(eps) = eps fix f_0",
                 sp.simplify(f0 - (y**2 / eps - y**3 / (3 * eps**2) + eps / 3)) == 0, f"f_0 = {sp.simplify(f0)}")
    u, size = sp.Matrix([a, b]), sp.sqrt(a**2 + b**2)
    for name, f1, potential in (("sticking", STICKING, f0), ("sliding", SLIDING, y)):
        D = potential.subs(y, size)
        force = f1.subs(y, size) * u / size
        report.claim(f"Eq. (16) is minus the gradient of Eq. (18), Eq. (20) its Hessian ({name})",
                     sp.simplify(sp.Matrix([sp.diff(D, v) for v in u]) - force) == sp.zeros(2, 1)
                     and sp.simplify(sp.hessian(D, (a, b)) - block(f1)) == sp.zeros(2, 2), "symbolic")


def check_eigenvalues(report):
    u, across, size = sp.Matrix([a, b]), sp.Matrix([-b, a]), sp.sqrt(a**2 + b**2)
    for name, f1 in (("sticking", STICKING), ("sliding", SLIDING)):
        H = block(f1)
        along_ok = sp.simplify(H * u - sp.diff(f1, y).subs(y, size) * u) == sp.zeros(2, 1)
        across_ok = sp.simplify(H * across - (f1 / y).subs(y, size) * across) == sp.zeros(2, 1)
        report.claim(f"the eigenvalues of Eq. (20) are f_1' along u and f_1 / |u| across, neither negative ({name})",
                     along_ok and across_ok, "symbolic")


def check_numbers(report, rows):
    printed, library = common.column(rows, "printed_min"), common.column(rows, "library_min")
    largest = common.column(rows, "printed_max")
    force = common.column(rows, "mu_lambda")
    for name, values in (("printed formula", printed), ("library", library)):
        report.claim(f"the smallest eigenvalue of the block is not negative ({name})",
                     (values / largest).min() > -1e-13,
                     f"minimum {(values / largest).min():.1e} of the largest eigenvalue (rounding), {values.size} random "
                     f"blocks, |u|/eps 1e-4 to 1e2, mu lambda {force.min():.1e} to {force.max():.1e} N")
    report.claim("the projection changes nothing", common.column(rows, "projection").max() < 1e-13,
                 f"at most {common.column(rows, 'projection').max():.1e} of the block")
    report.claim("the library's block is Eq. (20)", common.column(rows, "difference").max() < 1e-12,
                 f"largest relative difference {common.column(rows, 'difference').max():.1e}")


def write_table(report, rows):
    report.text("Smallest eigenvalue of the block, in units of mu lambda / eps, by slip and by mu lambda:")
    slip, force = common.column(rows, "u_over_eps"), common.column(rows, "mu_lambda")
    value = common.column(rows, "printed_min")
    slips, forces = (1e-4, 1e-2, 0.5, 1.0, 10.0, 101.0), np.quantile(force, (0, 1 / 3, 2 / 3, 1))
    body = []
    for low, high in zip(slips[:-1], slips[1:]):
        cells = []
        for weak, strong in zip(forces[:-1], forces[1:]):
            here = value[(slip >= low) & (slip < high) & (force >= weak) & (force <= strong)]
            cells.append(here.min() if here.size else "none")
        body.append((f"{low:g} to {high:g}", *cells))
    report.table(("u / eps", *(f"mu lambda {weak:.1e} to {strong:.1e} N" for weak, strong in zip(forces[:-1], forces[1:]))), body)


def draw(report, rows):
    figure, axis = common.axes(2)
    slip = common.column(rows, "u_over_eps")
    left, right = axis[0]
    left.semilogx(slip, common.column(rows, "f1"), "C0", label=r"$f_1$, Eq. (17)")
    left.semilogx(slip, common.column(rows, "f0_over_eps").clip(0, 2), "C1", label=r"$f_0 / \epsilon$")
    left.set(xlabel=r"$|u| / \epsilon$,  $\epsilon = \epsilon_v \Delta t$", ylim=(0, 2), title="friction law")
    right.semilogx(slip, common.column(rows, "printed_max"), "C0", label=r"across u: $f_1/|u|$")
    right.semilogx(slip, common.column(rows, "printed_min"), "C1", label=r"along u: $f_1'$")
    right.axhline(0, color="0.6", lw=0.8)
    right.set(xlabel=r"$|u| / \epsilon$", ylabel=r"eigenvalue / $(\mu\lambda/\epsilon)$", title="Eq. (20)")
    for axes in (left, right):
        axes.legend()
    report.plot(figure, "sec5_friction", "The friction law and the two eigenvalues of the friction block.")


def main():
    args = common.formula_options(__doc__, samples=2000).parse_args()
    rows = common.formulas(args, "friction")
    report = common.Report("sec5_friction", "Section 5: the friction Hessian", args)
    check_law(report)
    check_eigenvalues(report)
    check_numbers(report, rows)
    write_table(report, rows)
    draw(report, rows)
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
