#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Errors in the supplement's text: each printed version failing by numbers, each corrected one passing.
Algorithm 1 and Eqs. (24)-(25) are C++ tests (PrintedAlgorithm1.*, TwoSprings.*, docs/paper/section6.md)."""
import sys

import numpy as np

import common

DHAT = 1e-3


def unit(v):
    return v / np.linalg.norm(v)


def eigenvalue_6(g, power):
    return -2 * (g - 1) * (g + 2 * g * np.log(g) - 1) / g**power


def eq6(random):
    """lambda_2,3 = (2 / g) times g b'(g), b' by differences of b = -(g - 1)^2 ln g."""
    g = random.uniform(0.05, 0.9, 200)
    h = 1e-5
    b = lambda x: -((x - 1) ** 2) * np.log(x)
    slope = 2 * (b(g + h) - b(g - h)) / (2 * h)
    residual = lambda power: np.abs(eigenvalue_6(g, power) / slope - 1).max()
    return residual(2), residual(1)


def point_point(random):
    """Length of the ideal segment; it must be dhat."""
    printed, right = [], []
    for _ in range(200):
        x1 = random.normal(size=3)
        d = DHAT * random.uniform(0.05, 0.95)
        x2 = x1 + d * unit(random.normal(size=3))
        n = unit(x2 - x1)
        printed.append((x2 - (x1 + (DHAT - d) * n)) @ n)
        right.append((x2 - (x1 - (DHAT - d) * n)) @ n)
    return tuple(np.abs(np.array(lengths) / DHAT - 1).max() for lengths in (printed, right))


def edge_normal(random):
    """| |n_e| - 1 | with the printed and the corrected normaliser."""
    printed, right = [], []
    for _ in range(200):
        x1, x2, x3 = random.normal(size=(3, 3))
        n_t = unit(np.cross(x2 - x1, x3 - x1))
        along = np.cross(x2 - x3, n_t)
        printed.append(np.linalg.norm(along / np.linalg.norm(np.cross(x1 - x2, n_t))))
        right.append(np.linalg.norm(along / np.linalg.norm(np.cross(x2 - x3, n_t))))
    return tuple(np.abs(np.array(lengths) - 1).max() for lengths in (printed, right))


def signed_distance(random):
    """v . n against the distance of the point to the plane: printed as it is, corrected by flipping n."""
    printed, right = [], []
    for _ in range(200):
        x = random.normal(size=(4, 3))
        n = unit(np.cross(x[2] - x[1], x[3] - x[1]))
        v = x[0] - x[1]
        true = abs(v @ n)
        printed.append(abs(v @ n - true) / true)
        right.append(abs(v @ (n if v @ n > 0 else -n) - true) / true)
    return max(printed), max(right)


def point_point_distance(random):
    """d = v . n = |n| as printed (n is a unit vector), = |v| corrected."""
    v = random.normal(size=(200, 3))
    d = np.array([w @ unit(w) for w in v])
    return np.abs(1.0 - d).max(), np.abs(np.linalg.norm(v, axis=1) / d - 1).max()


def mollified_stretch(random):
    """J = diag(1, sqrt(c), f): the mollifier's argument is |u x v|^2 = J_22^2 times a constant. With c = |u x v| as in
    the rest of section 4 the printed J_22 = sqrt(c) has the wrong power; with c = |u x v|^2 it is right."""
    u, v = random.normal(size=(2, 200, 3))
    gamma = np.sum(np.cross(u, v) ** 2, axis=1)
    power = lambda stretch: np.polyfit(np.log(gamma), np.log(stretch**2), 1)[0]
    return abs(power(np.sqrt(np.sqrt(gamma))) - 1), abs(power(np.sqrt(gamma)) - 1)


ERRATA = (("Eq. (6): denominator g^2", "g", eq6),
          ("1.4: ideal point x1 + (dhat - d) n", "x1 - (dhat - d) n, as n points from x1 to x2", point_point),
          ("1.3: n_e divided by |(x1 - x2) x n_t|", "by |(x2 - x3) x n_t|", edge_normal),
          ("1.1, 1.2: d = v . n", "n flipped where that is negative", signed_distance),
          ("1.4: d = v . n = |n|", "= |v|", point_point_distance),
          ("4.1: J_22 = sqrt(c) with c = |u x v|", "c there is |u x v|^2", mollified_stretch))


def main():
    args = common.options(__doc__, seed=1).parse_args()
    report = common.Report("errata", "Errata of the supplement", args)
    table = []
    for printed, corrected, test in ERRATA:
        wrong, right = test(np.random.default_rng(args.seed))
        report.claim(f"as printed: {printed}", wrong < 1e-6, f"residual {wrong:.1e}", expected=False)
        report.claim(f"corrected: {corrected}", right < 1e-6, f"residual {right:.1e}")
        table.append((printed, wrong, corrected, right))
    report.table(("printed", "residual", "corrected", "residual"), table)
    report.text("Without numbers: T is 3x2 in the text of section 5 but 3s x 2 in Eq. (19); the third column of Table 3 should "
                "read 3e-4; the first block of Table 5 lists four materials and three rows.")
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
