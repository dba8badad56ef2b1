# SPDX-License-Identifier: BSD-3-Clause
"""Reads what a device plays: the files of load.modulation.kind = "file".

Usage: python3 -m shearwake.device.read FILE    (the program starts it)
The text for the program, or the error, is written to the standard error, which the program reads. Exit 0, or 3 for an error.

* CSV with a row per point: a header such as t_s,x_mm,y_mm,z_mm,intensity_1, in any order; dwell_ms may replace t_s.
* CSV with t_s and intensity_1 or pressure_1 alone: an envelope.
* CSV of OpenMPD (AcousTools, export/CSV.py): the numbers of frames and of pistons, then a row of phases in rad per frame.
* .wav, as AUTD3 plays it (autd3-doc, Modulation/Wav): full scale from the lowest to the highest sample is the pressure from 0 to 1.
* .hjif of ISO/IEC 23090-31.
"""
from __future__ import annotations

import csv
import itertools
import math
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from . import BadFile, Played, hjif

BAD = 3
LARGEST_B, MOST, MOST_FRAMES = 1 << 26, 100_000, 5_000
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
MILLIMETRES = {"m": 1e3, "cm": 10.0, "mm": 1.0, "um": 1e-3}
LEVELS = ("intensity_1", "intensity", "level", "pressure_1")
HEADER = "the header must name columns with their units, as in t_s,x_mm,y_mm,z_mm,intensity_1, or t_s,intensity_1 for an envelope"
GAP = 1.5  # times the median of the rests
REGULAR = 0.01  # deviation of a sample of an envelope, in intervals
SHORTEST_s, LONGEST_s = 1e-6, 1e3  # of a rest or an interval
FLAT = 3  # successive samples at full scale are clipped
FLOAT, EXTENSIBLE = 3, 0xFFFE  # formats of .wav files
WAV_KINDS = {(1, 8), (1, 16), (1, 24), (1, 32), (FLOAT, 32), (FLOAT, 64)}


def rows_of(text: str) -> Iterator[tuple[int, list[str]]]:
    """Line and cells of each row that is neither empty nor a comment."""
    first = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    separator = next((s for s in ",;\t" if s in first), ",")
    reader = csv.reader(text.splitlines(), delimiter=separator, strict=True)
    try:
        for cells in reader:
            if cells and any(c.strip() for c in cells) and not cells[0].lstrip().startswith("#"):
                yield reader.line_num, [cell.strip() for cell in cells]
    except csv.Error as error:
        raise BadFile(f"line {reader.line_num}: is not CSV: {error}") from None


def number_in(line: int, cell: str, name: str) -> float:
    try:
        value = float(cell if "_" not in cell else "")  # Python reads 1_0 as 10
    except ValueError:
        value = math.nan
    if not abs(value) < 1e9:
        raise BadFile(f"line {line}: {name} must be a finite number below 1e9, but is {cell[:60]!r}")
    return value


def columns_of(line: int, names: list[str]) -> dict[str, tuple[int, float]]:
    """Place and factor to s, mm or 1 of t, dwell, x, y, z, level and pressure. Raises BadFile."""
    found: dict[str, tuple[int, float]] = {}
    for place, full in enumerate(names):
        name, _, unit = full.rpartition("_")
        if full in LEVELS:
            column, factor = "pressure" if full == "pressure_1" else "level", 1.0
        elif name in ("t", "dwell") and unit in SECONDS:
            column, factor = name, SECONDS[unit]
        elif name in ("x", "y", "z") and unit in MILLIMETRES:
            column, factor = name, MILLIMETRES[unit]
        else:
            raise BadFile(f"line {line}: {full[:60]!r} is not a column with a unit; {HEADER}")
        if column in found:
            raise BadFile(f"line {line}: has two columns {column}")
        found[column] = place, factor
    has = found.keys()
    if ("t" in has) == ("dwell" in has) or ("x" in has) != ("y" in has) or ("x" not in has and ("level" in has) == ("pressure" in has)):
        raise BadFile(f"line {line}: {HEADER}")
    return found


