#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Verifies the upper bounds of `shearwake optimise` with NumPy alone.

Usage: scripts/verify_certificate.py out/JOB.optimise

For each case and strength s, the folder contains symmetric matrices N, D and F, the number S = 1'F1 of the load without
modulation on the path of the job, and a certificate: numbers eta, mu >= 0 and tau, and weights w >= 0. Let
M = F + mu (N - eta D). If the matrix

    K = [ tau    -w'/2       ]
        [ -w/2   diag(w) - M ]

is positive semidefinite and tau < s^2 S, no envelope 0 <= e <= 1 with e'Fe >= s^2 S has e'Ne / e'De >= eta: with z = (1, e),
z'Kz = tau - sum w e (1 - e) - e'Me >= 0, so e'Me <= tau < s^2 S, but e'Me >= e'Fe >= s^2 S. If rounding makes the least
eigenvalue of K negative, by d, tau must be smaller by d z'z <= d (1 + number of knots). The script checks these conditions,
that the certificate proves no bound that is smaller by more than twice the accuracy of the bisection (1e-4), that table.csv
contains this bound, that the found envelope satisfies its constraints, and that its eta is that of the quotient. The proof is
about envelopes that are linear between the knots. Exit code 1 if anything fails. The interpreter needs NumPy (Debian: /usr/bin/python3 with
the package python3-numpy).
"""
import csv
import json
import math
import pathlib
import sys

import numpy as np


ACCURACY = 1e-4  # of the bound, relative


def problems(forms, reference, optimum, row):
    """What is wrong with one optimum, its certificate and its row of the table."""
    N, D, F = (np.array(forms[name]) for name in ("numerator", "denominator", "focal"))
    bound, found = optimum["ceiling"], optimum["found"]
    s, eta, mu, tau, w = optimum["strength_at_least"], *(bound[name] for name in ("eta", "mu", "tau")), np.array(bound["weights"])
    e = np.array(found["values"])
    if any(len(part) != len(w) for part in (e, N, D, F)):
        yield f"its envelope and forms do not have {len(w)} knots"
        return
    if mu < 0 or w.min() < 0:
        yield "a weight is negative"
    def largest(bound):
        """A bound of e'Me for M with this eta."""
        K = np.block([[np.array([[tau]]), -w[None, :] / 2], [-w[:, None] / 2, np.diag(w) - F - mu * (N - bound * D)]])
        return tau + (1 + len(w)) * max(0.0, -np.linalg.eigvalsh(K).min())
    if largest(eta) >= s**2 * reference:
        yield f"the form of an envelope can be {largest(eta):g}, which is not less than {s**2 * reference:g}"
    if largest(eta * (1 - 2 * ACCURACY)) < s**2 * reference:
        yield f"the bound is {eta}, but its certificate proves a smaller one"
    for name, value in (("eta_ceiling_1", eta), ("eta_optimum_1", found["eta"])):
        if row is None or not math.isclose(float(row[name]), value, rel_tol=1e-8):  # the table has nine digits
            yield f"table.csv has {row[name] if row else 'no'} {name}, but the certificate {value}"
    if e.min() < 0 or e.max() > 1 or e @ F @ e < s**2 * reference * (1 - 1e-12):
        yield "the envelope does not satisfy its constraints"
    if abs(e @ N @ e / (e @ D @ e) - found["eta"]) > 1e-12:
        yield "the envelope has another eta"
    if found["eta"] > eta:
        yield f"the optimum, {found['eta']}, exceeds the bound"


def main(folder):
    failed = checked = 0
    table = pathlib.Path(folder) / "optimise" / "table.csv"
    rows = list(csv.DictReader(table.open(encoding="utf-8", newline=""))) if table.exists() else []
    for path in sorted(table.parent.glob("*.strength-*.json")):
        optimum = json.loads(path.read_text(encoding="utf-8"))
        forms, base = (json.loads((path.parent / f"{optimum[of]}.forms.json").read_text(encoding="utf-8"))
                       for of in ("forms", "case"))
        row = next((row for row in rows if row["case"] == optimum["case"]
                    and math.isclose(float(row["strength_at_least_1"]), optimum["strength_at_least"], rel_tol=1e-8)), None)
        found = list(problems(forms, np.array(base["focal"]).sum(), optimum, row))
        print(f"{path.stem}: eta {optimum['found']['eta']:.4f}, upper bound {optimum['ceiling']['eta']:.4f}: "
              f"{'; '.join(found) or 'verified'}")
        checked += 1
        failed += bool(found)
    if checked == 0:
        print(f"{folder} contains no results of shearwake optimise", file=sys.stderr)
    return 1 if failed or not checked else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
