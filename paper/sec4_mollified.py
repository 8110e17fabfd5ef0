# SPDX-License-Identifier: Apache-2.0
"""Supplement 4: Eqs. (11) to (15) against finite differences in J space, and how far the three
Hessian models of nearly parallel edges are from the exact projection."""
import sys

import numpy as np

import common

EPS = 1.3  # of the checks in J space, where J = diag(1, c, s) has entries of order 1
SUBCASES = {"PP": "point-point", "PE": "point-edge", "EE": "edge-edge"}
VARIANTS = {
    "two-mode": "the authors': positive part of M (Eq. 14) through dc/dx, dd/dx",
    "four-mode": "the same with the gamma 2, 3 modes (Eqs. 11, 12) through all of d(u x v)/dx",
    "exact": "numeric projection of the exact Hessian",
}
TWISTS = {"x": ((1, 2, 1), (2, 1, -1)), "y": ((0, 2, -1), (2, 0, 1)), "z": ((0, 1, 1), (1, 0, -1))}


def energy(J, r):
    """b~ = m(gamma) b(g), kappa dhat^4 = 1."""
    gamma, g = J[:, 1] @ J[:, 1], J[:, 2] @ J[:, 2]
    return (2 * gamma / EPS - gamma**2 / EPS**2) * (-1) ** r * (g - 1) ** 2 * np.log(g) ** r


def difference_hessian(c, s, r, h=2e-4):
    """Second central differences of b~ in the 9 entries of J, columns stacked."""
    base = np.diag([1.0, c, s])

    def at(i, j, a, b):
        J = base.T.flatten()
        J[i] += a * h
        J[j] += b * h
        return energy(J.reshape(3, 3).T, r)

    return np.array([[(at(i, j, 1, 1) - at(i, j, 1, -1) - at(i, j, -1, 1) + at(i, j, -1, -1)) / (4 * h * h)
                      for j in range(9)] for i in range(9)])


def twist(axis):
    T = np.zeros((3, 3))
    for row, col, value in TWISTS[axis]:
        T[row, col] = value
    return T


def twist_matrices(c, s, n):
    """Eqs. (11) and (12) with U = V = I."""
    sigma = np.diag([1.0, c, s])
    right = sigma @ np.outer(n, n)
    Q2 = twist("x") @ right
    Q3 = (c * n[1] * twist("z") - s * n[2] * twist("y")) @ right
    return [Q / np.linalg.norm(Q) for Q in (Q2, Q3)]


def partials(gamma, g, r):
    """b~_gamma, b~_gammagamma, b~_g, b~_gg, b~_gammag from m and b of MATH 1.2, 3.1."""
    L, sign = np.log(g), (-1) ** r
    m, m1, m2 = 2 * gamma / EPS - gamma**2 / EPS**2, 2 * (EPS - gamma) / EPS**2, -2 / EPS**2
    b = sign * (g - 1) ** 2 * L**r
    b1 = sign * (2 * (g - 1) * L**r + r * (g - 1) ** 2 * L ** (r - 1) / g)
    b2 = sign * (2 * L**r + 4 * r * (g - 1) * L ** (r - 1) / g - r * (g - 1) ** 2 * L ** (r - 1) / g**2
                 + r * (r - 1) * (g - 1) ** 2 * L ** (r - 2) / g**2)
    return m1 * b, m2 * b, m * b1, m * b2, m1 * b1


def closed_hessian(c, s, r):
    """(Eq. 15, its part M of Eq. 14, 4t, lambda'_7 and lambda'_8)."""
    bc, bcc, bg, bgg, bcg = partials(c * c, s * s, r)
    gamma1, g1, coupling = 2 * (bc + 2 * c * c * bcc), 2 * (bg + 2 * s * s * bgg), 4 * c * s * bcg
    M = np.zeros((9, 9))
    M[4, 4], M[8, 8] = gamma1, g1
    M[4, 8] = M[8, 4] = coupling
    H = M.copy()
    for n, value in ((np.eye(3)[1], 2 * bc), (np.eye(3)[2], 2 * bg)):
        for Q in twist_matrices(c, s, n):
            H += value * np.outer(Q.T.ravel(), Q.T.ravel())
    root = np.hypot(gamma1 - g1, 2 * coupling)
    return H, M, coupling, np.array([gamma1 + g1 - root, gamma1 + g1 + root]) / 2


