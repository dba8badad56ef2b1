# SPDX-License-Identifier: BSD-3-Clause
"""The surface over time: a player of the recorded snapshots or frames of all cases, which player.js draws.

Each time is a small picture within the page. Its grey levels are sign(u) sqrt(|u| / largest |u|), so that the page
can show values and choose the colours.
"""
from __future__ import annotations

import base64
import html
import io
import math
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from PIL import Image

from ... import wake
from ...case import Case
from ...script_json import script_json
from .. import answer, labels, layout, load, ranking, style, thinning, warnings_of
from ..figures import fig_surface
from ..words import counted, number

MOMENTS = 60             # largest number of times per case
WIDEST_px = 240
BUDGET_bytes = 1_200_000  # of all pictures; times are omitted and pictures reduced until they fit
QUALITY = 85             # of the lossy pictures that are used if lossless ones do not fit
PLAYED_s = 6.0           # duration of the run at the initial slow-down
SLOW_DOWNS = (10, 20, 50, 100, 200, 500, 1000, 2000, 5000)


@dataclass
class Detail:
    """How precisely the surfaces are stored."""
    moments: int
    widest_px: int = WIDEST_px
    lossless: bool = True


def cases_of(selection: load.Selection) -> list[Case]:
    """The cases with a recorded surface, those of the figures first and references last; of a large sweep some."""
    return [c for c in layout.with_references(thinning.with_surfaces(selection)) if len(load.surface_times(c))]


def first_shown(selection: load.Selection, cases: list[Case]) -> list[int]:
    """The indices of the two cases that are shown at first: the reference of the best case (of samples: the median), or another case,
    and this case."""
    column = answer.column(selection)
    chosen = ranking.middle_case(selection, column) if selection.sweep.uncertain else ranking.rank(selection, column).best
    best = next((c for c in cases if c is chosen), next((c for c in cases if not c.is_reference), cases[0]))
    own = selection.reference_of(best)
    others = [c for c in cases if c is not best]
    keys = [k for k in layout.axes(selection) if k in best.settings]

    def unlike(case: Case) -> tuple[int, bool]:
        """A case that differs in a single kind or labelled value is the best comparison, then one that differs in few values."""
        differ = [k for k in keys if case.settings.get(k) != best.settings[k]]
        of_kind = len(differ) == 1 and (not layout.is_number(best.settings[differ[0]])
                                        or (differ[0], best.settings[differ[0]]) in layout.labels(selection))
        return (0 if of_kind else max(1, len(differ))), case.is_reference
    same = [c for c in others if own and (c is own or (c.is_reference and layout.have_same_motion(c, own)))]
    other = same[0] if same else min(others, key=unlike, default=best)
    return [cases.index(selection.by_id[i]) for i in dict.fromkeys([other.id, best.id])]


def cut(shot: fig_surface.Snapshot, limits: tuple[float, float, float, float], widest_px: int) -> tuple[list[float],
        np.ndarray]:
    """The part of a snapshot within the limits, at a resolution for the page: extent and u(x, y)."""
    x = np.flatnonzero((shot.x_mm >= limits[0]) & (shot.x_mm <= limits[1]))
    y = np.flatnonzero((shot.y_mm >= limits[2]) & (shot.y_mm <= limits[3]))
    u = shot.u_um[x[0]: x[-1] + 1, y[0]: y[-1] + 1]
    dx, dy = np.diff(shot.x_mm[:2])[0] / 2, np.diff(shot.y_mm[:2])[0] / 2
    extent = (shot.x_mm[x[0]] - dx, shot.x_mm[x[-1]] + dx, shot.y_mm[y[0]] - dy, shot.y_mm[y[-1]] + dy)
    step = math.ceil(max(u.shape) / widest_px)
    return [round(float(v), 4) for v in extent], u[::step, ::step]


def picture(u_um: np.ndarray, peak: float, lossless: bool) -> str:
    """A grey WebP picture as base64 text; its rows run from the largest y to the smallest."""
    level = np.nan_to_num(u_um / peak) if peak else np.zeros_like(u_um)
    level = np.round(127.5 + 127.5 * np.sign(level) * np.sqrt(np.abs(level))).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(level.T[::-1]), mode="L").save(
        file, format="WEBP", lossless=lossless, quality=QUALITY, method=2)
    return base64.b64encode(file.getvalue()).decode("ascii")


