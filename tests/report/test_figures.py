# SPDX-License-Identifier: BSD-3-Clause
"""Tests the data of figures: axes of a sweep, heat maps, spectrograms."""
import base64
import io
import math
import tempfile
import unittest

import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image


from synthetic import AM, FWHM, Folder, InFolder, Page, case_id, draw

from shearwake.report import labels, layout, load, warnings_of, words
from shearwake.report.figures import (fig_curves, fig_drive, fig_frequency, fig_heat, fig_intensity, fig_measures, fig_multiples,
                                      fig_spectra, fig_spectrogram, fig_surface)
from shearwake.report.page import hover, player, table

SPEED = "load.modulation.speed_m_s"
SPACING = "domain.spacing_mm"


def grid(root, frequencies=(100.0, 200.0, 400.0), widths=(2.0, 3.0, 6.0), speeds=(5.0,), **content):
    """A sweep of three keys, whose spacing follows the speed."""
    keys = [AM, FWHM, SPEED, SPACING]
    folder = Folder(root, series=keys[1:], swept=keys)
    for f in frequencies:
        for width in widths:
            for speed in speeds:
                folder.add({AM: f, FWHM: width, SPEED: speed, SPACING: 5.0 / speed},
                           scalars={"eta_period_1": 1e-3 * f + width + 10 * speed}, **content)
    return folder


