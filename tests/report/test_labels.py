# SPDX-License-Identifier: BSD-3-Clause
"""Numbers in heat maps, legends, lines of references, and the scale of a uniform medium."""
import math

import pytest
from synthetic import AM, FWHM, Folder, InFolder, case_id, sweep

from shearwake.report import layout, load, style
from shearwake.report.figures import fig_frequency, fig_heat, fig_measures, fig_medium
from shearwake.report.style import plt
from shearwake.report.words import number
import texts


class LabelsTest(InFolder):
    def grid(self, frequencies, widths):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        for n in range(frequencies):
            for k in range(widths):
                folder.add({AM: 50.0 * (n + 1), FWHM: 2.0 + k}, scalars={"eta_period_1": 0.1231 + 0.01 * n + 0.1 * k},
                           snapshot=False)
        return folder

    def numbers(self, frequencies, widths):
        """The texts in the cells of a heat map, which do not overlap."""
        figure = self.drawn(self.grid(frequencies, widths), fig_heat)[2]["heat_eta_period_1"]
        self.assertEqual(texts.problems(figure), [])
        return figure.axes[0].texts

    def test_the_text_of_a_job_has_no_byte_order_mark(self):
        folder = Folder(self.root, job="\ufeffschema = 1\n")
        folder.add({AM: 100.0}, snapshot=False)
        self.assertEqual(load.load(folder.save()).sweep.job_text, "schema = 1\n")

    def test_numbers_in_wide_cells_are_horizontal(self):
        found = self.numbers(4, 3)
        self.assertEqual((len(found), {text.get_rotation() for text in found}), (12, {0.0}))

    @pytest.mark.extended
    def test_numbers_in_narrow_cells_are_turned(self):
        found = self.numbers(17, 3)
        self.assertEqual((len(found), {text.get_rotation() for text in found}), (51, {90.0}))

    def test_numbers_that_do_not_fit_are_omitted(self):
        self.assertIsNone(fig_heat.rotation(["0.123"], (30, 30)))

    def test_the_motion_that_is_felt_has_the_line_of_its_reference(self):
        figure = self.drawn(sweep(self.root), fig_frequency)[2]["frequency"]
        motion = next(axes for axes in figure.axes if "40 to 400" in axes.get_title(loc="left"))
        legend, = figure.legends
        self.assertEqual([text.get_text() for text in legend.get_texts()], ["AM-STM", "plain STM"])
        reference, = (line for line in motion.lines if line.get_label() == "plain STM")
        self.assertEqual(set(reference.get_ydata()), {0.3})
        self.assertLess(0.3, motion.get_ylim()[1], "the line is visible")

    def test_entries_of_legends_state_the_key_once(self):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        for n, width in enumerate((2.0, 3.0)):
            folder.add({AM: 100.0, FWHM: width}, case_id(n + 5))
            folder.add({AM: 200.0, FWHM: width}, case_id(n + 5))
        legend, = self.drawn(folder, fig_measures)[2]["eta"].legends
        self.assertEqual([text.get_text() for text in legend.get_texts()], ["focus FWHM 2\u00a0mm", "focus FWHM 3\u00a0mm"])
        self.assertEqual(legend.get_title().get_text(), "")

    def test_titles_are_not_wrapped_at_an_equals_sign(self):
        wrapped = layout.wrapped("depth of body 1 = 5\u00a0mm, shear-wave speed of body 1 = 1600\u00a0m/s", 2.0)
        self.assertIn("\n", wrapped)
        for line in wrapped.replace("\u00a0", " ").splitlines():
            self.assertFalse(line.endswith(("=", "body")) or line.startswith(("=", "1")), wrapped)

    def test_ticks_of_a_scale_around_one_do_not_touch(self):
        for most in (1.01, 1.08, 1.3, 2.2, 12.0):
            ticks = [math.log(tick) for tick in style.ratio_ticks((1.0 / most, most))]
            self.assertIn(0.0, ticks)
            self.assertTrue(all(len(number(math.exp(tick))) <= 5 for tick in ticks))  # 0.8, not 0.8333
            # A label takes a tenth of half a panel of 2.6 inches.
            self.assertGreater(min(b - a for a, b in zip(ticks, ticks[1:])), 0.1 * math.log(most), most)

    def test_a_uniform_medium_has_a_text_instead_of_a_scale(self):
        figure, (bar, plane) = plt.subplots(2)
        image = plane.imshow([[5.0, 5.0]])
        fig_medium.draw_scale(figure, image, bar, [5.0])
        self.assertEqual([text.get_text() for text in bar.texts], ["The shear-wave speed is 5 m/s everywhere."])
        plt.close(figure)
