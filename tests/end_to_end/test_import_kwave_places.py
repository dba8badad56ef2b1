# SPDX-License-Identifier: BSD-3-Clause
"""import-kwave places sources, sensors, layers and times as k-Wave does."""

import h5py
import numpy
import pytest

from kwave import nodes_of
from small_study import FilesTest, study

pytestmark = pytest.mark.extended


class Places(FilesTest):
    def test_places_of_sources_and_sensor_are_printed(self):
        self.changed()
        self.contains(self.imported("study.mat"), "10 x 9 x 8 nodes, 20 steps of 10 us, 1 source, 3 sensor nodes",
                      "source uz (dirichlet): 3 nodes, x 4 to 7, y 5, z 3", "sensor (p, u): 3 nodes, x 3 to 5, y 4, z 2")
        # A cube whose array was stored with reversed indices has the right shape, but another place.
        cube = study()
        for axis in "xyz":
            cube["kgrid"][f"N{axis}"] = 10
        mask = numpy.zeros((10, 10, 10))
        mask[3, 4, 2] = 1.0
        cube["medium"]["sound_speed_shear"] = 5.0
        cube["source"].update(u_mask=mask, uz=numpy.ones((1, 20)))
        cube["sensor"]["mask"] = cube["sensor"]["mask"].T
        with h5py.File(self.folder / "study.h5py", "w") as file:
            for group, fields in cube.items():
                for name, value in fields.items():
                    file[f"{group}/{name}"] = value  # without .T
        self.contains(self.imported("study.h5py"), "source uz (dirichlet): 1 node, x 3, y 5, z 4",
                      "Nx and Nz are equal: the arrays of the file are taken as (z, y, x)")

    def test_cuboids_have_whole_ascending_corners(self):
        for corners, words in (([5.0, 4, 2, 3, 4, 2], "second corner lies before the first"), ([3.0, 4, 2, 5, 4, 1], "second corner"),
                               ([3.5, 4, 2, 5, 4, 2], "contains the corner 3.5"), ([3.0, 4, 2, 11, 4, 2], "outside of the grid")):
            with self.subTest(corners=corners):
                self.changed(sensor={"mask": numpy.array([corners]).T})
                self.refused("study.mat", words)

    def test_sensors_do_not_reach_into_a_layer_outside_of_the_grid(self):
        for mask in ([[0.0, 4, 2, 5, 4, 2]], [[3.0, 4, 2, 11, 4, 2]], [[3.0, 4, 2, 1e9, 4, 2]], [[-5.5e-3, 0.0, 0.0]], [[4.5e-3, 0, 0]]):
            with self.subTest(mask=mask):
                self.changed(sensor={"mask": numpy.array(mask).T}, options={"PMLInside": False})
                self.refused("study.mat", "sensor.mask has points outside of the grid")
        study_file = self.changed(sensor={"mask": numpy.array([[1.0, 1, 1, 10, 9, 1]]).T}, options={"PMLInside": False})
        self.imported("study.mat")
        with h5py.File(study_file) as file:
            numpy.testing.assert_array_equal(file["sensor_mask_corners"][0], [[3, 3, 3, 12, 11, 3]])

    def test_cartesian_points_half_way_between_nodes_are_rounded_away_from_zero(self):
        # Centre (5, 4, 4) of 10 x 9 x 8 nodes; dz is 2 mm. The first point is replaced by the last at its node.
        at_mm = numpy.array([[0.6, -0.6, 0.2], [0.5, -0.5, 0.0], [1.5, 2.5, 1.0], [-2.5, 0.4, -3.0]]).T
        study_file = self.changed(sensor={"mask": 1e-3 * at_mm}, options={"CartInterp": "nearest"})
        self.imported("study.mat")
        with h5py.File(study_file) as file:
            numpy.testing.assert_array_equal(nodes_of(file, "sensor_mask_index"), [[6, 3, 4], [7, 7, 5], [2, 4, 2]])
        # 0.5 less one unit in the last place is below the half.
        below = 1e-3 * numpy.nextafter(0.5, 0.0)
        while below / 1e-3 >= 0.5:
            below = numpy.nextafter(below, 0.0)
        study_file = self.changed(sensor={"mask": numpy.array([[below], [-below], [0.0]])}, options={"CartInterp": "nearest"})
        self.imported("study.mat")
        with h5py.File(study_file) as file:
            numpy.testing.assert_array_equal(nodes_of(file, "sensor_mask_index"), [[5, 4, 4]])

    def test_cartesian_points_are_weighted_means_of_eight_nodes(self):
        at_mm = numpy.array([[0.25, 0.0, -1.0], [4.0, -4.0, 6.0]]).T
        study_file = self.changed(sensor={"mask": 1e-3 * at_mm})
        self.contains(self.imported("study.mat"), "interpolated linearly", "2 points between 16 nodes")
        with h5py.File(study_file) as file:
            self.assertEqual(file["sensor_mask_type"][0, 0, 0], 2)
            nodes, weights = nodes_of(file, "sensor_mask_index").reshape(2, 8, 3), file["sensor_mask_weights"][0]
        numpy.testing.assert_allclose(numpy.einsum("pn,pna->pa", weights, nodes), [[5.25, 4.0, 3.5], [9.0, 0.0, 7.0]], atol=1e-12)
        numpy.testing.assert_allclose(weights.sum(axis=1), 1.0)
        self.assertTrue((nodes >= 0).all() and (nodes < [10, 9, 8]).all())

    def test_times_that_contradict_each_other_are_rejected(self):
        times = 1e-5 * numpy.arange(20)
        for fields, words in (({"t_array": times, "dt": 2e-5}, "kgrid.dt is 2e-05 s, but the times of kgrid.t_array are 1e-05 s"),
                              ({"t_array": times[:15]}, "kgrid.Nt is 20, but kgrid.t_array contains 15"),
                              ({"t_array": times[:15], "Nt": "auto"}, ""),
                              ({"t_array": numpy.float32(times)}, ""),
                              ({"t_array": numpy.float32(times + 1e-2), "dt": "auto", "Nt": "auto"}, ""),
                              ({"t_array": "auto"}, "")):
            with self.subTest(fields=fields):
                study_file = self.changed(kgrid=fields)
                if words:
                    self.refused("study.mat", words)
                    continue
                self.imported("study.mat")
                with h5py.File(study_file) as file:
                    self.assertEqual(file["Nt"][0, 0, 0], 15 if "Nt" in fields and "dt" not in fields else 20)
                    # Single precision after 10 ms: 1e-9 s of 2e-4 s.
                    self.assertAlmostEqual(file["dt"][0, 0, 0] / 1e-5, 1.0, places=4)

    def test_automatic_times_and_layers_are_those_of_kwave(self):
        study_file = self.changed(kgrid={"t_array": "auto", "dt": "auto", "Nt": "auto"},
                                  options={"PMLSize": "auto", "PMLInside": False})
        # makeTime: .1 * 1 mm / (20 m/s) and the diagonal of 10 x 9 x 16 mm at 5 m/s. getOptimalPMLSize: 10 + 2 * 11 = 32,
        # 9 + 2 * 36 = 81 and 8 + 2 * 12 = 32.
        self.contains(self.imported("study.mat"), "837 steps of 5 us", "is, as in k-Wave, 11, 36, 12",
                      "k-Wave itself chooses times only for an initial pressure")
        with h5py.File(study_file) as file:
            self.assertEqual((file["dt"][0, 0, 0], file["Nt"][0, 0, 0]), (5e-6, 837))
            self.assertEqual([file[f"N{axis}"][0, 0, 0] for axis in "xyz"], [32, 81, 32])
        self.changed(options={"PMLSize": "auto", "PMLInside": False, "PMLRange": [10.0, 20.0], "HDFCompressionLevel": 9.0})
        # 9 + 2 * 18 = 45
        self.contains(self.imported("study.mat"), "is, as in k-Wave, 11, 18, 12", "HDFCompressionLevel: ignored")
        self.changed(options={"PMLSize": "auto"})
        self.refused("study.mat", "supports only with options.PMLInside = false")

    def test_automatic_times_that_divide_the_duration_count_the_last_step(self):
        """makeTime adds a step where the quotient is a whole number except for rounding: (8, 16, 16) mm at 5 m/s take 4.8 ms."""
        self.changed({"source": {"p0": numpy.ones((8, 16, 8))}}, medium={"sound_speed_shear": 5.0}, options={"Smooth": False},
                     kgrid={"Nx": 8, "Ny": 16, "Nz": 8, "dt": "auto", "Nt": "auto"})
        output = self.imported("study.mat")
        self.contains(output, "961 steps of 5 us")  # 24 mm / (5 m/s) / 5 us is 959.9999999999999
        self.assertNotIn("k-Wave itself", output)
