# SPDX-License-Identifier: BSD-3-Clause
"""The HTML page of a comparison: its complete text, and two surfaces with their difference."""
from __future__ import annotations

import base64
import html
import io
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ... import figure_style, wake
from ...case import Case
from .. import layout, load, style
from ..words import number
from . import compare_words
from .compare_fields import common_times, on_common_grid

SEEN = 0.02      # smallest visible displacement relative to the largest
MARGIN_mm = 3.0


def surfaces(pair: tuple[Case, Case], time_ms: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The surfaces of both cases at this time on the common grid, in mm and um."""
    a, b = pair
    i, j = next((i, j) for i, j in common_times(load.surface_times(a), load.surface_times(b))
                if abs(1e3 * load.surface_times(a)[i] - time_ms) < 1e-6)
    x, y, u, v = on_common_grid(a.snapshot(i), b.snapshot(j))
    return 1e3 * x, 1e3 * y, 1e6 * u, 1e6 * v


def visible(x: np.ndarray, y: np.ndarray, u: np.ndarray, v: np.ndarray, at_mm: list[float]) -> tuple[np.ndarray, np.ndarray,
            np.ndarray, np.ndarray]:
    """The part of the common grid with visible displacement and the place of the largest difference."""
    seen = np.maximum(np.abs(u), np.abs(v)) > SEEN * max(np.abs(u).max(), np.abs(v).max())
    parts = []
    for axis, values, at in ((0, x, at_mm[0]), (1, y, at_mm[1])):
        shown = [*values[seen.any(axis=1 - axis)], at]
        room = 0.1 * (max(shown) - min(shown)) + MARGIN_mm
        parts.append((values >= min(shown) - room) & (values <= max(shown) + room))
    return x[parts[0]], y[parts[1]], u[np.ix_(*parts)], v[np.ix_(*parts)]


def panel(axes: Axes, x: np.ndarray, y: np.ndarray, u: np.ndarray, end: float, title: str) -> Any:
    image = axes.imshow(u.T, origin="lower", cmap=style.DIVERGING, vmin=-end, vmax=end, extent=wake.extent(x, y))
    axes.set_title(title, loc="left", fontsize=9)
    axes.set_xlabel("x (mm)")
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.grid(False)
    return image


def title_of(chosen: dict[str, Any], side: int) -> str:
    """The case with its settings, engine and spacing, wrapped to the width of a panel."""
    kind = ["reference"] if chosen["is_reference"][side] else []
    words = ", ".join([*kind, *compare_words.settings(chosen, side)]) or chosen[("first", "second")[side]]
    facts = f"{chosen['engines'][side]}, {chosen['grids'][side]['spacing_mm']:g} mm"
    return f"{('first', 'second')[side]}: {layout.wrapped(words, 3.0)}\n{facts}"


def picture(result: dict[str, Any], pairs: list[tuple[Case, Case]]) -> bytes:
    """The pair that differs most, at the time of its largest difference, as PNG; empty without a common surface. Both
    surfaces have the same colour scale."""
    chosen = compare_words.worst(result["pairs"]) if pairs else {"fields": []}
    if not chosen["fields"]:
        return b""
    field = max(chosen["fields"], key=lambda f: f["largest_um"])  # relative L2 is large while the skin hardly moves
    x, y, u, v = visible(*surfaces(pairs[result["pairs"].index(chosen)], field["time_ms"]), field["at_mm"])
    common, own = (max(float(np.abs(values).max()) for values in part) or 1.0 for part in ((u, v), (u - v,)))
    figure_style.reset()
    width = 1.4 * style.width_in()
    height = min(0.29 * width * np.ptp(y) / np.ptp(x), 0.8 * width) + 2.2  # titles and colour bars
    figure, made = plt.subplots(1, 3, layout="constrained", sharey=True, figsize=(width, height))
    titles = [title_of(chosen, 0), title_of(chosen, 1),
              f"first − second\nrelative L2 {compare_words.percent(field['relative_l2'])}"]
    images = [panel(axes, x, y, values, end, title)
              for axes, values, end, title in zip(made, (u, v, u - v), (common, common, own), titles)]
    for image, axes, label in ((images[0], list(made[:2]), "$u_z$ (µm), both"), (images[2], made[2], "difference (µm)")):
        bar = figure.colorbar(image, ax=axes, orientation="horizontal", label=label, shrink=0.9,
                              aspect=40 if image is images[0] else 20)
        bar.locator = MaxNLocator(5)
        bar.update_ticks()
        bar.outline.set_linewidth(0.5)
        bar.ax.grid(False)
    made[2].plot(*field["at_mm"], "o", color=style.INK, markersize=9, markerfacecolor="none")
    made[2].set_title(f"largest {number(field['largest_um'], 3)} µm at the circle", loc="right", fontsize=8, y=-0.02,
                      va="bottom", path_effects=style.halo(2.0, "white"))
    made[0].set_ylabel("y (mm)")
    figure.suptitle(f"The surfaces at {number(field['time_ms'])} ms", x=0.01, ha="left", fontsize=10)
    style.finish(figure)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=150, format="png")
    plt.close(figure)
    return drawn.getvalue()


def write_page(result: dict[str, Any], pairs: list[tuple[Case, Case]], path: Path) -> None:
    """Writes the page, which loads nothing from elsewhere."""
    title = html.escape(f"{result['first']} compared with {result['second']}")
    drawn = picture(result, pairs)
    image = (f'<p><img style="max-width:100%" alt="the surfaces that differ most" src="data:image/png;base64,'
             f'{base64.b64encode(drawn).decode()}"></p>\n' if drawn else
             "<p>No picture: no cases with a surface at a common time are compared.</p>\n")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'<!DOCTYPE html>\n<html lang="en">\n<meta charset="utf-8">\n<title>{title}</title>\n<h1>{title}</h1>\n'
                    f"{image}<pre>{html.escape(compare_words.words(result, everything=True))}</pre>\n</html>\n", encoding="utf-8")
