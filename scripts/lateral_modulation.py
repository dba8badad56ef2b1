# SPDX-License-Identifier: BSD-3-Clause
"""The level of LM on a circle minus that of AM with all three components of the acceleration, for one layer on a rigid base.

Engine layered computes the tangential motion for scans alone, so this is an implementation of its own: the closed form of the
layer (docs/explanation/engine-layered.md) on a periodic plane. Its normal levels are compared with those of the engine.
"""
from __future__ import annotations

import math

import numpy as np

DENSITY_kg_m3, C_P_m_s = 1000.0, 1500.0  # of the preset palm
FWHM_m, RADIUS_m = 10.2e-3, 3e-3  # of jobs/studies/takahashi-lm.toml
SPACING_m, POINTS, TIMES = 2e-3, 128, 64
HIGHEST_Hz = 500.0
# The threshold of src/measures/sensation.hpp: centres of third octaves (Hz) and rms accelerations (m/s^2)
THRESHOLD = np.array([(8, .095), (10, .1), (12.5, .095), (16, .108), (20, .15), (25, .16), (31.5, .109), (40, .065), (50, .072), (63, .049),
                      (80, .028), (100, .023), (125, .022), (160, .021), (200, .029), (250, .032), (315, .061),
                      (500, .061 * (.061 / .021) ** (2 / 3))])
LARGEST_DIFFERENCE_dB = 0.2  # to the engine, which samples an infinite plane and has edges of third octaves at other rounding


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


def levels(kind: str, f_Hz: float, skin: list[float], cache: dict[float, tuple[np.ndarray, np.ndarray]]) -> tuple[float, float]:
    """Levels of the normal acceleration and of all three components."""
    c_s_m_s, viscosity_Pa_s, thickness_mm, peak_Pa = skin
    x = SPACING_m * (np.arange(POINTS) - POINTS // 2)
    phase = 2 * math.pi * np.arange(TIMES) / TIMES
    centre, width = (RADIUS_m if kind == "STM" else 0.0) * np.stack([np.cos(phase), np.sin(phase)]), 4 * math.log(2) / FWHM_m**2
    gain = np.ones(TIMES) if kind == "STM" else 0.5 * (1 + np.sin(phase))
    load = peak_Pa * gain[:, None, None] * np.exp(-width * ((x[:, None] - centre[0, :, None, None]) ** 2 + (x - centre[1, :, None, None]) ** 2))
    spectrum = np.fft.fft2(np.fft.fft(load, axis=0)[1:TIMES // 2] / TIMES)
    kx = 2 * math.pi * np.fft.fftfreq(POINTS, SPACING_m)
    squares = np.rint((kx[:, None] ** 2 + kx**2) / kx[1] ** 2).astype(int)
    unique, place = np.unique(squares, return_inverse=True)
    k = kx[1] * np.sqrt(np.maximum(unique, 1e-6))
    normal, every = {}, {}
    for n, harmonic in enumerate(spectrum, start=1):
        f = n * f_Hz
        if f > HIGHEST_Hz or (kind == "AM" and n > 1):
            break
        if f not in cache:
            cache[f] = respond(k, 2 * math.pi * f, c_s_m_s, viscosity_Pa_s, 1e-3 * thickness_mm)
        w, u = (part[place].reshape(squares.shape) * harmonic for part in cache[f])
        along = np.fft.ifft2(np.stack([w, u * kx[:, None] / k[place].reshape(squares.shape), u * kx / k[place].reshape(squares.shape)]))
        power = 2 * (2 * math.pi * f) ** 4 * np.abs(along) ** 2
        normal[f], every[f] = power[0], power.sum(axis=0)
    return level_dB(normal), level_dB(every)


def compare(skin: list[float], engine_dB: dict[float, float]) -> np.ndarray:
    """LM minus AM with all components, at the frequencies of the normal levels of AM that the engine computed."""
    cache: dict[float, tuple[np.ndarray, np.ndarray]] = {}
    differences = []
    for f_Hz, expected_dB in engine_dB.items():
        normal_dB, every_dB = levels("AM", f_Hz, skin, cache)
        if abs(normal_dB - expected_dB) > LARGEST_DIFFERENCE_dB:
            raise SystemExit(f"AM at {f_Hz:g} Hz on {skin}: {normal_dB:.2f} dB, but engine layered computed {expected_dB:.2f} dB")
        differences.append(levels("STM", f_Hz, skin, cache)[1] - every_dB)
    return np.array(differences)
