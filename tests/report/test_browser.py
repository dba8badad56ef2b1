# SPDX-License-Identifier: BSD-3-Clause
"""Tests a report in a headless chromium at the widths of a desktop and a phone.

Without chromium these tests are skipped; in scripts/test, which installs chromium, they fail.
"""
import math
import os
import tempfile
import unittest

import pytest

import browser
from test_figures import grid
from synthetic import AM, FWHM, Folder, case_id, sweep

COLUMN = 'Array.from(document.querySelectorAll("table.sortable tbody tr"), row => row.cells[{0}].textContent)'
HEAD = 'document.querySelectorAll("table.sortable th button")[{0}]'
INDEX = 'Array.from(document.querySelectorAll("table.sortable th"), head => head.dataset.name).indexOf("{0}")'

# Opacity of the panel of a figure at a time or frequency, 3 px below the top or above the bottom of its plot.
OPACITY = """((id, panel, x, edge) => {{
    const {{plot}} = charts.filter(chart => chart.holder.id === id)[panel], {{top, height}} = plot.bbox;
    return plot.ctx.getImageData(plot.valToPos(x, "x", true), edge === "top" ? top + 3 : top + height - 3, 1, 1).data[3];
}})("{}", {}, {}, "{}")"""


def need_chromium():
    """Skips the tests without chromium, or fails if chromium is required."""
    if browser.find():
        return
    missing = "chromium is missing: scripts/setup --tests installs it"
    if os.environ.get("SHEARWAKE_NEEDS_CHROMIUM"):
        raise AssertionError(missing)
    raise unittest.SkipTest(missing)


class Pages(unittest.TestCase):
    """Opens pages in chromium."""
    CLOCK = 'document.querySelector(".clock").textContent'
    FRAMES = """Array.from(document.querySelectorAll(".player canvas"), canvas => canvas.dataset.frame)"""

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
        cls.path = cls.page_of(folder)
        cls.browser = cls.enterClassContext(browser.Browser())

    def open(self, width, dark=False, path=None):
        return self.browser.open(path or self.path, width, 900 if width > 700 else 844, dark)

    def both(self, opened=None, **options):
        """The page at the widths of a desktop and a phone."""
        for width in (1280, 390):
            print("at a width of", width)  # shown if the test fails
            yield width, (opened or self.open)(width, **options)

    def new_folder(self, **options):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        return Folder(temporary.name, **options)

    @staticmethod
    def page_of(folder):
        folder.report()
        return folder.path / "report" / "index.html"

    def fits(self, page, width):
        shown = page.run("document.documentElement.scrollWidth")
        self.assertLessEqual(shown, page.run("innerWidth"))
        self.assertEqual(page.run("innerWidth"), width)
        self.assertEqual(page.errors(), [])
        self.assertEqual(page.requests(), [])
        broken = page.run("Array.from(document.images).filter(i => !i.naturalWidth).length")
        self.assertEqual(broken, 0)


