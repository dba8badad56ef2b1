# SPDX-License-Identifier: BSD-3-Clause
"""Draws the trend of a number over the nights as inline SVG."""
import html
from collections.abc import Collection
import math

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 300, 92, 56, 16, 8, 8
# Okabe and Ito (2008), as in shearwake.report.style.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#666666", "#000000"]
ALARM = "#D55E00"


def label(value: float, percent: bool) -> str:
    if value == 0:
        return "0"
    if not percent:
        return f"{value:.3g}"
    return f"{100 * value:+.2g} %" if abs(value) < 10 else f"{value:+.1g} x"


def pieces(values: dict, nights: list[int]) -> list[list]:
    """Sequences of nights without a gap, each as [(place, value), ...]."""
    run, found = [], []
    for place, night in enumerate(nights):
        if night in values:
            run.append((place, values[night]))
        elif run:
            found.append(run)
            run = []
    return found + [run] if run else found


class Scale:
    def __init__(self, nights: list[int], low: float, high: float) -> None:
        self.count, self.low, self.high = len(nights), low, high

    def x(self, place: int) -> float:
        share = place / (self.count - 1) if self.count > 1 else 1.0
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return HEIGHT - BOTTOM - share * (HEIGHT - BOTTOM - TOP)


def curve(name: str, values: dict, nights: list[int], scale: Scale, colour: str, alarm: bool) -> str:
    drawn = []
    for run in pieces(values, nights):
        points = " ".join(f"{scale.x(p):.1f},{scale.y(v):.1f}" for p, v in run)
        if len(run) > 1:
            drawn.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.4"/>')
        else:
            drawn.append(f'<circle cx="{scale.x(run[0][0]):.1f}" cy="{scale.y(run[0][1]):.1f}" r="1.8" '
                         f'fill="{colour}"/>')
    if nights[-1] in values:
        drawn.append(f'<circle cx="{scale.x(len(nights) - 1):.1f}" cy="{scale.y(values[nights[-1]]):.1f}" '
                     f'r="2.8" fill="{ALARM if alarm else colour}"/>')
    return f"<g><title>{html.escape(name)}</title>{''.join(drawn)}</g>"


def chart(series: dict[str, dict[int, float]], nights: list[int], dates: list[str], band: float | None = None,
          alarms: Collection[str] = (), title: str = "") -> str:
    """series: {name: {night: value}}. If band is given, values are relative changes and +-band is shaded;
    otherwise values are drawn on an axis from 0. alarms: names whose last value is marked."""
    values = [v for one in series.values() for v in one.values() if math.isfinite(v)]
    percent = band is not None
    if band is not None:
        low, high = min([*values, -1.5 * band]), max([*values, 1.5 * band])
    else:
        low, high = 0.0, 1.1 * max([*values, 1e-300])
    if high == low:
        low, high = -1e-9, 1e-9  # no tolerance and no change: a line in the middle
    scale = Scale(nights, low, high)
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{html.escape(title)}">']
    if band is not None:
        parts.append(f'<rect x="{LEFT}" y="{scale.y(band):.1f}" width="{WIDTH - LEFT - RIGHT}" '
                     f'height="{max(1.0, scale.y(-band) - scale.y(band)):.1f}" class="band"/>')
    parts.append(f'<path d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{WIDTH - RIGHT}" class="axis"/>')
    # A value that is indistinguishable from 0 on this scale is labelled 0, for example the edge of the
    # tolerance next to a much larger change.
    ticks = [(v, label(v, percent) if abs(v) > 0.01 * (high - low) else "0") for v in (high, low)]
    if percent and scale.y(low) - scale.y(0) > 11 and scale.y(0) - scale.y(high) > 11:
        ticks.append((0.0, "0"))
    parts += [f'<text x="{LEFT - 4}" y="{scale.y(v) + 3:.1f}" text-anchor="end">{t}</text>' for v, t in ticks]
    parts.append(f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 3}" text-anchor="end">{html.escape(dates[-1])}</text>')
    if len(dates) > 1:
        parts.append(f'<text x="{LEFT}" y="{HEIGHT - 3}">{html.escape(dates[0])}</text>')
    for i, (name, one) in enumerate(series.items()):
        parts.append(curve(name, one, nights, scale, COLOURS[i % len(COLOURS)], name in alarms))
    return "".join(parts) + "</svg>"
