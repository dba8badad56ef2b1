# SPDX-License-Identifier: BSD-3-Clause
"""A figure of the page."""
import base64
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from PIL import Image

from . import style
from .page import hover

COLOURS = 96  # of the pictures within the page; the files next to it have all


@dataclass
class Figure:
    drawn: Any  # by matplotlib, until it is saved
    name: str  # name of its file without .png
    title: str
    caption: str  # of the picture and of its charts
    alternative: str  # alternative text for readers who cannot see the picture
    charts: list = field(default_factory=list)  # of chart.py, on the page as JSON objects; empty: the picture alone
    maps: list = field(default_factory=list)  # values under the pointer
    cases: list | None = None  # ids of the cases that it shows; None: all complete cases of the sweep
    warnings: list = field(default_factory=list)  # from warnings_of.of_figure()
    still: str = ""  # small_picture() of its file

    def save(self, folder: Path) -> None:
        """Writes the files of the figure, and keeps what the page needs of it."""
        path = folder / f"{self.name}.png"
        style.save(self.drawn, path)
        self.maps, self.drawn = hover.maps_of(self.drawn), None
        self.still = small_picture(path, 2 if self.charts else 1)


def small_picture(path: Path, reduction: int = 1) -> str:
    """The picture with few colours as base64 text of a lossless WebP, a fifth of the size of the file."""
    file = io.BytesIO()
    few = Image.open(path).convert("RGB").reduce(reduction).quantize(COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.convert("RGB").save(file, format="WEBP", lossless=True, method=2)
    return base64.b64encode(file.getvalue()).decode("ascii")
