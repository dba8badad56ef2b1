#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of an output folder and writes a self-contained HTML page.

Usage: report.py DIR    writes DIR/report/index.html and each figure as .png and .pdf
Prints the result in a sentence and the path of the page. Needs numpy, h5py and matplotlib. Exit 0: done;
1: a figure could not be drawn; 4: case files are damaged, which the page lists; 6: the folder does not exist.
"""
import gc
import os
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
import fig_medium
import fig_multiples
import fig_profiles
import fig_receptors
import fig_spectra
import fig_spectrogram
import fig_surface
import fig_time
import fig_traces
import fig_uncertain
import fig_volume
import layout
import style
import warnings_of
from in_one_piece import in_one_piece
from load import NoPlan, load
from page import page
from player import player
from progress import Progress
from summary import summary
from unchanged import Drawn
from words import counted

ENVIRONMENT = 6  # exit code of the program for missing files
DAMAGED = 4      # exit code of the program for cases that failed or are damaged


def of_all(sweep):
    """Figures in which each case is a point or a cell, in the order of the page. Those of samples summarise them."""
    if sweep.uncertain:
        return [("samples", fig_uncertain.figures)]
    return [("measures", fig_measures.figures), ("frequencies", fig_frequency.figures),
            ("afferents", fig_afferents.figures), ("heat maps", fig_heat.figures),
            ("small multiples", fig_multiples.figures)]


def of_few(sweep):
    """Figures in which each case is a panel or a line; of a large sweep they show only a few cases. Lines over
    time and frequency are omitted if there are too many curves for a panel."""
    made = [("surface", fig_surface.figures), ("intensity", fig_intensity.figures), ("drive", fig_drive.figures),
            ("medium", fig_medium.figures), ("volumes", fig_volume.figures),
            ("receptors", fig_receptors.figures), ("hand", fig_hand.figures)]
    if len(layout.groups(sweep)) > style.CURVES:
        return made
    return [*made, ("profiles", fig_profiles.figures), ("time courses", fig_time.figures),
            ("traces", fig_traces.figures), ("spectra", fig_spectra.figures),
            ("spectrograms", fig_spectrogram.figures)]


def attempt(name, problems, draw, *arguments):
    """Returns the result of `draw`. If it fails, adds a sentence to the problems and returns None, so that the
    other figures are drawn."""
    try:
        return draw(*arguments)
    except OSError:
        raise  # for example a full disk, on which nothing else can be written
    except Exception as error:
        traceback.print_exc()
        problems.append(f"The figures of the {name} could not be drawn: {error}")
        return None


def draw_all(sweep, folder, drawn, progress):
    """The figures, the player of the surface, and a sentence for each part that could not be drawn."""
    figures, problems = [], []
    if not layout.ordinary(sweep):
        return figures, "", problems
    some = layout.few(sweep)
    groups = [(name, draw, sweep) for name, draw in of_all(sweep)] + [(name, draw, some) for name, draw in of_few(sweep)]
    missing = sum(not case.whole for case in sweep.cases)
    shown, every = len(layout.ordinary(some)), len(layout.ordinary(sweep))
    for n, (name, draw, cases) in enumerate(groups):
        progress.show(f"figures {n + 1} of {len(groups) + 1} ({name})")
        for figure in attempt(name, problems, drawn.draw, name, draw, cases, folder) or []:
            if missing and cases is sweep and not figure.name.startswith("heat_"):  # heat maps mark these cases
                figure.caption += f" {counted(missing, 'case')} without a result: see \"Not in the figures\"."
            if cases is not sweep:
                figure.caption += (f" The figure shows {shown} of {counted(every, 'case')}, spread evenly over the sweep; "
                                   "the table lists all.")
            if figure.cases is None:
                figure.cases = [case.id for case in cases.cases if case.whole]
            figure.warnings = warnings_of.of_figure(sweep, figure.name, figure.cases)
            figures.append(figure)
    progress.show(f"figures {len(groups) + 1} of {len(groups) + 1} (surface over time)")
    return figures, attempt("surface over time", problems, drawn.draw, "surface over time", player, sweep) or "", problems


def collect_garbage_seldom():
    """Matplotlib creates many objects that refer to each other, most of which live as long as a figure."""
    gc.freeze()
    gc.set_threshold(200_000, 20, 20)


def write_report(directory):
    """Returns the path of the page, the summary, the figures that could not be drawn, and the ids of damaged
    cases."""
    progress = Progress()
    sweep = load(directory, progress.show)
    folder = Path(directory) / "report"
    path = folder / "index.html"
    with in_one_piece(folder, ("*.png", "*.pdf"), last=path.name) as part:
        drawn = Drawn(folder, part)
        figures, moving, problems = draw_all(sweep, part, drawn, progress)
        drawn.save()
        (part / path.name).write_text(page(sweep, figures, part, problems, moving), encoding="utf-8")
    progress.end()
    return path, summary(sweep), problems, [case.id for case in sweep.cases if case.status == "damaged"]


def main(arguments):
    if len(arguments) != 1:
        print("usage: report.py DIR", file=sys.stderr)
        return 2
    collect_garbage_seldom()
    try:
        path, result, problems, damaged = write_report(arguments[0])
    except (NoPlan, OSError) as error:
        print(f"report: {error}", file=sys.stderr)
        return ENVIRONMENT
    for problem in problems:
        print(f"report: {problem}", file=sys.stderr)
    if damaged:
        print(f"report: {counted(len(damaged), 'damaged case file')}: {', '.join(damaged)}", file=sys.stderr)
    try:
        print(f"result: {result}\nreport: {path}", flush=True)
    except OSError as error:
        print(f"report: the output cannot be written: {error.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # discards what is not flushed yet
        return ENVIRONMENT
    return 1 if problems else DAMAGED if damaged else 0


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="replace")  # the encoding of a terminal may lack η
    sys.exit(main(sys.argv[1:]))
