# SPDX-License-Identifier: BSD-3-Clause
"""The style of all figures: the defaults of Matplotlib with the fonts, colours and lines of this package, whatever the user's
matplotlibrc contains."""
import contextlib
from typing import Any

import matplotlib
from matplotlib import pyplot

INK = "#222222"
REPORT = {
    "font.family": "DejaVu Sans", "font.size": 9.5, "axes.labelsize": 9.5, "axes.titlesize": 9.5,
    "xtick.labelsize": 9, "ytick.labelsize": 9, "legend.fontsize": 9, "axes.edgecolor": "#666666",
    "axes.linewidth": 0.7, "axes.spines.top": False, "axes.spines.right": False,
    "text.color": INK, "axes.labelcolor": INK, "xtick.color": "#444444", "ytick.color": "#444444",
    "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.6, "axes.axisbelow": True,
    "legend.frameon": False, "lines.linewidth": 1.6, "axes.unicode_minus": True,
    "pdf.fonttype": 42, "mathtext.default": "regular", "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5), "figure.max_open_warning": 0,
    "axes.titley": 1.0,  # Matplotlib would measure all tick labels to find a place
    "figure.figsize": (7.6, 4.8),  # 730 CSS pixels wide, so that fonts appear at their nominal size
}
PAPER = {**REPORT, **dict.fromkeys(("font.size", "axes.labelsize", "axes.titlesize"), 8.0),
         **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), 7.0),
         "lines.linewidth": 1.1, "lines.markersize": 4.0, "axes.linewidth": 0.6, "axes.grid": False, "axes.edgecolor": INK,
         "xtick.color": INK, "ytick.color": INK, "savefig.format": "pdf", "savefig.dpi": 600, "svg.fonttype": "none"}
WIDTHS_in = {1: 3.5, 2: 7.2}  # of one and two columns of a page
_chosen: list[str] = []


def reset() -> None:
    """Replaces all parameters of Matplotlib by its defaults and the style of the report, and draws into files only. Each command
    that draws calls this function before its first figure."""
    matplotlib.use("agg")
    matplotlib.rcdefaults()
    pyplot.rcParams.update(REPORT)


def style(name: str = "report", columns: int = 2) -> contextlib.ExitStack:
    """Sets the style of all following figures, also of those that a script draws itself: "report", or "paper" for figures that fill
    one column (89 mm) or two columns (183 mm) of a page, with letters of 7 and 8 points that remain text in PDF and SVG. `savefig`
    writes PDF by default in the style "paper". In a `with` block the style ends with the block. Raises ValueError."""
    if name not in ("report", "paper") or columns not in WIDTHS_in:
        raise ValueError(f'the styles are "report" and "paper" with 1 or 2 columns, not {name!r} with {columns}')
    width = WIDTHS_in[columns]
    parameters: dict[str, Any] = REPORT if name == "report" else PAPER | {"figure.figsize": (width, 0.36 * width + 1.3)}
    before = dict(pyplot.rcParams)
    until_end = contextlib.ExitStack()
    until_end.callback(dict.update, pyplot.rcParams, before)
    _chosen.append(name)
    until_end.callback(_chosen.pop)
    matplotlib.rcdefaults()
    pyplot.rcParams.update(parameters)
    return until_end


def current() -> contextlib.AbstractContextManager[Any]:
    """The style that style() has set, otherwise that of the report within this context."""
    if _chosen:
        return contextlib.nullcontext()
    return style()


def width_in() -> float:
    """The width of a figure in inches."""
    return float(pyplot.rcParams["figure.figsize"][0])
