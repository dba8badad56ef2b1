# SPDX-License-Identifier: BSD-3-Clause
"""Tests the slices of maps."""
import os

import h5py
import numpy as np


from synthetic import Folder, InFolder, case_id, lone_case

from shearwake.report import load, medium_files
from shearwake.report.figures import fig_medium

LAYER = """
[medium]
base = "rigid"
{map}
[[medium.layer]]
thickness_m = 0.02
c_s_m_s = 3.0
"""
EARLY_s, LATE_s = 1.0e9, 2.0e9  # before and after the start of the synthetic cases, 2026-01-02


class MediaTest(InFolder):
    def setUp(self):
        super().setUp()
        self.root = self.root / "out" / "sweep"
        self.root.mkdir(parents=True)

    def folder(self, job, extra):
        folder = Folder(self.root, swept=(), x="", job=job)
        folder.add({})
        folder.change(case_id(1), "[domain]", "[domain]\nnx = 50\nny = 31")
        folder.change(case_id(1), "", extra)
        return folder

    def file(self, name, time_s, **datasets):
        """An HDF5 file next to the folder `out`."""
        path = self.root.parents[1] / name
        with h5py.File(path, "w") as file:
            for key, values in datasets.items():
                file[key.replace("__", "/")] = values
        os.utime(path, (time_s, time_s))
        return path

    def captions(self, folder, module=fig_medium):
        return [figure.caption for figure in self.drawn(folder, module)[1].values()]


class Maps(MediaTest):
    JOB = 'schema = 1\n[medium]\nmap = "soft.h5"\n'
    X, Y, Z = 1e-3 * np.arange(-5.0, 6.0), 1e-3 * np.arange(-4.0, 5.0), 1e-3 * np.arange(0.0, 11.0, 2.0)

    def map(self, time_s=EARLY_s):
        x, y, z = np.meshgrid(self.X, self.Y, self.Z, indexing="ij")
        return self.file("soft.h5", time_s, x_m=self.X, y_m=self.Y, z_m=self.Z, c_s_m_s=10.0 + 100 * x + 200 * y + 300 * z)

    def test_speeds_are_linear_between_nodes_and_those_of_the_layer_outside(self):
        self.map()
        loaded = load.load(self.folder(self.JOB, LAYER.format(map='map = "0"')).save())
        along_x, along_y = fig_medium.scene(loaded, loaded.cases[0])
        for plane, slope in ((along_x, 100.0), (along_y, 200.0)):
            z = np.linspace(0.0, 0.02, len(plane.c_s))
            at = 1e-3 * np.linspace(*plane.extent[:2], plane.c_s.shape[1])
            inside = np.ix_(z <= 0.010, np.abs(at) <= 0.004)
            expected = 10.0 + slope * at[None, :] + 300.0 * z[:, None]
            np.testing.assert_allclose(plane.c_s[inside], expected[inside], rtol=1e-12)  # rounding errors
            np.testing.assert_array_equal(plane.c_s[np.ix_(z > 0.0111, np.abs(at) < 1.0)], 3.0)
            np.testing.assert_array_equal(plane.c_s[np.ix_(z <= 0.010, np.abs(at) > 0.0056)], 3.0)

    def test_the_figure_states_where_the_map_is_from(self):
        self.map()
        caption, = self.captions(self.folder(self.JOB, LAYER.format(map='map = "0"')))
        self.assertIn("has not changed since the run", caption)

    def test_a_map_that_was_changed_later_or_is_missing_is_not_drawn(self):
        folder = self.folder(self.JOB, LAYER.format(map='map = "0"'))
        self.assertEqual(self.captions(folder), [])
        self.map(LATE_s)
        self.assertEqual(self.captions(folder), [])

    def test_a_swept_or_overridden_key_selects_the_map(self):
        path = self.map()
        case = lone_case(path, attributes={"started": "2026-01-02T03:04:05Z"})
        case.settings = {"medium.map": str(path)}
        self.assertEqual(medium_files.file_of(self.root, "", case, "medium.map"), path)
        case.settings, case.attributes["overrides"] = {}, 'medium.map = "soft.h5"\nload.peak_Pa = 3'
        self.assertEqual(medium_files.file_of(self.root, "", case, "medium.map"), path)
