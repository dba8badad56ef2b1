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
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import hjif
from .hjif import BadFile

BAD = 3
LARGEST_B, MOST, MOST_FRAMES = 1 << 26, 100_000, 5_000
UNITS = {"t dwell": {"s": 1.0, "ms": 1e-3, "us": 1e-6}, "x y z": {"m": 1e3, "cm": 10.0, "mm": 1.0, "um": 1e-3}}  # in s and mm
COLUMNS = {f"{name}_{unit}": (name, factor) for names, units in UNITS.items() for name in names.split() for unit, factor in units.items()}
COLUMNS |= {"intensity_1": ("level", 1.0), "intensity": ("level", 1.0), "level": ("level", 1.0), "pressure_1": ("pressure", 1.0)}
HEADER = "the header must name columns with their units, as in t_s,x_mm,y_mm,z_mm,intensity_1, or t_s,intensity_1 for an envelope"
GAP = 1.5  # times the median of the rests
REGULAR = 0.01  # deviation of a sample of an envelope, in intervals
SHORTEST_s, LONGEST_s = 1e-6, 1e3  # of a rest or an interval
FLAT = 3  # successive samples at full scale are clipped
FLOAT, EXTENSIBLE = 3, 0xFFFE  # formats of .wav files
WAV_KINDS = {(1, 8), (1, 16), (1, 24), (1, 32), (FLOAT, 32), (FLOAT, 64)}
Rows = list[tuple[int, list[str]]]  # line and cells


@dataclass
class Signal:
    """A load over time: a list of points (`points_mm`), an envelope, or frames of phases (`phases_rad`: frame by piston). `dwells_s` and
    `levels`, factors of the force, belong to the points or samples."""

    kind: str
    dwells_s: np.ndarray = field(default_factory=lambda: np.empty(0))
    levels: np.ndarray = field(default_factory=lambda: np.empty(0))
    points_mm: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    phases_rad: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    warnings: list[str] = field(default_factory=list)


def rows_of(text: str) -> Iterator[tuple[int, list[str]]]:
    """The rows that are neither empty nor a comment. Raises BadFile."""
    first = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    separator = next((s for s in ",;\t" if s in first), ",")
    reader = csv.reader(text.splitlines(), delimiter=separator, strict=True)
    try:
        for cells in reader:
            if cells and any(c.strip() for c in cells) and not cells[0].lstrip().startswith("#"):
                yield reader.line_num, [cell.strip() for cell in cells]
    except csv.Error as error:
        raise BadFile(f"line {reader.line_num}: is not CSV: {error}") from None


def refuse(wrong: np.ndarray, reason: Callable[[int], str]) -> None:
    """Raises BadFile with the reason of the first element that is wrong."""
    if (found := np.flatnonzero(wrong)).size:
        raise BadFile(reason(int(found[0])))


def numbers_in(rows: Rows, names: Sequence[str]) -> np.ndarray:
    """The numbers of rows with a cell for each name: row by name. Raises BadFile."""
    table = np.empty((len(rows), len(names)))
    for n, (line, cells) in enumerate(rows):
        if len(cells) != len(names):
            raise BadFile(f"line {line}: has {len(cells)} cells, but must have {len(names)}")
        for place, cell in enumerate(cells):
            try:
                table[n, place] = float(cell if "_" not in cell else "")  # Python reads 1_0 as 10
            except ValueError:
                table[n, place] = math.nan
            if not abs(table[n, place]) < 1e9:
                raise BadFile(f"line {line}: {names[place]} must be a finite number below 1e9, but is {cell[:60]!r}")
    return table


def columns_of(line: int, names: list[str]) -> dict[str, tuple[int, float]]:
    """Place and factor to s, mm or 1 of t, dwell, x, y, z, level and pressure. Raises BadFile."""
    found: dict[str, tuple[int, float]] = {}
    for place, full in enumerate(names):
        if full not in COLUMNS:
            raise BadFile(f"line {line}: {full[:60]!r} is not a column with a unit; {HEADER}")
        column, factor = COLUMNS[full]
        if column in found:
            raise BadFile(f"line {line}: has two columns {column}")
        found[column] = place, factor
    has = found.keys()
    if ("t" in has) == ("dwell" in has) or ("x" in has) != ("y" in has) or ("x" not in has and ("level" in has) == ("pressure" in has)):
        raise BadFile(f"line {line}: {HEADER}")
    return found


