# SPDX-License-Identifier: BSD-3-Clause
"""What devices and formats can play of a load, and their files.

AUTD3: autd3-doc (Users_Manual/API/stm/focus.md, modulation.md, sampling_config.md and silencer.md) for pyautd3 29. Ultraleap: "Time
Point Streaming" (support.ultraleap.com, article 360004421818) and the StreamingEmitter of the Haptics SDK 3. Chosen for this program:
the intensity of both is the acoustic pressure of the strongest output, whose square is the force."""
from __future__ import annotations

import functools
import io
import json
import tempfile
import wave
from collections.abc import Callable, Container
from pathlib import Path

import numpy as np

from .. import program
from . import hjif
from .load import BadExport, Export, Load, frames_text
from .read import MOST, MOST_FRAMES, Signal

CLOCK_Hz = 40_000  # rates of AUTD3 and OpenMPD are this clock divided by whole numbers; the highest rate of Ultraleap
MOST_POINTS, USUAL_POINTS, MOST_FOCI = 65_536, 8192, 8
MODULATION_Hz, MOST_MODULATION = 4000, 32_768
AUTD3_STEP_mm, AUTD3_RANGE_mm = 0.025, 3276.775
PHASE_LEVELS = 128  # board_X.pat of OpenMPD
BACK = (".csv", ".wav", ".hjif", ".phases.csv")  # files that load.modulation reads


def export_of(load: Load, asked: Signal) -> Export:
    """The load between samples is that of the last one."""
    made, steps = Export(load, asked), np.linalg.norm(np.diff(asked.points_mm, axis=0), axis=1)
    made.notes.append(f"update rate: the focus moves in steps of up to {steps.max(initial=0.0):.3g} mm, and the strength in steps of up to "
                      f"{np.abs(np.diff(asked.levels)).max(initial=0.0):.3g}, every {1e6 * asked.dwells_s[0]:.4g} us")
    if abs(made.stretch - 1) > 1e-9:
        made.notes.append(f"update rate: a cycle of {1e3 * load.cycle_s:.6g} ms takes {1e3 * load.cycle_s * made.stretch:.6g} ms, a whole number of samples")
    return made


def ticks_of(load: Load) -> int:
    """Ticks of the clock in the cycles that are played, or in the run."""
    return round(CLOCK_Hz * (load.cycle_s * load.cycles(CLOCK_Hz) or load.run_s))


