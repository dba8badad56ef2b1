# SPDX-License-Identifier: BSD-3-Clause
"""The HTML page of a night: the numbers that differ from the baselines, then the trends of all numbers.
The page loads nothing from elsewhere, and all text is escaped."""
import html
from collections.abc import Iterable

from . import night, table, trend
from .history import History

CSS = """
:root { color-scheme: light; } * { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 1.5rem 1rem 4rem; background: #fff; color: #222;
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.5rem; margin: 0 0 .3rem; } h2 { font-size: 1.2rem; margin: 2.4rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1.4rem 0 .4rem; } p { margin: .4rem 0; }
.small, figcaption { color: #555; font-size: .85rem; }
.verdict { border-left: 5px solid #009E73; padding: .2rem 0 .2rem .9rem; font-size: 1.1rem; }
.verdict.bad { border-color: #D55E00; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem .25rem 0; text-align: left; border-bottom: 1px solid #e4e4e4;
  vertical-align: top; } .moves td:nth-child(n + 3) { white-space: nowrap; }
th { border-bottom: 1.5px solid #888; } td.bad, .bad b { color: #B34700; font-weight: 600; }
pre { background: #f6f6f6; padding: .7rem; font-size: .8rem; overflow-x: auto; white-space: pre-wrap; }
.scroll { overflow-x: auto; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 1rem 1.2rem; }
figure { margin: 0; } figure.moved figcaption b { color: #B34700; }
figcaption { overflow-wrap: anywhere; line-height: 1.3; } figcaption b { color: #222; }
svg { width: 100%; height: auto; display: block; } svg text { font-size: 8.5px; fill: #555; }
.band { fill: #009E73; fill-opacity: .16; } .axis { fill: none; stroke: #999; stroke-width: .7; }
code { font-size: .85rem; }
"""
VERDICTS = {night.EQUAL: "equal to the baseline", night.DIFFERS: "differs from the baseline",
            night.NO_BASELINE: "has no baseline", night.BROKEN: "failed"}


def escape(text: object) -> str:
    return html.escape(str(text))


def row(cells: Iterable, tag: str = "td") -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(c)}</{tag}>" for c in cells) + "</tr>"


def moved_table(differences: dict) -> str:
    """One line per column that differs, largest change first."""
    if not differences.get("moved"):
        return ""
    lines = [row(["column", "change", "baseline", "now", "case", "cases that differ"], "th")]
    for column in differences["moved"]:
        cell = column["cells"][0]
        lines.append(row([column["column"], cell["words"], cell["reference"] or "(empty)",
                          cell["now"] or "(empty)", cell["case"],
                          f"{len(column['cells'])} of {differences['cases']}"]))
    return ('<h3>Differences, largest first</h3>'
            f'<div class="scroll"><table class="moves">{"".join(lines)}</table></div>')


def other_differences(differences: dict) -> str:
    lines = []
    for kind in ("missing_columns", "extra_columns", "missing_cases", "extra_cases"):
        if differences.get(kind):
            lines.append(f"<p class='bad'><b>{kind.replace('_', ' ')}</b>: "
                         f"{escape('; '.join(differences[kind]))}</p>")
    if differences.get("cases_of_other_id"):
        lines.append(f"<p class='small'>{differences['cases_of_other_id']} cases have other ids than in the "
                     "baseline, so their physics has changed. They are matched by their swept values.</p>")
    return "".join(lines)


def changes(values: dict[str, dict[int, float]], baseline: dict[str, float]) -> dict:
    """{case: {night: change}} relative to the baseline or, without one, to the first night."""
    largest = max((abs(v) for v in baseline.values()), default=0.0)
    found = {}
    for case, by_night in values.items():
        base = baseline.get(case, by_night[min(by_night)])
        scale = abs(base) or largest or max(abs(v) for v in by_night.values()) or 1.0
        found[case] = {n: (v - base) / scale for n, v in by_night.items()}
    return found


def span(values: dict, last: int) -> str:
    now = [by_night[last] for by_night in values.values() if last in by_night]
    if not now:
        return "no number in the last night"
    least, most = min(now), max(now)
    return f"{least:.6g}" if least == most else f"{least:.4g} to {most:.4g}, {len(now)} cases"


