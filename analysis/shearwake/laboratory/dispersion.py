# SPDX-License-Identifier: BSD-3-Clause
"""Phase speed and attenuation of a surface wave from a line scan.

The two-dimensional Fourier transform of v(s, t) has a ridge at k = 2 pi f / c(f). Of a line through the source, the part on one
side of it contains waves of one direction. sqrt(s) compensates the decay of circular waves with the distance s.
"""
import numpy as np

LEAST_POINTS = 12
NEAR_FIELD = 0.15  # fraction of the side next to the source that is left out
SPEEDS_M_S = (0.3, 60.0)
LEAST_RATIO = 3.0  # of the spectrum of a point to that of the noise
LEAST_SHARE = 0.02  # of the strongest line of the spectrum: weaker frequencies have no result


def line_coordinates(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Positions along the line through the points [m]; its first axis points to positive x, or to positive y."""
    points = np.stack((x, y), axis=1)
    centre = points.mean(axis=0)
    axis = np.linalg.svd(points - centre, full_matrices=False)[2][0]
    axis = axis * np.sign(axis[np.argmax(np.abs(axis))])
    return points @ axis


def side(s: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the source and velocities of the longer side, in ascending order, without the near field."""
    chosen = s > 0.0 if np.count_nonzero(s < 0.0) <= np.count_nonzero(s > 0.0) else s < 0.0
    order = np.argsort(np.abs(s[chosen]))
    distance, rows = np.abs(s[chosen])[order], velocity[chosen][order]
    is_far = distance >= NEAR_FIELD * (distance[-1] if len(distance) else 0.0)
    return distance[is_far], rows[is_far]


def peak_wavenumber(distance: np.ndarray, row: np.ndarray, frequency_Hz: float) -> float:
    """The wavenumber of the ridge of one frequency: the maximum of |sum v sqrt(s) e^{iks}|, refined by a parabola."""
    low, high = (2.0 * np.pi * frequency_Hz / c for c in reversed(SPEEDS_M_S))
    spacing, length = np.median(np.diff(distance)), distance[-1] - distance[0]
    low, high = max(low, 2.0 * np.pi / length), min(high, np.pi / spacing)  # waves that the line resolves
    if high <= low:
        return np.nan
    k = np.arange(low, high, 0.05 * 2.0 * np.pi / length)
    if len(k) < 5:
        return np.nan
    window = np.hanning(len(distance) + 2)[1:-1] * np.sqrt(distance)
    strength = np.abs(np.exp(1j * np.outer(k, distance)) @ (window * row))
    n = int(np.argmax(strength))
    if n in (0, len(k) - 1):
        return np.nan
    before, at, after = np.log(strength[n - 1:n + 2])
    return k[n] + 0.5 * (before - after) / (before - 2.0 * at + after) * (k[1] - k[0])


def attenuation_1_m(distance: np.ndarray, row: np.ndarray) -> float:
    """The decay of log |v sqrt(s)| per metre, by a line through all points."""
    amplitude = np.abs(row) * np.sqrt(distance)
    good = amplitude > 0.0
    if np.count_nonzero(good) < 3:
        return np.nan
    return -np.polyfit(distance[good], np.log(amplitude[good]), 1)[0]


def curves(s: np.ndarray, velocity: np.ndarray, rate_Hz: float, noise_m_s: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies [Hz], phase speeds [m/s] and attenuations [1/m] from positions along a line through the source, which is at 0; NaN
    where the line contains no wave of this frequency, or none that exceeds white noise of this standard deviation per sample."""
    distance, rows = side(s, velocity)
    if len(distance) < LEAST_POINTS:
        raise ValueError(f"a dispersion curve requires at least {LEAST_POINTS} points on one side of the source, "
                         f"but there are {len(distance)}")
    spectrum = np.fft.rfft(rows, axis=1)
    frequencies = np.fft.rfftfreq(rows.shape[1], 1.0 / rate_Hz)
    power = np.sqrt(np.mean(np.abs(spectrum) ** 2, axis=0))
    least = max(LEAST_SHARE * power.max(), LEAST_RATIO * noise_m_s * np.sqrt(rows.shape[1]))
    speeds, decays = np.full(len(frequencies), np.nan), np.full(len(frequencies), np.nan)
    for n, f in enumerate(frequencies):
        if f <= 0.0 or power[n] < least:
            continue
        k = peak_wavenumber(distance, spectrum[:, n], f)
        if np.isfinite(k):
            speeds[n], decays[n] = 2.0 * np.pi * f / k, attenuation_1_m(distance, spectrum[:, n])
    return frequencies, speeds, decays