class FolderTest(InFolder):
    def test_a_key_that_follows_another_is_not_an_axis(self):
        sweep = load.load(grid(self.root, speeds=(5.0, 7.0)).save())
        self.assertEqual(layout.axes(sweep), [AM, FWHM, SPEED])

    @pytest.mark.extended
    def test_heat_maps_of_two_swept_keys_contain_every_case(self):
        folder = grid(self.root)
        failed = folder.add({AM: 800.0, FWHM: 2.0, SPEED: 5.0, SPACING: 1.0}, written=False)
        folder.fail(failed, "not finite")
        page = Page(folder.report())
        self.assertIn("heat_eta_period_1", {i.split(".")[0] for i in self.names()})
        sweep = load.load(self.root)
        x, y, others = fig_heat.plane(sweep)
        self.assertEqual((x, y, others), (AM, FWHM, []))
        (values, broken, _, _), = fig_heat.cells(sweep, "eta_period_1", x, y, others, [()])
        self.assertEqual(values.shape, (3, 4))
        self.assertEqual(values[1, 2], 1e-3 * 400.0 + 3.0 + 50.0)  # row: 3 mm, column: 400 Hz
        self.assertEqual(np.argwhere(broken).tolist(), [[0, 3]])
        self.assertTrue(np.isnan(values[1, 3]) and not broken[1, 3])  # not swept
        self.assertIn("Cross-hatched: 1 without a result", page.data)
        self.assertIn("Hatched: 2 without a value", page.data)

    def names(self):
        return [p.name for p in (self.root / "report").iterdir()]

    def test_three_swept_keys_are_drawn_as_small_multiples(self):
        folder = grid(self.root, speeds=(3.0, 5.0, 7.0, 9.0))
        sweep = self.drawn(folder, fig_multiples, fig_measures)[0]
        self.assertIn("multiples_eta_period_1.png", self.names())
        self.assertNotIn("eta.png", self.names())  # would have twelve curves in one panel
        x, y, others = fig_heat.plane(sweep)
        self.assertEqual((x, y, others), (AM, SPEED, [FWHM]))
        self.assertEqual(fig_heat.panels(sweep, others), ([(2.0,), (3.0,), (6.0,)], 3))

    def test_strings_can_be_an_axis_of_a_heat_map(self):
        kind = "load.modulation.kind"
        folder = Folder(self.root, x=AM, series=[kind], swept=[AM, kind])
        for f in (100.0, 200.0, 400.0):
            for name in ("STM", "AM-STM", "SM-STM"):
                folder.add({AM: f, kind: name}, kind=name)
        sweep = self.drawn(folder, fig_heat, fig_measures)[0]
        self.assertEqual(layout.values_of(sweep, kind), ["STM", "AM-STM", "SM-STM"])
        self.assertIn("heat_eta_period_1.png", self.names())
        self.assertIn("eta.png", self.names())  # three curves also fit into one panel

    def test_a_large_sweep_has_panels_of_a_few_cases(self):
        values = [50.0 * n for n in range(1, 16)]
        sweep = load.load(grid(self.root, values, (1.0, 2.0, 3.0, 4.0), snapshot=False).save())
        some = layout.few(sweep)
        self.assertEqual(len(layout.ordinary(sweep)), 60)
        self.assertEqual(len(layout.ordinary(some)), 24)  # three curves of eight cases
        shown = layout.values_of(some, AM)
        self.assertEqual((shown[0], shown[-1]), (50.0, 750.0))
        self.assertIs(layout.few(some), some)
        self.assertEqual(layout.group_keys(some), layout.group_keys(sweep))

    def test_a_drawn_shape_has_a_map_of_its_mean_intensity(self):
        folder = Folder(self.root)
        lines = [[(0.01, 0.0), (0.0, 0.01)], [(-0.01, 0.0), (0.0, -0.01), (0.01, 0.0)]]
        folder.add({AM: 100.0}, drawn=lines, scalars={"sharpness_1": 0.75})
        sweep = self.drawn(folder, fig_intensity)[0]
        self.assertIn("intensity.png", self.names())
        x, y, square, found = load.mean_square(sweep.cases[0])
        self.assertEqual(square.shape, (len(x), len(y)))
        self.assertEqual([line.tolist() for line in found],
                         [[list(point) for point in line] for line in lines])
        self.assertIn(">sharpness<", table.table(sweep, []))

    def test_a_straight_line_has_no_map_of_its_mean_intensity(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars={"sharpness_1": 0.75})
        with h5py.File(folder.file(case_id(1)), "r+") as file:
            x, y = file["focus_x"][()], file["focus_y"][()]
            draw(file, file["time"][()], [[(0.0, 0.0), (0.028, 0.0)]])
            file["focus_x"][...], file["focus_y"][...] = x, y
        sweep = self.drawn(folder, fig_intensity)[0]
        self.assertIsNotNone(load.mean_square(sweep.cases[0]))
        self.assertNotIn("intensity.png", self.names())
        self.assertNotIn("sharpness", table.table(sweep, []))

    def test_the_level_of_sensation_has_a_map_with_its_threshold(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, drawn=[[(0.0, 0.0)]], scalars={"felt_peak_dB": 12.0, "felt_band_Hz": 100.0})
        with h5py.File(folder.file(case_id(1)), "r+") as file:
            group = file.create_group("sensation")
            group["x"], group["y"] = 1e-3 * np.arange(-10, 11), 1e-3 * np.arange(-8, 9)
            group["level"] = 12.0 - 0.3 * np.hypot(*np.meshgrid(np.arange(-10, 11), np.arange(-8, 9), indexing="ij"))**2
        sweep = self.drawn(folder, fig_intensity)[0]
        self.assertIn("sensation.png", self.names())
        self.assertEqual(load.levels(sweep.cases[0])[2].shape, (21, 17))
        figure, axes = plt.subplots()
        self.addCleanup(plt.close, figure)
        fig_surface.draw_threshold(axes, load.levels(sweep.cases[0]))
        line = np.concatenate([path.vertices for path in axes.collections[0].get_paths()])
        # 12 = 0.3 r^2; the contour is linear between samples 1 mm apart.
        np.testing.assert_allclose(np.hypot(*line.T), math.sqrt(40.0), atol=0.03)

    def test_colours_of_levels_begin_at_the_threshold_or_below(self):
        loud, faint = np.array([55.0, -60.0]), np.array([16.0, np.nan])
        self.assertEqual(fig_intensity.colour_limits([loud, faint]), (0.0, 55.0))
        self.assertEqual(fig_intensity.colour_limits([faint, np.array([-60.0])]), (-24.0, 16.0))
        self.assertEqual(fig_intensity.colour_limits([np.array([60.0, 30.0])]), (30.0, 60.0))

    def test_a_case_without_a_level_has_no_map_of_it(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, drawn=[[(0.0, 0.0)]])
        sweep = self.drawn(folder, fig_intensity)[0]
        self.assertIsNone(load.levels(sweep.cases[0]))
        self.assertNotIn("sensation.png", self.names())

    def test_frames_are_shown_with_a_slider(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, frames=True)
        self.assertIn("input", Page(folder.report()).tags)

    def test_velocity_is_drawn_if_displacement_has_no_peak(self):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        for f in (100.0, 200.0):
            folder.add({AM: f, FWHM: 3.0}, scalars={"peak_frequency_Hz": math.nan,
                                                    "velocity_peak_frequency_Hz": 300.0})
        sweep = self.drawn(folder, fig_frequency, fig_spectra)[0]
        self.assertEqual(fig_frequency.peaks(sweep), [("velocity_peak_frequency_Hz", "du/dt")])
        self.assertIn("spectra_velocity.png", self.names())

    def test_each_curve_has_a_column_below_the_common_reference(self):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        reference = case_id(7)
        for width in (2.0, 6.0):
            for f in (100.0, 200.0, 400.0):
                folder.add({AM: f, FWHM: width}, reference)
        folder.add({}, is_reference=True, kind="STM")
        sweep = load.load(folder.save())
        cells, columns = fig_surface.cells(sweep)
        self.assertEqual(columns, 2)
        ids = [c and int(c.id, 16) for c in cells]
        self.assertEqual(ids, [7, None, 1, 4, 2, 5, 3, 6])

    def test_references_that_differ_only_in_measurement_are_drawn_once(self):
        after = "measure.settled_after_ms"
        folder = Folder(self.root, swept=[AM, after])
        for f, ms, reference in ((100.0, 4.0, 3), (200.0, 5.0, 4)):
            folder.add({AM: f, after: ms}, case_id(reference))
        for ms in (4.0, 5.0):
            folder.add({after: ms}, is_reference=True, kind="STM")
        sweep = load.load(folder.save())
        (panel,) = layout.panels(sweep)
        self.assertEqual((panel.title, len(panel.cases)), ("", 2))
        self.assertEqual([layout.case_label(sweep, r) for r in panel.references], ["plain STM"])

    def test_some_of_many_values_have_lines(self):
        folder = Folder(self.root)
        for n in range(1, 19):
            folder.add({AM: 50.0 * n}, snapshot=False)
        some = layout.fewer_lines(load.load(folder.save()))
        shown = layout.x_values(some)
        self.assertEqual((len(shown), shown[0], shown[-1]), (6, 50.0, 900.0))

    def test_speed_modulation_leads_the_reference_by_its_amplitude(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, case_id(2))
        folder.add({}, is_reference=True, kind="STM")
        with h5py.File(folder.file(case_id(1)), "r+") as file:
            file["focus_x"][...] += 2e-3 * np.sin(1e3 * file["time"][()])
        sweep = load.load(folder.save())
        case, reference = sweep.cases
        np.testing.assert_allclose(fig_drive.lead_mm(sweep, case),
                                   2.0 * np.sin(1e3 * case.over_time["time"]), atol=1e-12)
        self.assertIsNone(fig_drive.lead_mm(sweep, reference))

    def test_frames_are_thinned_until_they_fit_on_the_page(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, frames=True)
        sweep = load.load(folder.save())
        self.addCleanup(setattr, player, "BUDGET_bytes", player.BUDGET_bytes)
        limits = player.common_view(sweep.cases)[2]
        self.assertEqual(player.detail_that_fits(sweep, sweep.cases, limits), player.Detail(player.MOMENTS))
        player.BUDGET_bytes = 1_500
        detail = player.detail_that_fits(sweep, sweep.cases, limits)
        data = player.case_data(sweep, sweep.cases[0], limits, detail, "")
        self.assertLess(sum(map(len, data["pictures"])), player.BUDGET_bytes)
        self.assertLess(len(data["times"]), 40)
        self.assertEqual((data["times"][0], data["times"][-1]), (0.1, 4.0))  # the first and the last are kept

    def test_a_picture_of_the_player_contains_the_displacement(self):
        u_um = 3.0 * np.linspace(-1.0, 1.0, 60).reshape(6, 10)
        image = Image.open(io.BytesIO(base64.b64decode(player.picture(u_um, 3.0, True)))).convert("L")
        root = (np.asarray(image, dtype=float)[::-1].T - 127.5) / 127.5
        # half a grey level of the root: 2 * 0.5 / 127.5 of the largest value
        np.testing.assert_allclose(3.0 * root * np.abs(root), u_um, atol=3.0 * 1.0 / 127.5)