def trends(result: night.Result, history: History, nights: list[tuple]) -> str:
    """One chart per watched column, starting with those that differ."""
    ids, dates = [n[0] for n in nights], [n[1][:10] for n in nights]
    readings = history.readings(result.name, ids[0])
    baseline: dict[str, dict[str, float]] = {}
    if result.watched.baseline.is_file():
        for case, column, value in table.readings(result.watched.baseline):
            baseline.setdefault(column, {})[case] = value
    moved = {c["column"]: {cell["case"] for cell in c["cells"]} for c in result.differences.get("moved", [])}
    tolerances = result.differences.get("tolerances", {})
    order = {name: place for place, name in enumerate(dict.fromkeys([*moved, *(r[1] for r in result.readings)]))}
    figures = []
    for column in sorted(readings, key=lambda name: order.get(name, len(order))):
        values = readings[column]
        drawn = trend.chart(changes(values, baseline.get(column, {})), ids, dates, tolerances.get(column, 0.0),
                            moved.get(column, ()), f"{column} over the nights")
        marked = ' class="moved"' if column in moved else ""
        figures.append(f"<figure{marked}><figcaption><b>{escape(column)}</b> {escape(span(values, ids[-1]))}"
                       f"</figcaption>{drawn}</figure>")
    reference = "the baseline" if baseline else "the first night shown"
    return (f"<h3>Trends of all numbers</h3><p class='small'>Change relative to {reference}, one line per case; "
            "the tolerance is shaded. Where the reference is 0, the change is relative to the largest value of "
            "the column.</p>"
            f"<div class='charts'>{''.join(figures)}</div>")


def speed_section(history: History, nights: list[tuple], slower: list[str]) -> str:
    ids, dates = [n[0] for n in nights], [n[1][:10] for n in nights]
    figures = []
    for name, values in history.speeds(ids[0]).items():
        last = f"{values[ids[-1]]:.3g}" if ids[-1] in values else "not measured"
        marked, alarms = (' class="moved"', (name,)) if name in slower else ("", ())
        figures.append(f"<figure{marked}><figcaption><b>{escape(name)}</b> {last}</figcaption>"
                       f"{trend.chart({name: values}, ids, dates, None, alarms, name)}</figure>")
    if not figures:
        return ""
    warning = f"<p class='bad'><b>slower</b>: {escape('; '.join(slower))}</p>" if slower else ""
    return ("<h2>Speed</h2><p class='small'>Times relative to the FFTs alone, which <code>shearwake bench</code> "
            "measured in the same night on the same machine. A speed is marked as "
            "slower if it exceeds the median of the earlier nights by 25 % in two consecutive nights; this does "
            "not fail the night.</p>"
            f"{warning}<div class='charts'>{''.join(figures)}</div>")


def job_section(result: night.Result, history: History, nights: list[tuple]) -> str:
    error = ""
    if result.verdict in (night.BROKEN, night.NO_BASELINE):
        error = f"<pre>{escape(result.message)}</pre>"
    return (f"<h2>{escape(result.name)}: {VERDICTS[result.verdict]}</h2>{error}"
            f"{moved_table(result.differences)}{other_differences(result.differences)}"
            f"{trends(result, history, nights)}")


def in_short(results: list[night.Result]) -> str:
    """For example 'quickstart differs from the baseline; mach-cone failed'."""
    parts = [f"{r.name} {VERDICTS[r.verdict]}" for r in results if r.verdict != night.EQUAL]
    return "; ".join(parts) or "all tables equal their baselines"


def page(verdict: str, results: list[night.Result], history: History, nights: list[tuple], slower: list[str]) -> str:
    last = nights[-1]
    bad = "" if verdict == night.EQUAL else " bad"
    lines = [row(["job", "verdict", "columns that differ"], "th")]
    for result in results:
        moved = ", ".join(c["column"] for c in result.differences.get("moved", []))
        lines.append(row([result.name, VERDICTS[result.verdict], moved]))
    past = [row(["night", "program", "host", "verdict", "jobs"], "th")]
    for number, started, git_id, host, verdict_of_night in reversed(nights):
        jobs = ", ".join(f"{name}: {v}" for name, v, _ in history.jobs(number))
        past.append(row([started.replace("T", " "), git_id, host, verdict_of_night, jobs]))
    summary = in_short(results)
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>shearwake: {escape(summary)}'
            f'</title><meta name="viewport" content="width=device-width"><style>{CSS}</style></head><body>'
            f"<h1>shearwake, night of {escape(last[1][:10])}</h1>"
            f'<p class="verdict{bad}">{escape(summary)}</p>'
            f'<p class="small">program {escape(last[2])}, host {escape(last[3])}, started {escape(last[1])} UTC</p>'
            f'<div class="scroll"><table>{"".join(lines)}</table></div>'
            f'{"".join(job_section(r, history, nights) for r in results)}'
            f"{speed_section(history, nights, slower)}"
            f'<h2>Nights</h2><div class="scroll"><table>{"".join(past)}</table></div></body></html>\n')
