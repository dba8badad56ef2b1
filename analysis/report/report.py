#!/usr/bin/env python3
"""Figures and one self-contained HTML page from a folder that `shearwake run` filled.

Usage: report.py DIR    writes DIR/report/index.html and each figure as .png and .pdf
Needs numpy, h5py and matplotlib. Exit 0: done; 1: a figure could not be drawn; 6: no such folder.
"""
import sys
import traceback
from pathlib import Path

import fig_afferents
import fig_drive
import fig_frequency
import fig_hand
import fig_heat
import fig_intensity
import fig_measures
import fig_multiples
import fig_spectra
import fig_spectrogram
import fig_surface
import fig_time
import layout
import style
from load import NoPlan, load
from page import page
from player import player
from words import counted

ENVIRONMENT = 6  # as the program's own exit code for files that are missing


def of_all():
    """Figures in which every case has its point or its cell, in the order of the page."""
    return [("measures", fig_measures.figures), ("frequencies", fig_frequency.figures),
            ("afferents", fig_afferents.figures), ("heat maps", fig_heat.figures),
            ("small multiples", fig_multiples.figures)]


def of_few(sweep):
    """Figures in which a case has a panel or a line of its own: of a large sweep only a few. Lines
    over time and frequency say nothing where curves are too many for a panel."""
    made = [("intensity", fig_intensity.figures), ("drive", fig_drive.figures), ("hand", fig_hand.figures),
            ("surface", fig_surface.figures)]
    if len(layout.groups(sweep)) > style.CURVES:
        return made
    return [*made, ("time courses", fig_time.figures), ("spectra", fig_spectra.figures),
            ("spectrograms", fig_spectrogram.figures)]


def attempt(name, problems, draw, *arguments):
    """What `draw` returns; when it fails, nothing and a sentence: the rest is worth having."""
    try:
        return draw(*arguments)
    except Exception as error:
        traceback.print_exc()
        problems.append(f"The figures of the {name} could not be drawn: {error}")
        return None


def draw_all(sweep, folder):
    """The figures, the moving surface, and a sentence for each part that could not be drawn."""
    figures, problems = [], []
    if not layout.ordinary(sweep):
        return figures, "", problems
    for name, draw in of_all():
        figures += attempt(name, problems, draw, sweep, folder) or []
    missing = sum(not case.whole for case in sweep.cases)
    for figure in figures:
        if missing and not figure.name.startswith("heat_"):  # these mark them themselves
            figure.caption += f" {counted(missing, 'case')} without a result: listed above."
    some = layout.few(sweep)
    drawn, every = len(layout.ordinary(some)), len(layout.ordinary(sweep))
    for name, draw in of_few(sweep):
        for figure in attempt(name, problems, draw, some, folder) or []:
            if some is not sweep:
                figure.caption += (f" From {drawn} of {every} cases, spread evenly over the sweep; "
                                   "the table has all.")
            figures.append(figure)
    return figures, attempt("moving surface", problems, player, some) or "", problems


def write_report(directory):
    """Returns the path of the page, and what could not be drawn."""
    sweep = load(directory)
    folder = Path(directory) / "report"
    folder.mkdir(exist_ok=True)
    for old in [*folder.glob("*.png"), *folder.glob("*.pdf")]:
        old.unlink()
    figures, moving, problems = draw_all(sweep, folder)
    path = folder / "index.html"
    path.write_text(page(sweep, figures, folder, problems, moving), encoding="utf-8")
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
