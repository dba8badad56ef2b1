# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of an output folder and writes a self-contained HTML page.

Usage: python3 -m shearwake.report DIR [--only ID[,ID]] [--json]    writes DIR/report/index.html and each figure as .png and .pdf
Prints the result in a sentence and the path of the page, or a JSON document. Needs numpy, h5py and matplotlib. Exit 0: done;
1: a figure could not be drawn; 2: no complete case has the id; 4: case files are damaged, which the page lists; 6: the
folder does not exist.
"""
from __future__ import annotations

import argparse
import functools
import gc
import json
import sys
import tempfile
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from .. import figure_style
from ..errors import NotAnOutputFolder
from . import layout, style, warnings_of
from .figure import Figure
from .figures import (fig_adaptive, fig_afferents, fig_drive, fig_frequency, fig_hand, fig_heat, fig_intensity, fig_measures,
                      fig_medium, fig_multiples, fig_optimise, fig_profiles, fig_receptors, fig_spectra, fig_spectrogram,
                      fig_surface, fig_time, fig_traces, fig_uncertain, fig_volume)
from .load import Selection, load, read_all, read_motion
from .page import topics
from .page.chart import chart_data
from .page.page import page
from .page.player import player
from .progress import Progress, parallel_map, print_result
from .ranking import caution
from .summary import summary
from .words import OTHERS, counted, some_of

USAGE = 2        # exit code of the program for wrong arguments
ENVIRONMENT = 6  # exit code of the program for missing files
SCHEMA = 2       # version of the JSON document
DAMAGED = 4      # exit code of the program for cases that failed or are damaged


def of_all(selection: Selection) -> list[tuple[str, Callable[..., Any]]]:
    """Figures in which each case is a point or a cell, in the order of the page. Those of samples summarise them."""
    first = [("adaptive axes", fig_adaptive.figures)] if selection.sweep.adaptive_axes else []
    if selection.sweep.uncertain:
        return [*first, ("samples", fig_uncertain.figures)]
    if fig_optimise.is_study(selection):  # its cases are five modulations each, which the generic figures cannot distinguish
        return [*first, ("optima", fig_optimise.figures)]
    return [*first, ("measures", fig_measures.figures), ("frequencies", fig_frequency.figures),
            ("afferents", fig_afferents.figures), *(("heat maps", functools.partial(fig_heat.figures, part=part)) for part in (slice(4), slice(4, None))),
            ("small multiples", fig_multiples.figures)]


class NoCase(Exception):
    """No complete case has the id that --only names."""


OF_THEIR_OWN = ("medium", "receptors")  # their captions state which part of the sweep they show


def of_few(selection: Selection) -> list[tuple[str, Callable[..., Any]]]:
    """Figures in which each case is a panel or a line; of a large sweep they show only a few cases. Lines over
    time and frequency are omitted if there are too many curves for a panel."""
    if fig_optimise.is_study(selection):
        return [("medium", fig_medium.figures), ("receptors", fig_receptors.figures), ("hand", fig_hand.figures)]
    made = [("surface", fig_surface.figures), ("intensity", fig_intensity.figures), ("drive", fig_drive.figures),
            ("medium", fig_medium.figures), ("volumes", fig_volume.figures),
            ("receptors", fig_receptors.figures), ("hand", fig_hand.figures)]
    if len(layout.groups(selection)) > style.CURVES:
        return made
    return [*made, ("profiles", fig_profiles.figures), ("time courses", fig_time.figures),
            ("traces", fig_traces.figures), ("spectra", fig_spectra.figures),
            ("spectrograms", fig_spectrogram.figures)]


def draw_group(name: str, draw: Callable[..., Any], selection: Selection, folder: Path) -> tuple[Any, list[str]]:
    """The result of `draw`. If it fails, None and a sentence that states why, so that the other figures are drawn."""
    try:
        result = draw(selection)
        for figure in () if isinstance(result, str) else result:
            figure.save(folder)
            figure.charts = [chart_data(chart) for chart in figure.charts]
        return result, []
    except OSError:
        raise  # for example a full disk, on which nothing else can be written
    except Exception as error:
        traceback.print_exc()
        return None, [f"The figures of the {name} could not be drawn: {error}"]


def shown_caption(selection: Selection, figure: Figure, made: list[Figure]) -> str:
    """States how many cases the figures of a group show, unless they show all: each one by itself, or the first for all
    of them if each shows a single case."""
    alone = len(made) > 1 and all(len(f.cases or []) == 1 for f in made)
    if alone and figure is not made[0]:
        return ""
    ids = {i for f in (made if alone else [figure]) for i in f.cases or []}
    every = layout.ordinary(selection)
    count = sum(case.id in ids for case in every)
    return f" {some_of(count, len(every), 'case')}; {OTHERS}." if count < len(every) else ""


def draw_all(selection: Selection, some: Selection, folder: Path, progress: Progress) -> tuple[list[Figure], str, list[str]]:
    """The figures, of which those with a panel or a line per case show only the cases `some`, the player of the surface,
    and a sentence for each part that could not be drawn."""
    figures: list[Figure] = []
    problems: list[str] = []
    if not layout.ordinary(selection):
        return figures, "", problems
    groups = [(name, draw, selection) for name, draw in of_all(selection)]
    all_cases = len(groups)
    groups += [(name, draw, some) for name, draw in of_few(selection)]
    missing = sum(not case.is_complete for case in selection.cases)
    tasks = [("surface over time", player, selection), *groups]
    results = parallel_map([functools.partial(draw_group, *task, folder) for task in tasks],
                           lambda n: progress.show(f"figures {n} of {len(tasks)}"))
    for _, found in results:
        problems += found
    (moving, _), *others = results
    for n, ((name, _, cases), (result, _)) in enumerate(zip(groups, others)):
        made = result or []
        for figure in made:
            if figure.cases is None:
                figure.cases = [case.id for case in cases.cases if case.is_complete]
        for figure in made:
            if missing and n < all_cases and not figure.name.startswith("heat_"):  # heat maps mark these cases
                figure.caption += f" {counted(missing, 'case')} without a result: see \"Not in the figures\"."
            if n >= all_cases and name not in OF_THEIR_OWN:
                figure.caption += shown_caption(selection, figure, made)
            if topics.topic_of(figure.name) == topics.SENSATION and (text := caution(selection)):
                figure.caption += f" {text}"
            figure.warnings = warnings_of.of_figure(selection, figure.name, figure.cases)
            figures.append(figure)
    return figures, moving or "", problems


def collect_garbage_seldom() -> None:
    """Matplotlib creates many objects that refer to each other, most of which live as long as a figure."""
    gc.freeze()
    gc.set_threshold(200_000, 20, 20)


def selected(selection: Selection, ids: Sequence[str]) -> Selection:
    """The cases of figures with a panel or a line per case. Raises NoCase."""
    complete = [case.id for case in layout.ordinary(selection)]
    if wrong := [i for i in ids if i not in complete]:
        raise NoCase(f"{', '.join(wrong)}: not the id of a complete case of {selection.sweep.folder}, references apart; "
                     f"tables/{selection.sweep.name}.csv lists the ids")
    return layout.only(selection, ids) if ids else layout.few(selection)


def write_report(directory: str | Path, only: Sequence[str] = ()) -> tuple[Path, str, list[str], Selection]:
    """Returns the path of the page, the summary, the figures that could not be drawn, and the cases. Raises
    NotAnOutputFolder, NoCase."""
    figure_style.reset()
    progress = Progress()
    selection = load(directory, progress.show)
    some = selected(selection, only)
    folder = Path(directory) / "report"
    path = folder / "index.html"
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".", dir=folder) as name:  # each file is replaced once it is complete
        part = Path(name)
        summary(selection)  # is remembered in this process and those that draw, as are the files of these cases
        read_all(layout.recordings(selection), read_motion)
        figures, moving, problems = draw_all(selection, some, part, progress)
        (part / path.name).write_text(page(selection, figures, problems, moving), encoding="utf-8")
        new = sorted(part.iterdir(), key=lambda file: file.name == path.name)
        for file in new:
            file.replace(folder / file.name)
    for old in {*folder.glob("*.png"), *folder.glob("*.pdf")} - {folder / file.name for file in new}:
        old.unlink()
    progress.end()
    return path, summary(selection), problems, selection


def document(path: Path, result: str, selection: Selection, damaged: list[str]) -> str:
    """The JSON document of `shearwake report --json`."""
    complete = [case for case in selection.cases if case.is_complete]
    return json.dumps({"schema": SCHEMA, "command": "report", "folder": str(selection.sweep.folder), "page": str(path),
                       "result": result, "cases": len(selection.cases), "complete": len(complete),
                       "not_valid": sum(any(w["severity"] == "error" for w in case.warnings) for case in complete),
                       "damaged": damaged}, indent=1, ensure_ascii=False)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="report", description="Draws figures and writes one HTML page.")
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--only", metavar="ID[,ID]", default="", help="draw these cases where not all can be drawn")
    parser.add_argument("--json", action="store_true", help="print a JSON document instead of text")
    given = parser.parse_args(arguments)
    collect_garbage_seldom()
    try:
        path, result, problems, selection = write_report(given.folder, [i for i in given.only.split(",") if i])
    except NoCase as error:
        print(f"report: {error}", file=sys.stderr)
        return USAGE
    except (NotAnOutputFolder, OSError, BrokenProcessPool) as error:  # BrokenProcessPool: a process was killed
        print(f"report: {error}", file=sys.stderr)
        return ENVIRONMENT
    for problem in problems:
        print(f"report: {problem}", file=sys.stderr)
    damaged = [case.id for case in selection.cases if case.status == "damaged"]
    if damaged:
        print(f"report: {counted(len(damaged), 'damaged case file')}: {', '.join(damaged)}", file=sys.stderr)
    text = document(path, result, selection, damaged) if given.json else f"result: {result}\nreport: {path}"
    if not (given.json and problems) and not print_result(text, "report"):
        return ENVIRONMENT
    return 1 if problems else DAMAGED if damaged else 0


def command() -> None:
    sys.stdout.reconfigure(errors="replace")  # type: ignore[attr-defined]  # the encoding of a terminal may lack η
    sys.exit(main(sys.argv[1:]))


if __name__ == "__main__":
    command()
