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

from . import BadFile

Array = np.ndarray
RATE_Hz, TIMESCALE, MOST_TIMESCALE, TRANSIENT_ms = 8000, 1000, 48000, 22.0
WAVES: dict[str, Callable[[Array], Array]] = {  # of the number of periods
    "Sine": lambda p: np.sin(2 * np.pi * p), "Square": lambda p: 1 - 2 * np.round(p - np.floor(p)),
    "Triangle": lambda p: 1 - 4 * np.abs(np.round(p - 0.25) - (p - 0.25)), "SawToothUp": lambda p: 2 * (p - np.floor(p + 0.5)),
    "SawToothDown": lambda p: 2 * (np.floor(p + 0.5) - p)}
# Members that the reference reader requires.
HEAD = {"version": str, "profile": str, "level": int, "date": str, "description": str, "timescale": int, "perceptions": list,
        "avatars": list, "syncs": list}
PERCEPTION = {"id": int, "avatar_id": int, "description": str, "perception_modality": str, "channels": list, "effect_library": list}
CHANNEL = {"id": int, "description": str, "gain": float, "mixing_coefficient": float, "body_part_mask": int, "bands": list}
BAND = {"band_type": str, "lower_frequency_limit": int, "upper_frequency_limit": int, "effects": list}
EFFECT = {"effect_type": str, "position": int, "phase": float, "base_signal": str, "keyframes": list}
CHANNEL_PLACE = "perceptions[0].channels[0]"
TYPES = {str: "a text", int: "a whole number", float: "a number", list: "a list"}


def require(place: str, value: Any, members: dict[str, type]) -> Any:
    """The object, if it has the members. Raises BadFile with its place."""
    if not isinstance(value, dict):
        raise BadFile(f"{place or 'the document'} must be an object")
    for name, kind in members.items():
        found = value.get(name)
        fits = isinstance(found, (int, float) if kind is float else kind) and not isinstance(found, bool)
        if not fits or (isinstance(found, (int, float)) and not abs(found) < 1e9):
            raise BadFile(f"{f'{place}.' if place else ''}{name} must be {TYPES[kind]}{'' if name in value else ', but is missing'}")
    return value


