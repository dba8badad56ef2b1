# SPDX-License-Identifier: BSD-3-Clause
"""Universal File Format: type 58 (functions at nodes, ASCII and binary), with the nodes of type 2411 or 15 and the
units of type 164, as documented by the Structural Dynamics Research Laboratory of the University of Cincinnati.

The step of the abscissa has six digits in the format. The fifth identification line therefore repeats it exactly,
together with the quality of the point; files of other programs do without.
"""
import codecs
import datetime
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np

from .scan import MOST_POINTS, MOST_VALUES, BadScan, Scan, half_unit
from .units import TIMES, metres, speed_of, unit_label

TIME_RESPONSE, GENERAL = 1, 0
TIME, UNKNOWN, GENERAL_QUANTITY = 17, 0, 1
DISPLACEMENT, VELOCITY, ACCELERATION = 8, 11, 12
SINGLE, DOUBLE = 2, 4
HEADER_LINES = 11
# Units per metre of the systems of data set 164; None: stated in its second record.
PER_METRE = {1: 1.0, 2: 1.0 / 0.3048, 3: 1.0, 4: 1.0 / 0.3048, 5: 1e3, 6: 1e2, 7: 1.0 / 0.0254, 8: 1e3, 9: None, 10: 1e3}
TITLE = "velocity along the line of sight"  # of the data sets that this program writes
ALONG = {1: "x", 2: "y", 3: "z"}


def record(text: str) -> str:
    return text.ljust(80)[:80].rstrip() + "\n"


def label(text: str) -> str:
    return f" {text:<20.20s}"


def nodes_block(scan: Scan) -> str:
    lines = ["    -1\n", "  2411\n"]
    for n, (x, y) in enumerate(zip(scan.x_m, scan.y_m), 1):
        lines.append(f"{n:10d}{0:10d}{0:10d}{11:10d}\n")
        lines.append("".join(f"{value:25.16E}".replace("E", "D") for value in (x, y, 0.0)) + "\n")
    return "".join(lines) + "    -1\n"


UNITS_BLOCK = ("    -1\n   164\n" + f"{1:10d}{'SI: Meter (newton)':<20s}{2:10d}\n"
               + f"{1:25.17E}{1:25.17E}{1:25.17E}\n{273.15:25.17E}\n".replace("E", "D") + "    -1\n")


def header_of(scan: Scan, node: int, quality: float) -> str:
    step = 1.0 / scan.rate_Hz
    start = float(scan.time_s[0])
    along = ",".join(f"{value:.16E}" for value in scan.direction)
    stamp = datetime.datetime(2000, 1, 1).strftime("%d-%b-%y %H:%M:%S").upper()  # files of one scan are equal
    characteristic = (f"{TIME:10d}{0:5d}{0:5d}{0:5d}{label('Time')}{label('s')}\n",
                      f"{VELOCITY:10d}{1:5d}{0:5d}{0:5d}{label('Velocity')}{label('m/s')}\n",
                      f"{UNKNOWN:10d}{0:5d}{0:5d}{0:5d}{label('NONE')}{label('NONE')}\n")
    return "".join((
        record(TITLE),
        record(f"direction={along}"),
        record(stamp),
        record(f"delay={scan.trigger_delay_s:.16E}"),
        record(f"dt={step:.16E} t0={start:.16E} q={quality:.16E}"),
        f"{TIME_RESPONSE:5d}{node:10d}{0:5d}{0:10d} {'NONE':<10s}{node:10d}{3:4d} {'NONE':<10s}{0:10d}{0:4d}\n",
        f"{DOUBLE:10d}{len(scan.time_s):10d}{1:10d}{start:13.5E}{step:13.5E}{0:13.5E}\n",
        characteristic[0], characteristic[1], characteristic[2], characteristic[2]))


