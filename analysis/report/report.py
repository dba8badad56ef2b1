#!/usr/bin/env python3
"""Figures and one self-contained HTML page from a folder that `shearwake run` filled.

Usage: report.py DIR    writes DIR/report/*.png and DIR/report/index.html
Needs numpy, h5py and matplotlib. Exit 0: done; 1: a figure could not be drawn; 6: no such folder.
"""
import sys
import traceback
from pathlib import Path

import fig_measures
import fig_spectra
import fig_surface
import fig_time
import layout
from load import NoPlan, load
from page import page

ENVIRONMENT = 6  # as the program's own exit code for files that are missing


def parts():
    """What is drawn, in the order of the page."""
    return [("measures", fig_measures.figures), ("time courses", fig_time.figures),
            ("surface", fig_surface.figures), ("spectra", fig_spectra.figures)]


def draw_all(sweep, folder):
    """The figures, and a sentence for each part that could not be drawn."""
    figures, problems = [], []
    if not layout.ordinary(sweep):
        return figures, problems
    for name, draw in parts():
        try:
            figures += draw(sweep, folder)
        except Exception as error:  # the rest of the page is worth having
            traceback.print_exc()
            problems.append(f"The figures of the {name} could not be drawn: {error}")
    return figures, problems


def write_report(directory):
    """Returns the path of the page, and what could not be drawn."""
    sweep = load(directory)
    folder = Path(directory) / "report"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.png"):
        old.unlink()
    figures, problems = draw_all(sweep, folder)
    path = folder / "index.html"
    path.write_text(page(sweep, figures, folder, problems), encoding="utf-8")
    return path, problems


def main(arguments):
    if len(arguments) != 1:
        print("usage: report.py DIR", file=sys.stderr)
        return 2
    try:
        path, problems = write_report(arguments[0])
    except (NoPlan, OSError) as error:
        print(f"report: {error}", file=sys.stderr)
        return ENVIRONMENT
    for problem in problems:
        print(f"report: {problem}", file=sys.stderr)
    print(f"report: {path}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
