# SPDX-License-Identifier: BSD-3-Clause
"""Files of scans.

`read_scan` reads case files of shearwake, Universal File Format type 58 (ASCII and binary), CSV, MATLAB files
(version 5 through scipy, 7.3 through h5py) and HDF5; `write_scan` writes UFF, CSV and HDF5 that MATLAB and
Octave read. Units are SI.
"""
import array
import codecs
import csv
import io
import itertools
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np

from .scan import BadScan, Scan, rounding_of
from .scan_arrays import read_hdf5, read_mat5, write_hdf5
from .scan_settings import DELAYS, NOT_A_SCAN, SETTINGS, is_ignored, settings
from .scan_uff import read_uff, uff_bytes
from .units import check_unit, is_foreign, plain_unit

LONGEST_M = 2.0  # between points on skin or on a gel
MOST_ROUNDING = 0.2  # of the spacing of rounded times
LOWEST_Hz = 150.0  # vibrations that are felt have some 100 Hz; scans of more than 150 kHz whose times are in ms are not found


def checked(scan: Scan) -> Scan:
    """The same scan, or BadScan if its arrays do not belong together."""
    velocity = scan.velocity_m_s
    if velocity.ndim != 2 or velocity.shape != (len(scan.x_m), len(scan.time_s)):
        raise BadScan(f"it has {len(scan.x_m)} points and {len(scan.time_s)} times, but velocities of the shape "
                      f"{velocity.shape}")
    if len(scan.y_m) != len(scan.x_m) or len(scan.quality) != len(scan.x_m):
        raise BadScan("x, y and quality have different numbers of points")
    if velocity.shape[0] < 1 or velocity.shape[1] < 2:
        raise BadScan("it must contain at least one point and two times")
    for name, values in (("x", scan.x_m), ("y", scan.y_m), ("time", scan.time_s)):
        if not np.all(np.isfinite(values)):
            raise BadScan(f"{name} contains a value that is not a finite number")
    if np.any(np.isinf(velocity)):
        raise BadScan("the velocity contains an infinite value; use NaN for points without signal")
    if not np.all(np.isfinite((*scan.direction, scan.trigger_delay_s))) or not any(scan.direction):
        raise BadScan("the direction and the trigger delay must be finite numbers, and the direction must not be 0")
    if np.any((scan.quality < 0.0) | (scan.quality > 1.0 + 1e-6)):  # NaN: no signal; 1 may be rounded in single precision
        raise BadScan("quality contains a value outside of 0 (no signal) to 1; divide per cent by 100")
    step = np.diff(scan.time_s)
    rounding_s = min(0.5 * scan.rate_rounding * (scan.time_s[-1] - scan.time_s[0]), MOST_ROUNDING * float(np.mean(step)))
    if not np.all(step > 0.0) or np.max(np.abs(step - np.mean(step))) > 1e-3 * np.mean(step) + 2.0 * rounding_s:
        raise BadScan("the times are not uniformly spaced in ascending order")
    if np.max(np.abs(np.concatenate((scan.x_m, scan.y_m)))) > 10.0:
        raise BadScan("a point is more than 10 m from the origin; coordinates must be in metres")
    if max(np.ptp(scan.x_m), np.ptp(scan.y_m)) > LONGEST_M:
        raise BadScan(f"its points are {max(np.ptp(scan.x_m), np.ptp(scan.y_m)):.4g} m apart; coordinates must be in metres")
    if scan.rate_Hz < LOWEST_Hz:
        raise BadScan(f"its sampling rate is {scan.rate_Hz:.4g} Hz, which resolves no vibration; times must be in seconds")
    with np.errstate(invalid="ignore"):
        if np.nanmax(np.abs(velocity), initial=0.0) > 1000.0:
            raise BadScan("a velocity exceeds 1000 m/s; velocities must be in m/s")
    if abs(scan.direction[2]) < 0.1 * np.linalg.norm(scan.direction):
        raise BadScan("the line of sight is nearly parallel to the surface, so it contains no displacement along z")
    if scan.direction[2] < 0.0:
        scan.notes.append(f"positive velocities point out of the skin (direction_z = {scan.direction[2]:.6g}); they and the line of "
                          "sight are negated")
    return scan.along_z()


def read_scan(path: str | Path) -> Scan:
    """The scan in a file. Raises BadScan or OSError."""
    path = Path(path)
    path.stat()  # raises the reason if it cannot be read
    if not path.is_file():
        raise BadScan("it is not a regular file")
    with path.open("rb") as file:
        start = file.read(128).removeprefix(codecs.BOM_UTF8)
    if start.startswith(b"\x89HDF") or b"MATLAB 7.3" in start:
        return checked(read_hdf5(path))
    if start.startswith(b"MATLAB 5.0"):
        return checked(read_mat5(path))
    if path.suffix.lower() in (".uff", ".unv", ".uf", ".58") or start.lstrip()[:2] == b"-1":
        return checked(read_uff(path))
    return read_csv(path)


CSV_HEADER = ["x_m", "y_m", "quality"]
MOST_CSV_VALUES = 8_000_000  # are read in about 10 s and 300 MB
# A quantity and its unit: "velocities in mm/s", "x [mm]".
IN_UNIT = r"\b(velocit(?:y|ies)|speeds?|displacements?|coordinates|positions|x|y|times?)\s*(?:\bin\b|[:=(\[])([^,;]*)"
WITH_POINT = "; write decimal numbers with a point"