def uff_bytes(scan: Scan, binary: bool) -> bytes:
    """The scan as a file, with velocities into the skin; points without signal have zeros and the quality 0."""
    scan = scan.along_z()
    blocks = [UNITS_BLOCK.encode(), nodes_block(scan).encode()]
    for node, (row, quality) in enumerate(zip(scan.velocity_m_s, scan.quality), 1):
        has_signal = bool(np.all(np.isfinite(row)))
        values = np.where(np.isfinite(row), row, 0.0)
        header = header_of(scan, node, float(quality) if has_signal else 0.0).encode()
        if binary:
            data = values.astype("<f8").tobytes()
            first = f"{58:6d}b{1:6d}{2:6d}{HEADER_LINES:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n".encode()
        else:
            words = [f"{value:20.12E}" for value in values]
            data = "".join("".join(words[n:n + 4]) + "\n" for n in range(0, len(words), 4)).encode()
            first = b"    58\n"
        blocks.append(b"    -1\n" + first + header + data + (b"\n" if binary else b"") + b"    -1\n")
    return b"".join(blocks)


class Lines:
    """The bytes of a file, line by line."""

    def __init__(self, file: IO[bytes]) -> None:
        self.file, self.size = file, os.fstat(file.fileno()).st_size
        if file.read(3) != codecs.BOM_UTF8:
            file.seek(0)

    def next(self) -> str | None:
        line = self.file.readline()
        return line.removesuffix(b"\n").rstrip(b"\r").decode("latin-1") if line else None

    def read(self, count: int) -> bytes:
        left = self.size - self.file.tell()
        if not 0 <= count <= left:
            raise BadScan(f"the file is truncated: a record claims {count} bytes, but {left} are left")
        return self.file.read(count)


def field(line: str, start: int, width: int, what: str, kind: type = int) -> Any:
    text = line[start:start + width].replace("D", "E").replace("d", "e").strip()
    try:
        value = kind(text)
    except ValueError as error:
        raise BadScan(f"{what} is not a number: \"{text[:30]}\"") from error
    if kind is float and not np.isfinite(value):
        raise BadScan(f"{what} is not a finite number")
    return value


def is_mark(line: str) -> bool:
    return line.strip() == "-1"


def body(lines: Lines) -> list[str]:
    """The lines up to the end of an ASCII data set."""
    content: list[str] = []
    while (line := lines.next()) is not None:
        if is_mark(line):
            return content
        content.append(line)
    raise BadScan("the file is truncated: a data set has no end")


def nodes_of(content: list[str], kind: int) -> dict[int, tuple[float, ...]]:
    nodes = {}
    if kind == 15:
        for line in content:
            if line.strip():
                nodes[field(line, 0, 10, "a node number")] = tuple(
                    field(line, 40 + 13 * axis, 13, "a coordinate", float) for axis in range(3))
        return nodes
    for first, second in zip(content[0::2], content[1::2]):
        nodes[field(first, 0, 10, "a node number")] = tuple(
            field(second, 25 * axis, 25, "a coordinate", float) for axis in range(3))
    return nodes


def units_per_metre(content: list[str]) -> float:
    """Number of length units of the file per metre (data set 164)."""
    code = field(content[0], 0, 10, "the code of the units") if content else None
    known = PER_METRE.get(code)
    if len(content) > 1:
        factor = field(content[1], 0, 25, "the factor of the unit of length", float)
        if not factor > 0.0:
            raise BadScan("the factor of the unit of length is not positive")
        if known is not None and code != 1 and abs(factor / known - 1.0) > 1e-3:
            raise BadScan(f"data set 164 contradicts itself: its code {code} means lengths in {metres(known)}, its factor {factor:g} "
                          f"lengths in {metres(factor)}")
        return factor
    if known is None:
        raise BadScan(f"data set 164 contains no factor of the unit of length, which does not follow from the code {code}")
    return known


def integer(line: str, start: int, width: int, what: str) -> int:
    """An integer, of which blanks mean 0."""
    return field(line[start:start + width].strip() or "0", 0, width, what)


