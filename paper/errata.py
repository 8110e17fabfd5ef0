# SPDX-License-Identifier: Apache-2.0
"""The printed errors of the supplement: each printed version failing, its correction passing."""
import sys

import numpy as np

import common
from warp_reduction import product_error

DHAT = 0.1
TOLERANCE = 1e-6  # of the corrected versions; a printed one has to miss it a hundredfold


def unit(v):
    return v / np.linalg.norm(v)


def differences(f, x, h):
    """Fourth-order central differences, one row per component of x."""
    rows = []
    for i in range(x.size):
        e = np.zeros(x.size)
        e[i] = h
        rows.append((8 * (f(x + e) - f(x - e)) - (f(x + 2 * e) - f(x - 2 * e))) / (12 * h))
    return np.array(rows)


def eq6(args):
    """Against the library and against differences of b = -(g - 1)^2 ln g: lambda_2,3 = 2 b'."""
    rows = [row for row in common.formulas(args, "eigenvalues") if 1e-4 < row["g"] < 0.9]
    gap = common.column(rows, "g")
    h = 1e-4 * gap
    b = lambda g: -((g - 1) ** 2) * np.log(g)
    slope = (8 * (b(gap + h) - b(gap - h)) - (b(gap + 2 * h) - b(gap - 2 * h))) / (12 * h)
    worst = lambda formula: max(np.abs(formula / (2 * slope) - 1).max(),
                                np.abs(formula / common.column(rows, "lambda23_r1") - 1).max())
    return worst(common.column(rows, "eq6_printed")), worst(common.column(rows, "eq6_corrected"))


def point_point_gap(rng, sign):
    """|g / (d/dhat)^2 - 1| with the ideal point at x_1 + sign (dhat - d) n, n along x_2 - x_1."""
    x1, d = rng.normal(size=3), 0.8 * DHAT
    n = unit(rng.normal(size=3))
    x2 = x1 + d * n
    ideal = n @ (x2 - (x1 + sign * (DHAT - d) * n))
    return abs((d / ideal) ** 2 / (d / DHAT) ** 2 - 1)


def edge_normal_length(rng, corrected):
    """| |n_e| - 1 |."""
    x1, x2, x3 = rng.normal(size=(3, 3))
    n_t = unit(np.cross(x2 - x1, x3 - x1))
    length = np.linalg.norm(np.cross(x2 - x3 if corrected else x1 - x2, n_t))
    return abs(np.linalg.norm(np.cross(x2 - x3, n_t)) / length - 1)


def behind_triangle(rng, corrected):
    """|F - (I + (s - 1) n n^T)| for a point behind its triangle, where v . n < 0."""
    x2, x3, x4 = rng.normal(size=(3, 3))
    n, d = unit(np.cross(x3 - x2, x4 - x2)), 0.4 * DHAT
    x1 = (x2 + x3 + x4) / 3 - d * n
    if corrected:
        n = -n
    ideal = x1 + (DHAT - (x1 - x2) @ n) * n
    E = np.stack([x - x1 for x in (x2, x3, x4)], 1)
    F = E @ np.linalg.inv(np.stack([x - ideal for x in (x2, x3, x4)], 1))
    return np.linalg.norm(F - np.eye(3) - (d / DHAT - 1) * np.outer(n, n))


def norm_of_n(rng, corrected):
    """|d / |x_2 - x_1| - 1| with d = |n| or |v|."""
    v = rng.normal(size=3)
    return abs((np.linalg.norm(v) if corrected else np.linalg.norm(unit(v))) / np.linalg.norm(v) - 1)


def mollifier_entry(rng, corrected):
    """|gamma / |u x v|^2 - 1| with gamma = |J n_gamma|^2, c = |u x v| in J."""
    c = np.linalg.norm(np.cross(*rng.normal(size=(2, 3))))
    J = np.diag([1.0, c if corrected else np.sqrt(c), 0.5])
    return abs((J[:, 1] @ J[:, 1]) / c**2 - 1)


