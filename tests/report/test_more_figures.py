# SPDX-License-Identifier: BSD-3-Clause
"""Tests the profiles, traces, loads, slices of the medium and of volumes, and the map of receptors."""
import math
import unittest
from types import SimpleNamespace
from unittest import mock

import h5py
import numpy as np


from synthetic import AM, Folder, InFolder, case_id, sweep

from shearwake.report import layout, load
from shearwake.report.figures import (fig_frequency, fig_measures, fig_medium, fig_profiles, fig_receptors,
                                      fig_spectra, fig_surface, fig_traces, fig_volume)
from shearwake.report.page import chart, curve_chart, topics

MEDIUM = """
[medium]
base = "rigid"
[[medium.layer]]
thickness_m = 0.01
c_s_m_s = 3.0
[[medium.layer]]
thickness_m = 0.02
c_s_m_s = 6.0
[[medium.body]]
shape = "cylinder"
axis = "horizontal"
azimuth_deg = 90.0
radius_m = 0.002
length_m = 0.0
centre_m = [0.004, 0.0, 0.005]
c_s_m_s = 50.0
"""


class FolderTest(InFolder):
    def draw(self, folder, module):
        """The figures of a module for a folder."""
        return list(self.drawn(folder, module)[1].values())

    def test_profiles_pass_through_the_focus_along_and_across_its_path(self):
        figure, = self.draw(sweep(self.root), fig_profiles)
        along, across = figure.charts
        self.assertEqual([line.label.replace("\N{NO-BREAK SPACE}", " ") for line in along.lines],
                         ["AM frequency 100 Hz", "AM frequency 200 Hz", "AM frequency 400 Hz", "plain STM"])
        for panel, wide_m2 in ((along, 8e-6), (across, 8e-6)):
            line = panel.lines[0]
            # The surface is exp(-r^2 / 8e-6 m^2) around the focus, interpolated between points 1 mm apart, whose
            # error is at most h^2/8 times the largest second derivative, 2 * 3 um / 8e-6 m^2: 0.094 um.
            expected = 3.0 * np.exp(-(1e-3 * np.asarray(line.x))**2 / wide_m2)
            np.testing.assert_allclose(line.y, expected, atol=0.1)

    def test_profiles_pass_through_the_strongest_of_several_foci(self):
        folder = sweep(self.root)
        for number in range(1, 5):  # the middle of two foci is at rest at (18, 0) mm, the displacement at (28, 0) mm
            folder.change(case_id(number), "kind =", "foci_x_m = [-0.02, 0.01]\nfoci_y_m = [0.0, 0.0]\nkind =")
            with h5py.File(folder.file(case_id(number)), "r+") as file:
                file["focus_x"][...] = 0.018
        figure, = self.draw(folder, fig_profiles)
        for panel in figure.charts:
            line = panel.lines[0]
            # The last snapshot has its peak at 7 m/s * 4 ms; the tolerance as above.
            np.testing.assert_allclose(line.y, 3.0 * np.exp(-(1e-3 * np.asarray(line.x))**2 / 8e-6), atol=0.1)
        self.assertIn("Of several simultaneous foci the one with the largest displacement is taken: (28, 0) mm.", figure.caption)

    def with_two_traces(self, x, y, factors):
        """The sweep with two trace points and multiples of the motion of the usual one."""
        folder = sweep(self.root)
        for number in range(1, 5):
            with h5py.File(folder.file(case_id(number)), "r+") as file:
                group = file["traces"]
                values = {name: np.vstack([factor * group[name][()] for factor in factors]) for name in ("u_z", "amplitude")}
                for name, value in {"x": x, "y": y, "trace": [0.0, 1.0], **values}.items():
                    del group[name]
                    group[name] = value
        return folder

    def test_every_trace_point_has_its_displacement_and_spectrum(self):
        figure, = self.draw(self.with_two_traces([0.005, 0.0], [0.0, 0.0], (2, 1)), fig_traces)
        self.assertEqual([panel.title for panel in figure.charts],
                         ["x = 0 mm, y = 0 mm"] * 2 + ["x = 5 mm, y = 0 mm"] * 2)
        near, _, far, spectrum = (np.asarray(panel.lines[0].y) for panel in figure.charts)
        np.testing.assert_allclose(far, 2 * near)
        self.assertAlmostEqual(spectrum.max(), 1.0, delta=0.02)  # um: 2 periods of .5 um, twice as large, under the window

    def test_figures_state_the_trace_point_of_the_columns(self):
        # The columns are those of the first point, although the second one is nearer to the centre.
        folder = self.with_two_traces([0.025, 0.0115], [-0.002, 0.0], (1, 2))
        figure, = self.draw(folder, fig_frequency)
        self.assertIn("the spectrum at (25, −2) mm of", figure.caption)
        self.assertNotIn("centre", figure.caption)
        spectra = self.draw(folder, fig_spectra)[0]
        self.assertEqual(spectra.title, "Spectra at (25, −2) mm")
        self.assertIn("u at (25, −2) mm", spectra.caption)
        found = load.traces(load.load(folder.path).cases[0])
        np.testing.assert_array_equal(found.u_z_m[found.measured], found.u_z_m[1] / 2)
        self.assertEqual(layout.place_words([(0.0, -0.0)] * 2), "at the centre")
        self.assertEqual(layout.place_words([(0.0, 0.0), (0.001, 0.0)]), "at a trace point")

    def test_slices_of_the_medium_show_layers_and_bodies(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        folder.change(case_id(1), "[domain]", MEDIUM + "[domain]\nnx = 40\nny = 30")
        case = load.load(folder.save()).cases[0]
        medium = case.parameters["medium"]
        x = 1e-3 * np.array([0.0, 4.0, 4.0, 4.0, 6.1, 4.0])
        z = 1e-3 * np.array([5.0, 5.0, 9.0, 20.0, 5.0, 31.0])
        np.testing.assert_array_equal(fig_medium.speed(medium, x, np.array(0.01), z),
                                      [3.0, 50.0, 3.0, 6.0, 3.0, math.nan])
        figure, = self.draw_to_scale(folder, fig_medium)
        self.assertIn("first body", figure.caption)
        # The path from 0 to 28 mm and the body around 4 mm with a margin of the depth, within the domain of 40 mm x 30 mm.
        medium["body"][0]["length_m"] = 0.01
        # It is parallel to y: 2 mm around x = 4 mm, and 5 mm along y.
        path = np.array([[0.0, 0.0], [28.0, 0.0]])
        for axis, expected in ((0, (-3.0, 20.0)), (1, (-8.0, 8.0))):
            np.testing.assert_allclose(fig_medium.shown(axis, -20.0, 20.0, path, medium["body"], 3.0), expected)

    def test_rigid_bodies_without_a_speed_are_grey(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        folder.change(case_id(1), "[domain]", MEDIUM.replace("c_s_m_s = 50.0", "rigid = true") + "[domain]\nnx = 40\nny = 30")
        medium = load.load(folder.save()).cases[0].parameters["medium"]
        np.testing.assert_array_equal(fig_medium.speed(medium, np.array([0.0, 4e-3]), np.array(0.01), np.array(5e-3)),
                                      [3.0, math.nan])
        del medium["body"][0]["rigid"]  # an elastic body with the speed of the layer
        np.testing.assert_array_equal(fig_medium.speed(medium, np.array([0.0, 4e-3]), np.array(0.01), np.array(5e-3)),
                                      [3.0, 3.0])
        figure, = self.draw_to_scale(folder, fig_medium)
        self.assertIn("Rigid bodies without a shear-wave speed are grey.", figure.caption)

    def test_bodies_of_every_shape_have_their_extent(self):
        at = np.array([0.0, 0.9, 1.1])
        zero = np.zeros(3)
        for body, inside in (
                ({"shape": "ellipsoid", "semi_axes_m": [1.0, 2.0, 3.0]}, [(1, 1, 0), (1, 1, 1), (1, 1, 1)]),
                ({"shape": "box", "size_m": [2.0, 4.0, 1.0]}, [(1, 1, 0), (1, 1, 1), (1, 0, 0)]),
                ({"shape": "cylinder", "axis": "vertical", "radius_m": 1.0, "length_m": 0.0},
                 [(1, 1, 0), (1, 1, 0), (1, 1, 1)]),
                ({"shape": "cylinder", "axis": "horizontal", "azimuth_deg": 0.0, "radius_m": 1.0, "length_m": 2.0},
                 [(1, 1, 0), (1, 1, 0), (1, 1, 0)]),
                ({"shape": "ellipsoid", "semi_axes_m": [1.0, 2.0, 3.0], "azimuth_deg": 90.0},
                 [(1, 1, 1), (1, 1, 0), (1, 1, 1)]),
                ({"shape": "box", "size_m": [2.0, 4.0, 1.0], "roll_deg": 90.0}, [(1, 1, 0), (1, 0, 0), (1, 1, 1)]),
                ({"shape": "cylinder", "axis": "horizontal", "azimuth_deg": 30.0, "inclination_deg": 90.0,
                  "radius_m": 1.0, "length_m": 4.0}, [(1, 1, 0), (1, 1, 0), (1, 1, 1)])):
            body = {**body, "centre_m": [0.0, 0.0, 0.0]}
            for axis, expected in enumerate(inside):
                point = [zero, zero, zero]
                point[axis] = at
                with self.subTest(shape=body["shape"], axis=axis):
                    self.assertEqual(fig_medium.is_inside(body, *point).tolist(), [bool(v) for v in expected])

    def test_turned_bodies_reach_as_far_as_their_points(self):
        turn = {"azimuth_deg": 30.0, "inclination_deg": 50.0, "centre_m": [0.0, 0.0, 0.0]}
        points = np.linspace(-4.0, 4.0, 161)
        x, y, z = np.meshgrid(points, points, points, indexing="ij")
        for shape in ({"shape": "ellipsoid", "semi_axes_m": [3.0, 2.0, 1.0], "roll_deg": 20.0},
                      {"shape": "box", "size_m": [4.0, 3.0, 2.0], "roll_deg": 20.0},
                      {"shape": "cylinder", "axis": "horizontal", "radius_m": 1.0, "length_m": 5.0}):
            body = {**shape, **turn}
            inside = fig_medium.is_inside(body, x, y, z)
            for axis, position in enumerate((x, y)):
                with self.subTest(shape=body["shape"], axis=axis):
                    # Corners are thinner than the spacing of 0.05.
                    self.assertAlmostEqual(1e-3 * fig_medium.reach_mm(body, axis), position[inside].max(), delta=0.15)

    def test_volumes_have_slices(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        folder.change(case_id(1), "", "[record]\nvolumes_s = [0.004]\n")
        with h5py.File(folder.file(case_id(1)), "r+") as file:
            group = file.create_group("volume")
            group["time"], group["z"] = [0.004], 1e-3 * np.arange(5)
            group["x"], group["y"] = 1e-3 * np.arange(-8, 9), 1e-3 * np.arange(-6, 7)
            group["u_z"] = 1e-6 * np.ones((1, 5, 13, 17))
        figure, = self.draw_to_scale(folder, fig_volume)
        self.assertIn("u_z", figure.caption)
        self.assertNotIn("simultaneous", figure.caption)

    def test_volumes_are_cut_through_the_strongest_of_several_foci(self):
        x = y = np.arange(-6.0, 7.0)
        u = np.ones((5, 13, 13))
        u[2, 3, 1] = -2.0  # at y = -3, x = -5
        case = mock.Mock(focus={"time": np.zeros(1), "focus_x": np.array([1e-3]), "focus_y": np.zeros(1)})
        offsets = {"foci_x_m": [3e-3, -6e-3], "foci_y_m": [4e-3, -3e-3]}
        case.setting = lambda *keys, default: offsets[keys[-1]]
        self.assertEqual(fig_volume.planes(case, (0.0, "u_z", x, y, np.arange(5.0), u))[0], 3)

    def draw_to_scale(self, folder, module):
        """The figures of a module; checks that a millimetre has the same length along both axes and that no title
        separates a number from its unit."""
        _, figures, kept = self.drawn(folder, module)
        panels = [axes for figure in kept.values() for axes in figure.axes[:-1]]
        self.assertEqual(len(panels), 2)
        for axes in panels:
            axes.figure.canvas.draw()
            box, (left, right), (low, high) = axes.get_window_extent(), axes.get_xlim(), axes.get_ylim()
            # places of axes are rounded to pixels, at 30 per inch
            self.assertAlmostEqual(box.width / abs(right - left) / (box.height / abs(high - low)), 1.0, delta=0.02)
            self.assertNotRegex(axes.get_title(loc="left"), r"\n(ms|mm|=)")
        return list(figures.values())

    def test_ratios_have_the_reference_as_a_dashed_line_at_1(self):
        for figure in (f for f in self.draw(sweep(self.root), fig_measures) if f.name in ("gain", "strength")):
            line, = (line for line in figure.charts[0].lines if line.dashed)
            self.assertEqual((line.label, line.x, line.y), ("plain STM", [100.0, 200.0, 400.0], [1.0] * 3))
            self.assertIn("the dashed line at 1", figure.caption)

    def test_captions_name_the_plane_that_is_measured(self):
        folder = sweep(self.root)
        for number in range(1, 5):
            folder.change(case_id(number), "[measure]", "[measure]\ndepths_m = [0.0135]")
        for module in (fig_surface, fig_profiles, fig_traces):
            figure = self.draw(folder, module)[0]
            self.assertIn("the plane z = 13.5\N{NO-BREAK SPACE}mm", figure.caption)
            self.assertNotIn("surface", figure.caption)

    def test_curves_have_the_error_bars_of_the_table(self):
        loaded = load.load(sweep(self.root).save())
        self.assertFalse(curve_chart.have_errors(loaded, "eta_period_1"))
        for case in loaded.cases:
            case.values["eta_period_1_error"] = 0.01
        line = chart.chart_data(curve_chart.curve_chart(loaded, "eta", "eta_period_1", "eta"))["lines"][0]
        self.assertEqual(line["error"], [0.01, 0.01, 0.01])
        self.assertIn("Error bars", curve_chart.error_caption(loaded, "eta_period_1"))


class ReceptorMapTest(unittest.TestCase):
    def test_the_path_is_placed_on_the_hand_like_the_receptors(self):
        turn, shift = np.exp(0.3j), 100 + 20j
        for points in ([0.0, 10.0, 5j], [0.0, 10.0]):  # also receptors on a line
            patch = np.array(points, dtype=complex)
            hand = shift + turn * patch
            afferents = SimpleNamespace(patch=np.column_stack([patch.real, patch.imag]), x=hand.real, y=hand.imag)
            placed = fig_receptors.to_hand(afferents, np.array([[3.0, 4.0]]))[0]
            expected = shift + turn * (3 + 4j)
            np.testing.assert_allclose(placed, [expected.real, expected.imag])


class SampleTest(unittest.TestCase):
    def test_values_between_points_are_bilinear_and_empty_outside(self):
        x, y = np.arange(4.0), np.arange(3.0)
        shot = fig_surface.Snapshot(None, 0.0, x, y, 2 * x[:, None] + x[:, None] * y[None, :])
        np.testing.assert_allclose(fig_profiles.sample(shot, [0.5, 3.0, 1.25], [0.5, 2.0, 1.0]), [1.25, 12.0, 3.75])
        self.assertTrue(np.isnan(fig_profiles.sample(shot, [3.1, -0.1], [0.0, 0.0])).all())


class TopicsTest(unittest.TestCase):
    def test_every_figure_has_one_place_on_the_page(self):
        figures = [SimpleNamespace(name=name) for name in (
            "ipr", "eta", "gain", "strength", "displacement", "surface", "spectra", "drive", "medium", "volume",
            "hand_1", "receptors", "heat_eta_period_1", "eta_time", "traces", "profiles")]
        first = topics.headlines(figures)
        self.assertEqual([f.name for f in first], ["eta", "displacement"])
        rest = [f.name for _, members in topics.topics(figures, first) for f in members]
        self.assertEqual(sorted(rest + ["eta", "displacement"]), sorted(f.name for f in figures))
