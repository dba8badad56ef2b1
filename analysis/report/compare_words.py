# SPDX-License-Identifier: BSD-3-Clause
"""The result of a comparison as text."""
import math

from words import counted, value_text

COLUMNS = 12  # per pair of cases; of several pairs, the columns with their largest change


def percent(value):
    return f"{100 * value:.3g} %" if value is not None and math.isfinite(value) else "undefined"


def place(at_mm):
    return f"[{at_mm[0]:.4g}, {at_mm[1]:.4g}] mm"


def grid(pair):
    parts = [f"{g['points'][0]} x {g['points'][1]} points of {g['spacing_mm']:.4g} mm" for g in pair["grids"]]
    return parts[0] if parts[0] == parts[1] else " and ".join(parts)


def name(pair):
    settings = ", ".join(value_text(k, v) for k, v in pair["settings"].items())
    ids = pair["first"] if pair["first"] == pair["second"] else f"{pair['first']} and {pair['second']}"
    return f"{ids}{' (reference)' if pair['is_reference'] else ''}{': ' if settings else ''}{settings}"


def field_lines(pair):
    lines = [f"  surface at {f['time_ms']:.6g} ms: relative L2 {percent(f['relative_l2'])}, largest difference "
             f"{f['largest_um']:.3g} um ({percent(f['largest_relative'])} of the peak) at {place(f['at_mm'])}"
             for f in pair["fields"]] or ["  surface: no common time"]
    return lines + [f"  trace at {place(t['at_mm'])}: relative L2 {percent(t['relative_l2'])}, largest difference "
                    f"{t['largest_um']:.3g} um at {t['time_ms']:.6g} ms" for t in pair["traces"]]


def column_lines(rows):
    rows = [r for r in rows if r["change"] != 0]
    lines = [f"  {r['column']:<28} {r['first']:>12.6g} {r['second']:>12.6g}  "
             f"{'' if not math.isfinite(r['change']) else format(100 * r['change'], '+.3g') + ' %'}".rstrip()
             for r in rows[:COLUMNS]]
    if len(rows) > COLUMNS:
        lines.append(f"  and {counted(len(rows) - COLUMNS, 'column')} with smaller changes (--json lists all)")
    return lines or ["  all columns are equal"]


def pair_lines(pair):
    lines = [name(pair), f"  grid: {grid(pair)}"]
    if pair["engines"][0] != pair["engines"][1]:
        lines.append(f"  engines: {' and '.join(pair['engines'])}")
    lines += field_lines(pair)
    lines += [f"  {'column':<28} {'first':>12} {'second':>12}  change", *column_lines(pair["columns"])]
    if pair["columns_not_compared"]:
        lines.append("  not compared, because they count samples of different grids: "
                     + ", ".join(pair["columns_not_compared"]))
    return lines


def worst(pairs):
    """The pair with the largest relative L2 at any time; the first pair if no surface is compared."""
    return max(pairs, key=lambda p: max((f["relative_l2"] for f in p["fields"]
                                         if math.isfinite(f["relative_l2"])), default=-1.0))


def largest_changes(pairs):
    """Of each column, the row of the pair that changes most."""
    found = {}
    for pair in pairs:
        for row in pair["columns"]:
            known = found.get(row["column"])
            size = abs(row["change"]) if math.isfinite(row["change"]) else -1.0
            if known is None or size > known[0]:
                found[row["column"]] = (size, row)
    return [row for _, row in sorted(found.values(), key=lambda item: -item[0])]


def words(result):
    pairs = result["pairs"]
    lines = [f"{result['first']} compared with {result['second']}"]
    if len(pairs) == 1:
        lines += pair_lines(pairs[0])
    else:
        lines.append(f"{len(pairs)} pairs of cases; the pair whose surfaces differ most:")
        lines += pair_lines(worst(pairs))
        lines += ["", "largest change of each column over all pairs:", *column_lines(largest_changes(pairs))]
    for key, which in (("only_in_first", "first"), ("only_in_second", "second")):
        if result[key]:
            lines.append(f"only in the {which}: {', '.join(result[key])}")
    return "\n".join(lines)
