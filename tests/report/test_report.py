# SPDX-License-Identifier: BSD-3-Clause
"""The report of small synthetic folders with complete, failed, damaged and empty cases."""
import contextlib
import html
import io
import json
import math
import re
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np
import pytest

# Sets the path of the imports below.
from synthetic import AM, FWHM, SCALARS, Folder, InFolder, Page, case_id, lone_case, sweep, with_pdf, write_case

from shearwake import wake
from shearwake.report import __main__ as report, layout, load, words
from shearwake.script_json import script_json


class WholeSweepTest(unittest.TestCase):
    """A sweep that is drawn once for all tests."""

    TITLE = '<script>alert("1")</script> & more'

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = sweep(cls.temporary.name, title=cls.TITLE)
        with with_pdf:
            cls.text = cls.folder.report()
        cls.page = Page(cls.text)

    def test_every_figure_is_a_file_and_part_of_the_page(self):
        names = {"eta", "gain", "strength", "ipr_abs", "participation", "ipr", "frequency",
                 "drive", "eta_time", "profiles", "traces", "displacement", "ipr_abs_time", "ipr_time", "surface", "spectra",
                 "spectra_relative", "spectrograms"}
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.png")}, names)
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.pdf")}, names)
        self.assertEqual(len(self.page.images), len(names))
        for image in self.page.images:
            self.assertTrue(image["src"].startswith("data:image/webp;base64,"))
            self.assertTrue(image["alt"])

    def test_the_page_loads_nothing_from_elsewhere(self):
        for resource in self.page.resources:
            self.assertTrue(resource.startswith(("data:", "#")), resource[:80])
        for link in self.page.links:  # to files of the same output folder
            self.assertRegex(link, r"^(#|[a-z0-9_]+\.(png|pdf)$|\.\./(tables|cases)/)")
        self.assertNotIn("http", re.sub(r"base64,[A-Za-z0-9+/=]*", "", self.text))
        self.assertNotIn("@import", self.text)

    def test_text_of_the_user_is_escaped(self):
        self.assertNotIn("<script>alert", self.text)
        charts, maps = (self.text.count(f'class="{name}"') for name in ("chart", "maps"))
        self.assertEqual(self.page.tags.count("script"), charts + maps + 3)  # pictures of the player, uPlot, the page
        self.assertIn(self.TITLE, self.page.data)

    def test_a_text_neither_ends_a_script_nor_begins_a_comment_in_it(self):
        layer = {"name": "<!--<script> & </script>"}
        self.assertNotIn("<", script_json(layer))
        self.assertEqual(json.loads(script_json(layer)), layer)
        self.assertIn("# <& job>", self.page.data)

    def test_the_table_contains_the_numbers_of_the_files(self):
        for column in SCALARS:
            if column not in [cell["text"] for cell in self.page.rows[0]]:
                continue  # of the CSV table alone
            for row, cell in zip(self.folder.cases, self.page.column(column)):
                with h5py.File(self.folder.file(row["id"])) as file:
                    self.assertEqual(cell["title"], f"{file[column][()]:.9g}")
        self.assertEqual([c["text"] for c in self.page.column(AM)], ["100", "200", "400", "–"])
        self.assertEqual(self.page.column("eta_period_over_reference_1")[1]["title"],
                         f"{0.26 / 0.24:.9g}")
        self.assertEqual(self.page.column("focal_rms_over_reference_1")[0]["text"], "0.5")

    def test_the_summary_names_the_best_case(self):
        gap = "\N{NO-BREAK SPACE}"
        self.assertIn(f"The efficiency η is highest at AM frequency 400{gap}Hz, the end of the swept range: 27{gap}%, 1.13 times the "
                      f"24{gap}% of plain STM.", self.page.data)
        self.assertIn(f"0.43 (AM frequency 400{gap}Hz) to 0.5", self.page.data)
        self.assertIn("4 cases, 1 of them a reference: 4 complete.", self.page.data)

    def test_the_page_states_its_provenance(self):
        for fact in ("shearwake 0.1.0", "abc", "laptop", "2026-01-02 03:04:05 UTC"):
            self.assertIn(fact, self.page.data)


