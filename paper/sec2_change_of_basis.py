#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement 2: the second term of Eq. (4), E d(Ebar^-1)/dx, against the claim that it is negligible."""
import sys

import common

PAIRS = ("PP", "PE", "PT", "EE")


def main():
    args = common.formula_options(__doc__, samples=400).parse_args()
    rows = common.formulas(args, "constructions")
    report = common.Report("sec2_change_of_basis", "Section 2: the change-of-basis tensor", args)
    for pair in PAIRS:
        mine = lambda quantity: common.select(rows, quantity=quantity, pair=pair)
        for quantity, name in (("second_gradient", "gradient"), ("second_kept_mode", "kept mode")):
            worst = max(row["max"] for row in mine(quantity))
            report.claim(f"{pair}: the second term does not enter the {name}", worst < 1e-8,
                         f"at most {worst:.1e} of the first term")
        tensor = max(row["median"] for row in mine("second_tensor"))
        report.claim(f"{pair}: the second term as a tensor is negligible", tensor < 0.05,
                     f"median up to {tensor:.2g} of the first term", expected=pair == "PP")
    report.text("Negligible is not the word: as a tensor the second term is as large as the first one (point-point pairs "
                "apart). It is exactly orthogonal to the compressed direction, because the ideal shape keeps the height "
                "dhat whatever the vertices do; so it drops out of the gradient and of the one mode that is kept, and "
                "would matter for the dropped modes only.")
    for quantity in ("second_tensor", "second_gradient", "second_kept_mode", "second_dropped_modes"):
        report.text(f"**{quantity}**, relative to the first term:")
        report.table(("pair", "edge / dhat", "d / dhat", "q10", "median", "q90", "largest"),
                     [[row[k] for k in ("pair", "edge_over_dhat", "s", "q10", "median", "q90", "max")]
                      for row in common.select(rows, quantity=quantity)])
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
