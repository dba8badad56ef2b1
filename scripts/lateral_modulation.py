# SPDX-License-Identifier: BSD-3-Clause
"""The level of LM on a circle minus that of AM with all three components of the acceleration, for one layer on a rigid base.

Engine layered computes the tangential motion for scans alone, so this is an implementation of its own: the closed forms of the
layer and of a focus on a circle (docs/explanation/engine-layered.md). Its normal levels are compared with those of the engine.
"""
from __future__ import annotations

import math

import numpy as np

DENSITY_kg_m3, C_P_m_s = 1000.0, 1500.0  # of the preset palm
FWHM_m, RADIUS_m = 10.2e-3, 3e-3  # of jobs/studies/takahashi-lm.toml
# Wavenumbers: the spectrum of the focus is below 1e-4 at the end, and waves decay within 30 m, the period of this spacing.
STEP_1_m = 0.2
K_1_m = STEP_1_m * np.arange(1, 5001)
RADII_m = 2e-3 * np.sqrt(np.unique([i * i + j * j for i in range(8) for j in range(8)]))  # of the points of the grid of the job
HARMONICS, HIGHEST_Hz = 10, 500.0  # the eleventh has 1e-6 of the pressure
# The threshold of src/measures/sensation.hpp: centres of third octaves (Hz) and rms accelerations (m/s^2)
THRESHOLD = np.array([(8, .095), (10, .1), (12.5, .095), (16, .108), (20, .15), (25, .16), (31.5, .109), (40, .065), (50, .072), (63, .049),
                      (80, .028), (100, .023), (125, .022), (160, .021), (200, .029), (250, .032), (315, .061),
                      (500, .061 * (.061 / .021) ** (2 / 3))])
LARGEST_DIFFERENCE_dB = 0.01  # to the engine: the tolerance of its transfer function is 1e-6, and this integral has 1e-4