def check_equations(report):
    worst = {"Eq. (15)": 0.0, "Eq. (13)": 0.0, "Eq. (14)": 0.0}
    for c in (0.05, 0.3, 0.65, 0.67, 0.9, 1.1):
        for s in (0.2, 0.4, 0.8):
            for r in (1, 2):
                H, M, coupling, primes = closed_hessian(c, s, r)
                measured = difference_hessian(c, s, r)
                size = np.abs(H).max()
                worst["Eq. (15)"] = max(worst["Eq. (15)"], np.abs(H - measured).max() / size)
                worst["Eq. (13)"] = max(worst["Eq. (13)"], abs(coupling - measured[4, 8]) / size)
                values = np.linalg.eigvalsh(M[np.ix_([4, 8], [4, 8])])
                worst["Eq. (14)"] = max(worst["Eq. (14)"], np.abs(values - primes).max() / np.abs(values).max())
    report.claim("Eqs. (11), (12), (15): the listed eigenpairs add up to the Hessian in J",
                 worst["Eq. (15)"] < 1e-5, f"largest relative difference {worst['Eq. (15)']:.1e} to finite differences")
    report.claim("Eq. (13): the coupling entry is 4t = d2b~/dc ds", worst["Eq. (13)"] < 1e-5, f"{worst['Eq. (13)']:.1e}")
    report.claim("Eq. (14): the closed forms of lambda'_7,8 are the eigenvalues of M", worst["Eq. (14)"] < 1e-12,
                 f"{worst['Eq. (14)']:.1e}")


def check_variants(report, rows):
    errors = [row for row in rows if row["quantity"] == "error"]
    exact = max(common.column(common.select(errors, variant="exact"), "max"))
    report.claim("the library's exact variant is the exact projection", exact < 1e-7, f"largest error {exact:.1e}")
    two, four = (common.select(errors, variant=v) for v in ("two-mode", "four-mode"))
    medians = common.column(two, "median")
    report.claim("the eigenpairs of M alone (two-mode) come within 10 % of the exact projection (our question, not in print)",
                 medians.max() < 0.1, f"medians {medians.min():.2g} to {medians.max():.2g}", expected=False)
    nearer = common.column(four, "median") <= common.column(two, "median")
    report.text(f"The median error of the four-mode variant is the smaller one in {nearer.sum()} of {nearer.size} rows "
                "(sub-case, r, s, range of gamma / eps).")


def write_table(report, rows):
    report.text("Variants: " + "; ".join(f"**{name}** {what}" for name, what in VARIANTS.items()) + ".")
    report.text("Median of |H - P| / |P| and of |H| / |P|, P the exact projection; r = 2, s = d/dhat = 0.5:")
    body = []
    for subcase in SUBCASES:
        for low in sorted({row["gamma_over_eps_lo"] for row in rows}):
            cells = []
            for quantity in ("error", "size"):
                for variant in ("two-mode", "four-mode"):
                    (row,) = common.select(rows, subcase=subcase, r=2.0, s=0.5, gamma_over_eps_lo=low, variant=variant,
                                           quantity=quantity)
                    cells.append(row["median"])
            body.append((subcase, f"{low:.2g} to {row['gamma_over_eps_hi']:.2g}", *cells))
    report.table(("sub-case", "gamma / eps", "error two-mode", "error four-mode", "size two-mode", "size four-mode"), body)


def draw(report, rows):
    figure, axis = common.axes(3, width=3.6)
    for axes, subcase in zip(axis[0], SUBCASES):
        for color, variant in enumerate(VARIANTS):
            for s, style in ((0.1, ":"), (0.5, "-"), (0.9, "--")):
                these = common.select(rows, subcase=subcase, r=2.0, s=s, variant=variant, quantity="error")
                x = np.sqrt(common.column(these, "gamma_over_eps_lo") * common.column(these, "gamma_over_eps_hi"))
                axes.semilogx(x, common.column(these, "median"), f"C{color}{style}", label=variant if s == 0.5 else None)
                if s == 0.5:
                    axes.fill_between(x, common.column(these, "q10"), common.column(these, "q90"), color=f"C{color}", alpha=0.15)
        axes.axvline(1 / 3, color="0.5", lw=0.8)
        axes.set(xlabel=r"$\gamma / \epsilon_\times$", title=SUBCASES[subcase], ylim=(-0.05, None))
    axis[0][0].set_ylabel("error to the exact projection")
    axis[0][0].legend(fontsize=8)
    report.plot(figure, "sec4_variants",
                "Median error, r = 2; d/dhat = 0.1 (dotted), 0.5 (solid, band of 80 %), 0.9 (dashed). Grey line: "
                "lambda_gamma1 changes its sign.")


def main():
    args = common.formula_options(__doc__, samples=200).parse_args()
    rows = common.formulas(args, "mollified")
    report = common.Report("sec4_mollified", "Section 4: the mollified Hessian", args)
    check_equations(report)
    check_variants(report, rows)
    write_table(report, rows)
    draw(report, rows)
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
