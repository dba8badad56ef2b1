# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the Python package for papers."""
from unittest import mock

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
import pytest

import shearwake
from shearwake import plot
from study import InFolder, job


class Plots(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep = job().run()

    def setUp(self):
        self.addCleanup(plt.close, "all")

    def test_a_column_is_drawn_against_the_swept_key_with_its_label_and_reference(self):
        figure = self.sweep.plot("eta_period_1")
        self.assertIsInstance(figure, Figure)
        axes, = figure.axes
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("AM frequency (Hz)", "efficiency η"))
        drawn = next(line for line in axes.lines if len(line.get_xdata()) == len(self.sweep))
        np.testing.assert_array_equal(drawn.get_ydata(), [case.value("eta_period_1") for case in self.sweep])
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["AM-STM", "plain STM"])
        with self.assertRaisesRegex(KeyError, "did you mean eta_period_1"):
            self.sweep.plot("eta_periood_1")

    @pytest.mark.extended
    def test_every_figure_of_the_report_is_a_figure_or_was_not_recorded(self):
        recorded = {"drive", "medium", "over_time", "profiles", "snapshots", "spectra", "spectrogram", "traces"}
        for drawn, expected in ((self.sweep.cases[1].plot, recorded), (self.sweep.plot, recorded | {"measures", "frequencies"})):
            made = set()
            for name in drawn._modules:
                self.assertIn(name, dir(drawn))
                try:
                    self.assertIsInstance(getattr(drawn, name)(), Figure)
                    made.add(name)
                except shearwake.NotRecorded as error:
                    self.assertIn(f"there is no figure {name}", str(error))
            self.assertEqual(made & expected, expected)
        self.assertIsInstance(self.sweep.plot.measures("gain"), Figure)
        with self.assertRaisesRegex(shearwake.NotRecorded, "no figure measures gian: the figures of this name are eta, gain"):
            self.sweep.plot.measures("gian")
        with self.assertRaisesRegex(AttributeError, "the figures are drive, "):
            self.sweep.cases[0].plot.heat_maps()

    def test_a_case_file_opened_by_itself_has_no_figures_of_the_report(self):
        case = shearwake.open_case(self.sweep.cases[0].path)
        self.assertIsInstance(case.plot.wake(), Figure)
        with self.assertRaisesRegex(shearwake.NotRecorded, f"shearwake.open\\(FOLDER\\)\\['{case.id}'\\]"):
            case.plot.traces()

    @pytest.mark.extended
    def test_the_style_for_papers_has_the_width_of_columns_and_text_that_remains_text(self):
        before = dict(plt.rcParams)
        for columns, width_in in ((1, 3.5), (2, 7.2)):
            with shearwake.style("paper", columns=columns):
                for figure in (self.sweep.plot("peak_um"), self.sweep.cases[0].plot.traces(), self.sweep.cases[0].plot.wake()):
                    self.assertEqual(figure.get_figwidth(), width_in)
                    size_pt = {text.get_fontsize() for axes in figure.axes for text in axes.get_xticklabels()}
                    self.assertEqual(size_pt, {7.0})
                figure.savefig("figure")
                figure.savefig("figure.svg")
        self.assertEqual(dict(plt.rcParams), before)
        with open("figure.pdf", "rb") as file:
            self.assertNotIn(b"/Type3", file.read())  # outlines, which cannot be edited
        with open("figure.svg", encoding="utf-8") as file:
            self.assertIn(">x (mm)<", file.read())
        with self.assertRaisesRegex(ValueError, '"paper" with 1 or 2 columns, not \'poster\' with 1'):
            shearwake.style("poster", columns=1)

    def test_without_a_chosen_style_the_parameters_of_the_script_do_not_enter(self):
        with plt.rc_context({"lines.marker": "x", "font.size": 30.0}):
            figure = self.sweep.plot("eta_period_1")
            self.assertEqual(figure.axes[0].xaxis.label.get_fontsize(), 9.5)
            self.assertEqual(plt.rcParams["font.size"], 30.0)

    def test_a_notebook_shows_a_figure_once(self):
        with mock.patch.object(plt, "get_backend", return_value="module://matplotlib_inline.backend_inline"):
            self.sweep.plot("eta_period_1")
        self.assertEqual(plt.get_fignums(), [])
        self.assertTrue(plot.OF_CASES.keys().isdisjoint(plot.OF_SWEEPS))
