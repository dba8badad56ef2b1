#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the report states as its result, and the warnings that it prints: readings that are not valid, missing
cases, numerical parameters, numerical errors, references that depend on a swept key.

Run: python3 tests/report/test_headlines.py    (unittest, numpy, h5py, matplotlib; seconds)
"""
import json
import tempfile
import unittest

from synthetic import AM, FWHM, Folder, Page, case_id

import fig_drive
import fig_surface
import layout
import load
import references
import warnings_of
from summary import summary

ENGINE = "solver.engine"
RETURNS = {"severity": "warning", "key": "domain.extent_mm", "message": "waves return at 4.8 ms"}
INVALID = {**RETURNS, "severity": "error"}
WINDOW = {"severity": "warning", "key": "measure.at_ms", "message": "the path ends at 3 ms"}


class HeadlineTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name

    def folder(self, etas, key=AM, **options):
        """One case per efficiency, with the key at 100, 200, ..."""
        folder = Folder(self.root, x=key, swept=[key], **options)
        for n, eta in enumerate(etas):
            folder.add({key: 100.0 * (n + 1)}, scalars={"eta_period_1": eta})
        return folder

    def result(self, folder):
        return summary(load.load(folder.save())).replace("\N{NO-BREAK SPACE}", " ")

    def errors(self, folder, errors):
        """The errors of eta of some cases, as `shearwake converge` stores them."""
        (folder.path / "converge").mkdir()
        (folder.path / "converge" / "converge.json").write_text(json.dumps({"schema": 1, "cases": [
            {"id": i, "columns": {"eta_period_1": {"error": e}}} for i, e in errors.items()]}))

    def test_a_reading_that_is_not_valid_is_no_result(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars={"eta_period_1": 0.8}, warnings=[INVALID])
        folder.add({AM: 200.0}, scalars={"eta_period_1": 0.3}, warnings=[RETURNS])
        text = self.result(folder)
        self.assertIn("is highest, 0.3, at AM frequency 200 Hz", text)
        self.assertIn("The readings of 1 case are not valid and are not used: waves return at 4.8 ms.", text)
        self.assertNotIn("0.8", text)

    def test_without_a_valid_reading_there_is_no_result(self):
        folder = Folder(self.root, x="", swept=[])
        folder.add({}, scalars={"eta_period_1": 0.8}, warnings=[INVALID])
        text = self.result(folder)
        self.assertIn("No efficiency is stated, because no case has valid readings: waves return", text)
        self.assertNotIn("0.8", text)

    def test_with_missing_cases_no_case_is_the_best(self):
        folder = self.folder([0.2, 0.4])
        folder.add({AM: 300.0}, written=False)
        text = self.result(folder)
        self.assertIn("of 2 complete cases is 0.2 to 0.4; no case is called the best until all are complete. "
                      "1 case of 3 has no result yet.", text)
        self.assertNotIn("highest", text)

    def test_engines_do_not_compete(self):
        folder = Folder(self.root, x=ENGINE, swept=[ENGINE])
        for engine, eta in (("layered", 0.40), ("spectral", 0.41)):
            folder.add({ENGINE: engine}, scalars={"eta_period_1": eta})
        text = self.result(folder)
        self.assertIn("is 0.4 to 0.41. The cases differ only in numerical parameters, so the range of 2.5 % is a "
                      "numerical error.", text)
        self.assertNotIn("best", text)

    def test_the_difference_between_engines_is_the_error_of_a_comparison(self):
        folder = Folder(self.root, series=[ENGINE], swept=[AM, ENGINE])
        for f, etas in ((100.0, (0.40, 0.42)), (200.0, (0.41, 0.43)), (300.0, (0.20, 0.21))):
            for engine, eta in zip(("layered", "pstd"), etas):
                folder.add({AM: f, ENGINE: engine}, scalars={"eta_period_1": eta})
        text = self.result(folder)
        self.assertIn("is highest, 0.43, at AM frequency 200 Hz.", text)
        self.assertNotIn("pstd", text)
        # Half of 0.41 to 0.43 is 2.4 %. 0.40 and 0.42 are within twice that, 0.2 is not.
        self.assertIn("1 further case differs from it by no more than the numerical error of both, 2.4 % of η", text)

    def test_differences_are_stated_relative_to_the_estimated_error(self):
        folder = self.folder([0.300, 0.500, 0.501])
        self.errors(folder, {case_id(1): 0.003})  # 1 %
        text = self.result(folder)
        self.assertIn("is highest, 0.5010 ± 0.0050, at AM frequency 300 Hz. 1 further case differs from it by no more "
                      "than the numerical error of both, 1 %", text)

    def test_a_sweep_without_estimate_says_so(self):
        self.assertIn("The numerical error has not been estimated: shearwake converge does so.",
                      self.result(self.folder([0.3, 0.5])))

    def test_warnings_are_printed_next_to_the_figures_that_they_concern(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, warnings=[RETURNS, WINDOW])
        folder.add({AM: 200.0}, warnings=[{**RETURNS, "message": "waves return at 5.1 ms"}])
        page = Page(folder.report())
        self.assertIn("Warning: waves return at 4.8 ms (AM frequency 100\N{NO-BREAK SPACE}Hz, and 1 more case).", page.data)
        sweep = load.load(folder.path)
        self.assertEqual([w["message"] for w in sweep.cases[0].warnings],
                         [RETURNS["message"], WINDOW["message"]])
        self.assertEqual(warnings_of.of_figure(sweep, "drive"), [])
        self.assertEqual(len(warnings_of.of_figure(sweep, "raster_1")), 1)  # not that of the measures
        for case in sweep.cases:
            case.physics["afferents"] = {"input": "carrier"}
        self.assertEqual(warnings_of.of_figure(sweep, "raster_1"), [])
        self.assertEqual(len(warnings_of.of_figure(sweep, "eta")), 2)
        table = (folder.path / "tables" / "s.csv").read_text()
        self.assertIn("warning: domain.extent_mm: waves return at 5.1 ms", table)

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
                folder.add({draw: f, FWHM: width}, is_reference=True, kind="STM")
        return load.load(folder.save())

    def test_references_that_depend_on_a_key_appear_once_per_value_with_their_label(self):
        sweep = self.with_own_references()
        cells, columns = fig_surface.cells(sweep)
        self.assertEqual(columns, 2)
        labels = [layout.case_label(sweep, c).replace("\N{NO-BREAK SPACE}", " ") for c in cells]
        self.assertEqual(labels, [first + f"draw frequency {f} Hz" for f in (50, 75, 100)
                                  for first in ("plain STM, ", "")])

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


if __name__ == "__main__":
    unittest.main()