def respond(k: np.ndarray, omega: float, c_s_m_s: float, viscosity_Pa_s: float, thickness_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertical and radial displacement W and U of the surface per unit of pressure, for wavenumbers k > 0."""
    mu = DENSITY_kg_m3 * c_s_m_s**2 + 1j * omega * viscosity_Pa_s
    modulus = DENSITY_kg_m3 * C_P_m_s**2 + 2j * omega * viscosity_Pa_s  # lambda + 2 mu
    alpha, beta = (np.sqrt(k**2 - DENSITY_kg_m3 * omega**2 / m + 0j) for m in (modulus, mu))
    p, s = np.exp(-alpha * thickness_m), np.exp(-beta * thickness_m)
    one = np.ones_like(alpha)
    # Columns: the four exponentials. U and W at the surface and at the base, and their derivatives at the surface.
    surface, base = (one, p, one, s), (p, one, s, one)
    def radial(e: tuple[np.ndarray, ...]) -> np.ndarray:
        return np.stack([k * e[0], k * e[1], beta * e[2], -beta * e[3]], axis=-1)
    def vertical(e: tuple[np.ndarray, ...]) -> np.ndarray:
        return np.stack([-alpha * e[0], alpha * e[1], -k * e[2], -k * e[3]], axis=-1)
    slope = np.stack([-alpha, alpha, -beta, beta], axis=-1)  # d/dz of each exponential
    K = k[:, None]
    u, w = radial(surface), vertical(surface)
    normal = modulus * slope * w - (modulus - 2 * mu) * K * u
    shear = mu * (slope * u + K * w)
    matrix = np.stack([normal, shear, radial(base), vertical(base)], axis=-2)
    right = np.zeros((len(k), 4, 1), dtype=complex)
    right[:, 0] = -1.0
    factors = np.linalg.solve(matrix, right)[..., 0]
    return (w * factors).sum(axis=-1), (u * factors).sum(axis=-1)


def level_dB(powers: dict[float, np.ndarray]) -> float:
    """Largest level over places and third octaves; powers are mean squares of the acceleration at each frequency."""
    bands: dict[int, np.ndarray] = {}
    for f, power in powers.items():
        threshold = math.exp(np.interp(math.log(f), np.log(THRESHOLD[:, 0]), np.log(THRESHOLD[:, 1])))
        band = round(10 * math.log10(f))
        bands[band] = bands.get(band, 0.0) + power / threshold**2
    return 10 * math.log10(max(float(band.max()) for band in bands.values()))


def bessel(x: np.ndarray) -> list[np.ndarray]:
    """J_m(x), m = 0 ... HARMONICS + 1, by the trapezoidal rule, which is exact to rounding for |x| + m below the number of points."""
    turns = 2 * math.pi * np.arange(96) / 96
    waves = [np.exp(-1j * x * math.sin(turn)) for turn in turns]
    return [(sum(np.exp(1j * m * turn) * wave for turn, wave in zip(turns, waves)) / len(turns)).real for m in range(HARMONICS + 2)]


AT_FOCUS, AT_PLACE = bessel(RADIUS_m * K_1_m), bessel(RADII_m[:, None] * K_1_m)
SPECTRUM_m2 = math.pi * FWHM_m**2 / (4 * math.log(2)) * np.exp(-(FWHM_m * K_1_m) ** 2 / (16 * math.log(2)))  # of a peak of 1
WEIGHTS = STEP_1_m * K_1_m * SPECTRUM_m2 / (2 * math.pi)


def levels(kind: str, f_Hz: float, skin: list[float], cache: dict[float, tuple[np.ndarray, np.ndarray]]) -> tuple[float, float]:
    """Levels of the normal acceleration and of all three components, for AM or for STM on a circle."""
    c_s_m_s, viscosity_Pa_s, thickness_mm, peak_Pa = skin
    normal, every = {}, {}
    for n in range(1, HARMONICS + 1 if kind == "STM" else 2):
        f, m = n * f_Hz, n if kind == "STM" else 0  # m: waves around the circle
        if f > HIGHEST_Hz:
            break
        if f not in cache:
            cache[f] = respond(K_1_m, 2 * math.pi * f, c_s_m_s, viscosity_Pa_s, 1e-3 * thickness_mm)
        strength = peak_Pa * WEIGHTS * (AT_FOCUS[m] if kind == "STM" else 0.25)  # (1 + sin) / 2 has the amplitude 1/4 at +f
        w, u = (part * strength for part in cache[f])
        lower = AT_PLACE[m - 1] if m else -AT_PLACE[1]
        vertical = AT_PLACE[m] @ w
        radial = 0.5 * (lower - AT_PLACE[m + 1]) @ u  # the gradient of J_m(k r) exp(i m theta) / k
        around = 0.5 * (lower + AT_PLACE[m + 1]) @ u  # m J_m(x) / x = (J_{m-1} + J_{m+1}) / 2
        scale = 2 * (2 * math.pi * f) ** 4  # mean square of the acceleration
        normal[f] = scale * np.abs(vertical) ** 2
        every[f] = normal[f] + scale * (np.abs(radial) ** 2 + np.abs(around) ** 2)
    return level_dB(normal), level_dB(every)


def compare(skin: list[float], engine_dB: dict[str, dict[float, float]]) -> np.ndarray:
    """LM minus AM with all components. `engine_dB`: the normal levels of AM and STM that the engine computed, by frequency."""
    cache: dict[float, tuple[np.ndarray, np.ndarray]] = {}
    every: dict[str, list[float]] = {}
    for kind, expected in engine_dB.items():
        for f_Hz, expected_dB in expected.items():
            normal_dB, every_dB = levels(kind, f_Hz, skin, cache)
            if abs(normal_dB - expected_dB) > LARGEST_DIFFERENCE_dB:
                raise SystemExit(f"{kind} at {f_Hz:g} Hz on {skin}: {normal_dB:.2f} dB, but engine layered computed {expected_dB:.2f} dB")
            every.setdefault(kind, []).append(every_dB)
    return np.array(every["STM"]) - np.array(every["AM"])