def case_data(selection: load.Selection, case: Case, limits: tuple[float, float, float, float], detail: Detail,
              modulation: str) -> dict[str, Any]:
    """The pictures of a case, its path and the positions of its focus, in mm, ms and um. `modulation` names that of the cases that
    are no references."""
    shots = [fig_surface.shot_of(case, n) for n in layout.evenly(range(len(load.surface_times(case))), detail.moments)]
    parts = [cut(s, limits, detail.widest_px) for s in shots]
    peaks = [float(f"{np.nanmax(np.abs(u), initial=0.0):.4g}") for _, u in parts]
    path = wake.focus_at(case, case.focus["time"][-1])[2]
    focus = [None if wake.is_over(case, s.t_s) else rounded(wake.focus_at(case, s.t_s)[0]) for s in shots]
    period = round(1e3 * float(case.focus["time"][-1]), 6) if layout.repeats(case) else None
    words = [] if case.is_reference or not modulation else [modulation]
    return {"label": ", ".join([*words, *filter(None, [warnings_of.label(selection, case, "player")])]), "period": period,
            "times": [round(1e3 * s.t_s, 6) for s in shots], "extent": parts[0][0], "peaks": peaks, "focus": focus,
            "pictures": [picture(u, p, detail.lossless) for (_, u), p in zip(parts, peaks)],
            "radius": 1e3 * case.setting("measure", "focal_radius_m"),
            "offsets": rounded(wake.offsets_mm(case)),
            "path": rounded(layout.evenly(list(path), 300)) if np.ptp(path, axis=0).max() > 0 else []}


def axes_of(selection: load.Selection, cases: list[Case]) -> list[dict[str, Any]]:
    """The swept axes with their values, from which the page selects a case: [{key, name, values}]. A single axis with the labels of
    all cases if the values of the axes do not distinguish the cases."""
    own = [c for c in cases if not c.is_reference]
    keys = [k for k in layout.axes(selection) if all(k in c.settings for c in own)]
    places = {tuple(str(c.settings[k]) for k in keys) for c in own}
    if own and len(places) == len(own):
        names = [labels.name(selection, k) for k in keys]
        return [{"key": k, "name": n[:1].upper() + n[1:], "values": [v for v in layout.values_of(selection, k) if any(c.settings[k] == v for c in own)]} for k, n in zip(keys, names)]
    return [{"key": "", "name": "Case", "values": [c.id for c in own or cases]}]


def load_name(cases: list[Case]) -> str:
    kinds = {c.setting("load", "modulation", "kind", default="") for c in cases if not c.is_reference} - {""}
    return kinds.pop() if len(kinds) == 1 else "modulated"


def selects_of(selection: load.Selection, cases: list[Case]) -> list[dict[str, Any]]:
    """The axes in words, for the page."""
    of_case = {c.id: warnings_of.label(selection, c, "player") for c in cases}
    return [{"name": axis["name"], "values": [labels.amount_text(selection, axis["key"], v) if axis["key"] else of_case[v]
                                              for v in axis["values"]]} for axis in axes_of(selection, cases)]


def places_of(selection: load.Selection, cases: list[Case]) -> list[dict[str, Any]]:
    """The position of each case on the axes, and the index of the first case with the motion of its reference."""
    axes, found = axes_of(selection, cases), []
    references = [(n, c) for n, c in enumerate(cases) if c.is_reference]
    index: dict[str, int | None] = {}  # of the pictures of a reference
    for case in cases:
        if case.is_reference and len(references) < len(cases):
            found.append({"at": None})
            continue
        place: dict[str, Any] = {"at": [axis["values"].index(case.settings[axis["key"]] if axis["key"] else case.id) for axis in axes]}
        own = selection.reference_of(case)
        if own and own.is_reference and own is not case:
            if own.id not in index:
                index[own.id] = next((n for n, c in references if c is own or layout.have_same_motion(c, own)), None)
            if index[own.id] is not None:
                place["reference"] = index[own.id]
        found.append(place)
    return found


def rounded(places: Any) -> Any:
    return np.round(places, 3).tolist()


