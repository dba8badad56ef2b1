# SPDX-License-Identifier: BSD-3-Clause
"""Tests a report in a headless chromium at the widths of a desktop and a phone.

Run: python3 tests/report/test_browser.py    (unittest, h5py, matplotlib, chromium; seconds)
Without chromium these tests are skipped; in scripts/test, which installs chromium, they fail.
"""
import math
import os
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import browser  # noqa: E402
from test_figures import grid  # noqa: E402
from synthetic import AM, Folder, case_id, sweep  # noqa: E402

COLUMN = """Array.from(document.querySelectorAll("table.sortable tbody tr"),
    row => row.cells[{0}].textContent)"""
HEAD = 'document.querySelectorAll("table.sortable th button")[{0}]'
INDEX = """Array.from(document.querySelectorAll("table.sortable th"),
    head => head.textContent).indexOf("{0}")"""



def need_chromium():
    """Skips the tests without chromium, or fails if chromium is required."""
    if browser.find():
        return
    missing = "chromium is missing: scripts/setup --tests installs it"
    if os.environ.get("SHEARWAKE_NEEDS_CHROMIUM"):
        raise AssertionError(missing)
    raise unittest.SkipTest(missing)


class BrowserTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        need_chromium()
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        folder = sweep(cls.temporary.name)
        folder.add({AM: 1000.0}, case_id(4), notes={"eta_period_1": "no period fits"},
                   scalars={"eta_period_1": math.nan})
        failed = folder.add({AM: 50.0}, case_id(4), written=False)
        folder.fail(failed, "the field is not finite")
        folder.report()
        cls.path = folder.path / "report" / "index.html"
        cls.browser = cls.enterClassContext(browser.Browser())

    def open(self, width, dark=False, path=None):
        return self.browser.open(path or self.path, width, 900 if width > 700 else 844, dark)

    def fits(self, page, width):
        shown = page.run("document.documentElement.scrollWidth")
        self.assertLessEqual(shown, page.run("innerWidth"))
        self.assertEqual(page.run("innerWidth"), width)
        self.assertEqual(page.errors(), [])
        self.assertEqual(page.requests(), [])
        broken = page.run("Array.from(document.images).filter(i => !i.naturalWidth).length")
        self.assertEqual(broken, 0)

    def test_the_page_fits_a_desktop_and_a_phone_without_errors(self):
        for width in (1280, 390):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    self.fits(self.open(width, dark), width)

    def folder_of(self, make):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = make(temporary.name)
        folder.report()
        return folder.path / "report" / "index.html"

    def shows(self, path, figure):
        """Asserts that the page contains this figure and fits at both widths."""
        for width in (1280, 390):
            with self.subTest(width=width):
                page = self.open(width, path=path)
                self.fits(page, width)
                self.assertTrue(page.run(f'!!document.querySelector("#{figure} + figure img")'))

    def test_heat_maps_fit_a_desktop_and_a_phone(self):
        self.shows(self.folder_of(lambda root: grid(root, snapshot=False)), "heat_eta_period_1")

    def test_a_drawn_shape_fits_a_desktop_and_a_phone(self):
        def square(root):
            folder = Folder(root, x="load.modulation.kind", swept=["load.modulation.kind"])
            line = [(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01), (-0.01, -0.01)]
            for kind in ("DTP", "STP"):
                folder.add({"load.modulation.kind": kind}, kind=kind, drawn=[line])
            return folder
        self.shows(self.folder_of(square), "intensity")

    def test_errors_of_a_script_are_detected(self):
        page = self.open(1280)
        page.run("void setTimeout(() => { throw new Error('wrong') }, 0)")
        page.run("new Promise(done => setTimeout(done, 50))")
        self.assertEqual(len(page.errors()), 1)

    def test_a_heading_sorts_numbers_by_value_and_empty_cells_last(self):
        for width in (1280, 390):
            with self.subTest(width=width):
                page = self.open(width)
                am = page.run(INDEX.format(AM))
                page.run(HEAD.format(am) + ".click()")
                self.assertEqual(page.run(COLUMN.format(am)),
                                 ["50", "100", "200", "400", "1000", "–"])
                page.run(HEAD.format(am) + ".click()")
                self.assertEqual(page.run(COLUMN.format(am)),
                                 ["1000", "400", "200", "100", "50", "–"])
                eta = page.run(INDEX.format("eta_period_1"))
                page.run(HEAD.format(eta) + ".click()")
                self.assertEqual(page.run(COLUMN.format(eta)),
                                 ["0.24", "0.25", "0.26", "0.27", "–", "–"])
                self.assertEqual(page.errors(), [])

    def test_the_keyboard_sorts_and_the_order_is_announced(self):
        page = self.open(1280)
        am = page.run(INDEX.format(AM))
        state = HEAD.format(am) + '.parentElement.getAttribute("aria-sort")'
        page.run(HEAD.format(am) + ".focus()")
        page.press("Enter", 13)
        self.assertEqual(page.run(state), "ascending")
        page.press("Enter", 13)
        self.assertEqual(page.run(state), "descending")
        self.assertEqual(page.run(COLUMN.format(am))[0], "1000")

    def test_the_slider_moves_every_panel(self):
        for width in (1280, 390):
            with self.subTest(width=width):
                page = self.open(width)
                self.assertEqual(page.run('document.querySelector("output").textContent'), "4 ms")
                focus = """Array.from(document.querySelectorAll(".player circle"),
                    c => c.getBoundingClientRect().left + scrollX)"""
                picture = 'document.querySelector(".player image").getAttribute("href")'
                late, shown = page.run(focus), page.run(picture)
                page.run('document.querySelector(".player input").focus()')
                page.press("ArrowLeft", 37)
                self.assertEqual(page.run('document.querySelector("output").textContent'), "2 ms")
                self.assertNotEqual(page.run(picture), shown)
                early = page.run(focus)
                self.assertEqual(len(early), 4)
                for before, after in zip(early, late):
                    self.assertLess(before, after)  # the focus moves along x
                self.assertEqual(page.errors(), [])

    def test_play_moves_the_slider_and_pause_stops_it(self):
        page = self.open(1280)
        page.run('document.querySelector(".play").click()')
        self.assertEqual(page.run('document.querySelector(".play").textContent'), "Pause")
        moved = page.run("""new Promise(done => {
            const slider = document.querySelector(".player input"), first = slider.value;
            const look = () => slider.value !== first ? done(true) : setTimeout(look, 20);
            setTimeout(() => done(false), 10000);
            look(); })""")
        self.assertTrue(moved)
        page.run('document.querySelector(".play").click()')
        self.assertEqual(page.run('document.querySelector(".play").textContent'), "Play")


if __name__ == "__main__":
    unittest.main()
