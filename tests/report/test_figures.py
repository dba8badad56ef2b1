"""Tests what the figures of a report are drawn from: axes of a sweep, heat maps, spectrograms.

Run: python3 tests/report/test_figures.py    (unittest, numpy, h5py, matplotlib; seconds)
"""
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from test_report import AM, FWHM, Folder, Page, case_id  # noqa: E402

import fig_frequency  # noqa: E402
import fig_heat  # noqa: E402
import fig_intensity  # noqa: E402
import fig_measures  # noqa: E402
import fig_multiples  # noqa: E402
import fig_spectrogram  # noqa: E402
import layout  # noqa: E402
import load  # noqa: E402
import player  # noqa: E402

SPEED = "load.modulation.speed_m_s"
SPACING = "domain.spacing_mm"


def grid(root, frequencies=(100.0, 200.0, 400.0), widths=(2.0, 3.0, 6.0), speeds=(5.0,), **content):
    """A sweep of three keys; the spacing follows the speed."""
    keys = [AM, FWHM, SPEED, SPACING]
    folder = Folder(root, series=keys[1:], swept=keys)
    for f in frequencies:
        for width in widths:
            for speed in speeds:
                folder.add({AM: f, FWHM: width, SPEED: speed, SPACING: 5.0 / speed},
                           scalars={"eta_period_1": 1e-3 * f + width + 10 * speed}, **content)
    return folder


class FolderTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = Path(self.temporary.name)

    def test_a_key_that_follows_another_is_no_axis(self):
        sweep = load.load(grid(self.root, speeds=(5.0, 7.0)).save())
        self.assertEqual(layout.axes(sweep), [AM, FWHM, SPEED])

    def test_two_swept_keys_make_heat_maps_that_hold_every_case(self):
        folder = grid(self.root)
        failed = folder.add({AM: 800.0, FWHM: 2.0, SPEED: 5.0, SPACING: 1.0}, written=False)
        folder.fail(failed, "not finite")
        page = Page(folder.report())
        self.assertIn("heat_eta_period_1", {i.split(".")[0] for i in self.names()})
        sweep = load.load(self.root)
        x, y, others = fig_heat.plane(sweep)
        self.assertEqual((x, y, others), (AM, FWHM, []))
        values, broken = fig_heat.cells(sweep, "eta_period_1", x, y, others, ())
        self.assertEqual(values.shape, (3, 4))
        self.assertEqual(values[1, 2], 1e-3 * 400.0 + 3.0 + 50.0)  # row: 3 mm, column: 400 Hz
        self.assertEqual(np.argwhere(broken).tolist(), [[0, 3]])
        self.assertTrue(np.isnan(values[1, 3]) and not broken[1, 3])  # was not swept
        self.assertIn("Crossed: 1 without a result", page.data)
        self.assertIn("Hatched: 2 without this reading", page.data)

    def names(self):
        return [p.name for p in (self.root / "report").iterdir()]

    def draw(self, folder, *modules):
        """The sweep, with the figures of these modules alone: a whole report takes seconds."""
        sweep = load.load(folder.save())
        (self.root / "report").mkdir()
        for module in modules:
            module.figures(sweep, self.root / "report")
        return sweep

    def test_three_swept_keys_make_small_multiples(self):
        folder = grid(self.root, speeds=(3.0, 5.0, 7.0, 9.0))
        sweep = self.draw(folder, fig_multiples, fig_measures)
        self.assertIn("multiples_eta_period_1.pdf", self.names())
        self.assertNotIn("eta.png", self.names())  # twelve curves in one panel
        x, y, others = fig_heat.plane(sweep)
        self.assertEqual((x, y, others), (AM, SPEED, [FWHM]))
        self.assertEqual(fig_heat.panels(sweep, others), ([(2.0,), (3.0,), (6.0,)], 3))

    def test_words_are_an_axis_of_a_heat_map(self):
        kind = "load.modulation.kind"
        folder = Folder(self.root, x=AM, series=[kind], swept=[AM, kind])
        for f in (100.0, 200.0, 400.0):
            for name in ("STM", "AM-STM", "SM-STM"):
                folder.add({AM: f, kind: name}, kind=name)
        sweep = self.draw(folder, fig_heat, fig_measures)
        self.assertEqual(layout.values_of(sweep, kind), ["STM", "AM-STM", "SM-STM"])
        self.assertIn("heat_eta_period_1.png", self.names())
        self.assertIn("eta.png", self.names())  # three curves fit one panel, too

    def test_of_a_large_sweep_a_few_cases_have_panels(self):
        values = [50.0 * n for n in range(1, 16)]
        sweep = load.load(grid(self.root, values, (1.0, 2.0, 3.0, 4.0), snapshot=False).save())
        some = layout.few(sweep)
        self.assertEqual(len(layout.ordinary(sweep)), 60)
        self.assertEqual(len(layout.ordinary(some)), 24)  # three curves of eight cases
        shown = layout.values_of(some, AM)
        self.assertEqual((shown[0], shown[-1]), (50.0, 750.0))
        self.assertIs(layout.few(some), some)
        self.assertEqual(layout.group_keys(some), layout.group_keys(sweep))

    def test_every_frame_makes_an_intensity_and_a_slider(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, frames=True)
        page = Page(folder.report())
        self.assertIn("intensity.png", self.names())
        self.assertIn("input", page.tags)
        case = load.load(self.root).cases[0]
        x, y, square = load.mean_square(case)
        with_settled = [t for t in case.series["time"] if t >= 0.001]
        spots = [np.exp(-((x[:, None] - 7.0 * t) ** 2 + y[None, :] ** 2) / 8e-6) * 3e-6
                 for t in with_settled]
        mean = np.mean(np.square(spots), axis=0)
        np.testing.assert_allclose(square, mean, rtol=1e-12)  # sums of 30: rounding

    def test_few_snapshots_are_no_average(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        sweep = self.draw(folder, fig_intensity)
        self.assertIsNone(load.mean_square(sweep.cases[0]))
        self.assertNotIn("intensity.png", self.names())

    def test_frames_are_thinned_until_the_page_can_hold_them(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, frames=True)
        sweep = load.load(folder.save())
        self.addCleanup(setattr, player, "BUDGET_bytes", player.BUDGET_bytes)
        player.BUDGET_bytes = 20_000
        shots, _, _ = player.thinned(player.chosen(sweep))
        self.assertLess(len(shots[0]), 40)
        self.assertGreater(len(shots[0]), 1)
        self.assertEqual((shots[0][0].t_s, shots[0][-1].t_s), (1e-4, 4e-3))  # first and last stay


class SpectrogramTest(unittest.TestCase):
    def test_a_tone_stands_at_its_frequency_with_its_amplitude(self):
        time = 5e-5 * np.arange(1, 1001)
        times, frequency, amplitude = fig_spectrogram.spectrogram(
            3e-6 * np.sin(2 * np.pi * 400.0 * time), 5e-5, 300)
        inside = times > 0.02  # windows that do not reach back before the beginning
        for column in amplitude[:, inside].T:
            top = column.argmax()
            self.assertLess(abs(frequency[top] - 400.0), 17.0)  # one step of frequency, 1/60 ms
            self.assertAlmostEqual(column[top] / 3e-6, 1.0, delta=0.02)  # between two steps: 1.4 %

    def test_a_moment_is_the_middle_of_its_window(self):
        u = np.zeros(400)
        u[200] = 1.0
        times, _, amplitude = fig_spectrogram.spectrogram(u, 1e-4, 80)
        moment = times[amplitude[40].argmax()]
        self.assertLess(abs(moment - 201e-4), 2e-4)  # sample 200 is at 201 intervals; two steps


class BandTest(unittest.TestCase):
    def test_a_band_holds_the_tone_within_it(self):
        time = 5e-5 * np.arange(1, 2001)
        u = np.sin(2 * np.pi * 200.0 * time) + 2.0 * np.sin(2 * np.pi * 700.0 * time)
        share = fig_frequency.energy_share(u, 5e-5, 100.0, 500.0)
        self.assertAlmostEqual(share, 1.0 / 5.0, delta=0.01)  # what leaks: width/distance = 1 %

    def test_silence_has_no_share(self):
        self.assertTrue(math.isnan(fig_frequency.energy_share(np.zeros(100), 5e-5, 40.0, 400.0)))


class SharpnessTest(unittest.TestCase):
    def test_it_is_the_energy_within_one_fwhm_of_the_path(self):
        case = load.Case(case_id(1), {}, False, "", Path("none"))
        case.series = {"time": np.array([0.0, 1.0]), "focus_x": np.array([0.0, 0.01]),
                       "focus_y": np.zeros(2)}
        case.physics = {"load": {"fwhm_m": 0.002}}
        x, y = 1e-3 * np.arange(-20, 31), 1e-3 * np.arange(-20, 21)
        square = np.zeros((len(x), len(y)))
        square[25, 21], square[25, 26] = 3.0, 1.0  # 1 mm and 6 mm beside the middle of the line
        self.assertAlmostEqual(fig_intensity.sharpness(case, x, y, square), 0.75)
        square[37, 20] = 4.0  # 7 mm beyond its end
        self.assertAlmostEqual(fig_intensity.sharpness(case, x, y, square), 0.375)
        case.physics["domain"] = {"sponge_m": 0.0145}  # takes x above 15.5 mm, |y| above 5.5 mm
        self.assertAlmostEqual(fig_intensity.sharpness(case, x, y, square), 1.0)

    def test_simultaneous_foci_draw_a_path_each(self):
        case = load.Case(case_id(1), {}, False, "", Path("none"))
        case.series = {"time": np.array([0.0, 1.0]), "focus_x": np.array([0.0, 0.01]),
                       "focus_y": np.zeros(2)}
        case.physics = {"load": {"fwhm_m": 0.002, "modulation": {"foci_x_m": [0.0, 0.0],
                                                                 "foci_y_m": [0.005, -0.005]}}}
        x, y = 1e-3 * np.arange(-20, 31), 1e-3 * np.arange(-20, 21)
        near = fig_intensity.along(case, 0.0025, x, y)
        self.assertTrue(near[25, 13] and near[25, 27])  # 2 mm beside each line
        self.assertFalse(near[25, 20])  # the place between them


if __name__ == "__main__":
    unittest.main()
