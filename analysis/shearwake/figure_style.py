# SPDX-License-Identifier: BSD-3-Clause
"""The style of all figures: the defaults of Matplotlib with the fonts, colours and lines of this package, whatever the user's
matplotlibrc contains."""
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
}


def reset() -> None:
    """Replaces all parameters of Matplotlib by its defaults and the style of the report, and draws into files only. Each command
    that draws calls this function before its first figure."""
    matplotlib.use("agg")
    matplotlib.rcdefaults()
    pyplot.rcParams.update(REPORT)
