# SPDX-License-Identifier: BSD-3-Clause
"""The load of each job in jobs/, written for devices and read back. Nothing is computed with it."""
import functools

import numpy as np
import pytest

from shearwake import program
from shearwake.device.load import Load, single_case
from shearwake.device.read import read
from shearwake.device.targets import AUTD3_STEP_mm, TARGETS, BadExport
from shearwake.keys import job_tables

from program import ROOT

RATE_Hz = 8000.0  # of .wav and .hjif
JOBS = sorted(path for path in (ROOT / "jobs").glob("*.toml") if "modulation" in job_tables(path.read_text(encoding="utf-8")).get("load", {}))
# A focus at rest, on a line, a circle, a polygon and a trajectory, at a constant and an oscillating speed, a drawn shape, several foci,
# an array, a list in a file, and a lens.
EACH_KIND = ("bounds-sm", "circle", "device-list", "fig2.6", "foci", "frier-speed", "gel-dispersion", "lens-letter", "pointers", "read-back",
             "reardon-square")


def read_back(made, name, folder):
    """Samples twice as dense as those of the list, by the program: every second one is in the middle of a rest."""
    tables = made.load.job.tables
    tables["load"]["modulation"] = made.table(folder / name)
    tables["sweep"]["load.modulation.kind"] = ["file"]
    tables["load"]["footprint"].pop("update_rate_kHz", None)
    with made.load.job.with_tables(tables).file() as job:
        return program.call_json(["show", "--modulation", str(job), f"--rate={2 * RATE_Hz}"])["run"]


def written(made, suffix, folder):
    content = made.files[suffix]
    (folder / f"file{suffix}").write_bytes(content if isinstance(content, bytes) else content.encode())
    return f"file{suffix}"


def columns(run):
    """x and y in mm and the gain on the force."""
    return np.column_stack((1e3 * np.array(run["x_m"]), 1e3 * np.array(run["y_m"]), run["gain"]))


def compared(asked):
    """Samples where the load does not jump, since at the time of a jump, rounding selects its value."""
    steps = np.abs(np.diff(asked, axis=0))
    jumps = (steps > 5 * np.mean(steps, axis=0) + 1e-4).any(axis=1)
    return ~(np.append(jumps, False) | np.append(False, jumps))


@pytest.mark.parametrize("path", [pytest.param(path, id=path.stem, marks=[] if path.stem in EACH_KIND else pytest.mark.extended) for path in JOBS])
def test_a_load_returns_from_the_files_of_devices(path, tmp_path):
    load = Load(single_case(path, []))
    load.show = functools.cache(load.show)
    if load.job.tables["load"]["footprint"].get("shape") == "lens":
        return stays_at_rest(load)
    made = TARGETS["csv"](load, RATE_Hz)
    asked = np.column_stack((made.asked.points_mm, made.asked.levels))

    # The samples are those of the case: all of its run, unless a cycle is stretched to a whole number of samples, which is stated.
    run = columns(load.show(RATE_Hz)["run"])[:-1]
    stretched = abs(made.stretch - 1) > 1e-9
    assert stretched == any("a whole number of samples" in note for note in made.notes)
    count = min(len(run), len(asked)) if stretched or not load.cycle_s else len(run)
    smooth = compared(run[:count])
    assert smooth.mean() >= 0.5
    np.testing.assert_allclose(np.resize(asked, (count, 3))[smooth], run[:count][smooth], atol=1e-4)

    # The program reads the list back.
    back = columns(read_back(made, written(made, ".csv", tmp_path), tmp_path))[1::2]
    count = min(len(back), len(run) if load.cycle_s else len(asked))
    assert count >= min(len(asked), len(run)) - 1
    np.testing.assert_allclose(back[:count], np.resize(asked, (count, 3)), atol=1e-4)

    # Envelopes keep the strength to 16 bits of the pressure, which are 4e-5 of the force, and keyframes to 1e-7.
    for kind in ("wav", "hjif"):
        of_kind = TARGETS[kind](load, RATE_Hz)
        found = read(tmp_path / written(of_kind, f".{kind}", tmp_path))
        np.testing.assert_allclose(found.levels[:len(asked)], asked[:, 2], atol=1e-4)
        np.testing.assert_allclose(found.dwells_s, 1 / RATE_Hz, rtol=1e-9)
        assert any("no positions" in note for note in of_kind.notes) == bool(np.ptp(asked[:, :2], axis=0).max())

    # AUTD3 rounds places to a lattice and the pressure to 8 bits at 4 kHz, and states both.
    try:
        autd3 = TARGETS["autd3"](load, RATE_Hz)
    except BadExport as error:
        assert "exceed" in str(error) and len(asked) * len(load.foci_mm) > 65_536
        return
    assert any(f"multiples of {AUTD3_STEP_mm} mm" in note for note in autd3.notes) and any("8 bits" in note for note in autd3.notes)
    ends_s = np.cumsum(autd3.played.dwells_s)
    at = np.minimum(np.searchsorted(ends_s, (np.arange(len(asked)) + 0.5) / RATE_Hz), len(ends_s) - 1)
    np.testing.assert_allclose(autd3.played.points_mm[at], asked[:, :2], atol=0.5 * AUTD3_STEP_mm + 1e-9)
    slow = asked[::2, 2]  # at 4 kHz
    np.testing.assert_allclose(autd3.played.levels[at][::2], slow, atol=1.01 / 255)  # half a step of the pressure: 1 / 255 of the force


def stays_at_rest(load):
    """A lens has a strength only."""
    made = TARGETS["wav"](load, RATE_Hz)
    assert np.ptp(made.asked.points_mm) == 0
