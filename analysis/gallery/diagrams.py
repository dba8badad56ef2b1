# SPDX-License-Identifier: BSD-3-Clause
"""The diagrams of docs/developer/architecture.md, as SVG: boxes at given places and labelled arrows between them."""
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# A box is its place (column, row) and its text; an arrow is (from, to, text). Rows count downward.
PATH_OF_A_CASE = {
    "boxes": {
        "job": (0, 0, "job.toml"), "plan": (1, 0, "Plan:\ncases with ids"), "teams": (2, 0, "teams of ranks"),
        "run": (3, 0, "pipeline:\nrun_case"), "engine": (3, 1, "engines:\nEngine::run"),
        "saved": (4, 1, "checkpoints/\nID.A.h5, ID.B.h5"), "observers": (2, 1, "pipeline:\nobservers"),
        "measures": (1, 1, "measures, neural"), "file": (0, 1, "storage:\ncases/ID.h5"),
        "tables": (0, 2, "tables/*.csv, *.md"), "report": (1, 2, "report/index.html"),
    },
    "arrows": [
        ("job", "plan", "config"), ("plan", "teams", "schedule/\ncost"), ("teams", "run", "schedule/run:\nWorker"),
        ("run", "engine", "Case"), ("engine", "observers", "frames,\nvolumes, stress"),
        ("engine", "saved", "storage/\ncheckpoint"), ("saved", "engine", ""), ("observers", "measures", "sums"),
        ("measures", "file", "columns,\nseries"), ("file", "tables", "reduce"), ("tables", "report", "shearwake.report\n(Python)"),
    ],
    "spacing": (3.0, 1.45), "box": (1.55, 0.72),
}
COMPONENTS = {
    "boxes": {
        "app": (2, 0, "app"), "bench": (0, 1, "bench"), "reduce": (3, 2, "reduce"), "studies": (2, 1, "studies"),
        "run": (2, 2, "schedule/run"), "cost": (1, 3, "schedule/cost"), "config": (3, 3, "config"), "pipeline": (1, 4, "pipeline"),
        "measures": (0, 6, "measures"), "neural": (1, 5.3, "neural"), "storage": (2, 5, "storage"),
        "engines": (3, 5, "engines: interface, layered,\nspectral, pstd, registry"),
        "case": (2, 6.4, "problem/case"), "fft": (4, 6, "fft"), "load": (1, 7.6, "problem/load"), "medium": (2, 7.6, "problem/medium"),
        "parallel": (4, 7, "parallel"), "simd": (4, 8, "simd"), "base": (2, 9, "base"),
    },
    "arrows": [(a, b, "") for a, others in {
        "simd": "base", "parallel": "simd", "fft": "parallel", "medium": "base", "load": "base", "case": "medium load",
        "engines": "case fft", "measures": "case simd", "neural": "case fft", "storage": "case parallel",
        "config": "engines", "pipeline": "engines measures neural storage", "cost": "pipeline",
        "run": "cost config", "reduce": "storage config", "studies": "run reduce", "bench": "cost", "app": "bench studies",
    }.items() for b in others.split()],
    "spacing": (2.3, 0.86), "box": (1.25, 0.46),
}
DIAGRAMS: dict[str, dict[str, Any]] = {"path-of-a-case": PATH_OF_A_CASE, "components": COMPONENTS}
Point = tuple[float, float]


def edge(middle: Point, half: Point, towards: Point) -> Point:
    """Where the line from the middle of a box towards a point leaves the box."""
    (x, y), (to_x, to_y) = middle, towards
    part = min(size / abs(step) for size, step in zip(half, (to_x - x, to_y - y)) if step)
    return x + part * (to_x - x), y + part * (to_y - y)


def draw(diagram: dict[str, Any], path: Path) -> None:
    (dx, dy), (width, height) = diagram["spacing"], diagram["box"]
    place = {name: (dx * column, -dy * row) for name, (column, row, _) in diagram["boxes"].items()}
    xs, ys = [x for x, _ in place.values()], [y for _, y in place.values()]
    size = max(xs) - min(xs) + 2.0 * width, max(ys) - min(ys) + 2.0 * height
    figure, axes = plt.subplots(figsize=(0.75 * size[0], 0.75 * size[1]))
    axes.set(xlim=(min(xs) - width, max(xs) + width), ylim=(min(ys) - height, max(ys) + height), aspect="equal")
    axes.axis("off")
    box = {"boxstyle": "round,pad=0.45", "facecolor": "#eef3f8", "edgecolor": "#4a6a8a"}
    texts = {name: axes.text(*place[name], text, ha="center", va="center", fontsize=8.5, bbox=box, zorder=3)
             for name, (_, _, text) in diagram["boxes"].items()}
    figure.canvas.draw()  # places the boxes
    half = {name: axes.transData.inverted().transform(text.get_bbox_patch().get_window_extent()).ptp(axis=0) / 2
            for name, text in texts.items()}
    for begin, end, text in diagram["arrows"]:
        axes.annotate("", edge(place[end], half[end], place[begin]), edge(place[begin], half[begin], place[end]),
                      arrowprops={"arrowstyle": "-|>", "color": "#555555", "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0})
        (x0, y0), (x1, y1) = place[begin], place[end]
        beside = x0 == x1  # a vertical arrow has its text on the right
        axes.text(0.5 * (x0 + x1) + (0.08 if beside else 0.0), 0.5 * (y0 + y1) + (0.0 if beside else 0.07), text,
                  ha="left" if beside else "center", va="center" if beside else "bottom", fontsize=7.5, color="#333333")
    with plt.rc_context({"svg.fonttype": "none", "svg.hashsalt": path.stem}):
        figure.savefig(path, facecolor="white", bbox_inches="tight", pad_inches=0.1, metadata={"Date": None})
    plt.close(figure)


def draw_all(folder: Path) -> list[Path]:
    """Draws every diagram into the folder; returns the paths."""
    folder.mkdir(exist_ok=True)
    paths = [folder / f"{name}.svg" for name in DIAGRAMS]
    for path in paths:
        draw(DIAGRAMS[path.stem], path)
    return paths
