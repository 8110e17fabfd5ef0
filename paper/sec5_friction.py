#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement 5, Eqs. (16)-(20): the 2x2 block of friction is never indefinite, so projecting it does nothing."""
import sys

import common


def main():
    args = common.formula_options(__doc__, samples=400).parse_args()
    rows = common.formulas(args, "friction")
    report = common.Report("sec5_friction", "Section 5: the friction Hessian", args)
    lowest = min(common.column(rows, "printed_min"))
    report.claim("both eigenvalues of Eq. (20) are non-negative", lowest > -1e-12,
                 f"smallest {lowest:.1e} of mu lambda / eps, u / eps from {rows[0]['u_over_eps']:.1e} to "
                 f"{rows[-1]['u_over_eps']:.1e}")
    change = max(common.column(rows, "projection"))
    report.claim("so the projection is a no-op", change < 1e-12, f"changes the block by {change:.1e} at most")
    apart = max(common.column(rows, "difference"))
    report.claim("the library's modes are Eq. (20)", apart < 1e-12, f"largest relative difference {apart:.1e}")
    figure, axis = common.axes()
    x = common.column(rows, "u_over_eps")
    axis[0][0].semilogx(x, common.column(rows, "printed_max"), label="across the slip")
    axis[0][0].semilogx(x, common.column(rows, "printed_min"), label="along the slip")
    axis[0][0].set(xlabel=r"$|u| / \epsilon$", ylabel=r"eigenvalue, in $\mu\lambda/\epsilon$")
    axis[0][0].legend()
    report.plot(figure, "friction", "Eigenvalues of the friction block: zero along the slip once it slides.")
    return report.write()


if __name__ == "__main__":
    sys.exit(main())
