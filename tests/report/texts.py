# SPDX-License-Identifier: BSD-3-Clause
"""Finds texts of a figure that are clipped by its edges or that overlap."""
from matplotlib.text import Text

EDGE_px = 1.0     # rounding of places to whole pixels
OVERLAP_px = 2.0  # of the boxes of two texts, which include the room for descenders


def hidden_ticks(figure):
    """The labels of ticks beyond the ends of their axis, which Matplotlib keeps but does not draw."""
    found = set()
    for axes in figure.axes:
        for axis, low, high in ((axes.xaxis, axes.bbox.x0, axes.bbox.x1), (axes.yaxis, axes.bbox.y0, axes.bbox.y1)):
            for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
                for label in (tick.label1, tick.label2):
                    place = label.get_transform().transform(label.get_position())[0 if axis is axes.xaxis else 1]
                    if not low - EDGE_px <= place <= high + EDGE_px:
                        found.add(label)
    return found


def visible_texts(figure):
    """(text, box in pixels) of each text that the figure shows."""
    renderer, hidden = figure.canvas.get_renderer(), hidden_ticks(figure)
    texts = [t for t in figure.findobj(Text) if t not in hidden and t.get_text().strip() and t.get_visible()
             and (t.axes is None or t.axes.get_visible())]
    return [(text, text.get_window_extent(renderer)) for text in texts]


def problems(figure):
    """Sentences about clipped and overlapping texts."""
    figure.canvas.draw()
    texts, page = visible_texts(figure), figure.bbox
    found = [f"clipped: {text.get_text()!r}" for text, box in texts
             if box.x0 < page.x0 - EDGE_px or box.x1 > page.x1 + EDGE_px
             or box.y0 < page.y0 - EDGE_px or box.y1 > page.y1 + EDGE_px]
    for i, (text, box) in enumerate(texts):
        for other, beside in texts[i + 1:]:
            wide = min(box.x1, beside.x1) - max(box.x0, beside.x0)
            high = min(box.y1, beside.y1) - max(box.y0, beside.y0)
            if wide > OVERLAP_px and high > OVERLAP_px:
                found.append(f"overlap: {text.get_text()!r} and {other.get_text()!r}")
    return found
