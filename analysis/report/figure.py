# SPDX-License-Identifier: BSD-3-Clause
"""A figure of the page."""
from dataclasses import dataclass


@dataclass
class Figure:
    name: str  # name of its file without .png
    title: str
    caption: str
    alternative: str  # alternative text for readers who cannot see the picture
