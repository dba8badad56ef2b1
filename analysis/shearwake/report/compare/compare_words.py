# SPDX-License-Identifier: BSD-3-Clause
"""The result of a comparison as text."""
from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from ..words import counted, key_name, setting_text

COLUMNS = 12  # per pair of cases; of several pairs, the columns with their largest change
FEW = 5  # of surfaces and traces: those that differ most
EQUAL = 1e-12  # relative changes up to here are rounding errors


def percent(value: float) -> str:
    return f"{100 * value:.3g} %" if value is not None and math.isfinite(value) else "undefined"


def place(at_mm: list[float]) -> str:
    return f"[{at_mm[0]:.4g}, {at_mm[1]:.4g}] mm"


def grid(pair: dict[str, Any]) -> str:
    parts = [f"{g['points'][0]} x {g['points'][1]} points of {g['spacing_mm']:.4g} mm" for g in pair["grids"]]
    return parts[0] if parts[0] == parts[1] else " and ".join(parts)


def settings_texts(values: dict[str, Any]) -> list[str]:
    """The swept keys and their values; keys with the same name and value, which are swept together, once."""
    return list(dict.fromkeys(setting_text(key_name(key), key, value) for key, value in values.items()))


def settings(pair: dict[str, Any], side: int) -> list[str]:
    """The swept keys of one case of a pair."""
    return settings_texts(pair["settings"][side])


def label(pair: dict[str, Any], side: int) -> str:
    """The id of one case of a pair with its swept keys."""
    words = ["reference"] if pair["is_reference"][side] else []
    words += settings(pair, side)
    return pair[("first", "second")[side]] + (f" ({', '.join(words)})" if words else "")


def name_lines(pair: dict[str, Any]) -> list[str]:
    if pair["first"] == pair["second"]:
        return [f"case {label(pair, 0)}"]
    return [f"first:  {label(pair, 0)}", f"second: {label(pair, 1)}"]


def warnings_of(pairs: list[dict[str, Any]], side: int) -> list[tuple[str, str]]:
    """The wording of each kind of warning of one side, with the first of its cases and their number."""
    found: dict[Any, list[Any]] = {}
    for pair in pairs:
        for warning in pair["warnings"][side]:
            start = "not valid" if warning["severity"] == "error" else "warning"
            found.setdefault((start, warning["key"]), []).append((warning["message"], label(pair, side)))
    lines = []
    for (start, _), entries in found.items():
        more = f", and {counted(len(entries) - 1, 'more case')}" if len(entries) > 1 else ""
        lines.append((start, entries[0][0] + (f" ({entries[0][1]}{more})" if len(pairs) > 1 else "")))
    return lines


def warning_lines(pairs: list[dict[str, Any]]) -> list[str]:
    """The stored warnings of both sides."""
    first, second = warnings_of(pairs, 0), warnings_of(pairs, 1)
    both = [entry for entry in first if entry in second]
    return [f"{start}, {title}: {message}" for title, entries in (("both", both), ("first", first), ("second", second))
            for start, message in entries if title == "both" or (start, message) not in both]


def difference(entry: dict[str, Any], largest: str, where: str) -> str:
    """The relative L2 norm and the largest difference with its place, unless both are equal."""
    if entry["relative_l2"] == 0.0:
        return "equal"
    return f"relative L2 {percent(entry['relative_l2'])}, largest difference {largest} {where}"


def surface_line(entry: dict[str, Any]) -> str:
    largest = f"{entry['largest_um']:.3g} um ({percent(entry['largest_relative'])} of the peak)"
    return f"  surface at {entry['time_ms']:.6g} ms: " + difference(entry, largest, f"at {place(entry['at_mm'])}")


def trace_line(entry: dict[str, Any]) -> str:
    return f"  trace at {place(entry['at_mm'])}: " + difference(entry, f"{entry['largest_um']:.3g} um",
                                                                f"at {entry['time_ms']:.6g} ms")


def most_different(entries: list[Any], noun: str, line: Callable[..., Any], everything: bool) -> list[str]:
    """A line for each entry, or, of many entries, for those with the largest differences in their order. A summary is
    the first line of several."""
    if len(entries) < 2:
        return [line(entry) for entry in entries]
    largest = max(entries, key=lambda e: e["largest_um"])
    relative = max((e["relative_l2"] for e in entries if math.isfinite(e["relative_l2"])), default=math.nan)
    if all(e["relative_l2"] == 0.0 for e in entries):
        return [f"  {counted(len(entries), noun)}: equal"]
    summary = (f"  {counted(len(entries), noun)}: relative L2 up to {percent(relative)}, largest difference "
               f"{largest['largest_um']:.3g} um")
    if everything or len(entries) <= FEW:
        return [summary, *map(line, entries)]
    order = sorted(range(len(entries)), key=lambda n: -entries[n]["largest_um"])[:FEW]
    return [f"{summary}; the {FEW} with the largest differences (--all lists each):",
            *(line(entries[n]) for n in sorted(order))]


