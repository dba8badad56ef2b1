# SPDX-License-Identifier: BSD-3-Clause
"""The common style of the figures: sizes, labels, and colours that colour-blind readers can distinguish."""
import re
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.text import Text
from matplotlib.ticker import ScalarFormatter

from .. import figure_style, wake
from ..figure_style import width_in
from .words import SUPERSCRIPTS, number

INK = figure_style.INK
DPI = 150
PDF = True  # for papers; tests draw faster without
GREY = "#707070"  # a contrast of 4.9 on white
# Okabe and Ito (2008), without yellow, which is hardly visible on white.
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DIVERGING = "RdBu_r"
DIRECT_LABELS = 8  # largest number of lines with a legend; more lines have a colour bar
CURVES = 8  # largest number of curves in a panel; more are drawn as heat maps and small multiples

halo = wake.halo


# All formulas in the figures: labels of this package and ticks of matplotlib's formatters.
FORMULA = re.compile(r"(\$(?:d?u_z(?:/dt)?|(?:\\times)?(?:\\mathdefault\{[^$]*\})+)\$)")


def plain(text: str) -> str:
    """A text for a figure. Titles and names come from job files, so dollar signs outside of formulas are escaped and
    control characters replaced."""
    pieces = FORMULA.split(text)
    pieces[::2] = [re.sub(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", "\N{REPLACEMENT CHARACTER}", piece)
                   .replace(r"\$", "$").replace("$", r"\$") for piece in pieces[::2]]
    return "".join(pieces)


def make_texts_plain(figure: Any) -> None:
    """Applies plain() to all texts of a figure except the labels of ticks."""
    for owner in (figure, *figure.axes):
        for child in owner.get_children():
            for text in [child.label] if isinstance(child, Axis) else [] if isinstance(child, Axes) else child.findobj(Text):
                text.set_text(plain(text.get_text()))


class PlainFormatter(ScalarFormatter):
    def get_offset(self) -> str:
        """The power of ten of an axis as '×10⁻⁷' instead of '1e−7' or a formula, which takes longer to draw."""
        return re.sub(r"1e(\N{MINUS SIGN}?\d+)", lambda found: "×10" + found[1].replace("\N{MINUS SIGN}", "-").translate(
            SUPERSCRIPTS), super().get_offset())


def finish(figure: Any) -> None:
    """Applies plain() to all texts, and PlainFormatter to all linear axes without a formatter of their own."""
    make_texts_plain(figure)
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(PlainFormatter())


def sequential(fraction: Any) -> np.ndarray:
    """A perceptually uniform colour map without the pale end, which is hardly visible on white."""
    return matplotlib.colormaps["viridis"](0.02 + 0.78 * np.asarray(fraction))


def sequential_map() -> Any:
    return matplotlib.colors.ListedColormap(sequential(np.linspace(0.0, 1.0, 256)))


NICE_RATIOS = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2, 3, 5, 10, 20, 50, 100, 1e3, 1e4, 1e6)

NICE_FRACTIONS = (0.999, 0.998, 0.995, 0.99, 0.98, 0.95, 0.9, 0.8, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4, 1e-6)


def ratio_limits(values: Any) -> tuple[float, float] | None:
    """Limits of a logarithmic scale around 1 that contains all ratios with a margin; None if some are not positive."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    if not values.size or values.min() <= 0:
        return None
    reach = max(1.0005, float(np.exp(np.abs(np.log(values)).max()))) ** 1.1
    return 1.0 / reach, reach


def ratio_ticks(limits: tuple[float, float]) -> list[float]:
    """Ticks of a logarithmic scale around 1, whose labels do not overlap: 0.5, 0.7, 0.8, 1, 1.2, 1.5, 2."""
    above, below, apart = [1.0], [1.0], limits[1] ** 0.15
    for ratio in NICE_RATIOS:
        if above[-1] * apart <= ratio <= limits[1]:
            above.append(ratio)
    for ratio in NICE_FRACTIONS:
        if below[-1] >= ratio * apart and ratio >= limits[0]:
            below.append(ratio)
    return [*reversed(below[1:]), *above]


def ratio_axis(axis: Axis, limits: tuple[float, float]) -> None:
    axis.set_major_locator(matplotlib.ticker.FixedLocator(ratio_ticks(limits)))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: number(value, 4)))
    axis.set_minor_locator(matplotlib.ticker.NullLocator())


def distinct(count: int) -> list:
    """`count` colours for unordered curves; for more than seven, samples of a colour map."""
    if count <= len(PALETTE):
        return PALETTE[:count]
    return [sequential(f) for f in np.linspace(0.0, 1.0, count)]


def panels(count: int, columns: int, height_in: float, more_in: float, **options: Any) -> tuple[Any, np.ndarray]:
    """A figure with rows of panels of this height, of which the first `count` are visible, and their axes."""
    rows = -(-count // columns)
    figure, made = plt.subplots(rows, columns, squeeze=False, layout="constrained", figsize=(width_in(), more_in + height_in * rows), **options)
    for axes in made.flat[count:]:
        axes.set_visible(False)
    return figure, made


def bar_beside(figure: Any, image: Any, axes: list[Axes], label: str, **options: Any) -> Any:
    bar = figure.colorbar(image, ax=axes, label=label, **options)
    bar.outline.set_visible(False)
    bar.ax.grid(False)
    return bar


def legend_strip(figure: Any, handles: list) -> None:
    """Adds a strip with a legend above the panels of a figure with constrained layout; handles have labels."""
    across = max(1, min(4, 90 // (8 + max(len(handle.get_label()) for handle in handles))))
    strip_in = 0.15 + 0.2 * -(-len(handles) // across)
    figure.set_figheight(figure.get_figheight() + strip_in)
    figure.legend(handles=handles, loc="upper center", ncol=across)
    figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 1.0 - strip_in / figure.get_figheight()))


def save(figure: Any, path: Path) -> None:
    """Writes the PNG for the page, and a PDF with vector graphics in the same folder."""
    finish(figure)
    figure.set(dpi=DPI, facecolor="white")  # the layout measures texts at this resolution
    if layout := figure.get_layout_engine():
        layout.execute(figure)
        figure.set_layout_engine("none")  # the PDF has the same places
    # Without savefig(), which draws each figure twice.
    FigureCanvasAgg(figure).print_png(path, pil_kwargs={"compress_level": 3})
    if PDF:
        FigureCanvasPdf(figure).print_pdf(path.with_suffix(".pdf"), metadata={"CreationDate": None})
    plt.close(figure)
