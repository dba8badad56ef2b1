# SPDX-License-Identifier: BSD-3-Clause
"""Phase speeds of guided P-SV waves of elastic layers on a rigid base, from the secular equation.

The displacement-stress vector is propagated through the layers by matrix exponentials (Aki and Richards, Quantitative
Seismology, eq. 7.28), independently of the program.
"""
from typing import Sequence

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

Layers = Sequence[tuple[float, ...]]


def secular(k: float, omega: float, layers: Layers) -> float:
    """The determinant of the tractions at the surface over the states without displacement at the base. `layers`: tuples of
    thickness (m), density (kg/m3), c_p and c_s (m/s), from the surface; k in 1/m."""
    states = np.zeros((4, 2))
    states[2, 0] = states[3, 1] = 1.0
    for h, rho, c_p, c_s in reversed(layers):
        mu, lam = rho * c_s ** 2, rho * (c_p ** 2 - 2.0 * c_s ** 2)
        p = lam + 2.0 * mu
        zeta = 4.0 * mu * (lam + mu) / p
        a = np.array([[0.0, k, 1.0 / mu, 0.0], [-k * lam / p, 0.0, 0.0, 1.0 / p],
                      [k * k * zeta - omega ** 2 * rho, 0.0, 0.0, k * lam / p], [0.0, -omega ** 2 * rho, -k, 0.0]])
        states = expm(-a * h) @ states
        states = states / np.abs(states).max(axis=0)
    return np.linalg.det(states[2:])


def secular_speeds(omega: float, layers: Layers, speeds: Sequence[float] | np.ndarray) -> list[float]:
    """All phase speeds, ascending, between neighbours of `speeds` (ascending) at which the determinant changes its sign."""
    values = [secular(omega / c, omega, layers) for c in speeds]
    return [brentq(lambda c: secular(omega / c, omega, layers), a, b)
            for a, b, u, v in zip(speeds, speeds[1:], values, values[1:]) if u * v < 0.0]
