# SPDX-License-Identifier: BSD-3-Clause
"""Envelopes in .hjif files of ISO/IEC 23090-31:2025, haptics coding.

The members and their evaluation are those of the reference software (MPEGGroup/HapticReferenceSoftware, IOJson.cpp, Effect.cpp
and Band.cpp), since the JSON schema is a part of the standard that is not public. Its signal s, from -1 to 1, is the acoustic
pressure (1 + s) / 2 of the strongest output, as AUTD3 plays a .wav file."""
from __future__ import annotations

import datetime
import json
from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray
RATE_Hz, MOST_TIMESCALE, TRANSIENT_ms = 8000, 48000, 22.0
WAVES: dict[str, Callable[[Array], Array]] = {  # of the number of periods
    "Sine": lambda p: np.sin(2 * np.pi * p), "Square": lambda p: 1 - 2 * np.round(p - np.floor(p)),
    "Triangle": lambda p: 1 - 4 * np.abs(np.round(p - 0.25) - (p - 0.25)), "SawToothUp": lambda p: 2 * (p - np.floor(p + 0.5)),
    "SawToothDown": lambda p: 2 * (np.floor(p + 0.5) - p)}
# Members that the reference reader requires, or reads if they are present (?): a type, one of several words, a list, or an object.
# Ranges of numbers are those of this reader.
WHOLE, NUMBER = (int, -1e9, 1e9), (float, -1e9, 1e9)
KEYFRAME = {"relative_position?": (int, 0, 1e9), "amplitude_modulation?": (float, -1, 1), "frequency_modulation?": (float, 0, 1e6)}
EFFECT = {"effect_type": {"Basis"}, "position": (int, 0, 1e9), "phase": NUMBER, "base_signal": set(WAVES), "keyframes": [KEYFRAME]}
BAND = {"band_type": str, "curve_type?": str, "block_length?": (int, 1, 1e9), "lower_frequency_limit": WHOLE, "upper_frequency_limit": WHOLE,
        "effects": [EFFECT]}
CHANNEL = {"id": WHOLE, "description": str, "gain": NUMBER, "mixing_coefficient": NUMBER, "body_part_mask": WHOLE,
           "frequency_sampling?": (int, 0, 1e6), "bands": [BAND]}
PERCEPTION = {"id": WHOLE, "avatar_id": WHOLE, "description": str, "perception_modality": str, "channels": [CHANNEL], "effect_library": list}
HEAD = {"version": str, "profile": str, "level": WHOLE, "date": str, "description": str, "timescale": (int, 1, MOST_TIMESCALE),
        "perceptions": [PERCEPTION], "avatars": list, "syncs": list}
TYPES = {str: "a text", int: "a whole number", float: "a number", list: "a list", dict: "an object"}


class BadFile(Exception):
    """What is wrong with a file, and where."""


def check(place: str, value: Any, schema: Any) -> None:
    """Raises BadFile with the place of the first member that is missing or wrong."""
    low, high = schema[1:] if isinstance(schema, tuple) else (None, None)
    kind = schema[0] if low is not None else str if isinstance(schema, set) else schema if isinstance(schema, type) else type(schema)
    if isinstance(value, bool) or not isinstance(value, (int, float) if kind is float else kind):
        raise BadFile(f"{place or 'the document'} must be {TYPES[kind]}")
    if low is not None and not low <= value <= high:
        raise BadFile(f"{place} must be {TYPES[kind]} from {low:g} to {high:g}, but is {value!r:.60}")
    if isinstance(schema, set) and value not in schema:
        raise BadFile(f"{place} must be {' or '.join(sorted(schema))}, but is {value[:60]!r}")
    if isinstance(schema, list):
        for n, entry in enumerate(value):
            check(f"{place}[{n}]", entry, schema[0])
    for name, member in schema.items() if isinstance(schema, dict) else ():
        inside = f"{place}.{name}".strip(".?")
        if name.rstrip("?") in value:
            check(inside, value[name.rstrip("?")], member)
        elif not name.endswith("?"):
            raise BadFile(f"{inside} is missing")


