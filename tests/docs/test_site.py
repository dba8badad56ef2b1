# SPDX-License-Identifier: BSD-3-Clause
"""The documentation site builds without warnings, and its pages are all there."""
import subprocess
import unittest

from blocks import DOCS, ROOT, pages
from program import PATIENCE_s, ProgramTest

import browser
from test_browser import need_chromium


class Site(ProgramTest):
    def build(self):
        done = subprocess.run([ROOT / "scripts" / "docs", self.folder / "site"], stdin=subprocess.DEVNULL,
                              capture_output=True, encoding="utf-8", timeout=PATIENCE_s, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_every_page_is_in_the_site(self):
        self.build()
        for page in pages():
            made = self.folder / "site" / page.relative_to(DOCS).with_suffix(".html")
            self.assertTrue(made.is_file(), made)
        demonstration = self.folder / "site" / "demo.html"
        self.assertTrue(demonstration.is_file())
        self.assertLess(demonstration.stat().st_size, 5_000_000)
        self.assert_plays(demonstration)

    def assert_plays(self, path):
        """The page plays in a browser without a server: its result has values, and other frames follow."""
        need_chromium()
        with browser.Browser(browser.SOFTWARE_WEBGL) as chromium:
            page = chromium.open(path, 1280, 900)
            self.assertEqual(page.run("location.protocol"), "file:")
            self.assertTrue(page.wait("typeof explorer === 'object' && explorer.result"))
            self.assertRegex(page.run("document.querySelector('[data-column=\"eta_at_1\"]').textContent"), r"^0\.\d+")
            page.run("explorer.play(true)")
            self.assertTrue(page.wait("explorer.frame > 3"))
            self.assertEqual(page.errors(), [])


if __name__ == "__main__":
    unittest.main()