class ValuesTest(unittest.TestCase):
    def test_only_a_few_values_have_their_errors(self):
        for shape, few in (((4, 5), True), ((21, 20), False)):  # up to 400 values
            axes = plt.figure().add_subplot()
            hover.attach(axes, np.ones(shape), (0, 1), (0, 1), "eta", "x", "y", error=np.full(shape, 0.1))
            self.assertEqual("error" in axes.hover, few)
            plt.close(axes.figure)

    def test_warnings_of_afferents_concern_the_maps_of_their_columns(self):
        for name, expected in (("heat_RA_total_rate_Hz", True), ("afferents_rate", True), ("heat_eta_period_1", False), ("eta", False)):
            self.assertEqual(warnings_of.is_of_receptors(name), expected, name)


class SpectrogramTest(unittest.TestCase):
    def test_a_spectrum_has_the_amplitude_of_a_tone_and_no_leakage_of_the_mean(self):
        t = 2.5e-4 * np.arange(1, 629)  # 157 ms: 23.55 periods of 150 Hz
        u = np.stack([7.3e-6 + 4.4e-6 * np.sin(2 * np.pi * 150.0 * t + 0.4), 4.4e-6 * np.sin(2 * np.pi * 150.0 * t)])
        frequency, amplitude = load.amplitude_spectrum(u, 2.5e-4)
        for row in amplitude:
            self.assertAlmostEqual(frequency[row.argmax()], 150.0, delta=0.5)
            self.assertAlmostEqual(row.max(), 4.4e-6, delta=0.01 * 4.4e-6)  # between two points of the padded spectrum
            self.assertLess(row[frequency < 100.0].max(), 1e-3 * 4.4e-6)  # side lobes of the window fall as 1/f^3

    def test_a_tone_has_its_frequency_and_amplitude(self):
        time = 5e-5 * np.arange(1, 1001)
        times, frequency, amplitude = fig_spectrogram.spectrogram(
            3e-6 * np.sin(2 * np.pi * 400.0 * time), 5e-5, 300)
        inside = times > 0.02  # windows that start within the run
        for column in amplitude[:, inside].T:
            top = column.argmax()
            self.assertLess(abs(frequency[top] - 400.0), 17.0)  # resolution of 1/60 ms
            self.assertAlmostEqual(column[top] / 3e-6, 1.0, delta=0.02)  # 1.4 % between two frequencies

    def test_a_tone_that_repeats_has_no_beginning(self):
        time = 5e-5 * np.arange(1, 401)
        u = 3e-6 * np.sin(2 * np.pi * 400.0 * time)  # 8 cycles in 20 ms
        times, frequency, amplitude = fig_spectrogram.spectrogram(u, 5e-5, 133, repeats=True)
        self.assertLess(times[0], 1e-3)
        self.assertGreater(times[-1], 19e-3)
        top = amplitude.max(axis=0)  # 3 %: between two frequencies, and side lobes that depend on the phase
        np.testing.assert_allclose(top, 3e-6, rtol=0.03)

    def test_the_time_of_a_window_is_its_middle(self):
        u = np.zeros(400)
        u[200] = 1.0
        times, _, amplitude = fig_spectrogram.spectrogram(u, 1e-4, 80)
        moment = times[amplitude[40].argmax()]
        self.assertLess(abs(moment - 201e-4), 2e-4)  # sample 200 is at 201 intervals; two steps


