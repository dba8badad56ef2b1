# SPDX-License-Identifier: BSD-3-Clause
"""The surface over time: a slider over the recorded snapshots or frames of a few cases.

Each time is a small indexed picture within the page; axes, focus and path are SVG. Without JavaScript the page
shows the last time.
"""
import base64
import html
import io
import json
import math

import matplotlib
import numpy as np
from matplotlib.ticker import MaxNLocator
from PIL import Image

import fig_surface
import layout
import load
import references
import style
import wake
from words import number

CASES = 4
MOMENTS = 60
WIDEST_px = 240
BUDGET_bytes = 5_000_000  # for all pictures; times are omitted until they fit
LEFT, RIGHT, TOP, BOTTOM, WIDTH = 44, 8, 26, 40, 400  # margins and width of a panel in SVG units


def chosen(sweep):
    """The reference, then cases from the first to the last curve, with at least two times."""
    return [c for c in references.first_and_last(sweep, CASES) if len(load.surface_times(c)) > 1]


def moments(case, most):
    """At most `most` snapshots of a case, spread evenly."""
    numbers = layout.evenly(range(len(load.surface_times(case))), most)
    found = [load.surface(case, n) for n in numbers]
    return [fig_surface.Snapshot(case, t, 1e3 * x, 1e3 * y, 1e6 * u) for t, x, y, u in found]


def cut(shot, limits):
    """The part of a snapshot within the limits, at a resolution for the page: extent and u(x, y)."""
    x = np.flatnonzero((shot.x_mm >= limits[0]) & (shot.x_mm <= limits[1]))
    y = np.flatnonzero((shot.y_mm >= limits[2]) & (shot.y_mm <= limits[3]))
    u = shot.u_um[x[0]: x[-1] + 1, y[0]: y[-1] + 1]
    dx, dy = np.diff(shot.x_mm[:2])[0] / 2, np.diff(shot.y_mm[:2])[0] / 2
    extent = (shot.x_mm[x[0]] - dx, shot.x_mm[x[-1]] + dx,
              shot.y_mm[y[0]] - dy, shot.y_mm[y[-1]] + dy)
    step = math.ceil(max(u.shape) / WIDEST_px)
    return extent, u[::step, ::step]


def palette():
    colours = matplotlib.colormaps[style.DIVERGING](np.linspace(0.0, 1.0, 128))
    return (255 * colours[:, :3]).astype(np.uint8)


