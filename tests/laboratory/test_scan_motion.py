# SPDX-License-Identifier: BSD-3-Clause
"""From the velocities of a scan to displacements, surfaces and dispersion curves."""
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from shearwake.laboratory import dispersion, measure_scan, scan_motion
from shearwake.laboratory.scan import BadScan, Scan
from shearwake.laboratory.scan_files import write_scan

NODES, SPACING_m, FRAMES, INTERVAL_s = 32, 3e-3, 40, 250e-6
OMEGA = 2.0 * np.pi * 50.0
GRID = SPACING_m * (np.arange(NODES) - NODES // 2)


def shape(x, y):
    return np.exp(-(x ** 2 + y ** 2) / (2.0 * 0.012 ** 2))


def displacement(x, y, t):
    """At rest with its velocity at t = 0."""
    return 1e-6 * (1.0 - np.cos(OMEGA * t)) ** 2 * shape(x, y)


def velocity(x, y, t):
    return 2e-6 * OMEGA * (1.0 - np.cos(OMEGA * t)) * np.sin(OMEGA * t) * shape(x, y)


class Measured(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def frames(self, x, y, change=None, **request):
        """The frames of all repetitions, and their description."""
        times = np.arange(FRAMES + 1) * INTERVAL_s
        values = np.array([velocity(a, b, times) for a, b in zip(x, y)])
        if change:
            change(values)
        write_scan(self.folder / "data.mat", Scan(times, x, y, values), "mat")
        request = {"grid": {"nx": NODES, "ny": NODES, "spacing_m": SPACING_m}, "periodic": False,
                   "frames_s": [(n + 1) * INTERVAL_s for n in range(FRAMES)], "period_s": FRAMES * INTERVAL_s,
                   "high_pass_Hz": 0.0, "gaps": "interpolate", "repetitions": 0, "seed": 1, **request}
        (self.folder / "request.json").write_text(json.dumps(request))
        code = measure_scan.main(self.folder / "data.mat", self.folder / "request.json", self.folder / "scan")
        self.assertEqual(code, 0)
        about = json.loads((self.folder / "scan.json").read_text())
        found = np.fromfile(self.folder / "scan.f64").reshape(about["repetitions"], FRAMES, NODES, NODES)
        return found, about

    def expected(self):
        x, y = np.meshgrid(GRID, GRID, indexing="ij")
        return np.array([displacement(x, y, (n + 1) * INTERVAL_s) for n in range(FRAMES)])

    def error(self, found):
        expected = self.expected()
        return np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected ** 2))

    def lattice(self, spacing_mm):
        one = np.arange(-45.0, 45.1, spacing_mm) * 1e-3
        x, y = np.meshgrid(one, one, indexing="ij")
        return x.ravel(), y.ravel()

    def test_points_at_the_nodes_give_the_displacement(self):
        x, y = np.meshgrid(GRID, GRID, indexing="ij")
        found, about = self.frames(x.ravel(), y.ravel())
        self.assertLess(self.error(found[0]), 1e-6)  # of the spline, fourth order
        self.assertEqual(about["covered_from_m"], [GRID[0], GRID[0]])

    def test_implausible_displacements_are_noted(self):
        for factor, noted in ((1000.0, False), (2000.0, True)):  # 4 and 8 mm, as of velocities in um/s or mm/s that are taken as m/s
            _, about = self.frames(*self.lattice(5.0), change=lambda values: np.multiply(values, factor, out=values))
            self.assertEqual("displacement of 0.008 m is implausible" in "; ".join(about["notes"]), noted, about["notes"])

    def test_coarser_scans_have_larger_errors(self):
        errors = [self.error(self.frames(*self.lattice(mm))[0][0]) for mm in (3.0, 5.0, 9.0)]
        self.assertEqual(errors, sorted(errors))
        self.assertLess(errors[0], 1e-3)
        self.assertLess(errors[2], 0.05)

    def test_a_fitted_offset_loses_no_node_at_the_edge_of_the_scan(self):
        x, y = self.lattice(3.0)
        for shift in (2e-7, 1e-4):  # beyond 5 % of the distance of the points, the edge lies inside of the outermost nodes
            found, about = self.frames(x + shift, y - shift)
            inner = (slice(None), slice(1, None), slice(1, None))  # without the nodes at -48 mm
            worst = np.max(np.abs(found[0] - self.expected())[inner]) / np.max(self.expected())
            self.assertLess(worst, 0.61 * shift / 0.012 + 1e-3)  # the slope of the Gaussian; interpolation
            self.assertTrue(np.all(found[0][-1, 1:, 1:] != 0.0))
            np.testing.assert_allclose(about["covered_from_m"], [x.min(), y.min()], rtol=1e-12)
        _, about = self.frames(x + 3e-4, y)
        np.testing.assert_allclose(about["covered_from_m"], [x.min() + SPACING_m, y.min()], rtol=1e-12)

    def test_gaps_are_interpolated_or_at_rest(self):
        x, y = self.lattice(3.0)
        gone = int(np.argmin(np.hypot(x - 0.006, y)))

        def remove(values):
            values[gone] = np.nan

        middle = (FRAMES // 2, NODES // 2 + 2, NODES // 2)
        true = self.expected()[middle]
        found, about = self.frames(x, y, remove)
        self.assertLess(abs(found[0][middle] - true), 0.02 * true)
        self.assertIn("960 of 961 points", " ".join(about["notes"]))
        self.assertEqual(self.frames(x, y, remove, gaps="mask")[0][0][middle], 0.0)

    def test_repetitions_vary_by_the_noise(self):
        def disturb(values):
            values += 2e-5 * np.random.default_rng(3).normal(size=values.shape)

        found, about = self.frames(*self.lattice(3.0), disturb, repetitions=4)
        self.assertEqual(len(found), 5)
        self.assertAlmostEqual(about["noise_m_s"] / 2e-5, 1.0, delta=0.1)
        spread = found[1:, -1].std(axis=0, ddof=1).mean()
        # A sum of n white velocities: noise dt sqrt(n); interpolation averages some points.
        alone = 2e-5 * INTERVAL_s * np.sqrt(FRAMES)
        self.assertTrue(0.4 * alone < spread < 2.0 * alone, (spread, alone))

    def test_a_line_gives_no_surface(self):
        with self.assertRaisesRegex(BadScan, "lie on one line"):
            scan_motion.Surface(np.linspace(0.0, 0.01, 9), np.linspace(0.0, 0.02, 9), GRID, GRID)


class Displacement(unittest.TestCase):
    def test_a_period_is_integrated_without_its_mean(self):
        times = np.arange(40) / 4000.0
        rows = np.stack((np.cos(2.0 * np.pi * 100.0 * times), np.sin(2.0 * np.pi * 300.0 * times)))
        frames = np.array([0.0011, 0.0042, 0.0100])
        found = scan_motion.displacement_m(rows, 0.0, 4000.0, frames, True)
        expected = np.stack((np.sin(2.0 * np.pi * 100.0 * frames) / (2.0 * np.pi * 100.0),
                             -np.cos(2.0 * np.pi * 300.0 * frames) / (2.0 * np.pi * 300.0)))
        np.testing.assert_allclose(found, expected, atol=1e-15)

    def test_the_high_pass_keeps_fast_motion_and_removes_drift(self):
        times = np.arange(4000) / 4000.0
        rows = (np.sin(2.0 * np.pi * 200.0 * times) + 0.5)[None]
        found = scan_motion.filtered(rows, 4000.0, 20.0, False)[0]
        middle = slice(1500, 2500)
        np.testing.assert_allclose(found[middle], rows[0][middle] - 0.5, atol=5e-3)  # (20 / 200)^4 and the edges
        with self.assertRaisesRegex(BadScan, "below half of the sampling rate"):
            scan_motion.filtered(rows, 4000.0, 2000.0, False)
        with self.assertRaisesRegex(BadScan, "lasts 1000 ms, less than 3 periods of the high-pass at 2 Hz"):
            scan_motion.filtered(rows, 4000.0, 2.0, False)
        periodic = scan_motion.filtered(rows, 4000.0, 2.0, True)[0]  # a period may be shorter than that of the filter
        np.testing.assert_allclose(periodic, rows[0] - 0.5, atol=1e-7)  # (2 / 200)^4

    def test_data_that_end_early_are_refused(self):
        with self.assertRaisesRegex(BadScan, "before the last frame"):
            scan_motion.displacement_m(np.zeros((1, 20)), 0.0, 1000.0, np.array([0.01, 0.03]), False)

    def test_a_period_must_be_a_whole_number_of_samples(self):
        scan = Scan(np.arange(100) / 1000.0, np.zeros(1), np.zeros(1), np.zeros((1, 100)))
        with self.assertRaisesRegex(BadScan, "not a whole number of samples"):
            scan_motion.one_period(scan, 0.0105)
        self.assertEqual(scan_motion.one_period(scan, 0.02)[1], 5)


class Dispersion(unittest.TestCase):
    def test_circular_waves_have_their_speed_and_attenuation(self):
        from scipy.special import hankel2

        s, times = np.arange(-60, 61, 2) * 1e-3, np.arange(600) / 20000.0
        distance = np.abs(np.where(s == 0.0, 1e-4, s))
        for frequency, speed, decay in ((100.0, 2.0, 5.0), (200.0, 2.5, 12.0), (400.0, 3.0, 20.0)):
            k = 2.0 * np.pi * frequency / speed - 1j * decay
            rows = np.real(hankel2(0, k * distance)[:, None] * np.exp(2j * np.pi * frequency * times))
            f, c, a = dispersion.curves(s, rows, 20000.0)
            n = int(np.argmin(np.abs(f - frequency)))
            with self.subTest(frequency=frequency):
                self.assertAlmostEqual(c[n] / speed, 1.0, delta=0.01)  # three wavelengths, near field of the Hankel function
                self.assertAlmostEqual(a[n] / decay, 1.0, delta=0.05)
                self.assertEqual(np.count_nonzero(np.isfinite(c)), 1)

    def test_noise_and_waves_longer_than_the_line_have_no_speed(self):
        s, times = np.arange(1, 41) * 1e-3, np.arange(600) / 20000.0
        rng = np.random.default_rng(5)
        for frequency, speed, found in ((200.0, 3.0, 1), (200.0, 12.0, 0)):  # wavelengths of 15 and 60 mm
            wave = np.cos(2.0 * np.pi * frequency * (times - s[:, None] / speed)) / np.sqrt(s[:, None])
            noisy = wave + 2.0 * rng.normal(size=wave.shape)
            with self.subTest(speed=speed):
                self.assertEqual(np.count_nonzero(np.isfinite(dispersion.curves(s, noisy, 20000.0, noise_m_s=2.0)[1])), found)
                self.assertGreater(np.count_nonzero(np.isfinite(dispersion.curves(s, noisy, 20000.0)[1])), 100)

    def test_few_points_are_refused(self):
        with self.assertRaisesRegex(ValueError, "at least 12 points"):
            dispersion.curves(np.arange(8) * 1e-3, np.ones((8, 20)), 1000.0)