def exact(head: list[str]) -> dict[str, list[float]]:
    """Numbers that this program adds to the identification lines of its files."""
    found: dict[str, list[float]] = {}
    if head[0].strip() != TITLE:
        return found
    for line in head[:5]:
        for name, words in re.findall(r"\b(dt|t0|q|delay|direction)=(\S+)", line):
            try:
                found[name] = [float(word) for word in words.split(",")]
            except ValueError as error:
                raise BadScan(f"the identification line \"{line[:40]}\" contains no number") from error
            if not np.all(np.isfinite(found[name])):
                raise BadScan(f"the identification line \"{line[:40]}\" contains a number that is not finite")
    return found


def numbers_of(content: list[str], count: int, width: int) -> np.ndarray:
    """`count` numbers of fixed width; blanks between them may be missing."""
    values = np.fromiter((field(line, start, width, "a value", float) for line in map(str.rstrip, content)
                          for start in range(0, len(line), width)), float)
    if len(values) != count:
        raise BadScan(f"a data set claims {count} values, but contains {'more' if len(values) > count else len(values)}")
    return values


class Function:
    """One data set of type 58."""

    def __init__(self, head: list[str], values_of: Callable[[int, int], np.ndarray]) -> None:
        if len(head) != HEADER_LINES:
            raise BadScan("the file is truncated: a data set of type 58 has fewer than 11 records")
        kind = field(head[5], 0, 5, "the type of a function")
        if kind not in (TIME_RESPONSE, GENERAL):
            raise BadScan(f"it contains functions of type {kind}; only time responses (1) can be read")
        self.node = field(head[5], 41, 10, "the node of a response")
        data, self.count = field(head[6], 0, 10, "the type of the data"), field(head[6], 10, 10, "a number of values")
        if data not in (SINGLE, DOUBLE):
            raise BadScan(f"its data are of type {data}; only real numbers (2 and 4) can be read")
        if not 2 <= self.count <= MOST_VALUES:
            raise BadScan(f"a data set claims {self.count} values; 2 to {MOST_VALUES} are supported")
        if field(head[6], 20, 10, "the spacing of the abscissa") != 1:
            raise BadScan("the times are not uniformly spaced")
        if field(head[7], 0, 10, "the type of the abscissa") not in (TIME, UNKNOWN):
            raise BadScan("the abscissa is not a time")
        label = unit_label(head[7])
        if label is not None and label not in TIMES:
            raise BadScan(f"the unit of the time is \"{label}\"; only s, ms and us can be read")
        to_s = TIMES[label] if label else 1.0
        self.notes: list[str] = []
        self.read_quantity(head[8], head[9])
        own = exact(head)
        first, step = (to_s * field(head[6], at, 13, what, float) for at, what in ((30, "the first time"), (43, "the time step")))
        if not step > 0.0:
            raise BadScan("the time step is not positive")
        rounding_s = to_s * half_unit(head[6][43:56])
        exact_s = own.get("dt", [0.0])[0]
        self.is_exact = abs(exact_s - step) <= 2.0 * rounding_s  # another program may have sampled again
        self.step_s = exact_s if self.is_exact else step
        self.start_s = own["t0"][0] if self.is_exact and "t0" in own else first
        self.rate_rounding = 0.0 if self.is_exact else rounding_s / step
        self.quality = own.get("q", [1.0])[0]
        self.delay_s = own.get("delay", [0.0])[0]
        self.read_direction(head[5], own.get("direction"))
        with np.errstate(invalid="ignore"):  # binary data may contain NaN: no signal
            self.values = self.sign * values_of(self.count, data)

    def read_quantity(self, numerator: str, denominator: str) -> None:
        """`speed`: the unit of the values in m/s; None: that of the file, by data set 164."""
        quantity = field(numerator, 0, 10, "the type of the ordinate")
        self.label = unit_label(numerator)
        self.speed = None if self.label is None else speed_of(self.label)
        if quantity not in (VELOCITY, UNKNOWN) and not (quantity == GENERAL_QUANTITY and self.speed):
            other = {DISPLACEMENT: "a displacement", ACCELERATION: "an acceleration"}.get(quantity, f"of type {quantity}")
            raise BadScan(f"the ordinate is {other}; only velocities (11) can be read")
        if self.label is not None and self.speed is None:
            raise BadScan(f"the unit of the velocity is \"{numerator[47:67].strip()}\"; only m/s, cm/s, mm/s, um/s and nm/s can be read")
        divisor, *exponents = (integer(denominator, start, width, "a number of the ordinate's denominator")
                               for start, width in ((0, 10), (10, 5), (15, 5), (20, 5)))
        if divisor > GENERAL_QUANTITY or any(exponents):
            raise BadScan("the ordinate is divided by another quantity (record 10); only velocities can be read")
        length, force, temperature = (integer(numerator, start, 5, "an exponent of the ordinate") for start in (10, 15, 20))
        if (force, temperature) == (0, 0) and length in (0, 1):
            return
        dimension = f"length^{length} force^{force} temperature^{temperature} (record 9)"
        if self.speed is None:
            raise BadScan(f"the ordinate has no unit and the dimension {dimension}; a velocity has length^1")
        self.notes.append(f"the unit of the velocity contradicts the dimension {dimension}; the unit is used")

    def read_direction(self, line: str, vector: list[float] | None) -> None:
        """Record 6: the velocities are those along z, or, with a negative direction, against it."""
        code = integer(line, 51, 4, "the response direction")
        if abs(code) > 6:
            raise BadScan(f"the response direction {code} (record 6) is unknown")
        if abs(code) > 3:
            raise BadScan(f"it contains rotations (response direction {code}, record 6); only velocities along z can be read")
        if abs(code) in (1, 2):
            raise BadScan(f"it contains velocities along {ALONG[abs(code)]} (response direction {code}, record 6); only those along z "
                          "can be read: export that component")
        if vector is not None and len(vector) != 3:
            raise BadScan("the direction must have three components")
        self.states_direction = code != 0 or vector is not None
        self.sign, self.direction = (-1.0 if code < 0 else 1.0), (0.0, 0.0, 1.0)
        if vector is not None:
            stated = -1.0 if vector[2] < 0.0 else 1.0
            self.direction = (stated * vector[0], stated * vector[1], stated * vector[2])
            if code == 0:
                self.sign = stated
            elif stated != self.sign:
                self.notes.append(f"the response direction {code} (record 6) is used, which contradicts the direction of the "
                                  "second identification line")


