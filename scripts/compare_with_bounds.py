#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the modulations of a sweep with the upper bounds of `shearwake optimise` for their paths and strengths.

Usage: scripts/compare_with_bounds.py TABLE.csv OPTIMISED...

TABLE.csv is the table of a sweep of AM-STM and SM-STM with plain STM as the reference. Each folder OPTIMISED contains upper
bounds for the motions of some of its rows, with the same swept keys: for AM-STM those of plain STM, for SM-STM those of
its own motion, on which its envelope is constant and its strength 1. Since the bound decreases with the strength, a row is
compared with the bound of the next larger strength, which is stricter. Exit code 1 if a row has no bound or exceeds it.
"""
import csv
import math
import pathlib
import sys

KIND = "load.modulation.kind"


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def is_same(a, b):
    try:
        return math.isclose(float(a), float(b), rel_tol=1e-9)
    except ValueError:
        return a == b


def keys_of(bound):
    """The swept keys of an optimised case: the columns before the strength."""
    names = list(bound)
    return names[1:names.index("strength_at_least_1")]


def bounds_of(row, bounds):
    """The bounds for the motion of a row."""
    is_sm = row[KIND] == "SM-STM"
    for bound in bounds:
        keys = keys_of(bound)
        if any("sm_frequency" in key for key in keys) == is_sm and all(is_same(row[k], bound[k]) for k in keys if k != KIND):
            yield bound


def main(table, folders):
    bounds = [row for folder in folders for row in rows_of(pathlib.Path(folder) / "optimise" / "table.csv")]
    exceeded, missing, closest, rows = [], [], (0.0, None), rows_of(table)
    for row in rows:
        strength = float(row["focal_rms_over_reference_1"]) if row[KIND] == "AM-STM" else 1.0
        fits = [b for b in bounds_of(row, bounds) if float(b["strength_at_least_1"]) >= strength * (1 - 1e-9)]
        if not fits:
            missing.append(row["id"])
            continue
        bound = float(min(fits, key=lambda b: float(b["strength_at_least_1"]))["eta_ceiling_1"])
        ratio = float(row["eta_period_1"]) / bound
        closest = max(closest, (ratio, row["id"]))
        if ratio > 1:
            exceeded.append(row["id"])
    print(f"{len(rows)} rows: {len(exceeded)} exceed the bound of their path and strength, {len(missing)} have no bound; the largest "
          f"ratio to the bound is {closest[0]:.3f}, of {closest[1]}")
    for name, ids in (("exceeded by", exceeded), ("no bound for", missing)):
        if ids:
            print(f"{name}: {', '.join(ids)}")
    return 1 if exceeded or missing or not rows else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