def csv_lines(file: IO[str], remarks: dict[str, Any], notes: list) -> Iterator[str]:
    """The lines of a CSV file that are neither empty nor remarks, without the separators and quotes that spreadsheets add."""
    for line in file:
        line = line.rstrip(" \t\r\n,;")
        if line.startswith(("#", '"#')):
            read_remark(line.strip('"')[1:].strip(), remarks, notes)
        elif line and not line.startswith("sep="):
            yield line


def read_csv(path: Path) -> Scan:
    """Lines of x, y, quality and one velocity per time; the header contains the times in seconds."""
    remarks: dict[str, Any] = {}
    notes: list[str] = []
    header: list[str] = []
    values = array.array("d")
    try:
        with path.open(encoding="utf-8-sig") as file:
            lines = csv_lines(file, remarks, notes)
            first = next(lines, "")
            separator = next((c for c in ";\t" if c in first.partition("y_m")[0]), ",")
            for row in csv.reader(itertools.chain([first], lines), delimiter=separator):
                if not header:
                    header = row
                    if [word.strip() for word in header[:3]] != CSV_HEADER:
                        break
                    continue
                if len(row) != len(header):
                    raise BadScan(f"every line must have {len(header)} fields, as the first one"
                                  + (WITH_POINT if len(row) > len(header) else ""))
                if "_" in "".join(row):  # which float() ignores
                    raise ValueError("_")
                values.extend(map(float, row))
                if len(values) > MOST_CSV_VALUES:
                    raise BadScan(f"it has more than {MOST_CSV_VALUES} values; larger scans are read from HDF5 and MATLAB files")
        is_scan = [word.strip() for word in header[:3]] == CSV_HEADER
        times = np.array([float(word) for word in header[3:] if is_scan])
    except UnicodeDecodeError as error:
        raise BadScan(NOT_A_SCAN + "it is neither text in UTF-8 nor a known binary format") from error
    except csv.Error as error:
        raise BadScan(f"{NOT_A_SCAN}{error}") from error
    except ValueError as error:
        comma = WITH_POINT if "," in str(error) else ""
        raise BadScan(f"it contains a field that is not a number: {str(error)[:80]}{comma}") from error
    if not is_scan:
        raise BadScan(NOT_A_SCAN + "the first line must begin with x_m,y_m,quality, followed by the times in seconds")
    numbers = np.frombuffer(values).reshape(-1, len(header))
    scan = Scan(times, numbers[:, 0], numbers[:, 1], np.ascontiguousarray(numbers[:, 3:]), numbers[:, 2],
                **settings(remarks, lambda value, _: value, notes))
    if len(times) > 1 and times[-1] > times[0]:
        scan.rate_rounding = 2.0 * rounding_of(header[3:]) / (times[-1] - times[0])
    return checked(scan)


def read_remark(text: str, remarks: dict[str, Any], notes: list) -> None:
    """A line "name = number" or "name: number" of a CSV file; other remarks are noted."""
    name, is_pair, value = text.partition("=") if "=" in text else text.partition(":")
    name = name.strip()
    if is_pair:
        is_ignored(name, value)  # rejects contradictions
    else:
        name, _, value = " ".join(text.split()).rpartition(" ")
    check_unit(name, value)
    for quantity, unit in re.findall(IN_UNIT, text.lower()):
        if is_foreign(plain_unit(unit)):
            raise BadScan(f"the remark \"{text[:60]}\" states the unit of {quantity}, but values are read in m, s and m/s; convert them "
                          "and remove it")
    if not is_pair and text:
        name, _, value = text.replace("\t", " ").partition(" ")
        if name not in (*DELAYS, *SETTINGS):
            notes.append(f"remark without effect: {text[:60]}")
            return
        raise BadScan(f"the remark \"{text[:30]}\" must have the form {name} = number")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if name in DELAYS or name in SETTINGS:
        if not math.isfinite(number):
            raise BadScan(f"{name} is not a number: \"{value.strip()[:30]}\"{WITH_POINT if ',' in value else ''}")
        if name in remarks:
            raise BadScan(f"{name} is given twice")
    elif text:
        notes.append(f"remark without effect: {text[:60]}")
    if is_pair:
        remarks[name] = number


def csv_text(scan: Scan) -> str:
    out = io.StringIO()
    out.write(f"# trigger_delay_s = {float(scan.trigger_delay_s)!r}\n")
    for axis, value in zip("xyz", scan.direction):
        out.write(f"# direction_{axis} = {float(value)!r}\n")
    out.write(",".join(CSV_HEADER + [repr(float(t)) for t in scan.time_s]) + "\n")
    for x, y, quality, row in zip(scan.x_m, scan.y_m, scan.quality, scan.velocity_m_s):
        out.write(",".join(repr(float(value)) for value in (x, y, quality, *row)) + "\n")
    return out.getvalue()


def write_scan(path: str | Path, scan: Scan, kind: str) -> None:
    """Writes a scan as "uff" (ASCII), "uffb" (binary), "csv" or "mat"."""
    path = Path(path)
    if kind == "mat":
        write_hdf5(path, scan)
    elif kind == "csv":
        path.write_text(csv_text(scan), encoding="utf-8")
    else:
        path.write_bytes(uff_bytes(scan, binary=kind == "uffb"))
