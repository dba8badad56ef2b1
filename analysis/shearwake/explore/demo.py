# SPDX-License-Identifier: BSD-3-Clause
"""Writes the page of `shearwake explore` with computed settings, which plays without a server.

Usage: python3 -m shearwake.explore.demo --program PATH PAGE.html
"""
import argparse
import base64
import gzip
import os
import sys
from pathlib import Path

import numpy as np

from . import page
from ..engine import Engine, Evaluation

LARGEST_B = 5_000_000
STORED = ("time", "depth", "force", "focus_x", "focus_y", "eta")  # in addition to the surface
NOTE = ("A demonstration with computed settings. shearwake explore computes any other setting on your machine. The frames of this "
        "page have steps of 1/1023 of the peak.")

JOB = """\
schema = 1

[job]
name = "demonstration"

[medium]
preset = "{preset}"

[load]
peak_Pa = 100.0
footprint = {{ shape = "gaussian", fwhm_mm = {fwhm} }}

[load.modulation]
{modulation}

[domain]
extent_mm = [128.0, 96.0]
spacing_mm = {spacing}
edges = "open"

[time]
duration_ms = 12.0
output_interval_us = 150.0

[solver]
engine = "layered"
"""
LINE = 'path = { shape = "line", from_mm = [-42.0, 0.0], to_mm = [42.0, 0.0] }\n'
CIRCLE = 'path = { shape = "circle", radius_mm = 14.0 }\n'
# Title, preset, FWHM in mm, and the modulation.
SETTINGS: tuple[tuple[str, str, float, str], ...] = (
    ("Moving at 7 m/s: a Mach cone behind the focus", "thesis-tissue", 4.5, f'kind = "STM"\n{LINE}speed_m_s = 7.0'),
    ("The same, amplitude-modulated at 400 Hz", "thesis-tissue", 4.5,
     f'kind = "AM-STM"\n{LINE}speed_m_s = 7.0\nam_frequency_Hz = 400.0'),
    ("Moving at 3 m/s, slower than the waves", "thesis-tissue", 4.5, f'kind = "STM"\n{LINE}speed_m_s = 3.0'),
    ("Speed-modulated: 7 m/s, plus and minus 2 m/s", "thesis-tissue", 4.5,
     f'kind = "SM-STM"\n{LINE}speed_m_s = 7.0\nspeed_deviation_m_s = 2.0\nsm_frequency_Hz = 300.0'),
    ("Resting, amplitude-modulated at 200 Hz", "thesis-tissue", 6.0, 'kind = "AM"\nam_frequency_Hz = 200.0'),
    ("A circle at 7 m/s on the forearm", "forearm", 6.0, f'kind = "STM"\n{CIRCLE}speed_m_s = 7.0'),
    ("A line at 7 m/s on skin of three layers", "three-layer-skin", 6.0, f'kind = "STM"\n{LINE}speed_m_s = 7.0'),
)


def job_of(preset: str, fwhm: float, modulation: str) -> str:
    return JOB.format(preset=preset, fwhm=fwhm, modulation=modulation, spacing=round(fwhm / 3.6, 2))


def stored(title: str, job: str, found: Evaluation) -> dict:
    """One setting for the page: its header, and its arrays compressed, with the surface in steps of 1/1023 of its peak."""
    header = {name: found.message[name] for name in ("case", "spacing_m", "fwhm_m", "foci_m", "surface_wave_m_s", "seconds", "warnings",
                                               "columns")}
    selected, parts = [], []
    for array in found.message["arrays"]:
        values = found.arrays[array["name"]]
        if array["name"] == "u_z":
            peak_m = float(np.abs(values).max())
            parts.append(np.rint(1023.0 * values / (peak_m or 1.0)).astype("<i2").tobytes())
        elif array["name"] in STORED:
            parts.append(values.tobytes())
        else:
            continue
        selected.append(array)
    header["arrays"] = selected
    data = base64.b64encode(gzip.compress(b"".join(parts), 9, mtime=0)).decode("ascii")
    return {"title": title, "settings": {}, "job": job, "header": header, "peak_m": peak_m, "data": data}


def compute() -> list[dict]:
    """All settings. Raises ProgramError if one of them cannot be computed."""
    with Engine() as engine:
        return [stored(title, job := job_of(preset, fwhm, modulation), engine.evaluate(job))
                for title, preset, fwhm, modulation in SETTINGS]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("page", type=Path)
    arguments = parser.parse_args()
    os.environ["SHEARWAKE"] = arguments.program
    text, _ = page.document({"stored": compute(), "note": NOTE, **page.keys_of()})
    if len(text.encode()) > LARGEST_B:
        sys.exit(f"the demonstration has {len(text.encode())} bytes; at most {LARGEST_B} are allowed")
    arguments.page.parent.mkdir(parents=True, exist_ok=True)
    arguments.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
