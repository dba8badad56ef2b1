# SPDX-License-Identifier: BSD-3-Clause
"""A figure of the page."""
from dataclasses import dataclass, field


@dataclass
class Figure:
    name: str  # name of its file without .png
    title: str
    caption: str  # of the picture and of its charts
    alternative: str  # alternative text for readers who cannot see the picture
    charts: list = field(default_factory=list)  # of chart.py, or as JSON objects; empty: the picture alone
    maps: list = field(default_factory=list)  # values under the pointer, from hover.maps_of()
    of_picture: str = ""  # what the picture shows in addition to the charts
    cases: list | None = None  # ids of the cases that it shows; None: all complete cases of the sweep
    warnings: list = field(default_factory=list)  # from warnings_of.of_figure()
