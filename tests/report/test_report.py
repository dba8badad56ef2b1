#!/usr/bin/env python3
"""The report on small synthetic folders: whole, failed, damaged and empty cases.

Run: python3 tests/report/test_report.py    (unittest, numpy, h5py, matplotlib; seconds)
"""
import html
import json
import math
import re
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "analysis" / "report"))

import layout  # noqa: E402
import load  # noqa: E402
import report  # noqa: E402
import style  # noqa: E402
import table  # noqa: E402
import wake  # noqa: E402
import words  # noqa: E402

style.DPI = 30  # what is drawn is the same, and quicker
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


def write_case(path, identity, kind="AM-STM", scalars=None, notes=None, snapshot=True,
               frames=False, drawn=None, facts=None):
    """A case file in the layout of src/sweep/case_content.cpp, a few samples wide."""
    time = 1e-4 * np.arange(1, 41)
    wave = 1.0 + 0.5 * np.sin(2 * np.pi * 500 * time)
    with h5py.File(path, "w") as file:
        file.attrs.update({
            "title": "t", "Conventions": "CF-1.8", "case_id": identity, "settings": "{}",
            "case": PHYSICS.format(kind=kind), "is_reference": "no", "reference_id": "", "job": "",
            "program": "shearwake 0.1.0", "git_id": "abc", "compiler": "g++", "host": "laptop",
            "build_type": "Release", "mpi_version": "m", "fftw_version": "f", "hdf5_version": "h",
            "ranks": 2, "wall_s": 0.5, "started": "2026-01-02T03:04:05Z",
            "ended": "2026-01-02T03:04:06Z", "status": "complete", **(facts or {})})
        file["time"], file["depth"] = time, [0.0]
        file["focus_x"], file["focus_y"] = 7.0 * time, 0.0 * time
        file["force"] = wave
        for name in ("eta", "ipr", "ipr_abs", "participation", "peak", "focal_rms"):
            file[name] = wave[None, :] * (0.2 if name == "eta" else 1.0)
        for name, value in {**SCALARS, **(scalars or {})}.items():
            file[name] = float(value)
            if name in (notes or {}):
                file[name].attrs["note"] = notes[name]
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
    """A focus that runs around, and the mean of what it does along the lines, (x, y) in m."""
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
            journal.write(json.dumps({"event": "failed", "id": identity, "reason": reason}) + "\n")
            journal.write('{"event":"fini')

    def save(self):
        (self.path / "plan.json").write_text(json.dumps(self.plan))
        return self.path

    def report(self):
        path, problems = report.write_report(self.save())
        if problems:
            raise AssertionError(problems)
        return path.read_text(encoding="utf-8")


class Page(HTMLParser):
    """Elements that are opened and closed in order; resources, cells and the words between."""

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
    """Three frequencies and their reference, none of them troubled."""
    folder = Folder(root, **options)
    reference = case_id(4)
    for number, f in enumerate([100.0, 200.0, 400.0]):
        folder.add({AM: f}, reference, scalars={"eta_period_1": 0.25 + 0.01 * number,
                                                "focal_rms_um": 1.5 - 0.1 * number})
    folder.add({}, is_reference=True, kind="STM",
               scalars={"eta_period_1": 0.24, "focal_rms_um": 3.0})
    return folder


