# SPDX-License-Identifier: BSD-3-Clause
"""The sortable table of the page, with the main columns of the table of `shearwake reduce`."""
from __future__ import annotations

import html
import math

from ... import wake
from ...case import Case
from ...keys import axis_label, is_at_instant, label
from .. import labels, layout, thinning
from ..figure import Figure
from ..load import Selection
from ..ranking import caution
from ..warnings_of import Kind, kinds as kinds_of_warnings
from ..words import counted, number


def measures(selection: Selection) -> list[str]:
    """The columns that the table of measures (src/measures/measure_table.cpp) lists for the page; columns of
    shapes only if the focus draws a shape, not a straight line, and ratios only if there are references."""
    shapes = not all(wake.runs_straight_on(c) for c in layout.recordings(selection))
    references = bool(layout.all_references(selection))
    shown = [c.name for c in selection.sweep.columns if (c.shown == "page" or (c.shown == "shapes" and shapes))
             and (references or not c.over_reference_of)]
    return sorted(shown, key=is_at_instant)  # readings over periods come first


def numeric_cell(amount: float) -> str:
    if amount is None or math.isnan(amount):
        return '<td class="n empty">–</td>'
    return f'<td class="n" data-v="{amount:.9g}" title="{amount:.9g}">{number(amount)}</td>'


def setting_cell(selection: Selection, case: Case, key: str) -> str:
    setting = case.settings.get(key)
    if isinstance(setting, str):
        return f'<td title="{html.escape(setting)}">{html.escape(labels.value_text(selection, key, setting))}</td>'
    if (key, setting) in layout.labels(selection):
        return f'<td class="n" data-v="{setting:.9g}" title="{setting:.9g}">{html.escape(labels.value_text(selection, key, setting))}</td>'
    return numeric_cell(math.nan if setting is None else float(setting))


def head(selection: Selection, columns: list[str]) -> str:
    cells = ""
    for column in columns:
        kind = "" if column in ("id", "reference", "valid", "status") else ' class="n"'
        name = html.escape(column)
        text = labels.axis_label(selection, column) if column in selection.sweep.swept_keys else axis_label(column)
        cells += f'<th scope="col"{kind} data-name="{name}" title="{name}"><button type="button">{html.escape(text)}</button></th>'
    return f"<thead><tr>{cells}</tr></thead>"


def id_cell(case: Case) -> str:
    """The id with a box that shows or hides the lines of the case, linked to the case file."""
    name = html.escape(case.id)
    return (f'<td><label><input type="checkbox" checked aria-label="show {name} in the figures"></label> '
            f'<a href="../cases/{name}.h5"><code>{name}</code></a></td>')


def filtered(figures: list[Figure]) -> str:
    """States which figures hide the lines of cases that are not selected: those with one line per case."""
    links = [f'<a href="#{html.escape(f.name)}">{html.escape(f.title)}</a>' for f in figures
             if any(line.get("case") for chart in f.charts for line in chart["lines"])]
    if not links:
        return "The filter selects rows of this table; it changes no figure."
    return ("Rows that the filter removes and cases that are not ticked have no lines in the figures with one line per "
            f"case: {'; '.join(links)}. All other figures and the player do not change.")


def tools(selection: Selection, figures: list[Figure]) -> str:
    """The filter above the table, its effect on the figures, and the links to the data."""
    name, shown = html.escape(selection.sweep.name), thinning.listed(selection)
    return ('<div class="tools"><label>Filter <input id="filter" type="search" '
            'placeholder="for example: eta_period_1 &gt; 0.2, complete"></label>'
            f'<output id="count">{len(shown)} of {counted(len(shown), "case")}</output>'
            '<button type="button" id="csv">Save rows as CSV</button></div>'
            f'<p class="counts">{thinning.sentence(selection)}Select a heading to sort by its column; select it again to reverse the order. Scroll sideways '
            f'to see all columns. {filtered(figures)} Files with all cases and columns, in the output folder of this page: '
            f'<a href="../tables/{name}.csv">{name}.csv</a>, '
            f'<a href="../tables/{name}.json">{name}.json</a>.</p>')


def row(selection: Selection, case: Case, kinds: list[str], keys: list[str], shown: list[str], followers: list[str], mark: str) -> str:
    """The cells of a case; `kinds` is the column that marks references, or empty without references."""
    cells = [id_cell(case), *(f'<td>{"yes" if case.is_reference else ""}</td>' for _ in kinds)]
    cells += [setting_cell(selection, case, k) for k in keys]
    cells += [numeric_cell(case.value(m, math.nan)) for m in shown]
    cells += [setting_cell(selection, case, k) for k in followers]
    valid = "" if not case.is_complete else "no" if any(w["severity"] == "error" for w in case.warnings) else "yes"
    cells += [f"<td>{valid}</td>", numeric_cell(case.wall_s), f"<td>{html.escape(case.status)}</td>", f'<td class="n">{mark}</td>']
    kind = ' class="reference"' if case.is_reference else ""
    return f'<tr data-id="{html.escape(case.id)}"{kind}>{"".join(cells)}</tr>'


def reasons(case: Case) -> str:
    """Why columns are empty, and limits of values: 'dominant frequency, sharpness: reason; Mach angle: another reason'."""
    columns: dict[str, list[str]] = {}
    for column, reason in case.notes.items():
        columns.setdefault(reason, []).append(label(column))
    return "; ".join(f"{', '.join(names)}: {reason}" for reason, names in columns.items())


def table(selection: Selection, figures: list[Figure]) -> str:
    """The table and, below it, the notes to which its last column refers."""
    keys = layout.axes(selection)
    followers = [k for k in selection.sweep.swept_keys if k not in keys]  # zipped with other keys; placed at the end
    shown = measures(selection)
    kinds = ["reference"] if any(c.is_reference for c in selection.cases) else []
    notes: dict[str, int] = {}
    warned: dict[str, list[Kind]] = {}
    for kind in kinds_of_warnings(selection):
        for case in kind.cases:
            warned.setdefault(case.id, []).append(kind)
    rows = []
    for case in thinning.listed(selection):
        marks = [f'<a href="#warning-{kind.number}">warning {kind.number}</a>' for kind in warned.get(case.id, [])]
        if note := case.reason or reasons(case):
            n = notes.setdefault(note, len(notes) + 1)
            marks.append(f'<a href="#note-{n}">note {n}</a>')
        mark = ", ".join(marks)
        rows.append(row(selection, case, kinds, keys, shown, followers, mark))
    columns = ["id", *kinds, *keys, *shown, *followers, "valid", "wall_s", "status", "note"]
    body = (f'{tools(selection, figures)}<div class="scroll tall" tabindex="0"><table class="sortable">{head(selection, columns)}'
            f'<tbody>{"".join(rows)}</tbody></table></div>')
    listed = "".join(f'<li id="note-{n}">{html.escape(w)}</li>' for w, n in notes.items())
    warning = caution(selection)
    return (body + (f'<ol class="notes">{listed}</ol>' if notes else "")
            + (f'<p class="counts">{html.escape(warning)}</p>' if warning else ""))
