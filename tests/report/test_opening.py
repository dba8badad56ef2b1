# SPDX-License-Identifier: BSD-3-Clause
"""The opening of the page in a headless chromium, its charts as a reader without a mouse or a screen uses them, and its print."""
import base64
import math
import tempfile

import h5py
import pytest
from test_afferents import add_afferents
from test_browser import Pages
from synthetic import AM, FWHM, case_id, sweep

INVALID = {"severity": "error", "key": "domain.extent_mm", "message": "waves return at 4.8 ms: the readings of this case are not valid"}
QUESTION = "Does AM keep more of the energy at the focus?"
CONTRAST = """(() => {
    const light = text => { const [r, g, b] = text.match(/[\\d.]+/g).map(Number).map(v => v / 255)
        .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    const behind = part => { for (let p = part; p; p = p.parentElement) {
        const colour = getComputedStyle(p).backgroundColor;
        if (!/rgba\\(.*, 0\\)/.test(colour)) return colour; } return "rgb(255, 255, 255)"; };
    document.querySelectorAll("details").forEach(part => { part.open = true; });
    return Array.from(document.querySelectorAll("body *")).filter(part => part.checkVisibility() && Array.from(part.childNodes)
        .some(node => node.nodeType === 3 && node.textContent.trim()) && !part.closest("noscript, script, .skip, option")).map(part => {
        const a = light(getComputedStyle(part).color), b = light(behind(part));
        return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), part.tagName + "." + part.className + ": " + part.textContent.slice(0, 40)];
    }).filter(([ratio]) => ratio < 4.5); })()"""