class WholeSweepTest(unittest.TestCase):
    """One sweep, drawn once."""

    TITLE = '<script>alert("1")</script> & more'

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = sweep(cls.temporary.name, title=cls.TITLE)
        cls.text = cls.folder.report()
        cls.page = Page(cls.text)

    def test_every_figure_is_a_picture_and_inside_the_page(self):
        names = {"eta", "gain", "strength", "ipr_abs", "participation", "ipr", "frequency",
                 "drive", "eta_time", "ipr_abs_time", "ipr_time", "surface", "spectra",
                 "spectra_relative", "spectrograms"}
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.png")}, names)
        self.assertEqual({p.stem for p in (self.folder.path / "report").glob("*.pdf")}, names)
        self.assertEqual(len(self.page.images), len(names))
        for image in self.page.images:
            self.assertTrue(image["src"].startswith("data:image/png;base64,"))
            self.assertTrue(image["alt"])

    def test_the_page_fetches_nothing(self):
        for resource in self.page.resources:
            self.assertTrue(resource.startswith(("data:", "#")), resource[:80])
        self.assertNotIn("http", re.sub(r"base64,[A-Za-z0-9+/=]*", "", self.text))
        self.assertNotIn("@import", self.text)

    def test_words_of_the_user_are_escaped(self):
        self.assertNotIn("<script>alert", self.text)
        self.assertEqual(self.page.tags.count("script"), 2)  # the slider's pictures, page.js
        self.assertIn(self.TITLE, self.page.data)
        self.assertIn("# <& job>", self.page.data)

    def test_the_table_holds_the_numbers_of_the_files(self):
        for column in table.MEASURES:
            if column in table.RATIOS:
                continue
            for row, cell in zip(self.folder.cases, self.page.column(column)):
                with h5py.File(self.folder.file(row["id"])) as file:
                    self.assertEqual(cell["title"], f"{file[column][()]:.9g}")
        self.assertEqual([c["text"] for c in self.page.column(AM)], ["100", "200", "400", "–"])
        self.assertEqual(self.page.column("eta_period_over_reference_1")[1]["title"],
                         f"{0.26 / 0.24:.9g}")
        self.assertEqual(self.page.column("focal_rms_over_reference_1")[0]["text"], "0.5")

    def test_the_summary_names_the_best_case(self):
        gap = "\N{NO-BREAK SPACE}"
        self.assertIn(f"highest at AM frequency 400{gap}Hz: 0.27 against 0.24, 13 % more",
                      self.page.data)
        self.assertIn(f"0.43 (AM frequency 400{gap}Hz) to 0.5", self.page.data)
        self.assertIn("4 cases (of them 1 reference): 4 complete.", self.page.data)

    def test_how_it_was_computed_is_told(self):
        for fact in ("shearwake 0.1.0", "abc", "laptop", "2026-01-02 03:04:05 UTC"):
            self.assertIn(fact, self.page.data)


class ReportTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.root = Path(self.temporary.name)

    def test_troubled_cases_are_listed_and_break_no_figure(self):
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
        self.assertIn("1 of 4 cases have no period reading", page.data)
        self.assertIn("4 cases without a result", page.data)
        self.assertIn(html.escape("the field is <not> finite"), text)
        self.assertIn("it holds another case", page.data)
        self.assertIn("not computed", page.data)
        self.assertEqual(len(page.images), 15)

    def test_all_measures_empty_still_make_a_page(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars=dict.fromkeys(SCALARS, math.nan), snapshot=False)
        images = len(Page(folder.report()).images)
        self.assertEqual(images, 7)  # bands, drive, three over time, spectra, spectrograms

    def test_a_lone_case_has_no_curves(self):
        folder = Folder(self.root, x="", swept=())
        folder.add({})
        page = Page(folder.report())
        self.assertEqual(len(page.images), 7)
        self.assertIn("Nothing is swept", page.data)

    def test_x_may_be_words(self):
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
        self.assertEqual(len(page.images), 15)  # a snapshot for each series

    def test_many_cases_share_panels(self):
        folder = Folder(self.root)
        for f in range(1, 16):
            folder.add({AM: 50.0 * f}, snapshot=f < 3)
        self.assertEqual(len(Page(folder.report()).images), 13)

    def test_no_whole_case_is_said(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, written=False)
        page = Page(folder.report())
        self.assertIn("No case is whole yet", page.data)
        self.assertFalse(page.images)

    def test_a_folder_without_plan_and_cases_is_refused(self):
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
    def test_a_path_that_has_ended_stays_where_it_last_pressed(self):
        case = load.Case(case_id(1), {}, False, "", Path("none"))
        case.series = {"time": np.arange(6.0), "focus_x": np.arange(6.0), "focus_y": np.zeros(6),
                       "force": np.array([1.0, 0.0, 1.0, 0.0, 0.0, 0.0])}  # zeros of AM are no end
        focus, direction, path = wake.focus_at(case, 5.0)
        self.assertEqual((focus[0], direction[0], len(path)), (2e3, 1.0, 3))
        self.assertFalse(wake.is_over(case, 1.0) or wake.is_over(case, 3.0))
        self.assertTrue(wake.is_over(case, 4.0))

    def test_fronts_open_behind_the_focus_at_the_angle(self):
        focus, direction = np.array([5.0, 1.0]), np.array([0.6, 0.8])
        for line in wake.fronts(focus, direction, 40.0, 7.0):
            back = line[1] - line[0]
            self.assertAlmostEqual(float(np.hypot(*back)), 7.0)
            self.assertAlmostEqual(float(back @ -direction) / 7.0, math.cos(math.radians(40.0)))


if __name__ == "__main__":
    unittest.main()
