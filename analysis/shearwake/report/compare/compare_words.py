# SPDX-License-Identifier: BSD-3-Clause
"""The result of a comparison as text."""
from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from ...keys import label as key_label
from ..words import counted, setting_text

FEW = 5  # of surfaces and traces: those that differ most
LISTED = 20  # missing and extra columns and cases


def printable(text: str) -> str:
    """One line without the control characters of names and cells, which a terminal would interpret."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f]", "?", text)


def percent(value: float) -> str:
    return f"{100 * value:.3g} %" if value is not None and math.isfinite(value) else "undefined"


def place(at_mm: list[float]) -> str:
    return f"[{at_mm[0]:.4g}, {at_mm[1]:.4g}] mm"


def grid(pair: dict[str, Any]) -> str:
    parts = [f"{g['points'][0]} x {g['points'][1]} points of {g['spacing_mm']:.4g} mm" for g in pair["grids"]]
    return parts[0] if parts[0] == parts[1] else " and ".join(parts)


def settings_texts(values: dict[str, Any]) -> list[str]:
    """The swept keys and their values; keys with the same name and value, which are swept together, once."""
    return list(dict.fromkeys(setting_text(key_label(key), key, value) for key, value in values.items()))


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
    return [f"{summary}; the {FEW} with the largest differences (--page lists each):",
            *(line(entries[n]) for n in sorted(order))]


def field_lines(pair: dict[str, Any], everything: bool) -> list[str]:
    return [*(most_different(pair["fields"], "surface", surface_line, everything) or ["  surface: no common time"]),
            *most_different(pair["traces"], "trace", trace_line, everything)]


def column_line(column: dict[str, Any], width: int, cases: int) -> str:
    """The largest difference of a column: 'peak_um  +1 %: 0.297 -> 0.3 at load.peak_Pa=100; 4 of 4 cases differ'."""
    first = column["cells"][0]
    values = [cell or "(empty)" for cell in (first["reference"], first["now"])]
    change = f": {' -> '.join(values)}" if first["reference"] or first["now"] else ""
    more = f"; {len(column['cells'])} of {counted(cases, 'case')} differ" if len(column["cells"]) > 1 else ""
    return f"{column['column']:<{width}}  {first['words']}{change} at {first['case']}{more}"


def item_lines(what: str, items: list[str]) -> list[str]:
    more = [f"{what}: {len(items) - LISTED} more"] if len(items) > LISTED else []
    return [*(f"{what}: {item}" for item in items[:LISTED]), *more]


def column_lines(result: dict[str, Any]) -> list[str]:
    """The columns and records that differ, largest first, and what only one side has."""
    width = max((len(column["column"]) for column in result["moved"]), default=0)
    lines = [column_line(column, width, result["cases"]) for column in result["moved"]]
    for what in ("missing_columns", "extra_columns", "missing_cases", "extra_cases"):
        lines += item_lines(what[:-1].replace("_", " "), result[what])
    if result["cases_of_other_id"]:
        lines.append(f"{counted(result['cases_of_other_id'], 'case')} with different ids"
                     + ("" if len(result["pairs"]) == 1 == result["cases"] else ", matched by swept values"))
    if result["not_compared"]:
        lines.append(f"not compared: {', '.join(result['not_compared'])}")
    return lines


def verdict(result: dict[str, Any]) -> str:
    """The last line."""
    start = f"{counted(result['cases'], 'case')}, {counted(len(result['tolerances']), 'column')} compared: "
    if result["equal"]:
        return start + "no difference"
    columns, cases = (len(result[f"missing_{what}"]) + len(result[f"extra_{what}"]) for what in ("columns", "cases"))
    return (f"{start}{counted(len(result['moved']), 'column')} changed, {counted(columns, 'column')} and "
            f"{counted(cases, 'case')} missing or extra")


def pair_lines(pair: dict[str, Any], everything: bool) -> list[str]:
    lines = [*name_lines(pair), f"  grid: {grid(pair)}"]
    if pair["engines"][0] != pair["engines"][1]:
        lines.append(f"  engines: {' and '.join(pair['engines'])}")
    return [*lines, *field_lines(pair, everything)]


def worst(pairs: list[dict[str, Any]]) -> dict[str, Any]:
    """The pair with the largest relative L2 at any time; the first pair if no surface is compared."""
    return max(pairs, key=lambda p: max((f["relative_l2"] for f in p["fields"]
                                         if math.isfinite(f["relative_l2"])), default=-1.0))


def words(result: dict[str, Any], everything: bool = False) -> str:
    """The text; with `everything`, all pairs, times and traces instead of those that differ most."""
    pairs = result["pairs"]
    lines = [f"{result['first']} compared with {result['second']}", *warning_lines(pairs)]
    if len(pairs) == 1 or everything:
        for pair in pairs:
            lines += pair_lines(pair, everything)
    elif pairs:
        lines += [f"{len(pairs)} pairs of cases; the pair whose surfaces differ most (--page lists each):",
                  *pair_lines(worst(pairs), everything)]
    return "\n".join(map(printable, [*lines, *column_lines(result), verdict(result)]))