@pytest.mark.extended
class OpeningTest(Pages):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = sweep(temporary.name, job=f"#:schema ./job.schema.json\n# SPDX-License-Identifier: BSD-3-Clause\n# {QUESTION}\n# Ten seconds.\nschema = 1\n")
        for number in (1, 4):
            with h5py.File(folder.file(case_id(number)), "r+") as file:
                file["eta_period_1_error"] = 0.002
        cls.path = cls.page_of(folder)

    def test_the_page_opens_with_question_answer_three_numbers_and_two_pictures(self):
        for width, page in self.both():
            self.fits(page, width)
            tops = page.run("""["h1", ".question", ".lead", ".numbers", ".player canvas", "#chart-eta"].map(
                name => document.querySelector(name).getBoundingClientRect().top)""")
            self.assertEqual(tops, sorted(tops))
            self.assertEqual(page.run('document.querySelector(".question").textContent'), QUESTION)
            lead = page.run('document.querySelector(".lead").textContent')
            self.assertTrue(lead.endswith("plain STM."), lead)
            self.assertNotIn("_", lead)
            numbers = page.run('Array.from(document.querySelectorAll(".numbers b"), part => part.textContent)')
            self.assertEqual(numbers, ["27\N{NO-BREAK SPACE}%", "1.3\N{NO-BREAK SPACE}µm", "120\N{NO-BREAK SPACE}mm²"])
            self.assertTrue(page.wait(f"{self.FRAMES}.every(frame => frame)"))
            shown = page.run('Array.from(document.querySelectorAll(".player .chosen"), part => part.textContent)')
            self.assertEqual(shown, ["plain STM", "AM-STM, AM frequency 400\N{NO-BREAK SPACE}Hz"])

    def test_a_long_comment_is_cut_and_the_name_replaces_a_missing_title(self):
        folder = self.new_folder(job="# " + "ein langer Kommentar ohne Ende " * 40 + "\nschema = 1\n")
        folder.plan["title"] = ""
        folder.add({AM: 100.0}, scalars={"eta_period_1": 0.2})
        page = self.open(1280, path=self.page_of(folder))
        shown = page.run('document.querySelector(".question").textContent')
        self.assertLessEqual(len(shown), 342)
        self.assertTrue(shown.endswith(" …"), shown)
        self.assertEqual(page.run('[document.querySelector("h1").textContent, document.title]'), [folder.plan["name"]] * 2)

    def test_warnings_are_named_by_what_is_wrong(self):
        folder = self.new_folder()
        folder.add({AM: 100.0}, scalars={"eta_period_1": 0.2}, warnings=[INVALID, {**INVALID, "message": "the wake is truncated"}])
        page = self.open(1280, path=self.page_of(folder))
        names = page.run('Array.from(document.querySelector("main .badge").querySelectorAll("a"), a => a.textContent)')
        self.assertEqual(names, ["not valid: waves return at 4.8 ms", "not valid: the wake is truncated"])

    def test_pictures_that_are_compared_have_the_same_height_whatever_their_titles(self):
        tops = 'Array.from(document.querySelectorAll(".player canvas"), c => c.getBoundingClientRect().top)'
        page = self.open(1280)
        page.run('document.querySelectorAll(".chosen")[0].textContent = "a long title ".repeat(20)')
        self.assertEqual(len(set(page.run(tops))), 1)

    def test_receptors_come_first_without_a_valid_efficiency(self):
        names = 'Array.from(document.querySelectorAll("main > h2"), part => part.id)'
        folder = self.new_folder()
        for n, spikes in enumerate((40.0, 90.0)):
            identity = folder.add({AM: 100.0 * (n + 1)}, warnings=[INVALID],
                                  scalars={"RA_total_rate_Hz": spikes, "RA_spikes_1": spikes, "RA_active_1": 2.0, "RA_rate_Hz": 5.0})
            add_afferents(folder.file(identity), [0, 0, 0, 1, 2], felt="carrier")
        page = self.open(1280, path=self.page_of(folder))
        self.assertEqual(page.run(names)[:2], ["player", "afferents_RA"])
        self.assertEqual(page.run('document.querySelector(".numbers b").textContent'), "90\N{NO-BREAK SPACE}spikes/s")

    def test_there_is_one_select_per_swept_axis(self):
        folder = self.new_folder(swept=[AM, FWHM], series=[FWHM])
        for f in (100.0, 200.0, 300.0):
            for width in (3.0, 5.0):
                folder.add({AM: f, FWHM: width}, scalars={"eta_period_1": 0.001 * f})
        path = self.page_of(folder)
        for width, page in self.both(path=path):
            self.fits(page, width)
            found = page.run("""Array.from(document.querySelectorAll(".player-panel")[1].querySelectorAll("label"),
                label => [label.firstChild.textContent.trim(), label.querySelector("select").options.length])""")
            self.assertEqual(found, [["AM frequency", 3], ["Focus FWHM", 2]])

    def test_points_of_an_instant_are_not_joined(self):
        page = self.open(1280)
        lines = page.run("""charts.filter(chart => chart.holder.id === "chart-eta").map(chart =>
            chart.plot.series[1].paths(chart.plot, 1, 0, 2) !== null)""")
        self.assertEqual(lines, [True, False])

    def test_ratios_have_a_logarithmic_scale_around_one(self):
        page = self.open(1280)
        page.run("document.querySelectorAll('details.topic').forEach(part => { part.open = true; })")
        self.assertTrue(page.wait('charts.some(chart => chart.holder.id === "chart-strength")'))
        low, high, kind = page.run("""(() => { const {y} = charts.find(chart => chart.holder.id === "chart-strength").plot.scales;
            return [y.min, y.max, y.distr]; })()""")
        self.assertEqual(kind, 3)  # logarithmic
        self.assertAlmostEqual(math.log(low), -math.log(high))

    def test_charts_have_names_roles_buttons_and_data(self):
        for width, page in self.both():
            self.assertEqual(page.run('document.querySelector("#chart-eta").getAttribute("aria-label")'),
                             "Reconstruction efficiency against AM frequency")
            self.assertIn("efficiency η against AM frequency (Hz)",
                          page.run('document.querySelector("#chart-eta .uplot[role=img]").getAttribute("aria-label")'))
            button = 'document.querySelector("#chart-eta .legend button")'
            self.assertEqual(page.run(f'{button}.getAttribute("aria-pressed")'), "true")
            page.run(f"{button}.focus()")
            page.press("Enter", 13)
            self.assertEqual(page.run(f'{button}.getAttribute("aria-pressed")'), "false")
            self.assertFalse(page.run("charts[0].plot.series[1].show"))
            page.run('document.querySelector("#chart-eta .data").open = true')
            self.assertTrue(page.wait('!!document.querySelector("#chart-eta .data table")'))
            rows = page.run("""Array.from(document.querySelector("#chart-eta .data table").rows,
                row => Array.from(row.cells, cell => cell.textContent))""")
            self.assertEqual(rows[1], ["100", "0.25 ± 0.002", "0.24"])
            self.fits(page, width)

    def test_contrast_of_all_texts(self):
        for dark in (False, True):
            with self.subTest(dark=dark):
                self.assertEqual(self.open(1280, dark).run(CONTRAST), [])

    def test_the_first_tab_skips_to_the_results(self):
        page = self.open(1280)
        page.press("Tab", 9)
        self.assertEqual(page.run("document.activeElement.textContent"), "Skip to the results")
        self.assertGreater(page.run("document.activeElement.getBoundingClientRect().left"), 0)
        self.assertTrue(page.run("!!document.querySelector(document.activeElement.hash)"))

    def test_a_print_contains_all_figures_without_controls_and_wraps_tables(self):
        page = self.open(1280)
        page.run("dispatchEvent(new Event('beforeprint'))")
        page.send("Emulation.setEmulatedMedia", media="print")
        self.assertEqual(page.run("document.querySelectorAll('details.topic:not([open])').length"), 0)
        self.assertTrue(page.run("Array.from(document.querySelectorAll('.chart')).every(part => part.querySelector('canvas'))"))
        shown = page.run("""Array.from(document.querySelectorAll("nav, button:not(.legend button, th button), select, input"))
            .filter(part => part.checkVisibility()).length""")
        self.assertEqual(shown, 0)
        self.assertEqual(page.run("getComputedStyle(document.querySelector('table.sortable td')).whiteSpace"), "normal")
        self.assertEqual(page.run("getComputedStyle(document.querySelector('.tall')).overflow"), "visible")
        page.run("dispatchEvent(new Event('afterprint'))")
        self.assertGreater(page.run("document.querySelectorAll('details.topic:not([open])').length"), 0)
        self.assertTrue(base64.b64decode(page.send("Page.printToPDF")["data"]).startswith(b"%PDF"))