class ReportTest(InFolder):
    @pytest.mark.extended
    def test_incomplete_cases_are_listed_and_do_not_affect_figures(self):
        folder = sweep(self.root)
        failed = folder.add({AM: 600.0}, case_id(4), written=False)
        damaged = folder.add({AM: 800.0}, case_id(4))
        folder.add({AM: 900.0}, case_id(4), written=False)
        other = folder.add({AM: 950.0}, case_id(4))
        folder.add({AM: 50.0}, case_id(4), notes={"eta_period_1": "no period <fits>"},
                   scalars={"eta_period_1": math.nan, "focal_rms_um": math.nan})
        folder.fail(failed, "the field is <not> finite")
        content = folder.file(damaged).read_bytes()
        folder.file(damaged).write_bytes(content[: len(content) // 3])
        write_case(folder.file(other), case_id(99))
        text = folder.report()
        page = Page(text)
        self.assertEqual([c["text"] for c in page.column("status")],
                         ["complete"] * 4 + ["failed", "damaged", "missing", "damaged", "complete"])
        self.assertEqual(page.column("eta_period_1")[-1]["text"], "–")
        self.assertIn("efficiency η: no period <fits>", page.data)
        self.assertIn("1 of 4 cases has no mean over periods", page.data)
        self.assertIn("4 cases without a result", page.data)
        self.assertIn(html.escape("the field is <not> finite"), text)
        self.assertIn("it contains another case", page.data)
        self.assertIn("not computed", page.data)
        self.assertEqual(len(page.images), 18)

    def test_a_case_without_measures_has_a_page(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars=dict.fromkeys(SCALARS, math.nan), snapshot=False)
        images = len(Page(folder.report()).images)
        self.assertEqual(images, 7)  # drive, three over time, traces, spectra, spectrograms

    @pytest.mark.extended
    def test_a_sweep_without_references_has_no_columns_of_references(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        folder.add({AM: 200.0})
        names = [cell["title"] for cell in Page(folder.report()).rows[0]]
        self.assertIn("eta_period_1", names)
        self.assertEqual([name for name in names if "reference" in name], [])

    def test_a_single_case_has_no_curves(self):
        folder = Folder(self.root, x="", swept=())
        folder.add({})
        page = Page(folder.report())
        self.assertEqual(len(page.images), 9)
        self.assertIn("The job sweeps no key", page.data)

    @pytest.mark.extended
    def test_x_may_be_a_string(self):
        folder = Folder(self.root, x="load.modulation.kind", swept=["load.modulation.kind"])
        for kind in ("STM", "AM-STM", "SM-STM"):
            folder.add({"load.modulation.kind": kind}, case_id(1), kind=kind)
        self.assertEqual(len(Page(folder.report()).images), 18)

    @pytest.mark.extended
    def test_series_are_curves_in_the_order_of_their_values(self):
        folder = Folder(self.root, series=[FWHM], swept=[AM, FWHM])
        for width in (10.0, 3.0):
            reference = case_id(len(folder.cases) + 4)
            for f in (400.0, 100.0, 200.0):
                folder.add({AM: f, FWHM: width}, reference)
            folder.add({FWHM: width}, is_reference=True, kind="STM")
        page = Page(folder.report())
        groups = layout.groups(load.load(self.root))
        self.assertEqual([g.values for g in groups], [(3.0,), (10.0,)])
        self.assertEqual([c.settings[AM] for c in groups[0].cases], [100.0, 200.0, 400.0])
        self.assertEqual(len(page.images), 18)  # one snapshot per series

    @pytest.mark.extended
    def test_many_cases_share_panels(self):
        folder = Folder(self.root)
        for f in range(1, 16):
            folder.add({AM: 50.0 * f}, snapshot=f < 3)
        self.assertEqual(len(Page(folder.report()).images), 15)

    @pytest.mark.extended
    def test_captions_state_how_many_cases_are_drawn_and_the_option_selects_them(self):
        folder = Folder(self.root)
        for n in range(9):
            folder.add({AM: 100.0 * (n + 1)})
        text = "of 9 cases are drawn; shearwake report --only ID[,ID] draws others."

        def counts(page):
            return {name: int(match.group(1)) for name in ("drive", "spectrograms", "spectra", "eta_time", "surface", "eta")
                    if (match := re.search(f'id="{name}">(?:(?!<figure>).)*<figure>(?:(?!</figure>).)*?([0-9]+) {re.escape(text)}',
                                           page, re.DOTALL))}

        self.assertEqual(counts(folder.report()), {"drive": 3, "spectrograms": 3, "spectra": 6, "eta_time": 6, "surface": 5})
        chosen = [case_id(3), case_id(4)]
        page = report.write_report(self.root, chosen)[0].read_text(encoding="utf-8")
        self.assertEqual(counts(page), dict.fromkeys(["drive", "spectrograms", "spectra", "eta_time", "surface"], 2))
        lines = json.loads(re.search(r'id="chart-eta_time"><script type="application/json">(.*?)</script>', page).group(1))
        self.assertEqual([line["case"] for line in lines[0]["lines"]], chosen)
        with contextlib.redirect_stderr(io.StringIO()) as output:
            self.assertEqual(report.main([str(self.root), "--only", case_id(99)]), report.USAGE)
        self.assertIn("not the id of a complete case", output.getvalue())

    def test_the_command_prints_the_result(self):
        folder = sweep(self.root)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            self.assertEqual(report.main([str(folder.save())]), 0)
        lines = printed.getvalue().splitlines()
        self.assertRegex(lines[0], "^result: The efficiency η is highest at ")
        self.assertEqual(lines[1], f"report: {folder.path / 'report' / 'index.html'}")

    def test_a_sweep_without_complete_cases_has_a_page(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, written=False)
        page = Page(folder.report())
        self.assertIn("No case is complete yet", page.data)
        self.assertFalse(page.images)

    def test_a_folder_without_plan_and_cases_is_rejected(self):
        self.assertEqual(report.main([str(self.root)]), report.ENVIRONMENT)


class WordsTest(unittest.TestCase):
    def test_keys_become_labels(self):
        self.assertEqual(words.axis_label(AM), "AM frequency (Hz)")
        self.assertEqual(words.axis_label("medium.layer[1].c_s_m_s"),
                         "Shear-wave speed, layer 1 (m/s)")
        self.assertEqual(words.axis_label("medium.layer[2].viscosity_Pa_s"),
                         "Viscosity, layer 2 (Pa s)")
        self.assertEqual(words.axis_label("load.modulation.kind"), "Modulation")

    def test_numbers_are_short_and_have_true_minus_signs(self):
        shown = {2858.9: "2859", 0.18: "0.18", -1.5: "\N{MINUS SIGN}1.5", 4.11e-7: "4.11×10⁻⁷",
                 1e6: "1×10⁶", 0.0: "0", math.nan: "", 99999.0: "100000"}
        for value, expected in shown.items():
            self.assertEqual(words.number(value), expected)
        self.assertEqual([words.number(-0.0), words.millimetres(6.123e-16), words.millimetres(-1e-9)], ["0"] * 3)

    def test_counts_have_the_right_number(self):
        self.assertEqual(words.some_of(1, 1, "case"), "1 of 1 case is drawn")
        self.assertEqual(words.some_of(2, 8, "case"), "2 of 8 cases are drawn")


class WakeTest(unittest.TestCase):
    def test_a_path_that_has_ended_stays_at_its_last_position(self):
        case = lone_case("none")
        case.focus = {"time": np.arange(6.0), "focus_x": np.arange(6.0), "focus_y": np.zeros(6),
                      "force": np.array([1.0, 0.0, 1.0, 0.0, 0.0, 0.0])}  # zeros of AM do not end the load
        focus, direction, path = wake.focus_at(case, 5.0)
        self.assertEqual((focus[0], direction[0], len(path)), (2e3, 1.0, 3))
        self.assertFalse(wake.is_over(case, 1.0) or wake.is_over(case, 3.0))
        self.assertTrue(wake.is_over(case, 4.0))

    def test_of_foci_that_differ_by_rounding_the_first_is_the_strongest(self):
        foci = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
        with mock.patch.object(wake, "focus_at", return_value=(np.zeros(2),)), mock.patch.object(wake, "offsets_mm", return_value=foci):
            for sizes, chosen in (((1.0, -1.0 - 1e-9, 0.5), 0), ((np.nan, 1.0, 1.0 + 1e-9), 1), ((1.0, 0.0, -1.1), 2), ((np.nan,) * 3, 0)):
                with self.subTest(sizes=sizes):
                    np.testing.assert_array_equal(wake.strongest_focus_mm(lone_case("none"), 0.0, lambda x, y, u=sizes: np.array(u)), foci[chosen])

    def test_mach_lines_open_behind_the_focus_at_their_angle(self):
        focus, direction = np.array([5.0, 1.0]), np.array([0.6, 0.8])
        for line in wake.fronts(focus, direction, 40.0, 7.0):
            back = line[1] - line[0]
            self.assertAlmostEqual(float(np.hypot(*back)), 7.0)
            self.assertAlmostEqual(float(back @ -direction) / 7.0, math.cos(math.radians(40.0)))
