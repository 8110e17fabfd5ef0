#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement 1: the explicit E, Ebar and F of every pair type against the library's closed forms."""
import sys

import common

# Rounding is amplified by up to (edge / d)^2 = 1e6 and, for point-edge pairs, by flat triangles.
CLAIMS = (("error_gap", "the gap |F n|^2 is (d / dhat)^2", 1e-9),
          ("error_stretch", "F only compresses, along the normal: F^T F = I + (s^2 - 1) n n^T", 1e-9),
          ("error_gradient", "the gradient through F is the library's w_i n b_d", 1e-7),
          ("error_hessian", "the kept mode through F is the library's Gauss-Newton Hessian", 1e-7))


def main():
    args = common.formula_options(__doc__, samples=400).parse_args()
    rows = common.formulas(args, "constructions")
    report = common.Report("sec1_constructions", "Section 1: explicit constructions of F", args)
    for quantity, statement, limit in CLAIMS:
        for pair in ("PP", "PE", "PT", "EE"):
            worst = max(row["max"] for row in common.select(rows, quantity=quantity, pair=pair))
            report.claim(f"{pair}: {statement}", worst < limit, f"largest error {worst:.1e}")
    report.text("Random pairs, edges of 2, 10 and more dhat, d / dhat from 0.01 to 0.9; ideal points, H and K as in the "
                "supplement with the corrections of the errata page.")
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