def common_view(cases: list[Case]) -> tuple[float, float, tuple[float, float, float, float]]:
    """End of the colour scale of the wake, largest displacement, and the part of the surface that all cases show,
    from the last times of at most 40 cases."""
    shots = []
    for case in layout.evenly(cases, 40):
        count = len(load.surface_times(case))
        shots += [fig_surface.shot_of(case, n) for n in sorted({0, count // 2, count - 1})]
    shots = [s for s in shots if np.isfinite(s.u_um).any()]
    end = fig_surface.scale(shots)
    return end, max(float(np.nanmax(np.abs(s.u_um))) for s in shots), fig_surface.window(shots, end)


def detail_that_fits(selection: load.Selection, cases: list[Case], limits: tuple[float, float, float, float]) -> Detail:
    """The best detail whose pictures are expected to fit on the page, estimated from a few cases."""
    counts = [len(load.surface_times(c)) for c in cases]
    choices = [Detail(MOMENTS), Detail(MOMENTS, lossless=False), Detail(30, lossless=False),
               Detail(30, 160, False), Detail(20, 160, False), Detail(12, 120, False), Detail(6, 120, False),
               Detail(3, 100, False), Detail(1, 80, False)]
    for detail in choices:
        sample = []
        for case in layout.evenly(cases, 3):
            u = [cut(fig_surface.shot_of(case, n), limits, detail.widest_px)[1] for n in (-1, 0)]
            sample += [len(picture(v, float(np.nanmax(np.abs(v))), detail.lossless)) for v in u]
        if max(sample) * sum(min(n, detail.moments) for n in counts) <= BUDGET_bytes:
            return detail
    return choices[-1]


def colours() -> list[list[int]]:
    table = matplotlib.colormaps[style.DIVERGING](np.linspace(0.0, 1.0, 129))
    return (255 * table[:, :3]).round().astype(int).tolist()


def slow_down_options(times: list[float]) -> str:
    """The slow-downs, of which that near PLAYED_s per run is selected."""
    run_s = 1e-3 * (max(times) - min(times)) or 1.0
    chosen = min(SLOW_DOWNS, key=lambda s: abs(math.log(s * run_s / PLAYED_s)))
    return "".join(f'<option value="{s}"{" selected" if s == chosen else ""}>{s} times slower</option>'
                   for s in SLOW_DOWNS)


def controls(data: dict[str, Any], last: int) -> str:
    wake_um, peak_um = (number(data[key], 3) for key in ("wake", "peak"))
    times = [t for case in data["cases"] for t in case["times"]]
    return (
        '<div class="controls"><button type="button" class="play">Play</button>'
        '<button type="button" class="back" aria-label="one frame back">◀|</button>'
        '<button type="button" class="forward" aria-label="one frame forward">|▶</button>'
        f'<input type="range" min="0" max="{last}" value="{last}" step="1" aria-label="time">'
        '<output class="clock"></output></div><div class="controls">'
        f'<label>Speed <select class="speed">{slow_down_options(times)}</select></label>'
        '<label>Colours <select class="scaling">'
        f'<option value="wake">wake, ±{wake_um} µm</option><option value="half">half of the wake</option>'
        f'<option value="peak">peak, ±{peak_um} µm</option><option value="own">each picture by itself</option>'
        '</select></label><button type="button" class="closer">Zoom in</button>'
        '<button type="button" class="whole">Whole surface</button></div>')


def caption(selection: load.Selection, cases: list[Case], data: dict[str, Any], detail: Detail) -> str:
    stored = max(len(load.surface_times(c)) for c in cases)
    text = (f"Displacement of {layout.plane_name(cases)} seen from above, {counted(len(cases), 'case')}. Solid circle with a centre point: "
            "focal disc. Dotted line: path of the focus. Choose "
            "the cases above the pictures. Point at a picture to read u at the same place in both; drag a "
            "rectangle to zoom. Values beyond the colour scale are clipped.")
    if all(c["period"] for c in data["cases"]):
        text += " The load repeats for ever: the pictures cover one period and start again."
    shown = max(len(c["times"]) for c in data["cases"])
    if len(layout.ordinary(thinning.with_surfaces(selection))) < len(layout.ordinary(selection)):
        text += f" They are spread evenly over the {counted(len(layout.ordinary(selection)), 'case')} of the sweep, with the best one."
    if shown < stored:
        text += f" The page contains {shown} of {counted(stored, 'frame')}."
    if not detail.lossless:
        text += " The pictures are compressed; values are accurate to about 3 % of the largest |u|."
    return text


def player(selection: load.Selection) -> str:
    """HTML of the player; '' if no case has a recorded surface."""
    cases = cases_of(selection)
    if not cases:
        return ""
    end, peak, limits = common_view(cases)
    detail = detail_that_fits(selection, cases, limits)
    kind = layout.modulation(selection)
    stored = [case_data(selection, c, limits, detail, kind) | place for c, place in zip(cases, places_of(selection, cases))]
    view = [f([c["extent"][i] for c in stored]) for i, f in enumerate((min, max, min, max))]
    data: dict[str, Any] = {"cases": stored, "first": first_shown(selection, cases), "view": view, "wake": float(f"{end:.3g}"), "peak": float(f"{peak:.3g}"),
            "axes": selects_of(selection, cases), "load": load_name(cases), "reference": layout.reference_name(layout.all_references(selection)),
            "palette": colours()}
    steps = ", ".join("rgb({}, {}, {})".format(*c) for c in data["palette"][::8])
    last = len({t for c in data["cases"] for t in c["times"]}) - 1
    panel = ('<div class="player-panel"><div class="axes-of-cases" role="group" aria-label="case"></div><canvas role="img" '
             f'aria-label="{layout.plane_name(cases)} seen from above"></canvas><p class="chosen"></p><output></output></div>')
    return (
        f'<figure class="player">{controls(data, last)}<div class="panels">{panel * len(data["first"])}</div>'
        f'<div class="bar"><span class="low"></span><i style="background:linear-gradient(to right, {steps})"></i>'
        '<span class="high"></span></div><noscript><p>The player needs JavaScript; the snapshots below do not.</p>'
        f'</noscript><figcaption>{html.escape(caption(selection, cases, data, detail))}</figcaption>'
        f'<script type="application/json">{script_json(data)}</script></figure>')