def friction_block(rng, corrected):
    """Eq. (19) against differences of its force: the block of a pair's first point, whose weight is
    w_1, with T as in the text (3 x 2) or as Eq. (19) needs it (rows w_i T)."""
    weights = rng.uniform(0.2, 0.8, size=2)
    w = np.array([1 - weights[0], weights[0], -(1 - weights[1]), -weights[1]])
    n = unit(rng.normal(size=3))
    t = unit(np.cross(n, rng.normal(size=3)))
    T = np.stack([t, np.cross(n, t)], 1)
    full = np.kron(w[:, None], T)
    eps, x = 1e-2, 1e-3 * rng.normal(size=12)
    force = lambda y: full @ (full.T @ y) * (2 * eps - np.linalg.norm(full.T @ y)) / eps**2
    u = full.T @ x
    y = np.linalg.norm(u)
    f1, slope = (2 * eps * y - y * y) / eps**2, 2 * (eps - y) / eps**2
    S = (slope * y - f1) / y**3 * np.outer(u, u) + f1 / y * np.eye(2)
    block = differences(force, x, 1e-6)[:3, :3]
    basis = full[:3] if corrected else T
    return np.linalg.norm(basis @ S @ basis.T - block) / np.linalg.norm(block)


def table_header(third):
    """Tolerances of Table 3 should fall tenfold from column to column, as those of Tables 2 and 4."""
    tolerances = np.array([3e-2, 3e-3, third, 3e-5, 3e-6, 3e-7])
    return np.abs(tolerances[:-1] / tolerances[1:] / 10 - 1).max()


def errata(args):
    """(where, error, correction, residual printed, residual corrected) of each."""
    # The printed and the corrected version of one check see the same random input.
    both = lambda f, *versions: tuple(f(np.random.default_rng(args.seed), v) for v in versions or (False, True))
    return [
        ("Eq. (6)", "denominator g^2", "denominator g", *eq6(args)),
        ("1.4", "ideal point x_1 + (dhat - d) n with n along x_2 - x_1", "x_1 - (dhat - d) n",
         *both(point_point_gap, 1, -1)),
        ("1.3", "n_e divided by |(x_1 - x_2) x n_t|: not a unit vector", "by |(x_2 - x_3) x n_t|",
         *both(edge_normal_length)),
        ("1.1, 1.2", "d = v . n is negative on one side; F is a reflection there", "flip n when v . n < 0",
         *both(behind_triangle)),
        ("1.4", "d = v . n = |n|", "d = v . n = |v|", *both(norm_of_n)),
        ("4.1", "J = diag(1, sqrt(c), f) for c = |u x v|", "J = diag(1, c, s)", *both(mollifier_entry)),
        ("Eqs. (16), (19)", "T is 3 x 2 but the Hessian 3s x 3s", "T is 3s x 2, rows w_i T", *both(friction_block)),
        ("Alg. 1, R_id", "thread_id m^2 / m", "(thread_id mod m^2) / m",
         *both(product_error, "printed row", "corrected")),
        ("Alg. 1, thread_id", "one index for all lines", "index in the block for offset, B_id, l_id; else global",
         *both(product_error, "block index", "corrected")),
        ("Table 3", "third tolerance 3e-3 (twice)", "3e-4", table_header(3e-3), table_header(3e-4)),
    ]


def main():
    args = common.formula_options(__doc__, samples=200).parse_args()
    report = common.Report("errata", "Errors of the supplement", args)
    rows = errata(args)
    for where, error, correction, printed, corrected in rows:
        report.claim(f"{where}: the printed version fails, the corrected one passes",
                     printed > 100 * TOLERANCE and corrected < TOLERANCE,
                     f"{error}: {printed:.1e}; {correction}: {corrected:.1e}")
    report.text("Relative residuals; zero means that the statement holds.")
    report.table(("where", "as printed", "corrected", "residual printed", "residual corrected"), rows)
    report.text("Not correctable from the text: the first block of Table 5 lists four materials and three rows of data.")
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