def picture(u_um, end):
    """A PNG as data URL with the colours of the figures, clipped at +- end."""
    level = np.nan_to_num(np.clip(0.5 + 0.5 * u_um / end, 0.0, 1.0), nan=0.5)
    image = Image.fromarray(np.round(127 * level).astype(np.uint8).T[::-1], mode="P")
    image.putpalette(palette().tobytes())
    file = io.BytesIO()
    image.save(file, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")


class Panel:
    """The panel of one case: its axes in SVG units and its pictures."""

    def __init__(self, title, shots, end, limits):
        self.title, self.shots = title, shots
        parts = [cut(s, limits) for s in shots]
        self.extent = parts[0][0]
        self.pictures = [picture(u, end) for _, u in parts]
        x0, x1, y0, y1 = self.extent
        self.scale = (WIDTH - LEFT - RIGHT) / (x1 - x0)
        self.height = TOP + BOTTOM + self.scale * (y1 - y0)

    def place(self, x_mm, y_mm):
        return (round(LEFT + self.scale * (x_mm - self.extent[0]), 2),
                round(TOP + self.scale * (self.extent[3] - y_mm), 2))

    def focus(self):
        """Positions of the focus at all times, None after the end of the load; and the complete path."""
        case = self.shots[0].case
        at = [None if wake.is_over(case, s.t_s) else self.place(*wake.focus_at(case, s.t_s)[0])
              for s in self.shots]
        path = wake.focus_at(case, case.series["time"][-1])[2]
        return at, [self.place(*p) for p in layout.evenly(path, 1500)]

    def data(self):
        at, _ = self.focus()
        return {"pictures": self.pictures, "focus": at,
                "times": [round(1e3 * s.t_s, 6) for s in self.shots]}

    def svg(self):
        x0, x1, y0, y1 = self.extent
        (left, top), (right, bottom) = self.place(x0, y1), self.place(x1, y0)
        at, path = self.focus()
        radius = 1e3 * self.shots[0].case.setting("measure", "focal_radius_m") * self.scale
        discs = "".join(f'<circle class="focus" r="{radius:.2f}" cx="{self.scale * x:.2f}" '
                        f'cy="{-self.scale * y:.2f}"/>'
                        for x, y in wake.offsets_mm(self.shots[0].case))
        shown = ('visibility="hidden"' if at[-1] is None
                 else f'transform="translate({at[-1][0]} {at[-1][1]})"')
        marks = []
        for x in MaxNLocator(6).tick_values(x0, x1):
            if x0 <= x <= x1:
                px = self.place(x, 0)[0]
                marks.append(f'<path d="M{px} {bottom}v4"/><text x="{px}" y="{bottom + 16:.0f}" '
                             f'text-anchor="middle">{number(x, 6)}</text>')
        for y in MaxNLocator(5).tick_values(y0, y1):
            if y0 <= y <= y1:
                py = self.place(0, y)[1]
                marks.append(f'<path d="M{left} {py}h-4"/><text x="{left - 7}" y="{py + 4:.1f}" '
                             f'text-anchor="end">{number(y, 6)}</text>')
        middle = (top + bottom) / 2
        line = " ".join(f"{x},{y}" for x, y in path)
        return (
            f'<svg viewBox="0 0 {WIDTH} {self.height:.0f}" role="img" '
            f'aria-label="{html.escape(self.title)}, the surface seen from above">'
            f'<text class="name" x="{left}" y="17">{html.escape(self.title)}</text>'
            f'<image x="{left}" y="{top}" width="{right - left:.2f}" height="{bottom - top:.2f}" '
            f'preserveAspectRatio="none" href="{self.pictures[-1]}"/>'
            f'<polyline class="path" points="{line}"/>'
            f'<g class="foci" {shown}>{discs}</g>'
            f'<rect class="frame" x="{left}" y="{top}" width="{right - left:.2f}" '
            f'height="{bottom - top:.2f}"/><g class="axis">{"".join(marks)}'
            f'<text x="{(left + right) / 2:.0f}" y="{bottom + 33:.0f}" text-anchor="middle">x (mm)'
            f'</text><text transform="translate(11 {middle:.0f}) rotate(-90)" '
            f'text-anchor="middle">y (mm)</text></g></svg>')


def colour_bar(end):
    steps = ", ".join("#%02x%02x%02x" % tuple(c) for c in palette()[::8])
    return (f'<div class="bar"><span>{number(-end, 2)}</span><i style="background:'
            f'linear-gradient(to right, {steps})"></i><span>{number(end, 2)} µm</span></div>')


def thinned(cases):
    """Snapshots of each case, as many as fit on the page."""
    most = MOMENTS
    while True:
        shots = [moments(c, most) for c in cases]
        end = fig_surface.scale([s for every in shots for s in every[-3:]])
        limits = fig_surface.window([every[n] for every in shots for n in (0, -1)], end)
        some = [len(picture(cut(every[-1], limits)[1], end)) for every in shots]
        if sum(n * len(every) for n, every in zip(some, shots)) <= BUDGET_bytes or most <= 4:
            return shots, end, limits
        most //= 2


def caption(cases, shots, end):
    text = ("Displacement of the surface seen from above, on the same colour scale in all panels. Circle: focal "
            f"disc. Dotted line: path of the focus. The colour scale ends at ±{number(end, 2)} µm, so that the "
            "wake is visible; larger values are clipped.")
    kept = max(len(load.surface_times(c)) for c in cases)
    if max(map(len, shots)) < kept:
        text += f" The page contains {max(map(len, shots))} of {kept} frames."
    return text


def player(sweep):
    """HTML of the slider and its panels; '' if no case has two times."""
    cases = chosen(sweep)
    if not cases:
        return ""
    shots, end, limits = thinned(cases)
    panels = [Panel(layout.case_label(sweep, c), every, end, limits)
              for c, every in zip(cases, shots)]
    times = sorted({t for p in panels for t in p.data()["times"]})
    data = json.dumps({"times": times, "panels": [p.data() for p in panels]})
    last = len(times) - 1
    return (
        '<h2 id="player">The surface over time</h2><figure class="player">'
        '<div class="controls"><button type="button" class="play">Play</button>'
        f'<input type="range" min="0" max="{last}" value="{last}" step="1" '
        'aria-label="time"><output>' + f"{number(times[-1])} ms</output></div>"
        f'<div class="panels">{"".join(p.svg() for p in panels)}</div>{colour_bar(end)}'
        f'<figcaption>{html.escape(caption(cases, shots, end))}</figcaption>'
        f'<script type="application/json">{data}</script></figure>')
