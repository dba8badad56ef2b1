# SPDX-License-Identifier: BSD-3-Clause
"""Differences of fields on different grids, compared with known functions."""
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from synthetic import lone_case

from shearwake.report.compare import compare_page
from shearwake.report.compare.compare_fields import (common_axis, compare_surfaces, interpolation, on_common_grid,
                                                     place_of_largest, relative_l2)
from shearwake.report.compare.records import incomplete, record_cell


def axis(count, spacing):
    return spacing * (np.arange(count) - count // 2)


def field(x, y):
    return np.exp(-((x[:, None] - 0.002) ** 2 + (y[None, :] + 0.001) ** 2) / 18e-6)


def surface(count, spacing):
    x, y = axis(count, spacing), axis(count - 8, spacing)
    return 0.004, x, y, field(x, y)


class CompareFields(unittest.TestCase):
    def test_the_picture_shows_the_time_of_the_largest_difference(self):
        pair = {"fields": [{"time_ms": t, "relative_l2": l2, "largest_um": um, "at_mm": [0.0, 0.0]}  # the skin hardly moves at 0.1 ms
                           for t, l2, um in ((0.1, 1.0, 0.2), (5.0, 0.9, 6.8), (8.0, 0.9, 3.0))], "traces": [], "columns": []}
        with mock.patch.object(compare_page, "surfaces", side_effect=StopIteration) as asked, self.assertRaises(StopIteration):
            compare_page.picture({"pairs": [pair]}, [(None, None)])
        self.assertEqual(asked.call_args.args[-1], 5.0)

    def test_coinciding_points_are_copied_exactly(self):
        fine, coarse = axis(64, 0.5e-3), axis(32, 1e-3)
        matrix = interpolation(coarse[1:-1], fine)
        self.assertTrue(((matrix == 0) | (matrix == 1)).all())
        np.testing.assert_array_equal(matrix @ fine, coarse[1:-1])

    def test_polynomials_of_degree_7_are_interpolated_exactly(self):
        nodes, at = axis(20, 1.0), np.linspace(-9.9, 8.9, 57)
        values = (nodes / 10) ** 7 - (nodes / 10) ** 4 + 0.3
        # Rounding errors grow with the weights, which are below 10 even near the ends.
        np.testing.assert_allclose(interpolation(at, nodes) @ values, (at / 10) ** 7 - (at / 10) ** 4 + 0.3,
                                   atol=1e-13)

    def test_the_common_grid_is_the_coarser_one_within_both_domains(self):
        x = common_axis(axis(40, 1e-3), axis(40, 0.75e-3))
        self.assertAlmostEqual(x[1] - x[0], 1e-3, places=15)
        self.assertEqual((round(1e3 * x[0]), round(1e3 * x[-1])), (-15, 14))

    def test_grids_without_common_points_agree_to_the_order_of_the_interpolation(self):
        errors = []
        for spacing in (1.0e-3, 0.5e-3):
            _, _, a, b = on_common_grid(surface(int(0.04 / spacing), spacing), surface(int(0.06 / spacing), 0.7 * spacing))
            errors.append(relative_l2(a, b))
        # Degree 7: half the spacing reduces the error by 2^8, if it is resolved; at least by 2^6.
        self.assertLess(errors[1], errors[0] / 64)
        self.assertLess(errors[1], 1e-5)

    def test_the_place_is_that_of_the_true_maximum(self):
        x, y = axis(5, 1.0), axis(12, 1.0)
        difference = np.zeros((5, 12))
        difference[2, 11], difference[2, 7] = 1.8e-12, 3.278e-12  # far below rounding errors of the field itself
        self.assertEqual(place_of_largest(difference, x, y), (2, 7))
        found, = self.surfaces_with(difference)
        self.assertAlmostEqual(found["largest_um"], 3.278e-6, delta=1e-15)
        self.assertEqual(found["at_mm"], [0.0, 1.0])

    def surfaces_with(self, difference):
        """The comparison of two surfaces with this difference in m at nodes of 1 mm."""
        with tempfile.TemporaryDirectory() as folder:
            cases = []
            for name, u in (("a.h5", difference), ("b.h5", 0.0 * difference)):
                with h5py.File(Path(folder) / name, "w") as file:
                    surface = file.create_group("surface")
                    surface["time"], surface["u_z"] = [0.004], u[None, None]
                    surface["x"], surface["y"] = axis(u.shape[0], 1e-3), axis(u.shape[1], 1e-3)
                cases.append(lone_case(Path(folder) / name))
            return compare_surfaces(*cases)

    def test_values_that_are_not_numbers_differ(self):
        difference = np.zeros((5, 12))
        difference[1, 2] = np.nan
        (found,) = self.surfaces_with(difference)
        self.assertEqual(found["largest_um"], np.inf)
        self.assertEqual(record_cell([found], ("largest_um", "peak_um"), 1e9, "")["words"], "other")

    def test_a_record_differs_by_its_largest_difference_relative_to_its_largest_value(self):
        entries = [{"largest": 1e-6, "peak": 1e-6}, {"largest": 2e-6, "peak": 1.0}]  # the skin hardly moves at first
        self.assertIsNone(record_cell(entries, ("largest", "peak"), 2e-6, ""))
        cell = record_cell(entries, ("largest", "peak"), 1e-6, "")
        self.assertEqual((cell["change"], cell["over_tolerance"]), (2e-6, 2.0))
        still = [{"largest": 0.0, "peak": 0.0}]
        self.assertIsNone(record_cell(still, ("largest", "peak"), 0.0, ""))
        self.assertEqual(record_cell(still, ("largest", "peak"), 1.0, incomplete("times", 3, 2, 2))["words"],
                         "recorded at 3 and 2 times, of which 2 are common")

    def test_of_equal_differences_the_place_with_the_largest_y_is_chosen(self):
        x = y = np.array([-1.0, 0.0, 1.0])
        for error in (-1e-10, 0.0, 1e-10):  # closer than 1e-9 of the largest difference
            difference = np.array([[0.2, 0.0, 0.2], [0.1, 0.0, 0.1], [0.2 + error, 0.0, 0.2]])
            self.assertEqual(place_of_largest(difference, x, y), (2, 2))
        difference[0, 0] = 0.2 + 1e-8
        self.assertEqual(place_of_largest(difference, x, y), (0, 0))


    def test_the_relative_l2_norm_is_that_of_the_definition(self):
        b = np.array([[3.0, 4.0]])
        self.assertAlmostEqual(relative_l2(1.1 * b, b), 0.1, places=14)
        self.assertTrue(np.isnan(relative_l2(b, 0 * b)))
