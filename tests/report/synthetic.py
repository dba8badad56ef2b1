# SPDX-License-Identifier: BSD-3-Clause
"""Small synthetic folders with complete, failed, damaged and empty cases, for the tests of reports."""
import json
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from program import seal
from shearwake import Case, program
from shearwake.checksum import sealed
from shearwake.report import __main__ as report, load, style
from shearwake.report.style import plt

style.DPI, style.PDF = 30, False  # draws faster
with_pdf = mock.patch.object(style, "PDF", True)
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
    program.call(["reduce", str(folder)], (0, 4))


def write_case(path, identity, kind="AM-STM", scalars=None, notes=None, snapshot=True,
               frames=False, drawn=None, facts=None, strength=1.0, physics=None):
    """A case file in the layout of src/pipeline/case_content.cpp, a few samples wide; `strength` scales its motion."""
    time = 1e-4 * np.arange(1, 41)
    wave = 1.0 + 0.5 * np.sin(2 * np.pi * 500 * time)
    with h5py.File(path, "w") as file:
        file.attrs.update(fixed({
            "title": "t", "Conventions": "CF-1.8", "case_id": identity, "settings": "{}",
            "case": physics or PHYSICS.format(kind=kind), "is_reference": "no", "reference_id": "", "job": "",
            "program": "shearwake 0.1.0", "git_id": "abc", "compiler": "g++", "host": "laptop",
            "build_type": "Release", "mpi_version": "m", "fftw_version": "f", "hdf5_version": "h",
            "ranks": 2, "wall_s": 0.5, "started": "2026-01-02T03:04:05Z",
            "ended": "2026-01-02T03:04:06Z", "status": "complete", **(facts or {})}))
        file["time"], file["depth"] = time, [0.0]
        file["focus_x"], file["focus_y"] = 7.0 * time, 0.0 * time
        file["force"] = wave
        for name in ("eta", "ipr", "ipr_abs", "participation", "peak", "focal_rms"):
            file[name] = wave[None, :] * (0.2 if name == "eta" else strength if name == "peak" else 1.0)
        for name, value in {**SCALARS, **(scalars or {})}.items():
            file[name] = float(value)
            if name in (notes or {}):
                file[name].attrs.update(fixed({"note": notes[name]}))
        traces = file.create_group("traces")
        traces["x"], traces["y"], traces["trace"] = [0.0], [0.0], [0.0]
        traces["time"], traces["u_z"] = time, 1e-6 * strength * wave[None, :]
        traces["frequency"] = 50.0 * np.arange(41)
        traces["amplitude"] = 1e-7 * strength * np.ones((1, 41))
        if drawn:
            draw(file, time, drawn)
        if snapshot:
            x, y = 1e-3 * np.arange(-10, 40), 1e-3 * np.arange(-15, 16)
            surface = file.create_group("surface")
            kept = time if frames else np.array([0.002, 0.004])
            surface["time"], surface["depth"] = kept, [0.0]
            surface["x"], surface["y"] = x, y
            spots = [np.exp(-((x[:, None] - 7.0 * t) ** 2 + y[None, :] ** 2) / 8e-6) for t in kept]
            surface["u_z"] = np.stack(spots)[:, None] * 3e-6 * strength


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


def lone_case(path, parameters=None, attributes=None):
    """A case whose file, if there is one, lacks attributes, with these parameters and attributes instead."""
    case = Case(Path(path), {"id": "case", "settings": {}, "is_reference": False, "reference_id": ""})
    case.parameters, case.attributes = parameters or {}, attributes or {}
    return case


class Folder:
    """An output folder: `add` cases, then `report`."""

    def __init__(self, root, title="a sweep", x=AM, series=(), swept=(AM,),
                 job="schema = 1 # <& job>\n"):
        self.path, self.cases, self.job = Path(root), [], job
        self.plan = {"schema": 2, "name": "s", "title": title, "swept_keys": list(swept),
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
                     "reference_id": reference or "", "job": self.job,
                     "warnings": json.dumps(content.pop("warnings", []))}
            write_case(self.file(identity), identity, facts=facts, **content)
        return identity

    def file(self, identity):
        return self.path / "cases" / (identity + ".h5")

    def change(self, identity, old, new):
        """Replaces a part of the resolved case of a file, or adds to its end if `old` is empty."""
        with h5py.File(self.file(identity), "r+") as file:
            text = file.attrs["case"].decode()
            file.attrs["case"] = np.bytes_((text.replace(old, new) if old else text + new).encode())

    def fail(self, identity, reason):
        with open(self.path / "journal.jsonl", "a") as journal:
            journal.write(sealed({"event": "failed", "id": identity, "host": "laptop", "unix_s": 1.0,
                                  "blame": "case", "reason": reason}, end="") + "\n")
            journal.write('{"event":"fini')

    def save(self):
        (self.path / "plan.json").write_text(sealed(self.plan))
        for file in (self.path / "cases").glob("*.h5"):
            seal(file)
        reduce(self.path)
        return self.path

    def report(self):
        path, _, problems, _ = report.write_report(self.save())
        if problems:
            raise AssertionError(problems)
        return path.read_text(encoding="utf-8")


class InFolder(unittest.TestCase):
    """A test with a temporary folder, `root`."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)

    def drawn(self, folder, *modules):
        """The loaded sweep, the figures of modules and those of matplotlib, both by name; each is a file."""
        loaded, target = load.load(folder.save()), self.root / "report"
        target.mkdir(exist_ok=True)
        figures = {figure.name: figure for module in modules for figure in module.figures(loaded)}
        kept = {name: figure.drawn for name, figure in figures.items()}
        with mock.patch.object(plt, "close"):
            for figure in figures.values():
                figure.save(target)
        self.addCleanup(plt.close, "all")
        return loaded, figures, kept


def plain(text):
    """Without NO-BREAK SPACE."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


class Page(HTMLParser):
    """Parses a page: checks the nesting of elements and collects resources, cells and text."""

    VOID = {"meta", "img", "wbr", "br", "link", "input"}

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.resources, self.links, self.images, self.rows, self.tags = [], [], [], [], [], []
        self.data, self.titles = "", []
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        values = dict(attributes)
        for name in ("src", "href", "srcset", "data", "action"):
            if name in values:
                (self.links if tag == "a" else self.resources).append(values[name])
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
        names = [cell["title"] for cell in self.rows[0]]
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
