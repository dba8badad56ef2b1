"""One look for every figure: sizes, colours that colour-blind readers can tell apart, labels."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib import patheffects  # noqa: E402

WIDTH_in = 7.6  # 730 CSS pixels: fonts are shown at their size
DPI = 150
INK = "#222222"
GREY = "#8a8a8a"
# Okabe and Ito (2008), without the yellow that white paper swallows.
PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DIVERGING = "RdBu_r"
DIRECT_LABELS = 8  # up to so many lines are told apart by a legend, more by a colour bar
CURVES = 8  # up to so many curves share a panel; more become heat maps and small multiples

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9.5, "axes.labelsize": 9.5, "axes.titlesize": 9.5,
    "xtick.labelsize": 9, "ytick.labelsize": 9, "legend.fontsize": 9, "axes.edgecolor": "#666666",
    "axes.linewidth": 0.7, "axes.spines.top": False, "axes.spines.right": False,
    "text.color": INK, "axes.labelcolor": INK, "xtick.color": "#444444", "ytick.color": "#444444",
    "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.6, "axes.axisbelow": True,
    "legend.frameon": False, "lines.linewidth": 1.6, "axes.unicode_minus": True,
    "pdf.fonttype": 42, "mathtext.default": "regular", "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5), "axes.formatter.use_mathtext": True,
})


def sequential(fraction):
    """Perceptually uniform, without the pale end that white paper swallows."""
    return matplotlib.colormaps["viridis"](0.02 + 0.78 * np.asarray(fraction))


def sequential_map():
    return matplotlib.colors.ListedColormap(sequential(np.linspace(0.0, 1.0, 256)))


def distinct(count):
    """`count` colours for curves without an order; from the eighth on they are steps of one map."""
    if count <= len(PALETTE):
        return PALETTE[:count]
    return [sequential(f) for f in np.linspace(0.0, 1.0, count)]


def halo(width=2.5, colour="white"):
    return [patheffects.withStroke(linewidth=width, foreground=colour)]


def spread(places, gap):
    """`places` moved as little as needed to be `gap` apart; in the given order."""
    order = np.argsort(places)
    moved = np.array(places, dtype=float)
    for _ in range(200):
        steps = np.diff(moved[order])
        if np.all(steps >= gap * 0.999):
            break
        for low, high in zip(order[:-1], order[1:]):
            missing = gap - (moved[high] - moved[low])
            if missing > 0:
                moved[low] -= 0.5 * missing
                moved[high] += 0.5 * missing
    return moved


def label_right(axes, labels):
    """Writes (y, text, colour) beside the right edge, at the height of y, none on another."""
    if not labels:
        return
    fractions = [axes.transLimits.transform(axes.transScale.transform((1.0, y)))[1]
                 for y, _, _ in labels]
    height_pt = 72.0 * axes.figure.get_figheight() * axes.get_position().height
    lines = max(text.count("\n") + 1 for _, text, _ in labels)
    for place, (_, text, colour) in zip(spread(fractions, 12.0 * lines / height_pt), labels):
        axes.text(1.015, place, text, transform=axes.transAxes, va="center", ha="left", fontsize=9,
                  color=colour, clip_on=False, linespacing=1.15)


def save(figure, path):
    """The PNG of the page and, beside it, the same as PDF: lines are vectors there."""
    figure.savefig(path, dpi=DPI, facecolor="white")
    figure.savefig(path.with_suffix(".pdf"), facecolor="white", metadata={"CreationDate": None})
    plt.close(figure)