def divider(ticks: int, most: int, unit: int = 1) -> int:
    """The least divider of the clock with which a cycle has at most this many samples, preferably one that divides the cycle."""
    least = max(1, -(-ticks // (most * unit)))
    return next((n for n in range(least, 8 * least + 1) if ticks % (n * unit) == 0), least)


def clocked(device: str, most: int, rate_Hz: float | None, usual: int) -> int:
    """The divider of the clock that gives a rate. Raises BadExport."""
    n = usual if rate_Hz is None else min(max(round(CLOCK_Hz / rate_Hz), 1), most)
    if n > most or (rate_Hz is not None and abs(CLOCK_Hz / n / rate_Hz - 1) > 1e-6):
        raise BadExport(f"--rate: {device} plays {CLOCK_Hz} Hz / N with N from 1 to {most}, the nearest being {CLOCK_Hz / min(n, most):.6g} Hz")
    return n


def csv(load: Load, rate_Hz: float | None, for_ultraleap: bool = False) -> Export:
    """A list, or that of Ultraleap with an example that streams it, in m from the centre of the array, with 32 bits."""
    rate_Hz = rate_Hz or CLOCK_Hz / divider(ticks_of(load), MOST)
    if for_ultraleap and rate_Hz > CLOCK_Hz:
        raise BadExport(f"--rate: Ultraleap streams at most {CLOCK_Hz} time points per second")
    if for_ultraleap and len(load.foci_mm) > 1:
        raise BadExport("the example streams one control point, but the load has several foci")
    asked = load.sample(rate_Hz)
    made = export_of(load, asked)
    suffix, names, center_mm, per_mm, z, strength, kind = (
        (".ultraleap.csv", "t_s,x_m,y_m,z_m,pressure_1", load.center_mm, 1e-3, 1e-3 * load.distance_mm, np.sqrt(asked.levels), np.float32)
        if for_ultraleap else (".csv", "t_s,x_mm,y_mm,z_mm,intensity_1", np.zeros(2), 1.0, 0.0, asked.levels, np.float64))
    rows = zip(*(per_mm * (asked.points_mm - center_mm)).astype(kind).T, strength.astype(kind))
    made.played = made.add(suffix, names + "\n" + "".join(f"{n / rate_Hz:.10g},{x:.9g},{y:.9g},{z:.9g},{s:.9g}\n" for n, (x, y, s) in enumerate(rows)))
    made.played.points_mm += center_mm
    if for_ultraleap:
        made.notes.append("quantisation: positions and intensities have 32 bits")
        made.files[".ultraleap.cpp"] = ULTRALEAP_SOURCE.replace("@", "#")
    return made


def autd3(load: Load, rate_Hz: float | None) -> Export:
    """Points of FociSTM and a buffer of Modulation, both repeated."""
    ticks, foci = ticks_of(load), len(load.foci_mm)
    n, m = clocked("AUTD3", 65_535, rate_Hz, divider(ticks, USUAL_POINTS // foci)), divider(ticks, MOST_MODULATION, CLOCK_Hz // MODULATION_Hz)
    asked, levels = load.sample(CLOCK_Hz / n), load.sample(MODULATION_Hz / m).levels
    points = len(asked.levels)
    if points * foci > MOST_POINTS:
        raise BadExport(f"{points} points of {foci} foci exceed the {MOST_POINTS} of AUTD3; use a lower --rate, at most "
                        f"{CLOCK_Hz / -(-ticks * foci // MOST_POINTS):.6g} Hz")
    if foci > MOST_FOCI:
        raise BadExport(f"{foci} foci exceed the {MOST_FOCI} of FociSTM")
    made = export_of(load, asked)
    exact = (asked.points_mm - load.center_mm)[:, None, :] + load.foci_mm
    rounded = np.round(exact / AUTD3_STEP_mm) * AUTD3_STEP_mm
    if np.abs(rounded).max() > AUTD3_RANGE_mm or load.distance_mm > AUTD3_RANGE_mm:
        raise BadExport(f"a focus is beyond the range of AUTD3, {AUTD3_RANGE_mm} mm along each axis")
    buffer = np.round(255 * np.sqrt(levels)).astype(int)
    made.notes += [f"quantisation: positions are multiples of {AUTD3_STEP_mm} mm, which moves them by up to {np.abs(rounded - exact).max():.3g} mm",
                   f"quantisation: the envelope has {len(buffer)} values of 8 bits at {MODULATION_Hz / m:.6g} Hz, whose force differs by up to "
                   f"{np.abs((buffer / 255) ** 2 - levels).max():.3g}, and rests between them"]
    if points * foci > USUAL_POINTS:
        made.notes.append(f"range: {points * foci} points; the firmware of pyautd3 29 holds {USUAL_POINTS}, or 16384 in its extended mode")
    hold = m * CLOCK_Hz // MODULATION_Hz  # ticks of a value of the envelope
    if len(buffer) * hold != points * n and np.ptp(buffer):
        made.notes.append(f"update rate: {points} points and {len(buffer)} values of the envelope do not take the same time, so that they drift apart")
    made.notes.append("update rate: the default Silencer permits a change per ms; the script disables it, which is louder")
    document = {"points_mm": np.round(np.concatenate((rounded, np.full((*rounded.shape[:2], 1), load.distance_mm)), axis=2), 4).tolist(),
                "sampling_divider": n, "rate_Hz": CLOCK_Hz / n, "modulation": buffer.tolist(), "modulation_divider": hold,
                "modulation_rate_Hz": MODULATION_Hz / m, "loops": bool(load.cycle_s)}
    made.files = {".autd3.json": json.dumps(document) + "\n", ".autd3.py": AUTD3_SCRIPT}
    steps = np.union1d(np.arange(points) * n, np.arange(len(buffer)) * hold)  # both change at their own times
    steps = steps[steps < points * n]
    made.played = Signal("list", np.diff(np.append(steps, points * n)) / CLOCK_Hz, ((buffer / 255) ** 2)[np.minimum(steps // hold, len(buffer) - 1)],
                         (rounded[:, 0, :] - load.foci_mm[0] + load.center_mm)[steps // n])
    return made


def envelope(suffix: str, rates: Container[float], possible: str, content_of: Callable[[np.ndarray, int], str | bytes],
             load: Load, rate_Hz: float | None) -> Export:
    """A file with the pressure at one of some rates. It has straight lines between its samples, and no positions."""
    if rate_Hz is not None and rate_Hz not in rates:
        raise BadExport(f"--rate: possible are {possible} Hz")
    rate = int(rate_Hz or hjif.RATE_Hz)
    asked = load.sample(rate)
    made, count = export_of(load, asked), len(asked.levels)
    gain = made.add(suffix, content_of(np.sqrt(asked.levels), rate)).levels[:count]
    if np.ptp(asked.points_mm, axis=0).max() > 0:
        made.notes[0] = ("range: the file has no positions, so that the device plays the envelope at its own focus; the effect is that of the "
                         "envelope along the motion of the case")
    made.notes.append(f"quantisation: the force differs by up to {np.abs(gain - asked.levels).max():.3g}")
    made.played = load.sample(rate * max(1, min(CLOCK_Hz // rate, MOST // count)), load.cycles(rate))
    at = np.arange(len(made.played.levels)) * count / len(made.played.levels)
    made.played.levels = np.interp(at, np.arange(count + 1), np.append(gain, gain[0] if load.cycle_s else gain[-1]))
    made.played.dwells_s[:] = count / rate / len(at)
    return made


def wav_bytes(pressure: np.ndarray, rate_Hz: int) -> bytes:
    """16 bits. Full scale is left out, since it marks clipping."""
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setparams((1, 2, rate_Hz, 0, "NONE", ""))
        file.writeframes((np.round(pressure * 65_533) - 32_767).astype("<i2").tobytes())
    return buffer.getvalue()


def phases(load: Load, rate_Hz: float | None) -> Export:
    """OpenMPD's CSV, in the order of the transducers in the files of its boards."""
    n = clocked("OpenMPD", 255, rate_Hz, 4 * divider(ticks_of(load), MOST_FRAMES, 4))
    asked = load.sample(CLOCK_Hz / n, phases=True)
    if not asked.phases_rad.size:
        raise BadExport("the load is not that of an array; set load.footprint.shape = \"array\"")
    if np.ptp(asked.levels) > 1e-6:
        raise BadExport("phases alone cannot change the strength, but the load has an envelope; export its points with --to autd3")
    made, step = export_of(load, asked), 2 * np.pi / PHASE_LEVELS
    made.notes += [f"quantisation: the boards of OpenMPD round phases to {PHASE_LEVELS} levels, by up to {step / 2:.2g} rad",
                   f"to read it back, set load.footprint.update_rate_kHz = {1e-3 * CLOCK_Hz / n:.12g}"]
    if len(load.foci_mm) > 1:
        made.notes.append("range: all pistons play at full amplitude, also where the case drives them less strongly")
    made.files[".phases.csv"] = frames_text(asked.phases_rad)
    made.played = Signal("phases", phases_rad=step * np.round(asked.phases_rad / step))
    return made


def stl(load: Load, rate_Hz: float | None) -> Export:
    if load.job.tables["load"].get("footprint", {}).get("shape") != "lens":
        raise BadExport("the load is not a lens; set load.footprint.shape = \"lens\"")
    with tempfile.TemporaryDirectory() as folder, load.job.file() as path:
        program.call(["lens", str(path), "--out", folder])
        return Export(load, load.sample(CLOCK_Hz), files={".stl": (Path(folder) / "lens.stl").read_bytes()})


AUTD3_SCRIPT = '''# Plays a load on AUTD3: python3 FILE.autd3.py, next to FILE.autd3.json, with pyautd3 and pyautd3_link_soem 29.
import json
import numpy as np
import pyautd3
from pyautd3 import AUTD3, ControlPoint, Controller, FociSTM, SamplingConfig, Silencer
from pyautd3.modulation import Custom
from pyautd3_link_soem import SOEM

load = json.load(open(__file__.removesuffix(".py") + ".json"))
with Controller.builder([AUTD3([0.0, 0.0, 0.0])]).open(SOEM.builder()) as autd:
    autd.send(Silencer.disable())
    kind = getattr(pyautd3, f"ControlPoints{len(load['points_mm'][0])}")
    points = [tuple(ControlPoint(autd.center + np.array(focus)) for focus in foci) for foci in load["points_mm"]]
    stm = FociSTM(SamplingConfig(load["sampling_divider"]), [kind(p if len(p) > 1 else p[0]) for p in points])
    modulation = Custom(buffer=np.array(load["modulation"], np.uint8), sampling_config=SamplingConfig(load["modulation_divider"]))
    autd.send((modulation, stm))
    input("Enter stops the output. ")
    autd.close()
'''
ULTRALEAP_SOURCE = '''// Streams FILE.ultraleap.csv, its argument, with the Ultraleap Haptics SDK 3.
@include <ultraleap/haptics/streaming.hpp>
@include <fstream>
@include <iostream>
@include <vector>
using namespace Ultraleap::Haptics;
struct Row { double t, x, y, z, pressure; };
static std::vector<Row> rows;
static const LocalTimePoint start = LocalTimeClock::now();

void emit(const StreamingEmitter&, OutputInterval& interval, const LocalTimePoint&, void*) {
    for (auto& sample : interval) {
        const double rate_Hz = double(rows.size() - 1) / rows.back().t, t = std::chrono::duration<double>(sample - start).count();
        const Row& row = rows[std::size_t(t * rate_Hz) % rows.size()];
        sample.controlPoint(0).setPosition(Vector3(float(row.x), float(row.y), float(row.z)));
        sample.controlPoint(0).setIntensity(float(row.pressure));
    }
}
int main(int, char** arguments) {
    std::ifstream file(arguments[1]);
    file.ignore(1000, '\\n'); // the header
    char comma;
    for (Row r; file >> r.t >> comma >> r.x >> comma >> r.y >> comma >> r.z >> comma >> r.pressure;) rows.push_back(r);
    Library library;
    library.connect();
    StreamingEmitter emitter(library);
    emitter.addDevice(library.findDevice(DeviceFeatures::StreamingHaptics).value());
    emitter.setControlPointCount(1, AdjustRate::All);
    emitter.setEmissionCallback(emit, nullptr);
    emitter.start();
    std::cin.get(); // Enter stops the output
    emitter.stop();
}
'''
TARGETS: dict[str, Callable[[Load, float | None], Export]] = {
    "csv": csv, "autd3": autd3, "ultraleap": functools.partial(csv, for_ultraleap=True), "phases": phases, "stl": stl,
    "hjif": functools.partial(envelope, ".hjif", range(1, hjif.MOST_TIMESCALE + 1), f"whole numbers up to {hjif.MOST_TIMESCALE}", hjif.text_of),
    "wav": functools.partial(envelope, ".wav", (8000, 48_000), "8000 and 48000", wav_bytes)}
