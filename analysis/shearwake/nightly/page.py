# SPDX-License-Identifier: BSD-3-Clause
"""The HTML page of a night: the result, the differences from the baselines, then the trends of all numbers. The page loads nothing
from elsewhere, and all text is escaped."""
import html
import math
from collections.abc import Collection, Iterable
from contextlib import suppress
from pathlib import Path

from . import documents, night, table
from .history import History

# Okabe and Ito (2008), as in shearwake.report.style.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#666666", "#000000"]
ALARM = "#D55E00"


def escape(text: object) -> str:
    return html.escape(str(text))


def row(cells: Iterable, tag: str = "td") -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(c)}</{tag}>" for c in cells) + "</tr>"


def scrolled(rows: list[str]) -> str:
    return f'<div class="scroll"><table>{"".join(rows)}</table></div>'


def chart(title: str, series: dict[str, dict[int, float]], nights: list[int], text: str, band: float | None = None,
          marked: Collection[str] = ()) -> str:
    """A figure with a curve for each of series {name: {night: value}}. If `band` is given, values are relative changes, of which
    +-band is shaded; otherwise the axis begins at 0. `marked`: names whose last value has differed."""
    values = [v for curve in series.values() for v in curve.values() if math.isfinite(v)]
    low, high = (min([*values, -1.5 * band]), max([*values, 1.5 * band])) if band is not None else (0.0, max([*values, 1e-300]))
    high, low = (high, low) if high > low else (1e-9, -1e-9)  # no tolerance and no change: a line in the middle
    y = {v: f"{100 * (high - v) / (high - low):.2f}" for v in [*values, band or 0.0, -(band or 0.0)]}
    parts = [f'<rect class="band" x="0" y="{y[band]}" width="{len(nights)}" height="{max(1.0, float(y[-band]) - float(y[band])):.2f}"/>'
             ] if band is not None else []
    for n, (name, curve) in enumerate(series.items()):
        known = [(place, y.get(curve.get(number, math.nan))) for place, number in enumerate(nights)]
        path = "".join(f"{'L' if place and known[place - 1][1] else 'M'}{place + 0.5} {at}h0" for place, at in known if at)
        last = f'<path class="last" stroke="{ALARM if name in marked else COLOURS[n % 7]}" d="M{known[-1][0] + 0.5} {known[-1][1]}h0"/>' if known[-1][1] else ""
        parts.append(f'<g><title>{escape(name)}</title><path stroke="{COLOURS[n % 7]}" d="{path}"/>{last}</g>')
    ends = [f"{100 * v:+.2g} %" if band is not None else f"{v:.3g}" for v in (low, high)]
    return (f"<figure{' class=moved' if marked else ''}><figcaption><b>{escape(title)}</b> {escape(text)}</figcaption>"
            f'<svg viewBox="0 0 {len(nights)} 100" preserveAspectRatio="none" role="img" aria-label="{escape(title)} over the nights">'
            f"{''.join(parts)}</svg><figcaption>axis from {' to '.join(ends)}</figcaption></figure>")


def changes(values: dict[str, dict[int, float]], baseline: dict[str, float]) -> dict[str, dict[int, float]]:
    """{case: {night: change}} relative to the baseline or, without one, to the first night."""
    largest = max((abs(v) for v in baseline.values()), default=0.0)
    found = {}
    for case, by_night in values.items():
        base = baseline.get(case, by_night[min(by_night)])
        scale = abs(base) or largest or max(abs(v) for v in by_night.values()) or 1.0
        found[case] = {n: (v - base) / scale for n, v in by_night.items()}
    return found


def span(values: dict[str, dict[int, float]], last: int) -> str:
    now = [by_night[last] for by_night in values.values() if last in by_night]
    if not now:
        return "no number in the last night"
    least, most = min(now), max(now)
    return f"{least:.6g}" if least == most else f"{least:.4g} to {most:.4g}, {len(now)} cases"


def trends(result: night.Result, baseline_file: Path, history: History, nights: list[tuple]) -> str:
    """One chart per watched column, starting with those that differ."""
    ids = [n[0] for n in nights]
    readings = history.readings(result.name, ids[0])
    baseline: dict[str, dict[str, float]] = {}
    with suppress(OSError, table.NotATable):  # it is missing or damaged, which the verdict states
        for case, column, value in table.readings(baseline_file):
            baseline.setdefault(column, {})[case] = value
    moved = {c["column"]: {cell["case"] for cell in c["cells"]} for c in result.differences.get("moved", [])}
    tolerances = result.differences.get("tolerances", {})
    order = {name: place for place, name in enumerate(dict.fromkeys([*moved, *(r[1] for r in result.readings)]))}
    figures = [chart(column, changes(readings[column], baseline.get(column, {})), ids, span(readings[column], ids[-1]),
                     tolerances.get(column, 0.0), moved.get(column, ()))
               for column in sorted(readings, key=lambda name: order.get(name, len(order)))]
    reference = "the baseline" if baseline else "the first night shown"
    return (f"<h3>Trends of all numbers</h3><p class='small'>Change relative to {reference}, one line per case, from "
            f"{nights[0][1][:10]} to {nights[-1][1][:10]}; the tolerance is shaded. Where the reference is 0, the change is relative "
            f"to the largest value of the column.</p><div class='charts'>{''.join(figures)}</div>") if figures else ""


def speed_section(results: list[night.Result], history: History, nights: list[tuple]) -> str:
    ids, slower = [n[0] for n in nights], " ".join(text for r in results for text in r.slower)
    figures = [chart(name, {name: values}, ids, f"{values[ids[-1]]:.3g}" if ids[-1] in values else "not measured", None,
                     (name,) if name in slower else ()) for name, values in history.speeds(ids[0], nights[-1][3]).items()]
    return ("<h2>Speed</h2><p class='small'>Times of the jobs, and times of the engines relative to the FFTs alone, which "
            f"<code>shearwake bench</code> measured in the same night, on host {escape(nights[-1][3])}.</p>"
            f"<div class='charts'>{''.join(figures)}</div>") if figures else ""


def page(headline: str, results: list[night.Result], baselines: dict[str, Path], history: History, nights: list[tuple]) -> str:
    last = nights[-1]
    jobs = [row(["job", "verdict", "time (s)", ""], "th")]
    jobs += [row([r.name, r.state, f"{r.seconds:.1f}", "; ".join(filter(None, dict.fromkeys([r.reason, *r.slower])))]) for r in results]
    sections = ""
    for r in results:
        rows = "".join(f"<li>{escape(text)}</li>" for text in [*r.slower, *r.rows])
        shown = trends(r, baselines[r.name], history, nights) if r.name in baselines else ""
        sections += f"<h2>{escape(r.name)}: {r.state}</h2>" + (f'<div class="scroll"><ul>{rows}</ul></div>' if rows else "") + shown
    past = [row(["night", "program", "host", "verdict", "jobs"], "th")]
    for number, started, git_id, host, verdict in reversed(nights):
        verdicts = ", ".join(f"{name}: {v}" for name, v, _ in history.jobs(number))
        past.append(row([started.replace("T", " "), git_id, host, verdict, verdicts]))
    stamp = f"night of {last[1][:10]}: program {last[2]}, host {last[3]}, started {last[1]} UTC"
    return documents.page(headline, all(r.code == 0 for r in results), stamp, scrolled(jobs) + sections
                          + speed_section(results, history, nights) + f"<h2>Nights</h2>{scrolled(past)}")