def sensor_lines(pair: dict[str, Any]) -> list[Any]:
    """Nodes are counted from 1, as import-kwave does."""
    lines = [f"  sensor, {s['field']} at {counted(s['nodes'], 'node')}: "
             + difference(s, f"{s['largest']:.3g} {s['unit']}",
                          f"at node [{', '.join(f'{index + 1:.6g}' for index in s['at_node'])}] and {s['time_ms']:.6g} ms")
             for s in pair["sensors"]]
    if pair["sensors_note"]:
        lines.append(f"  {'note on the sensors' if lines else 'sensors not compared'}: {pair['sensors_note']}")
    return lines


def depth_lines(pair: dict[str, Any]) -> list[Any]:
    first, second = ([f"{z:.6g}" for z in depths] for depths in pair["depths_mm"])
    if first == second:
        return []
    return [f"  measured depths differ: {', '.join(first)} mm and {', '.join(second)} mm; surfaces, traces and columns are "
            "those of these depths"]


def field_lines(pair: dict[str, Any], everything: bool) -> list[str]:
    return [*depth_lines(pair),
            *(most_different(pair["fields"], "surface", surface_line, everything) or ["  surface: no common time"]),
            *most_different(pair["traces"], "trace", trace_line, everything), *sensor_lines(pair)]


def cell(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "none"


def column_lines(rows: list[dict[str, Any]], everything: bool = False) -> list[str]:
    """A table of the columns that differ by more than rounding errors."""
    rows = [r for r in rows if not abs(r["change"]) <= EQUAL]
    if not rows:
        return ["  all columns are equal"]
    lines = [f"  {'column':<28} {'first':>12} {'second':>12}  change (first - second) / |second|"]
    lines += [f"  {r['column']:<28} {cell(r['first']):>12} {cell(r['second']):>12}  "
              f"{'' if not math.isfinite(r['change']) else format(100 * r['change'], '+.3g') + ' %'}".rstrip()
              for r in (rows if everything else rows[:COLUMNS])]
    if len(rows) > COLUMNS and not everything:
        lines.append(f"  and {counted(len(rows) - COLUMNS, 'column')} with smaller changes (--all lists each)")
    return lines


def pair_lines(pair: dict[str, Any], everything: bool) -> list[str]:
    lines = [*name_lines(pair), f"  grid: {grid(pair)}"]
    if pair["engines"][0] != pair["engines"][1]:
        lines.append(f"  engines: {' and '.join(pair['engines'])}")
    lines += [*field_lines(pair, everything), *column_lines(pair["columns"], everything)]
    if pair["columns_not_compared"]:
        lines.append("  not compared, because they count samples of different grids: "
                     + ", ".join(pair["columns_not_compared"]))
    return lines


def worst(pairs: list[dict[str, Any]]) -> dict[str, Any]:
    """The pair with the largest relative L2 at any time; the first pair if no surface is compared."""
    return max(pairs, key=lambda p: max((f["relative_l2"] for f in p["fields"]
                                         if math.isfinite(f["relative_l2"])), default=-1.0))


def largest_changes(pairs: Any) -> Any:
    """Of each column, the row of the pair that changes most."""
    found: dict[Any, list[Any]] = {}
    for pair in pairs:
        for row in pair["columns"]:
            known = found.get(row["column"])
            size = abs(row["change"]) if math.isfinite(row["change"]) else -1.0
            if known is None or size > known[0]:
                found[row["column"]] = [size, row]
    return [row for _, row in sorted(found.values(), key=lambda item: -item[0])]


def words(result: dict[str, Any], everything: bool = False) -> str:
    """The text; with `everything`, all pairs, times, traces and columns instead of those that differ most."""
    pairs = result["pairs"]
    lines = [f"{result['first']} compared with {result['second']}", f"direction: {result['direction']}", *warning_lines(pairs)]
    if len(pairs) == 1 or everything:
        for pair in pairs:
            lines += pair_lines(pair, everything)
    else:
        lines.append(f"{len(pairs)} pairs of cases; the pair whose surfaces differ most (--all lists each):")
        lines += pair_lines(worst(pairs), everything)
    if len(pairs) > 1:
        lines += ["", "largest change of each column over all pairs:", *column_lines(largest_changes(pairs), everything)]
    for key, which in (("only_in_first", "first"), ("only_in_second", "second")):
        if result[key]:
            lines.append(f"only in the {which}: {', '.join(result[key])}")
    return "\n".join(lines)