class BrowserTest(Pages):
    heat_maps = None

    @classmethod
    def page_of_heat_maps(cls):
        """Drawn once."""
        if cls.heat_maps is None:
            temporary = tempfile.TemporaryDirectory()
            cls.addClassCleanup(temporary.cleanup)
            cls.heat_maps = cls.page_of(grid(temporary.name, snapshot=False))
        return cls.heat_maps

    def test_the_page_fits_a_desktop_and_a_phone_without_errors(self):
        for width in (1280, 390):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    self.fits(self.open(width, dark), width)

    def shows(self, path, figure):
        """Asserts that the page contains this figure and fits at both widths."""
        for width, page in self.both(path=path):
            self.fits(page, width)
            self.assertTrue(page.run(f'!!document.querySelector("#{figure} + figure img")'))

    @pytest.mark.long
    def test_heat_maps_fit_a_desktop_and_a_phone(self):
        self.shows(self.page_of_heat_maps(), "heat_eta_period_1")

    @pytest.mark.extended
    def test_a_drawn_shape_fits_a_desktop_and_a_phone(self):
        folder = self.new_folder(x="load.modulation.kind", swept=["load.modulation.kind"])
        line = [(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01), (-0.01, -0.01)]
        for kind in ("DTP", "STP"):
            folder.add({"load.modulation.kind": kind}, kind=kind, drawn=[line])
        self.shows(self.page_of(folder), "intensity")

    def test_errors_of_a_script_are_detected(self):
        page = self.open(1280)
        page.run("void setTimeout(() => { throw new Error('wrong') }, 0)")
        page.run("new Promise(done => setTimeout(done, 50))")
        self.assertEqual(len(page.errors()), 1)

    def test_a_heading_sorts_numbers_by_value_and_empty_cells_last(self):
        for _, page in self.both():
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

    @pytest.mark.extended
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

    def test_pointing_at_a_curve_shows_its_values(self):
        for _, page in self.both():
            place = page.run("""(() => {
                const {plot, lines} = charts.find(chart => chart.holder.id === "chart-eta");
                plot.over.scrollIntoView({block: "center"});
                const box = plot.over.getBoundingClientRect();
                return [box.left + plot.valToPos(lines[0].x[1], "x"), box.top + plot.valToPos(lines[0].y[1], "y")];
            })()""")
            page.move(place[0] - 3, place[1])
            page.move(*place)
            output = 'document.querySelector("#chart-eta output").textContent'
            self.assertTrue(page.wait(output + '.includes("200")'))
            self.assertEqual(page.run(output), "AM-STM: AM frequency (Hz) 200, efficiency η 0.26")
            self.assertEqual(page.errors(), [])

    def pointed_at(self, page, name, across, up):
        """The text below the maps of a figure when the pointer is at fractions of its first map."""
        page.run(f"""Array.from(document.querySelectorAll("details"), part => part.open = part.open
            || !!part.querySelector("#maps-{name}"))""")
        x, y = page.run(f"""(() => {{
            const holder = document.querySelector("#maps-{name}"), image = holder.querySelector("img");
            const [left, bottom, width, height] = JSON.parse(holder.querySelector("script").textContent)[0].box;
            image.scrollIntoView({{block: "center"}});
            const scroll = holder.querySelector(".scroll");  // pictures are wider than a phone
            scroll.scrollLeft = (left + {across} * width) * image.clientWidth - scroll.clientWidth / 2;
            holder.querySelector("output").textContent = "";
            const box = image.getBoundingClientRect();
            return [box.left + (left + {across} * width) * box.width, box.bottom - (bottom + {up} * height) * box.height];
        }})()""")
        page.move(x, y)
        output = f'document.querySelector("#maps-{name} output").textContent'
        self.assertTrue(page.wait(output + '.includes(":")'))
        return page.run(output)

    @pytest.mark.extended
    def test_pointing_at_a_cell_of_a_heat_map_shows_its_value(self):
        for _, page in self.both(path=self.page_of_heat_maps()):
            for across, up, words in ((0.5, 0.5, "AM frequency 200\u00a0Hz, focus FWHM 3\u00a0mm"),
                                      (0.9, 0.1, "AM frequency 400\u00a0Hz, focus FWHM 2\u00a0mm")):
                f, w = (200.0, 3.0) if across == 0.5 else (400.0, 2.0)
                text = self.pointed_at(page, "heat_eta_period_1", across, up)
                self.assertIn(words, text)
                self.assertTrue(text.endswith(f" {1e-3 * f + w + 50.0:g}"), text)  # of grid() at 5 m/s
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_pointing_at_a_surface_shows_u(self):
        for _, page in self.both():
            text = self.pointed_at(page, "surface", 0.5, 0.5)
            self.assertRegex(text, "^x \\(mm\\) .*, y \\(mm\\) .*: u .* µm$")
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_dragging_zooms_both_panels_of_a_figure_and_the_button_resets_them(self):
        page = self.open(1280)
        limits = """charts.filter(chart => chart.holder.id === "chart-eta").map(
            chart => [chart.plot.scales.x.min, chart.plot.scales.x.max])"""
        before = page.run(limits)
        self.assertEqual(len(before), 2)
        left, top, wide = page.run("""(() => {
            const over = charts.find(chart => chart.holder.id === "chart-eta").plot.over;
            over.scrollIntoView({block: "center"});
            const box = over.getBoundingClientRect();
            return [box.left, box.top + 20, box.width]; })()""")
        page.drag(left + 0.3 * wide, top, left + 0.6 * wide, top + 5)
        self.assertTrue(page.wait(f"JSON.stringify({limits}) !== '{str(before).replace(' ', '')}'"))
        for (low, high), (first, last) in zip(page.run(limits), before):
            self.assertLess(high - low, 0.5 * (last - first))
        page.run('document.querySelector("#chart-eta button").click()')
        self.assertTrue(page.wait(f"JSON.stringify({limits}) === JSON.stringify({before})"))

    @pytest.mark.extended
    def test_the_filter_selects_rows_and_lines(self):
        for _, page in self.both():
            page.run('document.querySelector("details:has(#eta_time)").open = true')
            shown = """Array.from(document.querySelectorAll("table.sortable tbody tr")).filter(
                row => !row.hidden).map(row => row.dataset.id)"""
            lines = """charts.find(chart => chart.holder.id === "chart-eta_time").plot.series.filter(
                (series, i) => i > 0 && series.show).length"""
            self.assertTrue(page.wait('charts.some(chart => chart.holder.id === "chart-eta_time")'))
            self.assertEqual(page.run(lines), 5)  # five complete cases, one of them the reference
            page.run('document.querySelector("#filter").focus()')
            page.type("am_frequency > 150, eta_period_1 >= 0.26")
            self.assertEqual(page.run(shown), [case_id(2), case_id(3)])
            self.assertEqual(page.run('document.querySelector("#count").textContent'), "2 of 6 cases")
            self.assertEqual(page.run(lines), 2)
            page.run(f"""document.querySelector("tr[data-id='{case_id(2)}'] input").click()""")
            self.assertEqual(page.run(lines), 1)
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_the_contents_open_the_topic_of_a_figure(self):
        page = self.open(1280)
        self.assertFalse(page.run("""document.querySelector("details:has(#spectra)").open"""))
        page.run("""document.querySelector("nav a[href='#spectra']").click()""")
        self.assertTrue(page.wait("""document.querySelector("details:has(#spectra)").open"""))
        self.assertTrue(page.wait('!!document.querySelector("#chart-spectra canvas")'))
        links = page.run('Array.from(document.querySelectorAll("nav a"), link => link.hash.slice(1))')
        tops = page.run(f"""{links}.map(id => document.getElementById(id)).map(
            (part, i, all) => i === 0 || !!(all[i - 1].compareDocumentPosition(part) & 4))""")
        self.assertTrue(all(tops), "the contents have the order of the page")

    @pytest.mark.extended
    def test_the_legend_shows_references_dashed(self):
        for width, page in self.both():
            styles = page.run("""Object.fromEntries(Array.from(
                document.querySelector("#chart-eta .panel").querySelectorAll(".legend button"),
                button => [button.textContent, getComputedStyle(button.querySelector("i")).borderTopStyle]))""")
            self.assertEqual(styles, {"AM-STM": "solid", "plain STM": "dashed"})
            marker = page.run("""(() => { const box = document.querySelector("#chart-eta .legend button:last-child i")
                .getBoundingClientRect(); return [box.width, box.height]; })()""")
            self.assertGreater(marker[0], 3 * marker[1])  # a part of a line, not a square
            self.assertEqual(page.run("[8e-7, 1.234e-5, 2e-3].map(numberText)"), ["8e\N{MINUS SIGN}7", "1.234e\N{MINUS SIGN}5", "0.002"])

    @pytest.mark.extended
    def test_crosses_of_readings_that_are_not_valid_have_values(self):
        folder = self.new_folder()
        for f in (100.0, 200.0, 400.0):
            wrong = {"severity": "error", "key": "domain.extent_mm", "message": "waves return"}
            folder.add({AM: f}, reference=case_id(4), scalars={"eta_period_1": 1e-3 * f},
                       warnings=[wrong] if f == 200.0 else [])
        folder.add({}, is_reference=True, kind="STM", scalars={"eta_period_1": 0.3})
        path = self.page_of(folder)
        for width, page in self.both(path=path):
            self.fits(page, width)
            place = page.run("""(() => {
                const {plot, lines} = charts.find(chart => chart.holder.id === "chart-eta");
                plot.over.scrollIntoView({block: "center"});
                const box = plot.over.getBoundingClientRect(), line = lines.find(line => line.crossed);
                return [box.left + plot.valToPos(line.x[1], "x"), box.top + plot.valToPos(line.y[1], "y")];
            })()""")
            ends = page.run("""(() => {
                const {plot, lines} = charts.find(chart => chart.holder.id === "chart-eta"), far = 2 * devicePixelRatio;
                const line = lines.find(line => line.crossed), at = plot.valToPos(line.x[1], "x", true);
                return [[-1, -1], [-1, 1], [1, -1], [1, 1]].map(([dx, dy]) => plot.ctx.getImageData(at + far * dx,
                    plot.valToPos(line.y[1], "y", true) + far * dy, 1, 1).data[3]);
            })()""")
            self.assertGreater(min(ends), 100, "all four arms are drawn, also after a dashed line")
            page.move(place[0] - 3, place[1])
            page.move(*place)
            output = 'document.querySelector("#chart-eta output").textContent'
            self.assertTrue(page.wait(output + '.includes("200")'))
            self.assertIn("not valid: AM frequency (Hz) 200, efficiency η 0.2", page.run(output))
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_labels_and_notes_are_complete_on_a_phone(self):
        preset = "medium.preset"
        folder = self.new_folder(series=[preset], swept=[AM, preset])
        for name in ("a-medium-with-a-long-name", "another-medium-with-an-even-longer-name"):
            folder.add({AM: 100.0, preset: name}, scalars={"eta_period_1": math.nan},
                       notes={"eta_period_1": "no period of the modulation fits into the run; " * 60})
        page = self.open(390, path=self.page_of(folder))
        self.fits(page, 390)
        self.assertTrue(page.wait(f"{self.FRAMES}.every(frame => frame)"))
        clipped = """Array.from(document.querySelectorAll({0!r}), part => part.scrollWidth > part.clientWidth + 1
            || part.scrollHeight > part.clientHeight + 1)"""
        self.assertEqual(page.run(clipped.format(".player-panel .chosen")), [False, False])
        self.assertEqual(page.run(clipped.format("ol.notes")), [False])
        for option, chosen in page.run("""Array.from(document.querySelectorAll(".player-panel"), panel => [
                panel.querySelector("select").selectedOptions[0].text, panel.querySelector(".chosen").textContent])"""):
            self.assertIn("longer-name" if "longer" in option else "long-name", chosen)
            self.assertTrue(chosen.endswith(option), chosen)
        self.assertEqual(page.run("getComputedStyle(document.querySelector('.tall')).backgroundAttachment"),
                         "local, local, scroll, scroll")  # a shadow at an edge behind which there are columns

    @pytest.mark.extended
    def test_panels_show_the_settled_part_the_instant_and_the_modulation_frequencies(self):
        folder = self.new_folder(series=[FWHM], swept=[AM, FWHM])
        for fwhm in (2.0, 3.0):
            for f in (100.0, 430.0):
                folder.add({AM: f, FWHM: fwhm}, case_id(5))
        folder.add({}, is_reference=True, kind="STM")
        path = self.page_of(folder)
        for _, page in self.both(path=path):
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