class BandTest(InFolder):
    def setUp(self):
        super().setUp()
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars={"share_100_500_1": 0.2})
        self.loaded = load.load(folder.save())

    def test_bands_are_columns_of_the_table(self):
        sweep = self.loaded
        sweep.cases[0].parameters["measure"]["bands_Hz"] = [100.0, 500.0, 500.0, 1000.0]
        shares = fig_frequency.bands(sweep)
        self.assertEqual(list(shares), ["share_100_500_1", "velocity_share_100_500_1", "share_500_1000_1", "velocity_share_500_1000_1"])
        self.assertEqual([fig_curves.has_any(sweep, column) for column in shares], [True, False, False, False])

    def test_the_perceptible_band_is_drawn_if_the_job_has_no_bands(self):
        self.assertEqual(list(fig_frequency.bands(self.loaded)), ["rms_40_400_um"])


class WordsTest(unittest.TestCase):
    def test_inline_tables_are_formatted_as_text(self):
        for value, expected in (
                ('{ shape = "circle", radius_mm = 15 }', "circle, radius 15 mm"),
                ('{ shape = "polygon", sides = 4, side_mm = 30 }', "square, side 30 mm"),
                ('{ shape = "gaussian", fwhm_mm = 10.2 }', "gaussian, FWHM 10.2 mm"),
                ('{ shape = "array", preset = "array-16x16", distance_mm = 200.0 }',
                 "array-16x16, distance 200 mm"),
                ("{ broken", "{ broken"), ("AM-STM", "AM-STM")):
            with self.subTest(value=value):
                found = words.value_text("load.footprint", value)
                self.assertEqual(found.replace("\N{NO-BREAK SPACE}", " "), expected)

    def test_foci_are_counted(self):
        for value, expected in (("[[1, 0]]", "1 focus"), ("[[1, 0], [-1, 0]]", "2 foci")):
            self.assertEqual(words.value_text("load.modulation.foci_mm", value), expected)

    def test_frequencies_that_are_swept_together_have_a_common_name(self):
        sm = AM.replace("am_", "sm_")
        for second, expected in ((200.0, "modulation frequency"), (300.0, "AM frequency")):
            with self.subTest(second=second), tempfile.TemporaryDirectory() as root:
                folder = Folder(root, swept=[AM, sm])
                folder.add({AM: 100.0, sm: 100.0}, written=False)
                folder.add({AM: 200.0, sm: second}, written=False)
                self.assertEqual(labels.name(load.load(folder.save()), AM), expected)