def read_list(rows: list[tuple[int, list[str]]]) -> Played:
    """A list of points, or an envelope."""
    line, names = rows[0]
    columns = columns_of(line, names)
    if len(rows) < 3:
        raise BadFile(f"has {len(rows) - 1} rows below its header, but a list has 2 or more")
    table = {name: np.empty(len(rows) - 1) for name in columns}
    for n, (line, cells) in enumerate(rows[1:]):
        if len(cells) != len(names):
            raise BadFile(f"line {line}: has {len(cells)} cells, but the header has {len(names)}")
        for name, (place, factor) in columns.items():
            value = table[name][n] = factor * number_in(line, cells[place], names[place])
            before = table[name][n - 1] if n else value
            if name in ("level", "pressure") and not 0 <= value <= 1:
                raise BadFile(f"line {line}: {names[place]} must be from 0 to 1, the strongest output, but is {value:g}")
            if name == "t" and (value <= before if n else value != 0):
                raise BadFile(f"line {line}: the time {value:g} s must " + (f"be after {before:g} s, that of the row before" if n else "be 0, since it is the first"))
            if name == "dwell" and value <= 0:
                raise BadFile(f"line {line}: the dwell must be above 0, but is {value:g} s")
            if name == "z" and value != before:
                raise BadFile(f"line {line}: z changes from {before:g} to {value:g} mm, but the skin is a plane of constant z")
    levels = table["pressure"] ** 2 if "pressure" in table else table.get("level", np.ones(len(rows) - 1))
    if "dwell" in table:
        dwells = table["dwell"]
    else:
        steps = np.diff(table["t"])
        dwells = np.append(steps, steps[-1])
    if not 0.999 * SHORTEST_s <= dwells.min() <= dwells.max() <= LONGEST_s:
        at = int(np.argmin(dwells) if dwells.min() < SHORTEST_s else np.argmax(dwells))
        raise BadFile(f"line {rows[at + 1][0]}: lasts {dwells[at]:g} s; possible are {SHORTEST_s:g} to {LONGEST_s:g} s")
    if "x" not in table:
        return regular(dwells, levels, [line for line, _ in rows[1:]])
    found = Played("list", dwells, levels, np.column_stack((table["x"], table["y"])))
    usual = float(np.median(dwells))
    if (gaps := np.flatnonzero(dwells > GAP * usual)).size:
        at = int(gaps[0])
        found.warnings.append(f"has {len(gaps)} gap{'s' if len(gaps) > 1 else ''}: the focus rests at the point of line {rows[at + 1][0]} for {1e3 * dwells[at]:.6g} ms, "
                              f"at most points for {1e3 * usual:.6g} ms")
    return found


def regular(dwells_s: np.ndarray, levels: np.ndarray, lines: list[int]) -> Played:
    """An envelope, whose samples must be uniformly spaced."""
    usual = float(np.median(dwells_s[:-1]))
    times = np.concatenate(([0.0], np.cumsum(dwells_s)[:-1]))
    interval = times[-1] / (len(times) - 1)
    wrong = np.flatnonzero(np.abs(times - interval * np.arange(len(times))) > REGULAR * interval)
    if wrong.size:
        gap = int(np.flatnonzero(np.abs(dwells_s - usual) > REGULAR * usual)[0])
        raise BadFile(f"line {lines[min(gap + 1, len(lines) - 1)]}: the samples of an envelope must be uniformly spaced, but this one follows "
                      f"after {dwells_s[gap]:.6g} s and most after {usual:.6g} s")
    return Played("envelope", np.full(len(levels), interval), levels)


def read_frames(rows: list[tuple[int, list[str]]]) -> Played:
    line, cells = rows[0]
    frames, pistons = (number_in(line, cell, name) for cell, name in zip(cells, ("the number of frames", "the number of pistons")))
    if not 1 <= pistons <= 10_000 or pistons != int(pistons) or not 2 <= frames <= MOST_FRAMES:
        raise BadFile(f"line {line}: states {frames:g} frames of {pistons:g} pistons; possible are 2 to {MOST_FRAMES} of 1 to 10000")
    if frames != len(rows) - 1:
        raise BadFile(f"line {line}: states {frames:g} frames, but {len(rows) - 1} rows follow")
    phases = np.empty((len(rows) - 1, int(pistons)))
    for n, (line, cells) in enumerate(rows[1:]):
        if len(cells) != pistons:
            raise BadFile(f"line {line}: has {len(cells)} phases, but line {rows[0][0]} states {pistons:g} pistons")
        for piston, cell in enumerate(cells):
            phases[n, piston] = number_in(line, cell, f"the phase of piston {piston + 1}")
    return Played("phases", phases_rad=phases)


def read_csv(path: Path) -> Played:
    rows = list(itertools.islice(rows_of(path.read_text(encoding="utf-8-sig")), MOST + 2))
    if len(rows) > MOST + 1:
        raise BadFile(f"line {rows[-1][0]}: exceeds the limit of {MOST} rows")
    if not rows:
        raise BadFile(f"has no row; {HEADER}")
    is_phases = len(rows[0][1]) == 2 and all(cell.lstrip("+-")[:1].isdigit() for cell in rows[0][1])
    return read_frames(rows) if is_phases else read_list(rows)