def members_of(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len({name for name, _ in pairs}) < len(pairs):
        raise BadFile(f"an object has a member twice; its members are {', '.join(name for name, _ in pairs)}"[:300])
    return dict(pairs)


def channel_of(document: Any) -> tuple[dict[str, Any], int]:
    """The only channel of a document, and its ticks per second."""
    head = require("", document, HEAD)
    if not 0 < head["timescale"] <= MOST_TIMESCALE:
        raise BadFile(f"timescale must be from 1 to {MOST_TIMESCALE}, but is {head['timescale']}")
    channels = [channel for p, perception in enumerate(head["perceptions"])
                for channel in require(f"perceptions[{p}]", perception, PERCEPTION)["channels"]]
    if len(channels) != 1:
        raise BadFile(f"perceptions have {len(channels)} channels; an envelope is a single one")
    channel = require(CHANNEL_PLACE, channels[0], CHANNEL)
    for b, band in enumerate(channel["bands"]):
        for e, effect in enumerate(require(f"{CHANNEL_PLACE}.bands[{b}]", band, BAND)["effects"]):
            check_effect(f"{CHANNEL_PLACE}.bands[{b}].effects[{e}]", effect)
    return channel, head["timescale"]


def check_effect(place: str, effect: Any) -> None:
    if require(place, effect, EFFECT)["position"] < 0 or effect["base_signal"] not in WAVES or effect["effect_type"] != "Basis":
        raise BadFile(f"{place}: position must not be negative, effect_type Basis, and base_signal one of {', '.join(WAVES)}")
    last = -1
    for k, frame in enumerate(effect["keyframes"]):
        at = f"{place}.keyframes[{k}]"
        require(at, frame, {})
        for name in ("relative_position", "amplitude_modulation", "frequency_modulation"):
            if name in frame:
                require(at, frame, {name: int if name == "relative_position" else float})
        position = frame.get("relative_position", last + 1)
        if position <= last:
            raise BadFile(f"{at}.relative_position must be greater than that of the keyframe before")
        for name, low, high in (("amplitude_modulation", -1, 1), ("frequency_modulation", 0, 1e6)):
            if not low <= frame.get(name, 0.0) <= high:
                raise BadFile(f"{at}.{name} must be from {low} to {high:g}, but is {frame[name]}")
        last = position


def curve(effect: dict[str, Any], member: str) -> tuple[Array, Array]:
    """Ticks and values of the keyframes that have the member."""
    frames = [(frame.get("relative_position", k), frame[member]) for k, frame in enumerate(effect["keyframes"]) if member in frame]
    return np.array([f[0] for f in frames], float), np.array([f[1] for f in frames], float)


def vectorial(effect: dict[str, Any], ticks: Array, timescale: int) -> Array:
    """Lines between the amplitudes, times a wave whose frequency changes along lines."""
    at, amplitudes = curve(effect, "amplitude_modulation")
    strength = np.interp(ticks, at, amplitudes) if len(at) else np.ones_like(ticks)
    at, frequencies = curve(effect, "frequency_modulation")
    fine: Array = np.unique(np.concatenate((np.zeros(1), at, ticks)))
    Hz = np.interp(fine, at, frequencies) if len(at) else np.zeros_like(fine)
    periods = np.concatenate(([0.0], np.cumsum(0.5 * (Hz[1:] + Hz[:-1]) * np.diff(fine)))) / timescale
    shift = effect["phase"] / (2 * np.pi) if Hz.any() else 0.0
    return strength * WAVES[effect["base_signal"]](np.interp(ticks, fine, periods) + shift)


def evaluated(place: str, band: dict[str, Any], effect: dict[str, Any], ticks: Array, timescale: int) -> Array:
    """One effect at these ticks after its position."""
    kind = band["band_type"]
    at, values = curve(effect, "amplitude_modulation")
    if kind == "VectorialWave":
        return vectorial(effect, ticks, timescale)
    if kind == "WaveletWave":
        require(place, band, {"block_length": int})
        index = np.floor(ticks / max(band["block_length"], 1) * len(values)).astype(int)
        return np.where((index >= 0) & (index < len(values)), values[np.clip(index, 0, len(values) - 1)], 0.0) if len(values) else 0 * ticks
    if kind == "Transient":
        length = TRANSIENT_ms * timescale / 1000
        since = ticks[:, None] - at
        return np.sum(np.where((since >= 0) & (since <= length), np.sin(4 * np.pi * since / length) * values, 0.0), axis=1)
    if kind == "Curve" and band.get("curve_type", "Cubic") in ("Linear", "Cubic") and len(at) > 1:
        after = np.clip(np.searchsorted(at, ticks, "right"), 1, len(at) - 1)
        share = np.clip((ticks - at[after - 1]) / (at[after] - at[after - 1]), 0.0, 1.0)
        if band.get("curve_type", "Cubic") == "Cubic":
            share = share ** 2 * (3 - 2 * share)
        return values[after - 1] + (values[after] - values[after - 1]) * share
    raise BadFile(f"{place}: a band {kind} with {len(at)} amplitudes{' and the curve ' + band['curve_type'] if 'curve_type' in band else ''} "
                  "is not read; possible are VectorialWave, WaveletWave, Transient, and Curve with lines or cubics")


def end_of(band: dict[str, Any], timescale: int) -> float:
    """The tick at which a band ends."""
    last = 0.0
    for effect in band["effects"]:
        own = max((frame.get("relative_position", k) for k, frame in enumerate(effect["keyframes"])), default=0)
        own = {"WaveletWave": band.get("block_length", 0), "Transient": own + TRANSIENT_ms * timescale / 1000}.get(band["band_type"], own)
        last = max(last, effect["position"] + own)
    return last


def pressures(text: str, most: int) -> tuple[int, Array, list[str]]:
    """Rate in Hz and samples of the acoustic pressure, 0 to 1, and warnings. Raises BadFile."""
    try:
        document = json.loads(text, object_pairs_hook=members_of)
    except json.JSONDecodeError as error:
        raise BadFile(f"line {error.lineno}, column {error.colno}: {error.msg}") from None
    except RecursionError:
        raise BadFile("is nested too deeply to be an effect") from None
    except BadFile:
        raise
    except ValueError:
        raise BadFile("has a whole number of thousands of digits") from None
    channel, timescale = channel_of(document)
    rate = channel.get("frequency_sampling") or RATE_Hz
    if type(rate) is not int or not 1 <= rate <= 1_000_000:
        raise BadFile(f"{CHANNEL_PLACE}.frequency_sampling must be from 1 to 1000000")
    count = int(max((end_of(band, timescale) for band in channel["bands"]), default=0.0) * rate / timescale + 1e-6)
    if not 2 <= count <= most:
        raise BadFile(f"lasts {count} samples of {rate} Hz, but an envelope has 2 to {most}")
    signal = np.zeros(count)
    for b, band in enumerate(channel["bands"]):
        starts = sorted(band["effects"], key=lambda effect: effect["position"])
        ticks = np.arange(count) * (timescale / rate)
        for effect, following in zip(starts, [*(other["position"] for other in starts[1:]), np.inf]):
            own = (ticks >= effect["position"]) & (ticks < following) & (ticks <= end_of({**band, "effects": [effect]}, timescale))
            signal[own] += evaluated(f"{CHANNEL_PLACE}.bands[{b}]", band, effect, ticks[own] - effect["position"], timescale)
    signal *= channel["gain"]
    clipped = np.flatnonzero(np.abs(signal) > 1 + 1e-9)
    found = [f"clipping: {len(clipped)} samples are beyond full scale, the first at {clipped[0] / rate:.6g} s"] if len(clipped) else []
    return rate, (1 + np.clip(signal, -1, 1)) / 2, found


def document_of(pressure: Array, rate_Hz: int, description: str) -> dict[str, Any]:
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
    made = {"version": "2023", "profile": "Main", "level": 1, "date": datetime.date.today().isoformat(), "description": description,
            "timescale": rate_Hz, "avatars": [], "perceptions": [perception], "syncs": []}
    channel_of(made)
    return made
