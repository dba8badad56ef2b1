# SPDX-License-Identifier: BSD-3-Clause
"""Differences of the surfaces and traces of two cases."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...case import Case
from .. import load

SAME_s = 1e-9  # times closer than this are equal; frames are at least 0.01 us apart
SAME_m = 1e-9  # and positions
POINTS = 8  # of the interpolation
TIE = 1e-9  # of the largest difference: closer values are equal, for example on both sides of a symmetry axis


def interpolation(at: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """The matrix that interpolates values at equidistant nodes to the points `at`, by polynomials through the
    nearest nodes. Its rows are unit vectors where a point coincides with a node."""
    spacing = nodes[1] - nodes[0]
    count = min(POINTS, len(nodes))
    place = (at - nodes[0]) / spacing
    nearest = np.round(place).astype(int)
    place = np.where(np.abs(place - nearest) * abs(spacing) < SAME_m, nearest, place)
    start = np.clip(np.floor(place).astype(int) - (count // 2 - 1), 0, len(nodes) - count)
    matrix = np.zeros((len(at), len(nodes)))
    for j in range(count):
        weight = np.ones(len(at))
        for k in range(count):
            if k != j:
                weight *= (place - (start + k)) / (j - k)
        matrix[np.arange(len(at)), start + j] = weight
    return matrix


def common_axis(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The points of the coarser axis that lie within both."""
    coarse, fine = (first, second) if first[1] - first[0] >= second[1] - second[0] else (second, first)
    low, high = max(first[0], second[0]) - SAME_m, min(first[-1], second[-1]) + SAME_m
    chosen = coarse[(coarse >= low) & (coarse <= high)]
    return np.clip(chosen, fine[0], fine[-1])


def common_times(first: np.ndarray, second: np.ndarray) -> list[tuple[int, int]]:
    """Pairs of indices of equal times."""
    return [(i, int(j)) for i, t in enumerate(first)
            for j in np.flatnonzero(np.abs(second - t) < SAME_s)[:1]] if len(second) else []


def on_common_grid(a: tuple[float, np.ndarray, np.ndarray, np.ndarray],
                   b: tuple[float, np.ndarray, np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Two surfaces (t_s, x_m, y_m, u_z_m) as x_m, y_m, u_a, u_b on the common grid."""
    x, y = (common_axis(*axes) for axes in ((a[1], b[1]), (a[2], b[2])))
    u_a, u_b = (interpolation(x, f[1]) @ f[3] @ interpolation(y, f[2]).T for f in (a, b))
    return x, y, u_a, u_b


def relative_l2(a: np.ndarray, b: np.ndarray) -> float:
    norm = math.sqrt(float(np.sum(b * b)))
    return math.sqrt(float(np.sum((a - b) ** 2))) / norm if norm else math.nan


def place_of_largest(difference: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[int, int]:
    """The indices of the largest difference. Of places with equal differences, the one with the largest y and then the
    largest x."""
    i, j = np.nonzero(difference >= (1.0 - TIE) * difference.max())
    n = np.lexsort((x[i], y[j]))[-1]
    return int(i[n]), int(j[n])


def compare_surfaces(first: Case, second: Case) -> list[dict[str, Any]]:
    """One entry for each common time: relative L2 of the difference, and its maximum with its location."""
    found = []
    for i, j in common_times(load.surface_times(first), load.surface_times(second)):
        a, b = first.snapshot(i), second.snapshot(j)
        x, y, u_a, u_b = on_common_grid(a, b)
        difference = np.nan_to_num(np.abs(u_a - u_b), nan=np.inf, posinf=np.inf)
        at = place_of_largest(difference, x, y)
        found.append({"time_ms": round(1e3 * a[0], 9), "points": [len(x), len(y)],
                      "relative_l2": relative_l2(u_a, u_b), "largest_um": 1e6 * float(difference.max()),
                      "peak_um": 1e6 * float(np.abs(u_b).max()),
                      "largest_relative": float(difference.max() / np.abs(u_b).max()) if u_b.any() else math.nan,
                      "at_mm": [1e3 * float(x[at[0]]), 1e3 * float(y[at[1]])]})
    return found


def compare_traces(first: Case, second: Case) -> list[dict[str, Any]]:
    """One entry for each trace point that both recorded, over the times that both have."""
    pairs = common_times(first.over_time["time"], second.over_time["time"])
    if not pairs:
        return []
    ours, theirs = (np.array(list(side)) for side in zip(*pairs))
    found = []
    one, two = load.traces(first), load.traces(second)
    for at, u in zip(one.points_m, one.u_z_m):
        for other, v in zip(two.points_m, two.u_z_m):
            if math.dist(at, other) > SAME_m:
                continue
            a, b = u[ours], v[theirs]
            n = int(np.argmax(np.abs(a - b)))
            found.append({"at_mm": [1e3 * at[0], 1e3 * at[1]], "times": len(pairs),
                          "relative_l2": relative_l2(a, b), "largest_um": 1e6 * float(abs(a - b)[n]),
                          "peak_um": 1e6 * float(np.abs(b).max()),
                          "time_ms": 1e3 * float(first.over_time["time"][ours[n]])})
    return found
