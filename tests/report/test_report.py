#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report of small synthetic folders with complete, failed, damaged and empty cases.

Run: python3 tests/report/test_report.py    (unittest, numpy, h5py, matplotlib; seconds)
"""
import contextlib
import html
import io
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("SHEARWAKE", str(ROOT / "build" / "shearwake"))
sys.path.insert(0, str(ROOT / "analysis" / "report"))

import layout  # noqa: E402
import load  # noqa: E402
import report  # noqa: E402
import style  # noqa: E402
import wake  # noqa: E402
import words  # noqa: E402
from summary import summary  # noqa: E402

style.DPI = 30  # draws faster
AM = "load.modulation.am_frequency_Hz"
FWHM = "load.footprint.fwhm_mm"
PHYSICS = """
[load.modulation]
kind = "{kind}"
[domain]
spacing_m = 0.001
[measure]
at_s = 0.004
settled_after_s = 0.001
focal_radius_m = 0.003
"""
SCALARS = {"eta_at_1": 0.2, "eta_period_1": 0.25, "ipr_at_1": 3e-9, "ipr_period_1": 2e-9,
           "ipr_at_mm2": 3e-9, "ipr_period_mm2": 2e-9, "ipr_abs_at_mm2": 2100.0,
           "ipr_abs_period_mm2": 2200.0, "participation_at_mm2": 130.0,
           "participation_period_mm2": 120.0, "peak_um": 3.3, "focal_rms_um": 1.5,
           "impulse_mN_ms": 7.0, "peak_frequency_Hz": 120.0, "rms_40_400_um": 0.3,
           "mach_angle_deg": 41.0, "mach_angle_theory_deg": 43.0}


def case_id(number):
    return f"{number:016x}"


def fixed(attributes):
    """Texts of fixed length, as the program writes them."""
    return {name: np.bytes_(value.encode() or b"\0") if isinstance(value, str) else value
            for name, value in attributes.items()}


def reduce(folder):
    """The report draws what `shearwake reduce` wrote. Exit code 4: cases are missing or damaged."""
    done = subprocess.run([PROGRAM, "reduce", str(folder)], check=False, capture_output=True,
                          text=True, env={**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                          "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    if done.returncode not in (0, 4):
        raise AssertionError(done.stdout + done.stderr)


def write_case(path, identity, kind="AM-STM", scalars=None, notes=None, snapshot=True,
               frames=False, drawn=None, facts=None):
    """A case file in the layout of src/pipeline/case_content.cpp, a few samples wide."""
    time = 1e-4 * np.arange(1, 41)
    wave = 1.0 + 0.5 * np.sin(2 * np.pi * 500 * time)
    with h5py.File(path, "w") as file:
        file.attrs.update(fixed({
            "title": "t", "Conventions": "CF-1.8", "case_id": identity, "settings": "{}",
            "case": PHYSICS.format(kind=kind), "is_reference": "no", "reference_id": "", "job": "",
            "program": "shearwake 0.1.0", "git_id": "abc", "compiler": "g++", "host": "laptop",
            "build_type": "Release", "mpi_version": "m", "fftw_version": "f", "hdf5_version": "h",
            "ranks": 2, "wall_s": 0.5, "started": "2026-01-02T03:04:05Z",
            "ended": "2026-01-02T03:04:06Z", "status": "complete", **(facts or {})}))
        file["time"], file["depth"] = time, [0.0]
        file["focus_x"], file["focus_y"] = 7.0 * time, 0.0 * time
        file["force"] = wave
        for name in ("eta", "ipr", "ipr_abs", "participation", "peak", "focal_rms"):
            file[name] = wave[None, :] * (0.2 if name == "eta" else 1.0)
        for name, value in {**SCALARS, **(scalars or {})}.items():
            file[name] = float(value)
            if name in (notes or {}):
                file[name].attrs.update(fixed({"note": notes[name]}))
        traces = file.create_group("traces")
        traces["x"], traces["y"], traces["trace"] = [0.0], [0.0], [0.0]
        traces["time"], traces["u_z"] = time, 1e-6 * wave[None, :]
        traces["frequency"] = 50.0 * np.arange(41)
        traces["amplitude"] = 1e-7 * np.ones((1, 41))
        if drawn:
            draw(file, time, drawn)
        if snapshot:
            x, y = 1e-3 * np.arange(-10, 40), 1e-3 * np.arange(-15, 16)
            surface = file.create_group("surface")
            kept = time if frames else np.array([0.002, 0.004])
            surface["time"], surface["depth"] = kept, [0.0]
            surface["x"], surface["y"] = x, y
            spots = [np.exp(-((x[:, None] - 7.0 * t) ** 2 + y[None, :] ** 2) / 8e-6) for t in kept]
            surface["u_z"] = np.stack(spots)[:, None] * 3e-6


def draw(file, time, lines):
    """Adds a focus that moves on a circle, and a mean intensity with the drawn lines, (x, y) in m."""
    del file["focus_x"], file["focus_y"]
    file["focus_x"], file["focus_y"] = 0.01 * np.cos(2e3 * time), 0.01 * np.sin(2e3 * time)
    mean = file.create_group("mean")
    mean["x"], mean["y"] = 1e-3 * np.arange(-20, 21), 1e-3 * np.arange(-15, 16)
    mean["u_z_squared"] = 1e-12 * np.ones((41, 31))
    mean["drawn_line"] = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    points = np.concatenate(lines)
    mean["drawn_x"], mean["drawn_y"] = points[:, 0], points[:, 1]


class Folder:
    """An output folder: `add` cases, then `report`."""

    def __init__(self, root, title="a sweep", x=AM, series=(), swept=(AM,),
                 job="schema = 1 # <& job>\n"):
        self.path, self.cases, self.job = Path(root), [], job
        self.plan = {"schema": 1, "name": "s", "title": title, "swept_keys": list(swept),
                     "table": {"x": x, "series": list(series)}, "cases": self.cases}
        (self.path / "cases").mkdir()
        (self.path / "job.toml").write_text(job)

    def add(self, settings, reference=None, is_reference=False, **content):
        identity = case_id(len(self.cases) + 1)
        self.cases.append({"id": identity, "settings": settings, "is_reference": is_reference,
                           "reference_id": reference or "", "case": ""})
        if content.pop("written", True):
            facts = {"title": self.plan["title"], "settings": json.dumps(settings),
                     "is_reference": "yes" if is_reference else "no",
                     "reference_id": reference or "", "job": self.job}
            write_case(self.file(identity), identity, facts=facts, **content)
        return identity

    def file(self, identity):
        return self.path / "cases" / (identity + ".h5")

    def fail(self, identity, reason):
        with open(self.path / "journal.jsonl", "a") as journal:
            journal.write(json.dumps({"event": "failed", "id": identity, "host": "laptop", "unix_s": 1.0,
                                      "reason": reason}) + "\n")
            journal.write('{"event":"fini')

    def save(self):
        (self.path / "plan.json").write_text(json.dumps(self.plan))
        reduce(self.path)
        return self.path

    def report(self):
        path, _, problems, _ = report.write_report(self.save())
        if problems:
            raise AssertionError(problems)
        return path.read_text(encoding="utf-8")


class Page(HTMLParser):
    """Parses a page: checks the nesting of elements and collects resources, cells and text."""

    VOID = {"meta", "img", "wbr", "br", "link", "input"}

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.resources, self.images, self.rows, self.tags = [], [], [], [], []
        self.data, self.titles = "", []
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        values = dict(attributes)
        for name in ("src", "href", "srcset", "data", "action"):
            if name in values:
                self.resources.append(values[name])
        if tag == "img":
            self.images.append(values)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append({"title": values.get("title"), "text": ""})
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data):
        self.data += data
        if "tr" in self.open and self.rows and self.rows[-1]:
            self.rows[-1][-1]["text"] += data

    def column(self, name):
        names = [cell["text"] for cell in self.rows[0]]
        return [row[names.index(name)] for row in self.rows[1:]]


def sweep(root, **options):
    """Three frequencies and their reference, all complete."""
    folder = Folder(root, **options)
    reference = case_id(4)
    for number, f in enumerate([100.0, 200.0, 400.0]):
        folder.add({AM: f}, reference, scalars={"eta_period_1": 0.25 + 0.01 * number,
                                                "focal_rms_um": 1.5 - 0.1 * number})
    folder.add({}, is_reference=True, kind="STM",
               scalars={"eta_period_1": 0.24, "focal_rms_um": 3.0})
    return folder


class WholeSweepTest(unittest.TestCase):
    """A sweep that is drawn once for all tests."""

    TITLE = '<script>alert("1")</script> & more'

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = sweep(cls.temporary.name, title=cls.TITLE)
        cls.text = cls.folder.report()
        cls.page = Page(cls.text)

    def test_every_figure_is_a_file_and_part_of_the_page(self):
        names = {"eta", "gain", "strength", "ipr_abs", "participation", "ipr", "frequency",
                 "drive", "eta_time", "ipr_abs_time", "ipr_time", "surface", "spectra",
                 "spectra_relative", "spectrograms"}
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.png")}, names)
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.pdf")}, names)
        self.assertEqual(len(self.page.images), len(names))
        for image in self.page.images:
            self.assertTrue(image["src"].startswith("data:image/png;base64,"))
            self.assertTrue(image["alt"])

    def test_the_page_loads_nothing_from_elsewhere(self):
        for resource in self.page.resources:
            self.assertTrue(resource.startswith(("data:", "#")), resource[:80])
        self.assertNotIn("http", re.sub(r"base64,[A-Za-z0-9+/=]*", "", self.text))
        self.assertNotIn("@import", self.text)

    def test_text_of_the_user_is_escaped(self):
        self.assertNotIn("<script>alert", self.text)
        self.assertEqual(self.page.tags.count("script"), 2)  # pictures of the slider, and page.js
        self.assertIn(self.TITLE, self.page.data)
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
        self.assertIn(f"AM-STM at AM frequency 400{gap}Hz focuses best: its efficiency η (eta_period_1) is "
                      "0.27, 13 % more than the 0.24 of plain STM.", self.page.data)
        self.assertIn(f"0.43 (AM frequency 400{gap}Hz) to 0.5", self.page.data)
        self.assertIn("4 cases (of them 1 reference): 4 complete.", self.page.data)

    def test_the_page_states_its_provenance(self):
        for fact in ("shearwake 0.1.0", "abc", "laptop", "2026-01-02 03:04:05 UTC"):
            self.assertIn(fact, self.page.data)


class ReportTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = Path(self.temporary.name)

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
        self.assertIn("eta_period_1: no period <fits>", page.data)
        self.assertIn("1 of 4 cases have no mean over periods", page.data)
        self.assertIn("4 cases without a result", page.data)
        self.assertIn(html.escape("the field is <not> finite"), text)
        self.assertIn("it contains another case", page.data)
        self.assertIn("not computed", page.data)
        self.assertEqual(len(page.images), 15)

    def test_a_case_without_measures_has_a_page(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars=dict.fromkeys(SCALARS, math.nan), snapshot=False)
        images = len(Page(folder.report()).images)
        self.assertEqual(images, 6)  # drive, three over time, spectra, spectrograms

    def test_a_single_case_has_no_curves(self):
        folder = Folder(self.root, x="", swept=())
        folder.add({})
        page = Page(folder.report())
        self.assertEqual(len(page.images), 7)
        self.assertIn("The job sweeps no key", page.data)

    def test_x_may_be_a_string(self):
        folder = Folder(self.root, x="load.modulation.kind", swept=["load.modulation.kind"])
        for kind in ("STM", "AM-STM", "SM-STM"):
            folder.add({"load.modulation.kind": kind}, case_id(1), kind=kind)
        self.assertEqual(len(Page(folder.report()).images), 15)

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
        self.assertEqual(len(page.images), 15)  # one snapshot per series

    def test_many_cases_share_panels(self):
        folder = Folder(self.root)
        for f in range(1, 16):
            folder.add({AM: 50.0 * f}, snapshot=f < 3)
        self.assertEqual(len(Page(folder.report()).images), 13)

    def summary(self, values, references=(0.2,), **settings):
        """The summary of cases with these efficiencies, of each of the references."""
        folder = Folder(self.root, **settings)
        number = len(values) * len(references)
        for place, reference in enumerate(references):
            for n, value in enumerate(values):
                folder.add({AM: 100.0 * (n + 1), FWHM: 2.0 + place}, case_id(number + 1 + place),
                           scalars={"eta_period_1": value * reference / references[0]})
        for place, reference in enumerate(references):
            folder.add({FWHM: 2.0 + place}, is_reference=True, kind="STM", scalars={"eta_period_1": reference})
        return summary(load.load(folder.save())).replace("\N{NO-BREAK SPACE}", " ")

    def test_the_summary_states_a_large_gain_as_a_factor(self):
        self.assertIn("AM-STM at AM frequency 200 Hz focuses best: its efficiency η (eta_period_1) is 0.5, "
                      "2.5 times the 0.2 of plain STM.", self.summary([0.3, 0.5]))

    def test_the_summary_reports_that_no_case_is_better_than_the_reference(self):
        self.assertIn("No case focuses better than plain STM. The best is AM-STM at AM frequency 100 Hz: its "
                      "efficiency η (eta_period_1) is 0.15, 25 % less than the 0.2 of plain STM.",
                      self.summary([0.15, 0.1]))

    def test_the_summary_compares_each_case_with_its_own_reference(self):
        text = self.summary([0.3, 0.5], (0.2, 0.4), series=[FWHM], swept=[AM, FWHM])
        self.assertIn("AM-STM at AM frequency 200 Hz, focus FWHM 2 mm improves most on plain STM under the same "
                      "conditions", text)
        self.assertIn("0.5, 2.5 times the 0.2 of plain STM.", text)

    def test_the_summary_names_the_body_of_a_key(self):
        folder = Folder(self.root, x="medium.body[1].depth_mm", swept=["medium.body[1].depth_mm"])
        for depth, value in ((5.0, 0.3), (8.0, 0.4)):
            folder.add({"medium.body[1].depth_mm": depth}, scalars={"eta_period_1": value})
        self.assertIn("The efficiency η (eta_period_1) is highest, 0.4, at depth of body 1 = 8\N{NO-BREAK SPACE}mm.",
                      summary(load.load(folder.save())))

    def test_the_command_prints_the_result(self):
        folder = sweep(self.root)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            self.assertEqual(report.main([str(folder.save())]), 0)
        lines = printed.getvalue().splitlines()
        self.assertRegex(lines[0], "^result: AM-STM at .* focuses best")
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


class WakeTest(unittest.TestCase):
    def test_a_path_that_has_ended_stays_at_its_last_position(self):
        case = load.Case(case_id(1), {}, False, "", Path("none"))
        case.series = {"time": np.arange(6.0), "focus_x": np.arange(6.0), "focus_y": np.zeros(6),
                       "force": np.array([1.0, 0.0, 1.0, 0.0, 0.0, 0.0])}  # zeros of AM do not end the load
        focus, direction, path = wake.focus_at(case, 5.0)
        self.assertEqual((focus[0], direction[0], len(path)), (2e3, 1.0, 3))
        self.assertFalse(wake.is_over(case, 1.0) or wake.is_over(case, 3.0))
        self.assertTrue(wake.is_over(case, 4.0))

    def test_mach_lines_open_behind_the_focus_at_their_angle(self):
        focus, direction = np.array([5.0, 1.0]), np.array([0.6, 0.8])
        for line in wake.fronts(focus, direction, 40.0, 7.0):
            back = line[1] - line[0]
            self.assertAlmostEqual(float(np.hypot(*back)), 7.0)
            self.assertAlmostEqual(float(back @ -direction) / 7.0, math.cos(math.radians(40.0)))


if __name__ == "__main__":
    unittest.main()