def read_wav(path: Path) -> Played:
    """The chunks fmt and data of a RIFF file, in PCM of 8 to 32 bits or as floating-point numbers."""
    content = path.read_bytes()
    if content[:4] != b"RIFF" or content[8:12] != b"WAVE":
        raise BadFile("byte 0: is not a sound file, which begins with RIFF and WAVE")
    at, form, chunk = 12, b"", b""
    while chunk[:4] != b"data":
        chunk = content[at:at + 8]
        size = int.from_bytes(chunk[4:], "little")
        if len(chunk) < 8 or (chunk[:4] == b"fmt " and not 16 <= size <= len(content) - at - 8):
            raise BadFile(f"byte {at}: is not a sound file: it ends in its header, before its samples")
        if chunk[:4] == b"fmt ":
            form = content[at + 8:at + 8 + size]
        at += 8 + size + size % 2 if chunk[:4] != b"data" else 8
    if not form:
        raise BadFile(f"byte {at - 8}: the chunk data has no chunk fmt before it")
    kind, channels, rate, _, frame_B, bits = struct.unpack("<HHIIHH", form[:16])
    if kind == EXTENSIBLE:
        kind = int.from_bytes(form[24:26], "little")
    if (kind, bits) not in WAV_KINDS or channels == 0 or frame_B != channels * bits // 8:
        raise BadFile(f"chunk fmt: format {kind} with {bits} bits and {frame_B} bytes per sample of {channels} channels is not read; save it as PCM of 16 bits")
    if channels != 1:
        raise BadFile(f"chunk fmt: has {channels} channels; an envelope has one")
    count, left = size // frame_B, len(content) - at
    if not 2 <= count <= MOST or not 1 <= rate <= 1_000_000:
        raise BadFile(f"byte {at - 8}: states {count} samples at {rate} Hz; possible are 2 to {MOST} samples at 1 to 1000000 Hz. Shorten it, or convert it to a lower rate")
    if left < size or size % frame_B:
        raise BadFile(f"byte {at - 8}: states {size} bytes of samples of {frame_B} bytes, of which {left} follow")
    raw = content[at:at + size]
    if kind == FLOAT:
        values = np.frombuffer(raw, f"<f{frame_B}").astype(float)
        if (wrong := np.flatnonzero(~(np.abs(values) <= 1))).size:
            raise BadFile(f"sample {wrong[0]} ({wrong[0] / rate:.6g} s): must be from -1 to 1, but is {values[wrong[0]]:g}")
        pressure = (1 + values) / 2
    else:
        steps = np.frombuffer(raw, np.uint8).reshape(-1, frame_B) @ 256 ** np.arange(frame_B)
        pressure = (steps + (1 << bits - 1 if bits > 8 else 0)) % (1 << bits) / ((1 << bits) - 1)  # 8 bits have no sign
    found = Played("envelope", np.full(count, 1 / rate), pressure ** 2)
    full = (pressure == 0) | (pressure == 1)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], full, [0])).astype(int)))
    flat = [int(a) for a, b in zip(edges[::2], edges[1::2]) if b - a >= FLAT]
    if flat:
        found.warnings.append(f"clipping: {len(flat)} runs of {FLAT} or more samples at full scale, the first at {flat[0] / rate:.6g} s; "
                              "if they are not intended, record it at a lower level")
    return found


def read_hjif(path: Path) -> Played:
    rate, pressure, warnings = hjif.pressures(path.read_text(encoding="utf-8-sig"), MOST)
    return Played("envelope", np.full(len(pressure), 1 / rate), pressure ** 2, warnings=warnings)


def read(path: Path) -> Played:
    """Raises BadFile and OSError."""
    if path.exists() and not path.is_file():
        raise BadFile("is not a regular file")
    if (size := path.stat().st_size) > LARGEST_B:
        raise BadFile(f"has {size / 1e6:.0f} MB, but at most {LARGEST_B / 1e6:.0f} MB are read")
    readers = {".csv": read_csv, ".wav": read_wav, ".hjif": read_hjif}
    if path.suffix.lower() not in readers:
        raise BadFile(f"is none of {', '.join(readers)}")
    try:
        return readers[path.suffix.lower()](path)
    except UnicodeDecodeError as error:
        raise BadFile(f"byte {error.start} is not text in UTF-8") from None


def text_for_program(found: Played) -> str:
    """What read_played() of the program reads."""
    if found.kind == "phases":
        return "\n".join([f"# phases {found.phases_rad.shape[1]}", *(" ".join(map(repr, row)) for row in found.phases_rad.tolist())])
    head = [f"# {line}" for line in (found.kind, *found.warnings)]
    points = found.points_mm if found.kind == "list" else np.zeros((len(found.levels), 2))
    rows = np.column_stack((points, 1e3 * found.dwells_s, found.levels)).tolist()
    return "\n".join([*head, "x_mm,y_mm,dwell_ms,level", *(",".join(map(repr, row)) for row in rows)])


def main(arguments: list[str]) -> int:
    path = Path(arguments[0])
    np.seterr(all="ignore")  # a warning would be part of the text
    try:
        sys.stderr.write(text_for_program(read(path)))
    except BadFile as error:
        sys.stderr.write(f"{path}: {error}")
        return BAD
    except OSError as error:
        sys.stderr.write(f"cannot read {path}: {error.strerror or error}")
        return BAD
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
