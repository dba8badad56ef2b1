#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Differences of fields on different grids, compared with known functions.

Run: python3 tests/report/test_compare_fields.py    (unittest, numpy, h5py; a second)
"""
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

from synthetic import ROOT

sys.path.insert(0, str(ROOT / "analysis" / "report"))

import compare_words  # noqa: E402
import load  # noqa: E402
from compare_fields import (common_axis, compare_sensors, interpolation, on_common_grid,  # noqa: E402
                            place_of_largest, relative_l2)


def axis(count, spacing):
    return spacing * (np.arange(count) - count // 2)


def field(x, y):
    return np.exp(-((x[:, None] - 0.002) ** 2 + (y[None, :] + 0.001) ** 2) / 18e-6)


def surface(count, spacing):
    x, y = axis(count, spacing), axis(count - 8, spacing)
    return 0.004, x, y, field(x, y)


class CompareFields(unittest.TestCase):
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

    def test_rounding_errors_do_not_decide_on_the_place_of_the_maximum(self):
        x = y = np.array([-1.0, 0.0, 1.0])
        for error in (-1e-8, 0.0, 1e-8):  # rounding errors of float32 for values near 1
            difference = np.array([[0.2, 0.0, 0.2], [0.1, 0.0, 0.1], [0.2 + error, 0.0, 0.2]])
            self.assertEqual(place_of_largest(difference, 1.0, x, y), (2, 2))
        difference[0, 0] = 0.21
        self.assertEqual(place_of_largest(difference, 1.0, x, y), (0, 0))

    def test_sensors_are_compared_at_common_nodes_and_times(self):
        with tempfile.TemporaryDirectory() as folder:
            cases = []
            for name, factor, nodes in (("a.h5", 1.1, [(1, 2, 3), (4, 5, 6)]), ("b.h5", 1.0, [(4, 5, 6), (7, 8, 9)])):
                path = Path(folder) / name
                with h5py.File(path, "w") as file:
                    for axis, values in zip("ijk", zip(*nodes)):
                        file[f"sensor/{axis}"] = values
                    file["sensor/time"] = [0.001, 0.002]
                    file["sensor/uz"] = factor * np.array([[sum(node), -sum(node)] for node in nodes], float)
                    file["sensor/uz"].attrs["units"] = "m/s"
                cases.append(load.Case(name, {}, False, "", path, physics={"domain": {"spacing_m": 0.001}}))
            entry, = compare_sensors(*cases)
        self.assertAlmostEqual(entry["relative_l2"], 0.1, places=14)
        self.assertAlmostEqual(entry["largest"], 1.5, places=12)
        self.assertEqual((entry["at_node"], entry["nodes"], entry["times"], entry["unit"]), ([4, 5, 6], 1, 2, "m/s"))

    def test_rounding_errors_of_columns_are_not_listed(self):
        rows = [{"column": "eta", "first": 0.2, "second": 0.2, "change": 1e-14},
                {"column": "peak", "first": 1.0, "second": 2.0, "change": -0.5}]
        self.assertEqual([line.split()[0] for line in compare_words.column_lines(rows)], ["column", "peak"])
        self.assertEqual(compare_words.column_lines(rows[:1]), ["  all columns are equal"])

    def test_the_relative_l2_norm_is_that_of_the_definition(self):
        b = np.array([[3.0, 4.0]])
        self.assertAlmostEqual(relative_l2(1.1 * b, b), 0.1, places=14)
        self.assertTrue(np.isnan(relative_l2(b, 0 * b)))


if __name__ == "__main__":
    unittest.main()
