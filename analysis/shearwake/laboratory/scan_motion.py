# SPDX-License-Identifier: BSD-3-Clause
"""From the velocities of a scan to displacements at the frames of a case, and from its points to a grid.

Times are relative to the start of the load. The line of sight and the trigger delay are those of the job if it has
[vibrometer], otherwise those of the file.
"""
from collections.abc import Iterator

import numpy as np

from .scan import BadScan, Scan

NEAR = 1e-6  # a point closer to a node of the grid than this fraction of the spacing is at the node
LEAST_PERIODS = 3  # of the high-pass in a recording
EDGE = 0.05  # in distances between neighbouring points: nodes this close to the scanned area are treated as on its edge
MASK_RADII = 1.5  # in distances between neighbouring points
NODES_AT_ONCE = 2_000_000  # values of an interpolation in memory


def noise_m_s(velocity: np.ndarray) -> np.ndarray:
    """The standard deviation of white noise of each point, from fourth differences, which a signal that is sampled
    ten times per period passes by a few percent. Underestimated after a low-pass filter far below the sampling rate."""
    if velocity.shape[1] < 9:
        return np.zeros(len(velocity))
    differences = np.diff(velocity, 4, axis=1)
    return np.median(np.abs(differences), axis=1) / (0.6745 * np.sqrt(70.0))


def filtered(velocity: np.ndarray, rate_Hz: float, high_pass_Hz: float, repeats: bool) -> np.ndarray:
    """The velocity after a Butterworth filter of second order, forward and backward, which shifts no phase."""
    if high_pass_Hz <= 0.0:
        return velocity
    from scipy import signal

    if high_pass_Hz >= 0.5 * rate_Hz:
        raise BadScan(f"the high-pass at {high_pass_Hz:g} Hz must be below half of the sampling rate, {0.5 * rate_Hz:g} Hz")
    sections = signal.butter(2, high_pass_Hz, "highpass", fs=rate_Hz, output="sos")
    if repeats:
        frequencies = np.fft.rfftfreq(velocity.shape[1], 1.0 / rate_Hz)
        gain = np.abs(signal.sosfreqz(sections, frequencies, fs=rate_Hz)[1]) ** 2
        return np.fft.irfft(np.fft.rfft(velocity, axis=1) * gain, velocity.shape[1], axis=1)
    duration_s = velocity.shape[1] / rate_Hz
    if duration_s < LEAST_PERIODS / high_pass_Hz:
        raise BadScan(f"it lasts {1e3 * duration_s:.6g} ms, less than {LEAST_PERIODS} periods of the high-pass at "
                      f"{high_pass_Hz:g} Hz, which would distort it: use a higher cutoff, or none")
    return signal.sosfiltfilt(sections, velocity, axis=1, padlen=min(velocity.shape[1] - 1, int(3 * rate_Hz / high_pass_Hz)))


def one_period(scan: Scan, period_s: float) -> tuple[np.ndarray, int]:
    """The mean of all complete periods of the velocities, and their number."""
    samples = period_s * scan.rate_Hz
    count = round(samples)
    if count < 2 or abs(samples - count) > 1e-6 * samples:
        raise BadScan(f"the period of the load, {1e3 * period_s:.6g} ms, is not a whole number of samples at "
                      f"{scan.rate_Hz:g} Hz: choose another sampling rate or modulation frequency")
    periods = len(scan.time_s) // count
    if periods == 0:
        raise BadScan(f"it lasts {1e3 * (scan.time_s[-1] - scan.time_s[0]):.6g} ms, less than one period of the load, "
                      f"{1e3 * period_s:.6g} ms")
    return scan.velocity_m_s[:, :periods * count].reshape(len(scan.x_m), periods, count).mean(axis=1), periods


