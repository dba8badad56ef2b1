# SPDX-License-Identifier: BSD-3-Clause
"""Differences of fields on different grids, compared with known functions."""
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from synthetic import lone_case

from shearwake.report.compare import compare_page, compare_words
from shearwake.report.compare.compare_fields import (common_axis, compare_surfaces, interpolation, on_common_grid,
                                                     place_of_largest, relative_l2)
from shearwake.report.compare.compare_sensors import compare_sensors
from shearwake.report.compare.records import incomplete, record_cell
from shearwake.report.compare.tolerances import Tolerance


def axis(count, spacing):
    return spacing * (np.arange(count) - count // 2)


def field(x, y):
    return np.exp(-((x[:, None] - 0.002) ** 2 + (y[None, :] + 0.001) ** 2) / 18e-6)


def surface(count, spacing):
    x, y = axis(count, spacing), axis(count - 8, spacing)
    return 0.004, x, y, field(x, y)


def sensor_case(folder, spacing_m, factor, nodes, points=None):
    """A case whose sensor recorded uz, the sum of the node's indices with alternating sign, and, if the number of points
    is given, its study file."""
    path = folder / "out" / "study" / "cases" / "case.h5"
    path.parent.mkdir(parents=True)
    with h5py.File(path, "w") as file:
        for direction, values in zip("ijk", zip(*nodes)):
            file[f"sensor/{direction}"] = values
        file["sensor/time"] = [0.001, 0.002]
        file["sensor/uz"] = factor * np.array([[sum(node), -sum(node)] for node in nodes], float)
        file["sensor/uz"].attrs["units"] = "m/s"
    if points:
        with h5py.File(folder / "study.h5", "w") as file:
            file["grid/points"], file["grid/spacing_m"] = np.array(points, float), np.full(3, spacing_m)
    return lone_case(path, {"domain": {"spacing_m": spacing_m}},
                     {"job": 'solver.pstd.study = "study.h5"', "started": "2999-01-01T00:00:00Z"})


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
        self.assertEqual(record_cell([found], ("largest_um", "peak_um"), Tolerance(1e9), "")["words"], "other")

    def test_a_record_differs_by_its_largest_difference_relative_to_its_largest_value(self):
        entries = [{"largest": 1e-6, "peak": 1e-6}, {"largest": 2e-6, "peak": 1.0}]  # the skin hardly moves at first
        self.assertIsNone(record_cell(entries, ("largest", "peak"), Tolerance(2e-6), ""))
        cell = record_cell(entries, ("largest", "peak"), Tolerance(1e-6), "")
        self.assertEqual((cell["change"], cell["over_tolerance"]), (2e-6, 2.0))
        still = [{"largest": 0.0, "peak": 0.0}]
        self.assertIsNone(record_cell(still, ("largest", "peak"), Tolerance(0.0), ""))
        self.assertEqual(record_cell(still, ("largest", "peak"), Tolerance(1.0), incomplete("times", 3, 2, 2))["words"],
                         "recorded at 3 and 2 times, of which 2 are common")

    def test_of_equal_differences_the_place_with_the_largest_y_is_chosen(self):
        x = y = np.array([-1.0, 0.0, 1.0])
        for error in (-1e-10, 0.0, 1e-10):  # closer than 1e-9 of the largest difference
            difference = np.array([[0.2, 0.0, 0.2], [0.1, 0.0, 0.1], [0.2 + error, 0.0, 0.2]])
            self.assertEqual(place_of_largest(difference, x, y), (2, 2))
        difference[0, 0] = 0.2 + 1e-8
        self.assertEqual(place_of_largest(difference, x, y), (0, 0))

    def test_sensors_are_compared_at_common_nodes_and_times(self):
        with tempfile.TemporaryDirectory() as folder:
            (entry,), note = compare_sensors(*(sensor_case(Path(folder) / name, 0.001, factor, nodes) for name, factor, nodes in (
                ("a", 1.1, [(1, 2, 3), (4, 5, 6)]), ("b", 1.0, [(4, 5, 6), (7, 8, 9)]))))
        self.assertAlmostEqual(entry["relative_l2"], 0.1, places=14)
        self.assertAlmostEqual(entry["largest"], 1.5, places=12)
        self.assertEqual((entry["at_node"], entry["nodes"], entry["times"], entry["unit"]), ([4, 5, 6], 1, 2, "m/s"))
        self.assertEqual(note, "")

    def test_points_between_nodes_are_not_taken_for_the_node_below(self):
        with tempfile.TemporaryDirectory() as folder:
            (entry,), _ = compare_sensors(*(sensor_case(Path(folder) / name, 0.001, 1.0, nodes) for name, nodes in (
                ("a", [(4.25, 5, 6), (4.75, 5, 6)]), ("b", [(4.75, 5, 6)]))))
        self.assertEqual((entry["nodes"], entry["at_node"], entry["largest"]), (1, [4.75, 5, 6], 0.0))

    def test_sensors_of_two_resolutions_are_compared_at_equal_positions(self):
        coarse, fine = [(5, 4, 3), (6, 4, 3)], [(12, 8, 6), (13, 8, 6)]  # (6, 4, 3) of 1 mm lies at (12, 8, 6) of 0.5 mm
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            cases = [sensor_case(path / "a", 1e-3, 1.0, coarse, points=(10, 8, 6)),
                     sensor_case(path / "b", 0.5e-3, 2.0, fine, points=(20, 16, 12))]
            (entry,), note = compare_sensors(*cases)
            self.assertEqual((entry["nodes"], entry["at_node"]), (1, [6, 4, 3]))
            self.assertAlmostEqual(entry["largest"], 2.0 * 26 - 13, places=12)
            self.assertIn("up to 0.25 mm apart", note)
            pair = {"sensors": [entry], "sensors_note": note}
            self.assertIn("at node [7, 5, 4]", compare_words.sensor_lines(pair)[0])  # counted from 1
            shifted = sensor_case(path / "c", 0.5e-3, 1.0, [(13, 8, 6)], points=(20, 16, 12))
            found, note = compare_sensors(cases[0], shifted)
            self.assertEqual(found, [])
            self.assertIn("the nearest are 0.5 mm apart", note)
            self.assertEqual(compare_words.sensor_lines({"sensors": [], "sensors_note": note}),
                             [f"  sensors not compared: {note}"])
            (path / "b" / "study.h5").unlink()
            found, note = compare_sensors(*cases)
            self.assertEqual(found, [])
            self.assertIn("the positions of the nodes are unknown", note)
            shifted.path.unlink()
            self.assertEqual(compare_sensors(cases[0], shifted), ([], "only the first has a sensor"))

    def test_the_relative_l2_norm_is_that_of_the_definition(self):
        b = np.array([[3.0, 4.0]])
        self.assertAlmostEqual(relative_l2(1.1 * b, b), 0.1, places=14)
        self.assertTrue(np.isnan(relative_l2(b, 0 * b)))
