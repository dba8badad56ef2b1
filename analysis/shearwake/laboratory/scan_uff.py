# SPDX-License-Identifier: BSD-3-Clause
"""Universal File Format: type 58 (functions at nodes, ASCII and binary), with the nodes of type 2411 or 15 and the
units of type 164, as documented by the Structural Dynamics Research Laboratory of the University of Cincinnati.

The step of the abscissa has six digits in the format. The fifth identification line therefore repeats it exactly,
together with the quality of the point; files of other programs do without.
"""
import datetime
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from .scan import MOST_POINTS, MOST_VALUES, BadScan, Scan

TIME_RESPONSE, GENERAL = 1, 0
TIME, UNKNOWN = 17, 0
DISPLACEMENT, VELOCITY, ACCELERATION = 8, 11, 12
SINGLE, DOUBLE = 2, 4
HEADER_LINES = 11
SPEEDS = {"m/s": 1.0, "mm/s": 1e-3, "um/s": 1e-6, "µm/s": 1e-6, "": 1.0, "none": 1.0}


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
        record("velocity along the line of sight"),
        record(f"direction={along}"),
        record(stamp),
        record(f"delay={scan.trigger_delay_s:.16E}"),
        record(f"dt={step:.16E} t0={start:.16E} q={quality:.16E}"),
        f"{TIME_RESPONSE:5d}{node:10d}{0:5d}{0:10d} {'NONE':<10s}{node:10d}{3:4d} {'NONE':<10s}{0:10d}{0:4d}\n",
        f"{DOUBLE:10d}{len(scan.time_s):10d}{1:10d}{start:13.5E}{step:13.5E}{0:13.5E}\n",
        characteristic[0], characteristic[1], characteristic[2], characteristic[2]))


def uff_bytes(scan: Scan, binary: bool) -> bytes:
    """The scan as a file; points without signal have zeros and the quality 0."""
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

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def next(self) -> str | None:
        if self.at >= len(self.data):
            return None
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        line = self.data[self.at:end].rstrip(b"\r").decode("latin-1")
        self.at = end + 1
        return line

    def take(self, count: int) -> bytes:
        if count < 0 or self.at + count > len(self.data):
            raise BadScan(f"the file is truncated: a record claims {count} bytes, but {len(self.data) - self.at} are left")
        part = self.data[self.at:self.at + count]
        self.at += count
        return part


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


def length_factor(content: list[str]) -> float:
    """Number of length units of the file per metre."""
    return field(content[1], 0, 25, "the factor of the unit of length", float) if len(content) > 1 else 1.0


def exact(head: list[str]) -> dict[str, list[float]]:
    """Numbers that this program adds to identification lines."""
    found = {}
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
    values = []
    for line in content:
        line = line.rstrip()
        for start in range(0, len(line), width):
            values.append(field(line, start, width, "a value", float))
            if len(values) > count:
                raise BadScan(f"a data set claims {count} values, but contains more")
    if len(values) != count:
        raise BadScan(f"a data set claims {count} values, but contains {len(values)}")
    return np.array(values)


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
        quantity = field(head[8], 0, 10, "the type of the ordinate")
        if quantity not in (VELOCITY, UNKNOWN):
            other = {DISPLACEMENT: "a displacement", ACCELERATION: "an acceleration"}.get(quantity, f"of type {quantity}")
            raise BadScan(f"the ordinate is {other}; only velocities (11) can be read")
        unit = head[8][47:67].strip()
        if unit.lower() not in SPEEDS:
            raise BadScan(f"the unit of the velocity is \"{unit}\"; only m/s, mm/s and um/s can be read")
        own = exact(head)
        self.start_s = own.get("t0", [field(head[6], 30, 13, "the first time", float)])[0]
        self.step_s = own.get("dt", [field(head[6], 43, 13, "the time step", float)])[0]
        if not self.step_s > 0.0:
            raise BadScan("the time step is not positive")
        self.quality = own.get("q", [1.0])[0]
        self.delay_s = own.get("delay", [0.0])[0]
        self.direction = tuple(own.get("direction", [0.0, 0.0, 1.0]))
        if len(self.direction) != 3:
            raise BadScan("the direction must have three components")
        with np.errstate(invalid="ignore"):  # binary data may contain NaN: no signal
            self.values = SPEEDS[unit.lower()] * values_of(self.count, data)


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
    data = lines.take(size)

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


def read_uff(data: bytes) -> Scan:
    lines, nodes, functions, factor = Lines(data), {}, [], 1.0
    while (line := lines.next()) is not None:
        if not is_mark(line):
            continue
        first = lines.next()
        if first is None:
            break
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
            factor = length_factor(content)
        if len(functions) > MOST_POINTS or len(nodes) > MOST_POINTS:
            raise BadScan(f"it has more than {MOST_POINTS} points")
    return joined(functions, nodes, factor)


def joined(functions: list[Function], nodes: dict, factor: float) -> Scan:
    if not functions:
        raise BadScan("it contains no data set of type 58")
    if not factor > 0.0:
        raise BadScan("the factor of the unit of length is not positive")
    known = set()
    for function in functions:
        if function.node not in nodes:
            raise BadScan(f"node {function.node} has no coordinates (data set 2411 or 15)")
        if function.node in known:
            raise BadScan(f"node {function.node} has several time responses; export one component")
        known.add(function.node)
        for name in ("count", "step_s", "start_s", "delay_s", "direction"):
            if getattr(function, name) != getattr(functions[0], name):
                raise BadScan(f"nodes {functions[0].node} and {function.node} have different times or directions")
    one = functions[0]
    places = np.array([nodes[function.node] for function in functions]) / factor
    velocity = np.array([function.values for function in functions])
    quality = np.array([function.quality for function in functions])
    velocity[quality == 0.0] = np.nan
    return Scan(one.start_s + one.step_s * np.arange(one.count), places[:, 0], places[:, 1], velocity, quality,
                one.delay_s, one.direction)