def displacement_m(velocity: np.ndarray, start_s: float, rate_Hz: float, frames_s: np.ndarray, repeats: bool) -> np.ndarray:
    """Displacement at the frames, (point, frame). Transient: at rest until the first sample, the integral of a
    spline of degree 5. Periodic: the Fourier series of one period without its mean, which a velocity does not contain."""
    if repeats:
        count = velocity.shape[1]
        spectrum = np.fft.rfft(velocity, axis=1) / count
        omega = 2.0 * np.pi * np.fft.rfftfreq(count, 1.0 / rate_Hz)
        spectrum[:, 1:] *= 2.0 / (1j * omega[1:])
        spectrum[:, 0] = 0.0
        if count % 2 == 0:
            spectrum[:, -1] = 0.0
        return np.real(spectrum @ np.exp(1j * np.outer(omega, frames_s - start_s)))
    from scipy.interpolate import make_interp_spline

    times = start_s + np.arange(velocity.shape[1]) / rate_Hz
    if frames_s[-1] > times[-1] + 0.5 / rate_Hz:
        raise BadScan(f"it ends {1e3 * times[-1]:.6g} ms after the start of the load, before the last frame of the job at "
                      f"{1e3 * frames_s[-1]:.6g} ms: reduce time.duration_ms or record longer")
    integral = make_interp_spline(times, velocity, k=min(5, len(times) - 1), axis=1).antiderivative()
    moving = integral(np.clip(frames_s, times[0], None))
    return moving - integral(np.array([max(times[0], min(0.0, times[-1]))]))


def is_line(x: np.ndarray, y: np.ndarray) -> bool:
    points = np.stack((x - np.mean(x), y - np.mean(y)), axis=1)
    sizes = np.linalg.svd(points, compute_uv=False)
    return len(sizes) < 2 or sizes[1] <= 1e-6 * max(sizes[0], 1e-12)


class Surface:
    """Interpolates from points to the nodes of a grid; outside of the scanned area the surface is at rest."""

    def __init__(self, x: np.ndarray, y: np.ndarray, grid_x: np.ndarray, grid_y: np.ndarray) -> None:
        from scipy.spatial import Delaunay, cKDTree

        if len(x) < 4 or is_line(x, y):
            raise BadScan("its points with a signal lie on one line, from which no surface can be reconstructed; shearwake fit "
                          "evaluates line scans")
        self.shape = (len(grid_x), len(grid_y))
        spacing = float(grid_x[1] - grid_x[0])
        self.nodes = np.stack(np.meshgrid(grid_x, grid_y, indexing="ij"), axis=-1).reshape(-1, 2)
        points = np.stack((x, y), axis=1)
        tree = cKDTree(points)
        distance, nearest = tree.query(self.nodes)
        self.exact = np.flatnonzero(distance < NEAR * spacing)
        self.source = nearest[self.exact]
        self.hull = Delaunay(points)
        self.point_spacing = float(np.median(tree.query(points, k=2)[0][:, 1]))
        inside = self.hull.find_simplex(self.nodes, tol=1e-9) >= 0
        inside[self.exact] = True
        self.places = self.nodes.copy()  # where the interpolation is evaluated
        for n in np.flatnonzero(~inside & (distance < 2.0 * self.point_spacing)):
            place = self.on_edge(self.nodes[n])
            if np.hypot(*(place - self.nodes[n])) <= EDGE * self.point_spacing:
                self.places[n], inside[n] = place, True
        self.covered = inside
        self.between = np.flatnonzero(inside & (distance >= NEAR * spacing))

    def on_edge(self, node: np.ndarray) -> np.ndarray:
        """The place of the scanned area that is closest to a node outside of it."""
        first, second = (self.hull.points[self.hull.convex_hull[:, end]] for end in (0, 1))
        along = second - first
        share = np.clip(np.sum((node - first) * along, axis=1) / np.sum(along ** 2, axis=1), 0.0, 1.0)
        found = first + share[:, None] * along
        return found[np.argmin(np.sum((found - node) ** 2, axis=1))]

    def without(self, places: np.ndarray, radius: float) -> None:
        """Excludes the nodes within `radius` of these places: gaps that are masked."""
        if not len(places):
            return
        from scipy.spatial import cKDTree

        far = cKDTree(places).query(self.nodes)[0] > radius
        self.covered &= far
        exact = far[self.exact]
        self.exact, self.source = self.exact[exact], self.source[exact]
        self.between = self.between[far[self.between]]

    def frames(self, u: np.ndarray) -> Iterator[np.ndarray]:
        """Displacements (point, frame) on the grid, (frame, x, y), in parts that fit into memory."""
        from scipy.interpolate import CloughTocher2DInterpolator

        step = max(1, NODES_AT_ONCE // max(1, len(self.nodes)))
        for first in range(0, u.shape[1], step):
            part = u[:, first:first + step]
            values = np.zeros((len(self.nodes), part.shape[1]))
            if len(self.between):
                cubic = CloughTocher2DInterpolator(self.hull, part)
                values[self.between] = cubic(self.places[self.between])
            values[self.exact] = part[self.source]
            yield values.T.reshape(-1, *self.shape)
