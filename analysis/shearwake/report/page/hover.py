# SPDX-License-Identifier: BSD-3-Clause
"""Values of maps under the pointer: heat maps, surfaces, spectrograms and slices of a picture, which maps.js shows."""
from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

CELLS = 400   # largest number of values that are stored with all digits
POINTS = 72   # of a stored map along its longer side
STEPS = 32767


def attach(axes: Axes, values: np.ndarray, x: Any, y: Any, what: str, x_label: str, y_label: str, unit: str = "",
           x_names: list[str] | None = None, y_names: list[str] | None = None, title: str = "",
           invalid: np.ndarray | None = None, error: np.ndarray | None = None) -> None:
    """Adds values (row, column) to the axes of a picture. x and y are the coordinates at the outer edges of the first and
    the last column and row; x_names and y_names replace the coordinates of columns and rows. `what` names the values, and
    `title` the panel. `invalid` marks values of few that are not valid, and `error` has their estimated
    errors, of at most CELLS values."""
    values = np.asarray(values, dtype=float)
    step = 1 if values.size <= CELLS else math.ceil(max(values.shape) / POINTS)
    axes.hover = {"x": [float(v) for v in x], "y": [float(v) for v in y], "title": title, "what": what, "unit": unit, "x_label": x_label,
                  "y_label": y_label, "x_names": x_names, "y_names": y_names, **stored(values[step // 2::step, step // 2::step])}
    if invalid is not None and np.any(invalid) and step == 1:
        axes.hover["invalid"] = [int(i) for i in np.flatnonzero(invalid)]
    if error is not None and values.size <= CELLS and np.isfinite(error).any():
        axes.hover["error"] = stored(error)["values"]


def stored(values: np.ndarray) -> dict[str, Any]:
    """Few values as numbers; many as base64 text of 16-bit integers, of which `scale` is the unit."""
    if values.size <= CELLS:
        rounded = [None if not math.isfinite(v) else float(f"{v:.5g}") for v in values.ravel()]
        return {"shape": list(values.shape), "values": rounded}
    largest = float(np.nanmax(np.abs(values), initial=0.0)) or 1.0
    steps = np.where(np.isfinite(values), np.round(np.nan_to_num(values) / largest * STEPS), -STEPS - 1)
    return {"shape": list(values.shape), "scale": largest / STEPS,
            "packed": base64.b64encode(steps.astype("<i2").tobytes()).decode("ascii")}


def maps_of(figure: Any) -> list[dict[str, Any]]:
    """The maps of a figure that was drawn, with the place of their axes in fractions of the picture, from its lower left
    corner, and the limits of the axes."""
    made = []
    for axes in figure.axes:
        if hasattr(axes, "hover") and axes.get_visible():
            box = axes.get_position()
            made.append({**axes.hover, "box": [round(v, 5) for v in (box.x0, box.y0, box.width, box.height)],
                         "limits": [[float(v) for v in axes.get_xlim()], [float(v) for v in axes.get_ylim()]]})
    return made
