# SPDX-License-Identifier: BSD-3-Clause
"""The documentation site builds without warnings, and its pages are all there."""
import json
import re
import subprocess

import pytest

from blocks import DOCS, ROOT, pages
from program import PATIENCE_s, PROGRAM, ProgramTest

import browser
from test_browser import need_chromium

NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


class Site(ProgramTest):
    def build(self):
        done = subprocess.run([ROOT / "scripts" / "docs", self.folder / "site"], stdin=subprocess.DEVNULL,
                              capture_output=True, encoding="utf-8", timeout=PATIENCE_s, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    @pytest.mark.long
    def test_every_page_is_in_the_site(self):
        self.build()
        for page in pages():
            made = self.folder / "site" / page.relative_to(DOCS).with_suffix(".html")
            self.assertTrue(made.is_file(), made)
        self.assert_pages_have_a_theme()

    def test_there_are_notebooks_without_stored_output(self):
        self.assertGreaterEqual(len(NOTEBOOKS), 3)
        for path in NOTEBOOKS:
            for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
                self.assertEqual(cell.get("outputs", []), [], path)

    @pytest.mark.extended
    def test_without_nbconvert_the_site_has_the_notebooks_without_outputs(self):
        text = f"""import importlib.util, os, sys
os.environ["SHEARWAKE"] = {str(PROGRAM)!r}
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, package=None: None if name == "nbconvert" else find(name, package)
from sphinx.cmd.build import main
sys.exit(main(["-W", "-q", "-b", "html", {str(DOCS)!r}, {str(self.folder / "plain")!r}]))"""
        done = subprocess.run(["/usr/bin/python3", "-c", text], stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
                              timeout=PATIENCE_s, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(done.stderr, "nbconvert or ipykernel is missing: the site contains the notebooks without outputs\n")
        for name, text in (("table-columns", "{class}_locking_1"), ("exit-codes", "<td><p>75</p></td>")):
            self.assertIn(text, (self.folder / "plain" / "reference" / f"{name}.html").read_text(encoding="utf-8"))
        page = (self.folder / "plain" / "index.html").read_text(encoding="utf-8")
        for path in NOTEBOOKS:
            link, = re.findall(f'href="([^"]*/{path.name})"', page)
            self.assertTrue((self.folder / "plain" / link).is_file(), link)

    def assert_pages_have_a_theme(self):
        """Script and style sheet of the theme are loaded, lines of code are not cut, and the gallery shows thumbnails."""
        need_chromium()
        with browser.Browser(browser.SOFTWARE_WEBGL) as chromium:
            for page in pages():
                with self.subTest(page=page):
                    shown = chromium.open(self.folder / "site" / page.relative_to(DOCS).with_suffix(".html"), 736, 900)
                    self.assertEqual(shown.errors(), [])
                    self.assertEqual(shown.requests(), [])
                    self.assertEqual(shown.run("Array.from(document.images).filter(i => !i.naturalWidth).length"), 0)
                    self.assertEqual(shown.run("""Array.from(document.querySelectorAll("pre")).filter(
                        block => block.scrollWidth > block.clientWidth).length"""), 0)
                    self.assertIn("fixed", shown.run("getComputedStyle(document.querySelector('nav.wy-nav-side')).position"))
                    phone = chromium.open(self.folder / "site" / page.relative_to(DOCS).with_suffix(".html"), 390, 844)
                    self.assertEqual(phone.run("document.documentElement.scrollWidth"), 390)
                    # The script of the theme opens the menu of a narrow window.
                    shown.run("document.querySelector('[data-toggle=\"wy-nav-top\"]').click()")
                    self.assertTrue(shown.run("document.querySelector('nav.wy-nav-side').classList.contains('shift')"))
            gallery = chromium.open(self.folder / "site" / "gallery.html", 1280, 900)
            links = gallery.run("Array.from(document.querySelectorAll('.thumbnails a'), a => a.getAttribute('href').slice(1))")
            self.assertEqual(len(links), gallery.run("document.querySelectorAll('section section section section:has(img)').length"))
            self.assertEqual(gallery.run(f"{links}.filter(id => !document.getElementById(id))"), [])
            for path in NOTEBOOKS:
                for width in (1280, 390):
                    with self.subTest(notebook=path.stem, width=width):
                        shown = chromium.open(self.folder / "site" / "notebooks" / f"{path.stem}.html", width, 900)
                        self.assertEqual((shown.errors(), shown.requests()), ([], []))
                        self.assertLessEqual(shown.run("document.documentElement.scrollWidth"), width)
                        self.assertEqual(shown.run("""Array.from(document.querySelectorAll("pre")).filter(
                            block => block.scrollWidth > block.clientWidth).length"""), 0)
                        self.assertGreater(shown.run("Array.from(document.querySelectorAll('.output_area img')).filter(i => i.naturalWidth).length"), 0)
                        self.assertGreater(shown.run("document.querySelectorAll('.output_area table').length"), 0)
                        self.assertEqual(shown.run("Array.from(document.querySelectorAll('.output_stderr'), part => part.textContent)"), [])
            start = chromium.open(self.folder / "site" / "index.html", 1280, 900)
            for path in NOTEBOOKS:
                self.assertTrue(start.run(f"!!document.querySelector('a[href=\"notebooks/{path.stem}.html\"]')"), path)
