# SPDX-License-Identifier: BSD-3-Clause
"""Tests in a headless chromium that interactive figures show what their captions describe.

Run: python3 -m pytest tests/report/test_browser_marks.py    (unittest, h5py, matplotlib, chromium; seconds)
"""
import tempfile
import unittest

import browser
import test_browser
from synthetic import AM, FWHM, Folder, case_id

# Opacity of the panel of a figure at a time or frequency, 3 px below the top or above the bottom of its plot.
OPACITY = """((id, panel, x, edge) => {{
    const {{plot}} = charts.filter(chart => chart.holder.id === id)[panel], {{top, height}} = plot.bbox;
    return plot.ctx.getImageData(plot.valToPos(x, "x", true), edge === "top" ? top + 3 : top + height - 3, 1, 1).data[3];
}})("{}", {}, {}, "{}")"""


class MarksTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        test_browser.need_chromium()
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        folder = Folder(cls.temporary.name, series=[FWHM], swept=[AM, FWHM])
        for width in (2.0, 3.0):
            for f in (100.0, 430.0):
                folder.add({AM: f, FWHM: width}, case_id(5))
        folder.add({}, is_reference=True, kind="STM")
        folder.report()
        cls.path = folder.path / "report" / "index.html"
        cls.browser = cls.enterClassContext(browser.Browser())

    def test_panels_show_the_settled_part_the_instant_and_the_modulation_frequencies(self):
        for width in (1280, 390):
            with self.subTest(width=width):
                page = self.browser.open(self.path, width, 900, False)
                page.run('document.querySelectorAll("details").forEach(part => { part.open = true; })')
                self.assertTrue(page.wait('["chart-eta_time", "chart-spectra"].every(id => charts.filter(chart => '
                                          'chart.holder.id === id).length === 2)'))  # a panel per curve
                for panel in (0, 1):
                    # the run is not settled until 1 ms, and the instant is at 4 ms, at the end; grid lines are between
                    self.assertGreater(page.run(OPACITY.format("chart-eta_time", panel, 0.7, "top")), 5)
                    self.assertEqual(page.run(OPACITY.format("chart-eta_time", panel, 1.3, "top")), 0)
                    for f in (100.0, 430.0):
                        self.assertGreater(page.run(OPACITY.format("chart-spectra", panel, f, "bottom")), 200)
                    self.assertLess(page.run(OPACITY.format("chart-spectra", panel, 330.0, "bottom")), 100)
                names = page.run('charts.filter(chart => chart.holder.id === "chart-eta_time").flatMap(chart => '
                                 'chart.lines.map(line => line.label))')
                self.assertEqual(len(names), 6)
                self.assertEqual(len(set(names)), 5)  # the common reference is in both panels
                self.assertEqual(page.errors(), [])


if __name__ == "__main__":
    unittest.main()