def read_list(rows: Rows) -> Signal:
    """A list of points, or an envelope, whose samples must be uniformly spaced."""
    columns = columns_of(*rows[0])
    if len(rows) < 3:
        raise BadFile(f"has {len(rows) - 1} rows below its header, but a list has 2 or more")
    numbers, lines = numbers_in(rows[1:], rows[0][1]), [line for line, _ in rows[1:]]
    table = {name: factor * numbers[:, place] for name, (place, factor) in columns.items()}
    level = table.get("pressure", table.get("level", np.ones(len(lines))))
    refuse((level < 0) | (level > 1), lambda n: f"line {lines[n]}: the strength must be from 0 to 1, the strongest output, but is {level[n]:g}")
    z, t = table.get("z", np.zeros(1)), table.get("t", np.zeros(1))
    refuse(z != z[0], lambda n: f"line {lines[n]}: z changes to {z[n]:g} mm, but the skin is a plane of constant z, here {z[0]:g} mm")
    refuse(np.append(t[0] != 0, np.diff(t) <= 0), lambda n: f"line {lines[n]}: the time {t[n]:g} s must be " + (
        f"after {t[n - 1]:g} s, that of the row before" if n else "0, since it is the first"))
    dwells = table["dwell"] if "dwell" in table else np.append(np.diff(t), t[-1] - t[-2])
    refuse((dwells < 0.999 * SHORTEST_s) | (dwells > LONGEST_s),
           lambda n: f"line {lines[n]}: lasts {dwells[n]:g} s; possible are {SHORTEST_s:g} to {LONGEST_s:g} s")
    steps, usual = dwells[:-1], float(np.median(dwells[:-1]))
    if "x" not in table:
        if np.abs(np.cumsum(steps - steps.mean())).max() > REGULAR * steps.mean():
            at = int(np.argmax(np.abs(steps - usual)))
            raise BadFile(f"line {lines[at + 1]}: the samples of an envelope must be uniformly spaced, but this one follows after {steps[at]:.6g} s "
                          f"and most after {usual:.6g} s")
        dwells = np.full(len(lines), steps.mean())
    found = Signal("list" if "x" in table else "envelope", dwells, level ** 2 if "pressure" in table else level,
                   np.column_stack((table["x"], table["y"])) if "x" in table else np.empty((0, 2)))
    if (gaps := np.flatnonzero(dwells > GAP * usual)).size:
        at = int(gaps[0])
        found.warnings.append(f"has {len(gaps)} gap{'s' if len(gaps) > 1 else ''}: the focus rests at the point of line {lines[at]} for {1e3 * dwells[at]:.6g} ms, "
                              f"at most points for {1e3 * usual:.6g} ms")
    return found


def read_frames(rows: Rows) -> Signal:
    frames, pistons = numbers_in(rows[:1], ("the number of frames", "the number of pistons"))[0]
    if not 1 <= pistons <= 10_000 or pistons != int(pistons) or not 2 <= frames <= MOST_FRAMES:
        raise BadFile(f"line {rows[0][0]}: states {frames:g} frames of {pistons:g} pistons; possible are 2 to {MOST_FRAMES} of 1 to 10000")
    if frames != len(rows) - 1:
        raise BadFile(f"line {rows[0][0]}: states {frames:g} frames, but {len(rows) - 1} rows follow")
    return Signal("phases", phases_rad=numbers_in(rows[1:], [f"the phase of piston {n + 1}" for n in range(int(pistons))]))


def read_csv(content: bytes) -> Signal:
    rows = list(itertools.islice(rows_of(content.decode("utf-8-sig")), MOST + 2))
    if len(rows) > MOST + 1:
        raise BadFile(f"line {rows[-1][0]}: exceeds the limit of {MOST} rows")
    if not rows:
        raise BadFile(f"has no row; {HEADER}")
    is_phases = len(rows[0][1]) == 2 and all(cell.lstrip("+-")[:1].isdigit() for cell in rows[0][1])
    return read_frames(rows) if is_phases else read_list(rows)


