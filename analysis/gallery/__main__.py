# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of docs/: the gallery, the comparison with the thesis, and the modulations.

Usage: scripts/draw-figures [--keep] [NAME...]    all, or those of some jobs: scripts/draw-figures quickstart

Runs each job into out/JOB unless its cases are complete, draws its report, and stores the figures that
show its result as PNG below 150 KB. The name `modulations` draws those of docs/explanation/modulations.md.
With --keep the existing reports are used and nothing is run. Needs numpy, h5py and matplotlib. Chromium, where it is installed, draws
the report of README.md.
SHEARWAKE names another program than build/shearwake.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image

from shearwake import program

from . import device, efficiency

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
WIDTHS_px, LIMIT_B = (900, 800, 700, 600), 150_000

# The figure of the report that shows the result of a job, by its file name without .png.
GALLERY = {
    "adaptive-gain": "adaptive",
    "am-on-force-or-pressure": "gain",
    "best-circle": "optimise_mean",
    "best-modulation": "optimise_front",
    "best-motion": "optimise_front",
    "bone-under-palm": "surface",
    "circle": "intensity",
    "compressibility": "ipr",
    "device-list": device.draw_folder,
    "fig2.2": "frequency",
    "fig2.3": "gain",
    "fig2.3-steady": "gain",
    "fig2.4": "gain",
    "fig2.4-steady": "gain",
    "fig2.5": "spectra_relative",
    "fig2.6": "raster_2",
    "fig2.7": "places_1",
    "foci": "intensity",
    "frier-speed": "displacement",
    "gaussian-or-array": "eta",
    "gel-dispersion": "surface",
    "lens-letter": "surface",
    "mach-cone": "surface",
    "pointers": "intensity",
    "quickstart": "eta",
    "reardon-square": "displacement",
    "skins": "gain",
    "speed-fwhm-modulation": "heat_eta_period_over_reference_1",
    "studies/howard-gap": "sensation",
    "steady-circle": "eta",
    "thesis-drive": "eta",
    "thesis-drive-displacement": "surface",
    "thesis-drive-phase": "eta",
    "thesis-drive-velocity": "surface",
    "thesis-method": "eta",
    "uncertain-skin": "uncertain_bands",
    "virtual-experiment": "surface",
    "what-is-felt": "afferents_PC",
}

# Figures of docs/explanation/thesis.md: their job and the figure of its report.
THESIS = {
    "surface-2.2": ("fig2.2", "surface"),
    "frequency-2.2": ("fig2.2", "frequency"),
    "gain-2.3": ("fig2.3", "gain"),
    "drive-2.4": ("fig2.4", "drive"),
    "gain-2.4": ("fig2.4", "gain"),
    "spectra-2.5": ("fig2.5", "spectra_relative"),
    "heat": ("speed-fwhm-modulation", "heat_eta_period_over_reference_1"),
    "pointers": ("pointers", "intensity"),
}

# Figures of docs/explanation/best-modulation.md, in the same form.
BEST = {name: ("best-modulation", f"optimise_{figure}")
        for name, figure in (("envelopes", "envelopes"), ("energy", "energy"), ("surfaces", "surfaces_1"))}
BEST["motion"] = ("best-motion", "optimise_energy")
PAGES = {"thesis": THESIS, "best-modulation": BEST}
# Jobs that shearwake optimise runs, and those that only produce numbers.
OPTIMISED = ("best-circle", "best-modulation", "best-motion")
WITHOUT_PICTURE = ("bounds-am", "bounds-sm", "read-back")

# Jobs that take more than a few minutes are shortened as scripts/quickstart does it.
OVERRIDES = {
    "bone-under-palm": [
        "domain.extent_mm=[80, 48]", "load.modulation.path.from_mm=[-14, 0]",
        "load.modulation.am_frequency_Hz=400", "time.duration_ms=4", "measure.at_ms=4",
        "measure.settled_after_ms=1.5", "record.snapshots_ms=[2, 4]",
        'sweep."medium.body[1].depth_mm"=[5, 8, 12]'],
    "studies/howard-gap": [
        "uncertain.samples=2", 'sweep."load.modulation.foci_mm"=[[[-5, 0], [5, 0]], [[-9, 0], [9, 0]], [[-15, 0], [15, 0]]]'],
}

# What a drawing of a modulation needs besides its own block on the page.
MODULATION_JOB = """schema = 1
[job]
name = "modulation"
title = "modulation"
[medium]
preset = "thesis-tissue"
[load]
peak_Pa = 100.0
footprint = {{ shape = "gaussian", fwhm_mm = 3.0 }}
{block}
[domain]
extent_mm = [120.0, 60.0]
spacing_mm = 1.0
[time]
duration_ms = {duration_ms}
output_interval_us = 100.0
"""
DURATIONS_ms = {"DTP": 500.0, "STP": 500.0, "custom": 200.0}  # 14 ms otherwise