def members_of(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len({name for name, _ in pairs}) < len(pairs):
        raise BadFile(f"an object has a member twice; its members are {', '.join(name for name, _ in pairs)}"[:300])
    return dict(pairs)


def effects_of(place: str, band: dict[str, Any], timescale: int) -> list[tuple[float, float, dict[str, Any], Array]]:
    """First and last tick of the effects of a band, their members and keyframes, by first tick. A row per keyframe: its tick, by default
    that after the keyframe before, its amplitude, and its frequency in Hz (NaN: none)."""
    found = []
    for e, effect in enumerate(band["effects"]):
        rows: list[list[float]] = []
        for k, frame in enumerate(effect["keyframes"]):
            first = rows[-1][0] + 1 if rows else 0
            rows.append([frame.get("relative_position", first), *(frame.get(f"{name}_modulation", np.nan) for name in ("amplitude", "frequency"))])
            if rows[-1][0] < first:
                raise BadFile(f"{place}.effects[{e}].keyframes[{k}].relative_position must be greater than that of the keyframe before")
        last = rows[-1][0] if rows else 0.0
        last = {"WaveletWave": band.get("block_length", 0), "Transient": last + TRANSIENT_ms * timescale / 1000}.get(band["band_type"], last)
        found.append((effect["position"], effect["position"] + last, effect, np.array(rows, float).reshape(-1, 3)))
    return sorted(found, key=lambda each: each[0])


def evaluated(place: str, band: dict[str, Any], effect: dict[str, Any], frames: Array, ticks: Array, timescale: int) -> Array:
    """One effect at these ticks after its first. Raises BadFile."""
    kind, form = band["band_type"], band.get("curve_type", "Cubic")
    (at, values), (at_of_Hz, frequencies) = (frames[~np.isnan(frames[:, n])][:, [0, n]].T for n in (1, 2))
    if kind == "VectorialWave":  # lines between the amplitudes, times a wave whose frequency changes along lines
        fine = np.unique(np.concatenate((np.zeros(1), at_of_Hz, ticks)))
        Hz = np.interp(fine, at_of_Hz, frequencies) if len(at_of_Hz) else np.zeros_like(fine)
        periods = np.concatenate(([0.0], np.cumsum(0.5 * (Hz[1:] + Hz[:-1]) * np.diff(fine)))) / timescale
        shift = effect["phase"] / (2 * np.pi) if Hz.any() else 0.0
        wave: Array = WAVES[effect["base_signal"]](np.interp(ticks, fine, periods) + shift)
        return wave * np.interp(ticks, at, values) if len(at) else wave
    if kind == "WaveletWave" and "block_length" in band:
        return np.append(values, 0.0)[np.minimum(ticks / band["block_length"] * len(values), len(values)).astype(int)]
    if kind == "Transient":
        length, signal = TRANSIENT_ms * timescale / 1000, np.zeros_like(ticks)
        for start, value in zip(at, values):
            own = slice(*np.searchsorted(ticks, (start, start + length)))
            signal[own] += value * np.sin(4 * np.pi * (ticks[own] - start) / length)
        return signal
    if kind == "Curve" and form in ("Linear", "Cubic") and len(at) > 1:
        number = np.interp(ticks, at, np.arange(len(at)))
        share = number % 1
        return np.interp(number + (share ** 2 * (3 - 2 * share) - share if form == "Cubic" else 0.0), np.arange(len(at)), values)
    raise BadFile(f"{place}: a band {kind} with {len(at)} amplitudes and the curve {form} is not read; possible are VectorialWave, WaveletWave "
                  "with block_length, Transient, and Curve with lines or cubics")


def pressures(text: str, most: int) -> tuple[int, Array, list[str]]:
    """Rate in Hz and samples of the acoustic pressure, 0 to 1, and warnings. Raises BadFile."""
    try:
        document = json.loads(text, object_pairs_hook=members_of)
    except json.JSONDecodeError as error:
        raise BadFile(f"line {error.lineno}, column {error.colno}: {error.msg}") from None
    except RecursionError:
        raise BadFile("is nested too deeply to be an effect") from None
    except ValueError:
        raise BadFile("has a whole number of thousands of digits") from None
    check("", document, HEAD)
    channels = [(f"perceptions[{p}].channels[{c}]", channel) for p, perception in enumerate(document["perceptions"])
                for c, channel in enumerate(perception["channels"])]
    if len(channels) != 1:
        raise BadFile(f"perceptions have {len(channels)} channels; an envelope is a single one")
    (place, channel), timescale = channels[0], document["timescale"]
    rate = channel.get("frequency_sampling") or RATE_Hz
    bands = [(band, effects_of(f"{place}.bands[{b}]", band, timescale)) for b, band in enumerate(channel["bands"])]
    count = int(max((end for _, effects in bands for _, end, *_ in effects), default=0.0) * rate / timescale + 1e-6)
    if not 2 <= count <= most:
        raise BadFile(f"lasts {count} samples of {rate} Hz, but an envelope has 2 to {most}")
    signal, ticks = np.zeros(count), np.arange(count) * (timescale / rate)
    for b, (band, effects) in enumerate(bands):
        for (first, last, effect, frames), following in zip(effects, [*(other[0] for other in effects[1:]), np.inf]):
            own = (ticks >= first) & (ticks < following) & (ticks <= last)
            signal[own] += evaluated(f"{place}.bands[{b}]", band, effect, frames, ticks[own] - first, timescale)
    signal *= channel["gain"]
    clipped = np.flatnonzero(np.abs(signal) > 1 + 1e-9)
    found = [f"clipping: {len(clipped)} samples are beyond full scale, the first at {clipped[0] / rate:.6g} s"] if len(clipped) else []
    return rate, (1 + np.clip(signal, -1, 1)) / 2, found


def text_of(pressure: Array, rate_Hz: int) -> str:
    """A vectorial band whose amplitude is the signal: the base signal is the first half of a square wave, which is 1. Keyframes
    on the line between their neighbours are left out."""
    signal = 2 * np.append(pressure, pressure[-1]) - 1
    bends = np.abs(np.diff(signal, 2)) > 1e-6
    kept = np.flatnonzero(np.concatenate(([True], bends, [True])))
    frames: list[dict[str, Any]] = [{"relative_position": int(n), "amplitude_modulation": round(float(signal[n]), 7)} for n in kept]
    frames[0]["frequency_modulation"] = 0
    effect = {"id": 0, "effect_type": "Basis", "position": 0, "phase": 0.0, "base_signal": "Square", "keyframes": frames}
    band = {"band_type": "VectorialWave", "lower_frequency_limit": 0, "upper_frequency_limit": 1000, "effects": [effect]}
    channel = {"id": 0, "description": "envelope of the acoustic pressure", "gain": 1.0, "mixing_coefficient": 1.0, "body_part_mask": 0,
               "frequency_sampling": rate_Hz, "sample_count": len(signal), "bands": [band]}
    perception = {"id": 0, "avatar_id": 0, "description": "focus of airborne ultrasound", "perception_modality": "Vibrotactile",
                  "reference_devices": [], "effect_library": [], "channels": [channel]}
    return json.dumps({"version": "2023", "profile": "Main", "level": 1, "date": datetime.date.today().isoformat(), "timescale": rate_Hz,
                       "description": "envelope of a focus, by shearwake", "avatars": [], "perceptions": [perception], "syncs": []}) + "\n"