def read_wav(content: bytes) -> Signal:
    """The chunks fmt and data of a RIFF file, in PCM of 8 to 32 bits or as floating-point numbers."""
    if content[:4] != b"RIFF" or content[8:12] != b"WAVE":
        raise BadFile("byte 0: is not a sound file, which begins with RIFF and WAVE")
    at, form, name, size = 12, b"", b"", 0
    while name != b"data":
        at += size + size % 2
        name, size, start = content[at:at + 4], int.from_bytes(content[at + 4:at + 8], "little"), at
        at += 8
        if at > len(content) or (name == b"fmt " and not 16 <= size <= len(content) - at):
            raise BadFile(f"byte {start}: is not a sound file: it ends in its header, before its samples")
        form = content[at:at + size] if name == b"fmt " else form
    if not form:
        raise BadFile(f"byte {start}: the chunk data has no chunk fmt before it")
    kind, channels, rate, _, frame_B, bits = struct.unpack("<HHIIHH", form[:16])
    if kind == EXTENSIBLE:
        kind = int.from_bytes(form[24:26], "little")
    if (kind, bits) not in WAV_KINDS or frame_B != channels * bits // 8 or channels != 1:
        raise BadFile(f"chunk fmt: format {kind} with {bits} bits, {channels} channels and {frame_B} bytes per sample is not read; "
                      "save it as PCM of 16 bits and one channel")
    count, left = size // frame_B, len(content) - at
    if not 2 <= count <= MOST or not 1 <= rate <= 1_000_000 or left < size or size % frame_B:
        raise BadFile(f"byte {start}: states {count} samples at {rate} Hz in {size} bytes, of which {min(left, size)} follow; all must follow, and possible "
                      f"are 2 to {MOST} samples at 1 to 1000000 Hz")
    if kind == FLOAT:
        values = np.frombuffer(content[at:at + size], f"<f{frame_B}").astype(float)
        refuse(~(np.abs(values) <= 1), lambda n: f"sample {n} ({n / rate:.6g} s): must be from -1 to 1, but is {values[n]:g}")
        pressure = (1 + values) / 2
    else:
        steps = np.frombuffer(content[at:at + size], np.uint8).reshape(-1, frame_B) @ 256 ** np.arange(frame_B)
        pressure = (steps + (1 << bits - 1 if bits > 8 else 0)) % (1 << bits) / ((1 << bits) - 1)  # 8 bits have no sign
    found = Signal("envelope", np.full(count, 1 / rate), pressure ** 2)
    flat = np.flatnonzero(np.convolve((pressure == 0) | (pressure == 1), np.ones(FLAT), "valid") == FLAT) if count >= FLAT else np.empty(0)
    if flat.size:
        found.warnings.append(f"clipping: {FLAT} or more successive samples are at full scale, the first at {flat[0] / rate:.6g} s; "
                              "if this is not intended, record it at a lower level")
    return found


def read_hjif(content: bytes) -> Signal:
    rate, pressure, warnings = hjif.pressures(content.decode("utf-8-sig"), MOST)
    return Signal("envelope", np.full(len(pressure), 1 / rate), pressure ** 2, warnings=warnings)


READERS = {".csv": read_csv, ".wav": read_wav, ".hjif": read_hjif}


def read(path: Path) -> Signal:
    """Raises BadFile and OSError."""
    if path.exists() and not path.is_file():
        raise BadFile("is not a regular file")
    if (size := path.stat().st_size) > LARGEST_B:
        raise BadFile(f"has {size / 1e6:.0f} MB, but at most {LARGEST_B / 1e6:.0f} MB are read")
    if path.suffix.lower() not in READERS:
        raise BadFile(f"is none of {', '.join(READERS)}")
    try:
        return READERS[path.suffix.lower()](path.read_bytes())
    except UnicodeDecodeError as error:
        raise BadFile(f"byte {error.start} is not text in UTF-8") from None


def text_for_program(found: Signal) -> str:
    """What read_played() of the program reads."""
    if found.kind == "phases":
        return "\n".join([f"# phases {found.phases_rad.shape[1]}", *(" ".join(map(repr, row)) for row in found.phases_rad.tolist())])
    points = found.points_mm if found.kind == "list" else np.zeros((len(found.levels), 2))
    if not np.ptp(points, axis=0).any():
        points[-1, 0] += 1e-6  # a path has a length, also if the focus stays at one place
    rows = np.column_stack((points, 1e3 * found.dwells_s, found.levels)).tolist()
    return "\n".join([*(f"# {line}" for line in (found.kind, *found.warnings)), "x_mm,y_mm,dwell_ms,level", *(",".join(map(repr, row)) for row in rows)])


def main(arguments: list[str]) -> int:
    path = Path(arguments[0])
    np.seterr(all="ignore")  # a warning would be part of the text
    try:
        sys.stderr.write(text_for_program(read(path)))
    except (BadFile, OSError) as error:
        sys.stderr.write(f"{path}: {getattr(error, 'strerror', None) or error}")
        return BAD
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