def run(job: str, out: Path) -> None:
    overrides = [word for value in OVERRIDES.get(job, []) for word in ("-S", value)]
    program.call(["optimise" if job in OPTIMISED else "run", str(ROOT / "jobs" / f"{job}.toml"), "--out", str(out), "--allow-mixed", *overrides])
    program.call(["report", str(out)])


def photograph(out: Path, picture: Path) -> None:
    """The first screen of a report, by Chromium."""
    subprocess.run(["chromium", "--headless", "--no-sandbox", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--window-size=1100,960",
                    f"--screenshot={picture}", (out / "report" / "index.html").as_uri()], check=True, capture_output=True)


def store(source: Path, target: Path) -> None:
    """A copy of a PNG with a palette of 256 colours, as wide as the size limit permits."""
    with Image.open(source) as opened:
        image = opened.convert("RGB")
    target.parent.mkdir(parents=True, exist_ok=True)
    for width in (w for w in WIDTHS_px if w <= image.width or w == WIDTHS_px[-1]):
        copy = image.resize((width, round(image.height * width / image.width)), Image.Resampling.LANCZOS)
        palette = copy.quantize(256, method=Image.Quantize.MAXCOVERAGE)  # keeps rare colours
        copy = copy.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
        levels = copy.getpalette()
        page = 3 * copy.getpixel((0, 0))
        levels[page:page + 3] = [255, 255, 255]  # a white page stays white
        copy.putpalette(levels)
        copy.save(target, optimize=True)
        if target.stat().st_size <= LIMIT_B:
            print(target.relative_to(ROOT))
            return
    sys.exit(f"{target} is larger than {LIMIT_B} bytes")


def draw_job(job: str, use_existing: bool) -> None:
    out = ROOT / "out" / (f"{job}-short" if job in OVERRIDES else f"{job}.optimise" if job in OPTIMISED else job)
    if not use_existing:
        run(job, out)
    pictures: dict[Path, Any] = {DOCS / "gallery" / f"{Path(job).name}.png": GALLERY[job]}
    if job == "quickstart" and shutil.which("chromium"):
        pictures[DOCS / "gallery" / "report.png"] = photograph
        pictures[DOCS / "gallery" / "efficiency.png"] = efficiency.draw_folder
    for page, figures in PAGES.items():
        for name, (its_job, figure) in figures.items():
            if its_job == job:
                pictures[DOCS / "explanation" / page / f"{name}.png"] = figure
    for target, figure in pictures.items():
        if callable(figure):
            with tempfile.TemporaryDirectory() as folder:
                figure(out, Path(folder) / "picture.png")
                store(Path(folder) / "picture.png", target)
        else:
            store(out / "report" / f"{figure}.png", target)


def draw_modulations() -> None:
    """The modulations of the page, each from the block above its picture."""
    page = (DOCS / "explanation" / "modulations.md").read_text(encoding="utf-8")
    found = re.findall(r"```toml\n([^`]*)```\s*!\[[^\]]*\]\((modulations/([\w-]+)\.png)\)", page)
    if not found:
        sys.exit("docs/explanation/modulations.md has no blocks with pictures")
    with tempfile.TemporaryDirectory() as folder:
        for block, path, name in found:
            job = Path(folder) / "job.toml"
            job.write_text(MODULATION_JOB.format(block=block, duration_ms=DURATIONS_ms.get(name, 14.0)),
                           encoding="utf-8")
            picture = Path(folder) / "picture.png"
            program.call(["show", "--modulation", str(job), "--picture", str(picture)])
            store(picture, DOCS / "explanation" / path)


def main(arguments: list[str]) -> None:
    use_existing = "--keep" in arguments
    jobs = sorted(path.stem for path in (ROOT / "jobs").glob("*.toml") if path.stem not in WITHOUT_PICTURE)
    studies = [name for name in GALLERY if "/" in name]
    if set(jobs) != set(GALLERY) - set(studies):
        sys.exit(f"no figure is chosen for these jobs: {', '.join(sorted(set(jobs) ^ (set(GALLERY) - set(studies))))}")
    jobs += studies
    names = [name for name in arguments if name != "--keep"] or [*jobs, "modulations"]
    for name in names:
        if name == "modulations":
            draw_modulations()
        elif name in GALLERY:
            draw_job(name, use_existing)
        else:
            sys.exit(f"{name} is not a known figure; known: {', '.join([*jobs, 'modulations'])}")


if __name__ == "__main__":
    main(sys.argv[1:])
