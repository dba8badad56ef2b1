#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Verifies the upper bounds of `shearwake optimise` with NumPy alone.

Usage: scripts/verify_certificate.py out/JOB.optimise

For each case and strength s, the folder contains symmetric matrices N, D and F, the number S = 1'F1 of the load without
modulation on the path of the job, a number eta, and weights mu >= 0 and w >= 0. They prove that no envelope |e| <= 1
with e'Fe >= s^2 S has e'Ne / e'De >= eta, if

    diag(w) - F - mu (N - eta D) is positive semidefinite, and sum w < s^2 S:

such an envelope would have e'Fe <= e'Fe + mu e'(N - eta D)e <= sum w e^2 <= sum w < s^2 S. The script checks both
conditions, that the found envelope satisfies its constraints, and that its eta is that of the quotient. Exit code 1 if
anything fails.
"""
import json
import pathlib
import sys

import numpy as np

ROUNDING = 1e-12  # of eigenvalues, relative to the trace of F


def problems(forms, reference, optimum):
    """What is wrong with one optimum and its certificate."""
    N, D, F = (np.array(forms[name]) for name in ("numerator", "denominator", "focal"))
    bound, found = optimum["ceiling"], optimum["found"]
    s, eta, mu, w = optimum["strength_at_least"], bound["eta"], bound["mu"], np.array(bound["weights"])
    e = np.array(found["values"])
    if mu < 0 or w.min() < 0:
        yield "a weight is negative"
    least = np.linalg.eigvalsh(np.diag(w) - F - mu * (N - eta * D)).min()
    if least < -ROUNDING * np.trace(F):
        yield f"the matrix is not positive semidefinite: it has the eigenvalue {least:g}"
    if w.sum() >= s**2 * reference:
        yield f"the sum of the weights, {w.sum():g}, is not less than {s**2 * reference:g}"
    if e.min() < 0 or e.max() > 1 or e @ F @ e < s**2 * reference * (1 - 1e-12):
        yield "the envelope does not satisfy its constraints"
    if abs(e @ N @ e / (e @ D @ e) - found["eta"]) > 1e-12:
        yield "the envelope has another eta"
    if found["eta"] > eta:
        yield f"the optimum, {found['eta']}, exceeds the bound"


def main(folder):
    failed = checked = 0
    for path in sorted((pathlib.Path(folder) / "optimise").glob("*.strength-*.json")):
        optimum = json.loads(path.read_text(encoding="utf-8"))
        forms, base = (json.loads((path.parent / f"{optimum[of]}.forms.json").read_text(encoding="utf-8"))
                       for of in ("forms", "case"))
        trouble = list(problems(forms, np.array(base["focal"]).sum(), optimum))
        print(f"{path.stem}: eta {optimum['found']['eta']:.4f}, no envelope reaches {optimum['ceiling']['eta']:.4f}: "
              f"{'; '.join(trouble) or 'verified'}")
        checked += 1
        failed += bool(trouble)
    if checked == 0:
        print(f"{folder} contains no results of shearwake optimise", file=sys.stderr)
    return 1 if failed or not checked else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