def ascii_function(content: list[str]) -> Function:
    def values_of(count: int, data: int) -> np.ndarray:
        if count > sum(len(line) for line in content[HEADER_LINES:]):
            raise BadScan(f"a data set claims {count} values, but contains fewer")
        return numbers_of(content[HEADER_LINES:], count, 20 if data == DOUBLE else 13)
    return Function(content[:HEADER_LINES], values_of)


def binary_function(first: str, lines: Lines) -> Function:
    order, floats = field(first, 7, 6, "the byte order"), field(first, 13, 6, "the format of numbers")
    if order not in (1, 2) or floats != 2:
        raise BadScan("its binary numbers are not in IEEE format")
    ascii_lines, size = field(first, 19, 12, "the number of records"), field(first, 31, 12, "the number of bytes")
    if ascii_lines != HEADER_LINES:
        raise BadScan(f"a binary data set has {ascii_lines} text records instead of {HEADER_LINES}")
    head = [line for _ in range(HEADER_LINES) if (line := lines.next()) is not None]
    if len(head) < HEADER_LINES:
        raise BadScan("the file is truncated: a data set of type 58 has fewer than 11 records")
    data = lines.read(size)

    def values_of(count: int, kind: int) -> np.ndarray:
        dtype = np.dtype({1: "<", 2: ">"}[order] + ("f8" if kind == DOUBLE else "f4"))
        if count * dtype.itemsize != size:
            raise BadScan(f"a data set claims {count} values, but contains {size} bytes")
        return np.frombuffer(data, dtype).astype(float)

    function = Function(head, values_of)
    while (line := lines.next()) is not None:
        if is_mark(line):
            return function
        if line.strip():
            raise BadScan("the end of a binary data set does not match its size")
    raise BadScan("the file is truncated: a data set has no end")


