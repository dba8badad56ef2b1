# SPDX-License-Identifier: BSD-3-Clause
"""References that depend on a swept key, and figures with several curves."""

from synthetic import AM, FWHM, Folder, InFolder, case_id, plain

from shearwake.report import layout, load, references
from shearwake.report.figures import fig_drive, fig_measures, fig_surface, fig_time
from shearwake.report.page import curve_chart


class ReferencesTest(InFolder):
    def with_own_references(self, widths=(3.0,)):
        """Three draw frequencies, each with its own reference, for each width."""
        draw = "load.modulation.draw_frequency_Hz"
        folder = Folder(self.root, x=draw, series=[FWHM], swept=[draw, FWHM])
        count = 3 * len(widths)
        for n, f in enumerate((50.0, 75.0, 100.0)):
            for m, width in enumerate(widths):
                folder.add({draw: f, FWHM: width}, case_id(count + 1 + n * len(widths) + m))
        for f in (50.0, 75.0, 100.0):
            for width in widths:
                folder.add({draw: f, FWHM: width}, is_reference=True, kind="STM", strength=f * width**2)
        return load.load(folder.save())

    def test_references_that_depend_on_a_key_appear_once_per_value_with_their_label(self):
        sweep = self.with_own_references()
        cells, columns = fig_surface.cells(sweep)
        self.assertEqual(columns, 2)
        labels = [plain(layout.case_label(sweep, c)) for c in cells]
        self.assertEqual(labels, [first + f"draw frequency {f} Hz" for f in (50, 75, 100)
                                  for first in ("plain STM, ", "")])

    def test_references_with_the_same_values_are_one_line(self):
        def labels(sweep):
            lines = curve_chart.curve_chart(sweep, "eta", "eta_period_1", "eta").lines
            return [line.label for line in lines if line.dashed]

        sweep = self.with_own_references(widths=(2.0, 3.0))
        self.assertEqual(labels(sweep), ["plain STM"])
        sweep.reference_of(sweep.cases[0]).values["eta_period_1"] = 0.3
        self.assertEqual(len(labels(sweep)), 2)

    def test_a_reference_of_several_curves_is_one_line_in_the_colour_of_the_first(self):
        kind = "load.modulation.am_depth"
        folder = Folder(self.root, series=[FWHM, kind], swept=[AM, FWHM, kind])
        for width in (2.0, 3.0):
            for depth in (0.5, 1.0):
                for f in (100.0, 200.0):
                    folder.add({AM: f, FWHM: width, kind: depth}, case_id(9 if width < 2.5 else 10))
        for width, eta in ((2.0, 0.2), (3.0, 0.3)):
            folder.add({FWHM: width}, is_reference=True, kind="STM", strength=width, scalars={"eta_period_1": eta})
        sweep = load.load(folder.save())
        lines = curve_chart.curve_chart(sweep, "eta", "eta_period_1", "eta").lines
        dashed = [(plain(line.label), line.colour) for line in lines if line.dashed]
        self.assertEqual(dashed, [("plain STM, focus FWHM 2 mm", lines[0].colour), ("plain STM, focus FWHM 3 mm", lines[2].colour)])
        eta = fig_measures.figures(sweep)[0]
        self.assertIn("A line that belongs to several curves has the colour of the first of them.", eta.caption)

    def test_lines_over_time_of_two_swept_keys_have_a_panel_per_curve_and_different_names(self):
        sweep = self.with_own_references(widths=(2.0, 3.0))
        figure = fig_time.figures(sweep)[0]
        self.assertEqual([plain(panel.title) for panel in figure.charts],
                         ["focus FWHM 2 mm", "focus FWHM 3 mm"])
        names = [line.label for panel in figure.charts for line in panel.lines]
        self.assertEqual(len(names), 12)
        self.assertEqual(len(set(names)), 12)
        for panel in figure.charts:  # what the caption describes is in the chart
            self.assertEqual([(m.kind, m.x, m.end) for m in panel.marks], [("band", 0.0, 1.0), ("line", 4.0, None)])
        for words in ("Shaded:", "Dotted line:", "Dashed: plain STM", "The colour is the draw frequency"):
            self.assertIn(words, figure.caption)

    def test_curves_with_other_references_have_their_own_column_of_references(self):
        sweep = self.with_own_references(widths=(2.0, 3.0))
        cells, columns = fig_surface.cells(sweep)
        self.assertEqual(columns, 4)
        shown = [c.id for c in cells if c.is_reference]
        self.assertEqual(len(shown), 6)
        self.assertEqual(len(set(shown)), 6)

    def test_figures_of_a_few_cases_pair_each_case_with_its_reference(self):
        sweep = self.with_own_references()
        for chosen in (references.first_and_last(sweep, 4), fig_drive.chosen(sweep)):
            self.assertEqual([c.is_reference for c in chosen], [True, False, True, False])
            for reference, case in zip(chosen[::2], chosen[1::2]):
                self.assertIs(sweep.reference_of(case), reference)
