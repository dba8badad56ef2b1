# SPDX-License-Identifier: BSD-3-Clause
"""Tests the reuse of unchanged figures and the progress of a report.

Run: python3 -m pytest tests/report/test_unchanged.py    (unittest, numpy, h5py, matplotlib; seconds)
"""
import io
import tempfile
import unittest
from pathlib import Path

import h5py


from synthetic import case_id, sweep, with_pdf

from shearwake.report import load
from shearwake.report.figures import fig_frequency, fig_measures
from shearwake.report.progress import Progress
from shearwake.report.unchanged import Drawn

GROUPS = [("measures", fig_measures.figures), ("frequencies", fig_frequency.figures)]


class UnchangedTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = Path(self.temporary.name)
        self.folder = sweep(self.root)
        self.report, self.count = self.root / "report", 0
        self.report.mkdir()

    def draw(self):
        """Draws both groups into a new folder, which becomes the report. Returns the number of reused groups and
        the titles."""
        loaded, self.count = load.load(self.folder.save()), self.count + 1
        part = self.root / f"part{self.count}"
        part.mkdir()
        drawn = Drawn(self.report, part)
        titles = [figure.title for name, draw in GROUPS for figure in drawn.draw(name, draw, loaded, part)]
        drawn.save()
        self.report = part
        return drawn.reused, titles

    def test_a_second_report_draws_nothing(self):
        first = self.draw()
        pictures = {path.name: path.read_bytes() for path in self.report.iterdir()}
        self.assertEqual(first[0], 0)
        self.assertEqual(self.draw(), (len(GROUPS), first[1]))
        self.assertEqual({path.name: path.read_bytes() for path in self.report.iterdir()}, pictures)

    def test_a_changed_case_is_drawn_again(self):
        self.draw()
        with h5py.File(self.folder.file(case_id(1)), "r+") as file:
            file["eta_period_1"][()] = 0.5
        self.assertEqual(self.draw()[0], 0)

    def test_a_changed_warning_is_drawn_again(self):
        self.draw()
        loaded, drawn = load.load(self.folder.path), Drawn(self.report, self.root)
        before = drawn.key("measures", loaded)
        self.assertEqual(before, drawn.old["measures"]["key"])
        loaded.cases[0].warnings.append({"severity": "error", "key": "domain.extent_mm", "message": "waves return"})
        self.assertNotEqual(drawn.key("measures", loaded), before)

    @with_pdf
    def test_a_removed_picture_is_drawn_again(self):
        self.draw()
        (self.report / "eta.pdf").unlink()
        self.assertEqual(self.draw()[0], len(GROUPS) - 1)
        self.assertTrue((self.report / "eta.pdf").exists())


class Terminal(io.StringIO):
    def isatty(self):
        return True


class ProgressTest(unittest.TestCase):
    def test_a_terminal_has_one_line_that_is_replaced(self):
        stream = Terminal()
        progress = Progress(stream)
        progress.show("reading case 1 of 2")
        progress.show("reading case 2 of 2")
        progress.end()
        lines = [line for line in stream.getvalue().split("\r\033[K") if line]
        self.assertEqual(lines, ["report: reading case 1 of 2", "report: reading case 2 of 2"])

    def test_elsewhere_there_is_one_line_per_minute(self):
        stream, seconds = io.StringIO(), iter(range(0, 100000, 20))
        progress = Progress(stream, lambda: next(seconds))
        for n in range(8):
            progress.show(f"case {n}")
        progress.end()
        self.assertGreaterEqual(stream.getvalue().count("\n"), 2)
        self.assertLess(stream.getvalue().count("\n"), 4)


if __name__ == "__main__":
    unittest.main()