def read_uff(path: Path) -> Scan:
    with path.open("rb") as file:
        return scan_in(Lines(file))


def scan_in(lines: Lines) -> Scan:
    nodes: dict[int, tuple[float, ...]] = {}
    functions: list[Function] = []
    per_metre: float | None = None
    count = 0
    while (line := lines.next()) is not None:
        count += 1
        if count > 2 * MOST_POINTS:
            raise BadScan(f"it has more than {2 * MOST_POINTS} data sets and lines outside of them")
        if not is_mark(line):
            continue
        first = lines.next()
        if first is None or is_mark(first):
            raise BadScan("the -1 at the start of a data set is missing, or the file is truncated")
        if first[:6].strip() == "58" and first[6:7].lower() == "b":
            functions.append(binary_function(first, lines))
            continue
        content = body(lines)
        kind = first.strip()
        if kind == "58":
            functions.append(ascii_function(content))
        elif kind in ("15", "2411"):
            nodes.update(nodes_of(content, int(kind)))
        elif kind == "164":
            units = units_per_metre(content)
            if per_metre is not None and per_metre != units:
                raise BadScan(f"it contains data sets 164 with different units of length, {metres(per_metre)} and {metres(units)}")
            per_metre = units
        if len(functions) > MOST_POINTS or len(nodes) > MOST_POINTS:
            raise BadScan(f"it has more than {MOST_POINTS} points")
    return joined(functions, nodes, per_metre)


def joined(functions: list[Function], nodes: dict, per_metre: float | None) -> Scan:
    """`per_metre`: length units per metre; None: the file contains no data set 164."""
    if not functions:
        raise BadScan("it contains no data set of type 58")
    known = set()
    for function in functions:
        if function.node not in nodes:
            raise BadScan(f"node {function.node} has no coordinates (data set 2411 or 15)")
        if function.node in known:
            raise BadScan(f"node {function.node} has several time responses; export one component")
        known.add(function.node)
        for name in ("count", "step_s", "start_s", "delay_s", "direction", "states_direction"):
            if getattr(function, name) != getattr(functions[0], name):
                raise BadScan(f"nodes {functions[0].node} and {function.node} have different times or directions")
    one = functions[0]
    length = metres(per_metre or 1.0)
    signs = {function.sign for function in functions}
    notes = [f"lengths in {length} " + ("(data set 164)" if per_metre else "(assumed, since data set 164 is missing)")]
    for label in sorted({function.label or "" for function in functions}):
        speed = speed_of(label) if label else None
        differs = speed is not None and per_metre is not None and abs(speed * per_metre - 1.0) > 1e-9
        source = "label of record 9" + (f", unlike data set 164 with {length}" if differs else "") if label \
            else "data set 164" if per_metre else "assumed, since the file states no unit"
        notes.append(f"velocities in {label or length + '/s'} ({source})")
    if one.states_direction:
        notes.append("response direction " + " and ".join(f"{sign:+.0f}z" for sign in sorted(signs)).replace("1z", "z") + " (record 6)")
    notes += sorted({note for function in functions for note in function.notes})
    places = np.array([nodes[function.node] for function in functions]) / (per_metre or 1.0)
    velocity = np.array([(function.speed or 1.0 / (per_metre or 1.0)) * function.values for function in functions])
    quality = np.array([function.quality for function in functions])
    velocity[quality == 0.0] = np.nan
    return Scan(one.start_s + one.step_s * np.arange(one.count), places[:, 0], places[:, 1], velocity, quality,
                one.delay_s, one.direction, notes, one.states_direction, one.rate_rounding)
