# SPDX-License-Identifier: BSD-3-Clause
"""How the report shows readings that are not valid: curves, heat maps, interactive figures, and the warnings next to the
figures."""
import re

import numpy as np
import pytest
from synthetic import AM, FWHM, Folder, InFolder, case_id

from shearwake.report import labels, load, style, warnings_of
from shearwake.report.figures import fig_heat, fig_measures, fig_multiples, fig_surface
from shearwake.report.page import chart, curve_chart

INVALID = {"severity": "error", "key": "domain.extent_mm", "message": "waves return at 4.8 ms"}
COARSE = {"severity": "warning", "key": "domain.spacing_mm", "message": "3 points per wavelength"}
DEPTH, CARRIER = "load.modulation.am_depth", "afferents.carrier.am_depth"


class ValidityTest(InFolder):
    def curve(self, reference_warnings=()):
        """Three frequencies and a reference; 200 Hz is not valid and far above the others."""
        folder = Folder(self.root)
        for f, eta, warnings in ((100.0, 0.3, []), (200.0, 9.0, [INVALID]), (400.0, 0.5, [COARSE])):
            folder.add({AM: f}, case_id(4), scalars={"eta_period_1": eta, "focal_rms_um": eta}, warnings=warnings)
        folder.add({}, is_reference=True, kind="STM", scalars={"eta_period_1": 0.2, "focal_rms_um": 1.0},
                   warnings=list(reference_warnings))
        return folder

    def grid(self, invalid):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        for f in (100.0, 200.0, 400.0):
            for width in (2.0, 3.0, 6.0):
                wrong = (f, width) in invalid
                folder.add({AM: f, FWHM: width}, scalars={"eta_period_1": 99.0 if wrong else 0.1 * width},
                           snapshot=False, warnings=[INVALID] if wrong else [])
        return folder

    @staticmethod
    def marked(axes, marker):
        """The finite points (x, y) of the lines with this marker."""
        lines = [line.get_xydata() for line in axes.get_lines() if line.get_marker() == marker]
        points = np.concatenate(lines) if lines else np.empty((0, 2))
        return [tuple(p) for p in points[np.isfinite(points).all(axis=1)]]

    def test_readings_that_are_not_valid_are_grey_crosses_off_the_curve(self):
        _, figures, kept = self.drawn(self.curve(), fig_measures)
        for name, low, high, wrong in (("eta", 0.3, 0.5, 9.0), ("strength", 0.3, 0.5, 9.0)):
            axes = kept[name].axes[0]
            self.assertEqual(self.marked(axes, "o"), [(100.0, low), (400.0, high)])
            self.assertEqual(self.marked(axes, "x"), [(200.0, wrong)])
            self.assertIn("not valid: 1 case.", figures[name].caption)
        crosses = [line for line in kept["eta"].axes[0].get_lines() if line.get_marker() == "x"]
        self.assertEqual({line.get_color() for line in crosses}, {style.GREY})

    def test_ratios_to_a_reference_that_is_not_valid_are_not_valid(self):
        _, figures, kept = self.drawn(self.curve([INVALID]), fig_measures)
        self.assertEqual(self.marked(kept["gain"].axes[0], "o"), [])
        self.assertEqual(len(self.marked(kept["gain"].axes[0], "x")), 3)
        self.assertIn("not valid: 3 cases.", figures["gain"].caption)
        self.assertIn("not valid: 2 cases, 1 of them a reference.", figures["eta"].caption)
        self.assertEqual(len(self.marked(kept["eta"].axes[0], "x")), 4)  # one case, and its reference at each frequency

    def test_interactive_curves_have_crosses_where_readings_are_not_valid(self):
        sweep = load.load(self.curve([INVALID]).save())
        lines = chart.chart_data(curve_chart.curve_chart(sweep, "eta", "eta_period_1", "eta"))["lines"]
        shown = {line["label"]: (line["y"], line["crossed"], line["dashed"]) for line in lines}
        self.assertEqual(shown["AM-STM"], ([0.3, None, 0.5], False, False))
        self.assertEqual(shown["AM-STM, not valid"], ([None, 9.0, None], True, False))
        self.assertNotIn("plain STM", shown)
        self.assertEqual(shown["plain STM, not valid"], ([0.2] * 3, True, False))

    def test_cells_that_are_not_valid_are_crossed_and_outside_of_the_colour_scale(self):
        _, figures, kept = self.drawn(self.grid({(200.0, 3.0), (400.0, 6.0)}), fig_heat)
        figure, axes = figures["heat_eta_period_1"], kept["heat_eta_period_1"].axes[0]
        image, = axes.get_images()
        self.assertAlmostEqual(image.norm.vmax, 0.6)
        self.assertEqual(int(np.isnan(image.get_array().filled(np.nan)).sum()), 2)
        crosses, = axes.get_lines()
        self.assertEqual(np.isfinite(crosses.get_xdata()).sum(), 8)  # two diagonals per cell
        self.assertEqual((axes.get_xlim(), axes.get_ylim()), ((-0.5, 2.5), (-0.5, 2.5)))
        self.assertIn("2 cases not valid, excluded from the colour scale", figure.caption)
        held, = figure.maps
        self.assertEqual(held["invalid"], [4, 8])  # cells of (row, column) = (1, 1) and (2, 2)
        self.assertEqual(held["values"][4], 99.0)

    def test_a_grid_without_valid_cells_has_no_heat_map(self):
        folder = self.grid({(f, w) for f in (100.0, 200.0, 400.0) for w in (2.0, 3.0, 6.0)})
        self.assertNotIn("heat_eta_period_1", self.drawn(folder, fig_heat)[1])

    def test_small_multiples_have_crosses(self):
        speed = "load.modulation.speed_m_s"
        folder = Folder(self.root, series=[FWHM, speed], swept=[AM, FWHM, speed])
        for f in (100.0, 200.0, 400.0):
            for width in (2.0, 3.0, 6.0):
                for v in (3.0, 5.0, 7.0):
                    folder.add({AM: f, FWHM: width, speed: v}, snapshot=False, warnings=[INVALID] if f == 200.0 else [])
        _, figures, kept = self.drawn(folder, fig_multiples)
        self.assertIn("not valid: 9 cases.", figures["multiples_eta_period_1"].caption)
        for axes in kept["multiples_eta_period_1"].axes:
            self.assertEqual({x for x, _ in self.marked(axes, "x")}, {200.0})
            self.assertEqual({x for x, _ in self.marked(axes, "o")}, {100.0, 400.0})

    def test_panels_of_cases_that_are_not_valid_say_so(self):
        _, figures, kept = self.drawn(self.curve(), fig_surface)
        titles = [axes.get_title(loc="left") for axes in kept["surface"].axes]
        self.assertEqual([title.replace("\n", " ").endswith("(not valid)") for title in titles[:4]],
                         [False, False, True, False])
        self.assertEqual(len(figures["surface"].cases), 4)

    @pytest.mark.extended
    def test_a_figure_names_only_the_warnings_of_the_cases_that_it_shows(self):
        text = self.curve().report()
        blocks = {name: block for name, block in re.findall(r'<h[23] id="(\w+)">(.*?)</figure>', text, re.DOTALL)}
        self.assertEqual(text.count("waves return at 4.8 ms (AM frequency 200"), 1)
        self.assertIn('href="#warning-1" title="waves return at 4.8 ms">not valid: waves return at 4.8 ms</a> (1 case)', blocks["eta"])
        # What does not make a reading wrong is stated once, at the first figure that it concerns.
        self.assertEqual(text.partition('<h2 id="table">')[0].count('href="#warning-2"'), 1)
        self.assertLess(text.index('href="#warning-2"'), text.index('id="eta"'))
        self.assertNotIn("#warning", blocks["drive"])
        # The result and its figures come first; a line below the result links to the list of warnings.
        self.assertLess(text.index('href="#warnings">2 warnings, 1 case not valid</a>'), text.index('id="player"'))
        self.assertLess(text.index('id="player"'), text.index('id="eta"'))
        self.assertLess(text.index('id="eta"'), text.index('id="warnings"'))
        self.assertLess(text.index('id="warnings"'), text.index('id="topic-'))
        sweep = load.load(self.root)
        self.assertEqual([k.key for k in warnings_of.of_figure(sweep, "surface", [case_id(1), case_id(3)])],
                         ["domain.spacing_mm"])
        self.assertEqual(warnings_of.of_figure(sweep, "surface", [case_id(1)]), [])

    @pytest.mark.extended
    def test_a_sweep_without_warnings_has_no_list(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        self.assertNotIn('id="warnings"', folder.report())

    @pytest.mark.extended
    def test_the_filter_names_the_figures_that_it_affects(self):
        page = self.curve().report()
        named = re.search(r"one line per case: (.*?)\. All other", page, re.DOTALL).group(1)
        names = set(re.findall(r'href="#(\w+)"', named))
        holders = re.findall(r'<div class="chart" id="chart-(\w+)"><script type="application/json">(.*?)</script>', page)
        self.assertEqual(names, {name for name, data in holders if '"case":' in data})
        self.assertIn("eta_time", names)
        self.assertNotIn("eta", names)
        self.assertEqual(set(), names - {name for name, _ in holders})

    def test_keys_of_the_same_name_are_distinct_unless_they_have_the_same_values(self):
        folder = Folder(self.root, x=DEPTH, swept=[DEPTH, CARRIER])
        for depth, other in ((0.0, 0.5), (1.0, 1.0)):
            folder.add({DEPTH: depth, CARRIER: other})
        sweep = load.load(folder.save())
        self.assertEqual(labels.settings_text(sweep, sweep.cases[0]), "AM depth of modulation = 0, AM depth of carrier = 0.5")
        self.assertEqual(labels.axis_label(sweep, DEPTH), "AM depth, modulation")
        for case in sweep.cases:
            case.settings[CARRIER] = case.settings[DEPTH]
        self.assertEqual(labels.settings_text(sweep, sweep.cases[0]), "AM depth 0")

    def test_references_per_value_of_x_have_crosses(self):
        draw = "load.modulation.draw_frequency_Hz"
        folder = Folder(self.root, x=draw, swept=[draw])
        for n, f in enumerate((50.0, 75.0, 100.0)):
            folder.add({draw: f}, case_id(4 + n))
        for f in (50.0, 75.0, 100.0):
            folder.add({draw: f}, is_reference=True, kind="STM", scalars={"eta_period_1": 0.2 + 1e-3 * f},
                       warnings=[INVALID] if f == 75.0 else [])
        sweep = load.load(folder.save())
        lines = curve_chart.curve_chart(sweep, "eta", "eta_period_1").lines
        self.assertEqual([line.label for line in lines], ["AM-STM", "plain STM, not valid", "plain STM"])
        np.testing.assert_array_equal(lines[1].y, [np.nan, 0.275, np.nan])
