# SPDX-License-Identifier: BSD-3-Clause
"""What devices and formats can play of a load, and their files.

AUTD3: autd3-doc (Users_Manual/API/stm/focus.md, modulation.md, sampling_config.md and silencer.md) for pyautd3 29. Ultraleap: "Time
Point Streaming" (support.ultraleap.com, article 360004421818) and the StreamingEmitter of the Haptics SDK 3. Chosen for this program:
the intensity of both is the acoustic pressure of the strongest output, whose square is the force."""
from __future__ import annotations

import io
import json
import wave
from collections.abc import Callable

import numpy as np

from . import hjif
from .load import BadExport, Export, Trace, cycles_of
from .read import MOST, MOST_FRAMES

CLOCK_Hz = 40_000  # sampling rates of AUTD3 are this clock divided by whole numbers
MOST_POINTS, USUAL_POINTS, MOST_FOCI = 65_536, 8192, 8
MODULATION_Hz, MOST_MODULATION = 4000, 32_768
AUTD3_STEP_mm, AUTD3_RANGE_mm = 0.025, 3276.775
ULTRALEAP_Hz = 40_000
DISTANCE_mm = 200.0  # of the skin, unless the case has an array
WAV_RATES_Hz = (8000, 48_000)
PHASE_LEVELS = 128  # board_X.pat of OpenMPD
BACK = (".csv", ".wav", ".hjif", ".phases.csv")  # files that load.modulation reads


Sample = Callable[[float], Trace]  # the load at a rate


def list_text(times_s: np.ndarray, mm: np.ndarray, gain: np.ndarray, names: str = "t_s,x_mm,y_mm,z_mm,intensity_1", z: float = 0.0) -> str:
    return names + "\n" + "".join(f"{t:.10g},{p[0]:.9g},{p[1]:.9g},{z:.9g},{g:.9g}\n" for t, p, g in zip(times_s, mm, gain))


def list_of(trace: Trace) -> Export:
    """The load between samples is that of the last one."""
    made = Export(trace, len(trace.gain) / trace.rate_Hz)
    steps = np.linalg.norm(np.diff(trace.xy_mm, axis=0), axis=1)
    made.notes.append(f"update rate: the focus moves in steps of up to {steps.max(initial=0.0):.3g} mm, and the strength in steps of up to "
                      f"{np.abs(np.diff(trace.gain)).max(initial=0.0):.3g}, every {1e6 / trace.rate_Hz:.4g} us")
    if trace.cycle_s and abs(made.played_s / (trace.cycle_s * trace.cycles) - 1) > 1e-9:
        made.notes.append(f"update rate: a cycle of {1e3 * trace.cycle_s:.6g} ms takes {1e3 * made.played_s:.6g} ms, a whole number of samples")
    return made


def play(made: Export, times_s: np.ndarray, mm: np.ndarray, gain: np.ndarray) -> None:
    """The list of points that the device plays, each until the next."""
    rows = zip(1e3 * np.diff(np.append(times_s, made.played_s)), mm, gain)
    made.played = ".csv", "dwell_ms,x_mm,y_mm,intensity_1\n" + "".join(f"{t:.12g},{p[0]:.12g},{p[1]:.12g},{g:.12g}\n" for t, p, g in rows)


