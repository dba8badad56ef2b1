"""What every figure hands to the page."""
from dataclasses import dataclass


@dataclass
class Figure:
    name: str  # of its file, without .png
    title: str
    caption: str
    alternative: str  # in words, for who cannot see it