def csv(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    trace = sample(rate_Hz or CLOCK_Hz / divider(ticks_of(sample), MOST))
    made = list_of(trace)
    made.files[".csv"] = list_text(trace.times_s, trace.xy_mm, trace.gain)
    play(made, trace.times_s, trace.xy_mm, trace.gain)
    return made


def ticks_of(sample: Sample) -> int:
    """Ticks of the clock in the cycles that are played, or in the run."""
    probe = sample(1000.0)
    return round(CLOCK_Hz * (probe.cycle_s * cycles_of(probe.cycle_s, CLOCK_Hz) or len(probe.gain) / probe.rate_Hz))


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


def autd3(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    """Points of FociSTM and a buffer of Modulation, both repeated."""
    ticks, foci = ticks_of(sample), len(sample(1000.0).foci_mm)
    n = clocked("AUTD3", 65_535, rate_Hz, divider(ticks, USUAL_POINTS // foci))
    trace, m = sample(CLOCK_Hz / n), divider(ticks, MOST_MODULATION, CLOCK_Hz // MODULATION_Hz)
    envelope = sample(MODULATION_Hz / m).gain
    points = len(trace.gain)
    if points * foci > MOST_POINTS:
        raise BadExport(f"{points} points of {foci} foci exceed the {MOST_POINTS} of AUTD3; use a lower --rate, at most "
                        f"{CLOCK_Hz / -(-ticks * foci // MOST_POINTS):.6g} Hz")
    if foci > MOST_FOCI:
        raise BadExport(f"{foci} foci exceed the {MOST_FOCI} of FociSTM")
    made = list_of(trace)
    centre = trace.xy_mm - np.array(trace.center_mm)
    rounded = np.round((centre[:, None, :] + trace.foci_mm) / AUTD3_STEP_mm) * AUTD3_STEP_mm
    if np.abs(rounded).max() > AUTD3_RANGE_mm or distance_mm > AUTD3_RANGE_mm:
        raise BadExport(f"a focus is beyond the range of AUTD3, {AUTD3_RANGE_mm} mm along each axis")
    buffer = np.round(255 * np.sqrt(envelope)).astype(int)
    made.notes += [f"quantisation: positions are multiples of {AUTD3_STEP_mm} mm, which moves them by up to "
                   f"{np.abs(rounded - centre[:, None, :] - trace.foci_mm).max():.3g} mm",
                   f"quantisation: the envelope has {len(buffer)} values of 8 bits at {MODULATION_Hz / m:.6g} Hz, whose force differs by up to "
                   f"{np.abs((buffer / 255) ** 2 - envelope).max():.3g}, and rests between them"]
    if points * foci > USUAL_POINTS:
        made.notes.append(f"range: {points * foci} points; the firmware of pyautd3 29 holds {USUAL_POINTS}, or 16384 in its extended mode")
    hold = m * CLOCK_Hz // MODULATION_Hz  # ticks of a value of the envelope
    if len(buffer) * hold != points * n and np.ptp(buffer):
        made.notes.append(f"update rate: {points} points and {len(buffer)} values of the envelope do not take the same time, so that they drift apart")
    made.notes.append("update rate: the default Silencer permits a change per ms; the script disables it, which is louder")
    document = {"points_mm": np.round(np.concatenate((rounded, np.full((*rounded.shape[:2], 1), distance_mm)), axis=2), 4).tolist(),
                "sampling_divider": n, "rate_Hz": CLOCK_Hz / n, "modulation": buffer.tolist(), "modulation_divider": hold,
                "modulation_rate_Hz": MODULATION_Hz / m, "loops": bool(trace.cycle_s)}
    made.files = {".autd3.json": json.dumps(document) + "\n", ".autd3.py": AUTD3_SCRIPT}
    steps = np.unique(np.concatenate((np.arange(points) * n, np.arange(len(buffer)) * hold)))  # both change at their own times
    steps = steps[steps < points * n]
    play(made, steps / CLOCK_Hz, (rounded[:, 0, :] - trace.foci_mm[0] + np.array(trace.center_mm))[steps // n],
         ((buffer / 255) ** 2)[np.minimum(steps // hold, len(buffer) - 1)])
    return made


def ultraleap(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    trace = sample(rate_Hz or ULTRALEAP_Hz / divider(ticks_of(sample), MOST))
    if trace.rate_Hz > ULTRALEAP_Hz:
        raise BadExport(f"--rate: Ultraleap streams at most {ULTRALEAP_Hz} time points per second")
    if len(trace.foci_mm) > 1:
        raise BadExport("the example streams one control point, but the load has several foci")
    made = list_of(trace)
    pressure = np.sqrt(trace.gain).astype(np.float32)
    metres = ((trace.xy_mm - np.array(trace.center_mm)) * 1e-3).astype(np.float32)
    made.notes.append("quantisation: positions and intensities have 32 bits")
    text = list_text(trace.times_s, metres, pressure, "t_s,x_m,y_m,z_m,pressure_1", 1e-3 * distance_mm)
    made.files = {".ultraleap.csv": text, ".ultraleap.cpp": ULTRALEAP_SOURCE.replace("@", "#")}
    play(made, trace.times_s, metres.astype(float) * 1e3 + np.array(trace.center_mm), pressure.astype(float) ** 2)
    return made


def envelope_of(sample: Sample, rate_Hz: float | None, rates: tuple[int, ...]) -> Export:
    if rate_Hz is not None and (rate_Hz not in rates if rates else rate_Hz != int(rate_Hz) or rate_Hz > hjif.MOST_TIMESCALE):
        raise BadExport("--rate: possible are " + (" and ".join(map(str, rates)) if rates else f"whole numbers up to {hjif.MOST_TIMESCALE}") + " Hz")
    made = list_of(sample(rate_Hz or hjif.RATE_Hz))
    made.keys = {"position_mm": made.trace.xy_mm[0].tolist()}
    return made


def with_envelope(made: Export, suffix: str, content: str | bytes, gain: np.ndarray) -> Export:
    made.files[suffix] = content
    made.played = suffix, content
    if np.ptp(made.trace.xy_mm, axis=0).max() > 0:
        made.notes[0] = "range: the file has no positions, so that the device plays the envelope at its own focus; the effect is that of the envelope along the motion of the case"
        made.played = gain
    made.notes.append(f"quantisation: the force differs by up to {np.abs(gain - made.trace.gain).max():.3g}")
    return made


def hjif_file(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    made = envelope_of(sample, rate_Hz, ())
    document = hjif.document_of(np.sqrt(made.trace.gain), int(made.trace.rate_Hz), "envelope of a focus, by shearwake")
    text = json.dumps(document) + "\n"
    return with_envelope(made, ".hjif", text, hjif.pressures(text, len(made.trace.gain) + 1)[1][:len(made.trace.gain)] ** 2)


def wav(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    """16 bits. Full scale is left out, since it marks clipping."""
    made = envelope_of(sample, rate_Hz, WAV_RATES_Hz)
    samples = np.round(np.sqrt(made.trace.gain) * 65_533).astype(int) - 32_767
    buffer = io.BytesIO()
    with wave.open(buffer, "wb") as file:
        file.setparams((1, 2, int(made.trace.rate_Hz), 0, "NONE", ""))
        file.writeframes(samples.astype("<i2").tobytes())
    return with_envelope(made, ".wav", buffer.getvalue(), ((samples + 32_768) / 65_535) ** 2)


def phases(sample: Sample, rate_Hz: float | None, distance_mm: float) -> Export:
    """OpenMPD's CSV, in the order of the transducers in the files of its boards."""
    n = clocked("OpenMPD", 255, rate_Hz, 4 * divider(ticks_of(sample), MOST_FRAMES, 4))
    trace = sample(CLOCK_Hz / n)
    if not trace.phases_rad.size:
        raise BadExport("the load is not that of an array; set load.footprint.shape = \"array\"")
    if np.ptp(trace.gain) > 1e-6:
        raise BadExport("phases alone cannot change the strength, but the load has an envelope; export its points with --to autd3")
    made, step = list_of(trace), 2 * np.pi / PHASE_LEVELS
    made.notes += [f"quantisation: the boards of OpenMPD round phases to {PHASE_LEVELS} levels, by up to {step / 2:.2g} rad",
                   f"to read it back, set load.footprint.update_rate_kHz = {1e-3 * trace.rate_Hz:.12g}"]
    if len(trace.foci_mm) > 1:
        made.notes.append("range: all pistons play at full amplitude, also where the case drives them less strongly")
    made.files[".phases.csv"], played = (
        f"{len(frames)},{frames.shape[1]}\n" + "".join(",".join(f"{phase:.9g}" for phase in frame) + "\n" for frame in frames)
        for frames in (trace.phases_rad, step * np.round(trace.phases_rad / step)))
    made.played = ".csv", played
    return made


AUTD3_SCRIPT = '''# Plays a load on AUTD3: python3 FILE.autd3.py, next to FILE.autd3.json, with pyautd3 and pyautd3_link_soem 29.
import json
import pathlib
import numpy as np
import pyautd3
from pyautd3 import AUTD3, ControlPoint, Controller, FociSTM, SamplingConfig, Silencer
from pyautd3.modulation import Custom
from pyautd3_link_soem import SOEM

load = json.loads(pathlib.Path(__file__).with_suffix(".json").read_text())
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
TARGETS = {"csv": csv, "autd3": autd3, "ultraleap": ultraleap, "hjif": hjif_file, "wav": wav, "phases": phases}
