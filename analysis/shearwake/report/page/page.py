# SPDX-License-Identifier: BSD-3-Clause
"""Writes one HTML page that contains all figures, loads nothing from elsewhere, and escapes all text."""
from __future__ import annotations

import html
from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import Any

from ... import stored
from ...script_json import script_json
from .. import answer, labels, layout, optima, thinning, warnings_of
from ..figure import Figure
from ..load import Selection
from ..numerical_error import valid
from ..summary import summary
from ..words import counted, number
from . import opening, player, table
from .topics import headlines, topics

HERE = Path(__file__).resolve().parent
CHANGED = " # -S; "  # begins the comment at a value of the command line (src/config/sweep/override.cpp)
FACTS = [("program", "program"), ("git id", "git_id"), ("compiler", "compiler"),
         ("build", "build_type"), ("MPI", "mpi_version"), ("FFTW", "fftw_version"),
         ("HDF5", "hdf5_version"), ("host", "host"), ("ranks per case", "ranks")]


def escape(text: str) -> str:
    return html.escape(str(text))


def counts(selection: Selection) -> str:
    """For example '8 cases, 1 of them a reference: 8 complete.'"""
    by_status = Counter(c.status for c in selection.cases)
    parts = [f"{n} {status}" for status, n in by_status.most_common()]
    return f"{layout.count_of(selection.cases)}: {', '.join(parts)}."


def folded(name: str, title: str, count: str, inner: str, state: str = "") -> str:
    """A section of the page that is closed unless `state` is "open"."""
    return (f'<details class="topic" id="{name}"{" " + state if state else ""}><summary><h2>{escape(title)}</h2> '
            f"<span>{escape(count)}</span></summary>{inner}</details>")


def losses(selection: Selection) -> str:
    """The first lines of the page, such as "1 of 10,000 cases failed: out of memory."; '' if all cases are complete."""
    lost = [case for case in selection.cases if not case.is_complete]
    lines = []
    for status, count in Counter(case.status for case in lost).most_common():
        reasons = list(dict.fromkeys(case.reason.rstrip(".") for case in lost if case.status == status))
        more = f" and {counted(len(reasons) - 1, 'further reason')}" if len(reasons) > 1 else ""
        state = status if status == "failed" else f"{'is' if count == 1 else 'are'} {status}"
        lines.append(f"{count:,} of {len(selection.cases):,} cases {state}: {reasons[0]}{more}.")
    return "".join(f'<p class="badge"><a href="#missing">{escape(line)}</a></p>' for line in lines)


def notices(selection: Selection, problems: list[Any]) -> str:
    """One line below the result that counts what is missing or doubtful, with links; '' if nothing is."""
    links = []
    if missing := sum(not case.is_complete for case in selection.cases):
        links.append(f'<a href="#missing">{counted(missing, "case")} without a result</a>')
    if problems:
        links.append(f'<a href="#missing">{counted(len(problems), "group")} of figures not drawn</a>')
    if found := warnings_of.kinds(selection):
        invalid = {case.id for kind in found if kind.is_error for case in kind.cases}
        wrong = f", {counted(len(invalid), 'case')} not valid" if invalid else ""
        links.append(f'<a href="#warnings">{counted(len(found), "warning")}{wrong}</a>')
    return f'<p class="badge">See also: {"; ".join(links)}.</p>' if links else ""


def warning_list(selection: Selection, state: str = "") -> str:
    """All warnings of the sweep, once each, with the number of cases; '' without warnings."""
    items = ""
    for kind in warnings_of.kinds(selection):
        start = "Not valid" if kind.is_error else "Warning"
        where = ""
        if len(kind.cases) > 1:
            where = f" ({layout.count_of(kind.cases)})"
        elif len(selection.cases) > 1:
            where = f" ({layout.case_label(selection, kind.cases[0])})"
        items += f'<li id="warning-{kind.number}">{escape(f"{start}: {kind.message}{where}.")}</li>'
    count = counted(items.count("<li "), "warning")
    return folded("warnings", "Warnings", count, f'<ol class="warning">{items}</ol>', state) if items else ""


def badge(found: list[warnings_of.Kind], shown: int, stated: set[int]) -> str:
    """A line with the warnings of those cases that a figure shows, with links to the list: what is not valid at each figure, other
    warnings at the first figure that they concern. `stated`: the numbers of these, to which those of the line are added."""
    new = [kind for kind in found if kind.is_error or kind.number not in stated]
    stated |= {kind.number for kind in new}
    if not new:
        return ""
    names = Counter(kind.name() for kind in new)
    links = [f'<a href="#warning-{kind.number}"' + (f' title="{escape(kind.message)}"' if kind.is_error else "")
             + f">{escape(kind.name() + (f', warning {kind.number}' if names[kind.name()] > 1 else ''))}</a>" + (f" ({escape(layout.count_of(kind.cases))})" if shown > 1 else "") for kind in new]
    return f'<p class="badge">{"Warning" if len(new) == 1 else "Warnings"} about the cases shown: {"; ".join(links)}.</p>'


def json_script(data: list[dict[str, Any]]) -> str:
    return f'<script type="application/json">{script_json(data)}</script>'


def picture(figure: Figure, level: str, stated: set[int]) -> str:
    """A figure with its heading: interactive if it has charts, else as picture. Without JavaScript interactive figures
    are pictures of half the resolution."""
    name = escape(figure.name)
    still = (f'<div class="scroll"><img alt="{escape(figure.alternative)}" '
             f'src="data:image/webp;base64,{figure.still}"></div>')
    shown = still
    if figure.maps:
        shown = (f'<div class="maps" id="maps-{name}">{still}{json_script(figure.maps)}<output>Point at a picture to read '
                 "its values.</output></div>")
    if figure.charts:
        shown = (f'<div class="chart" id="chart-{name}">{json_script(figure.charts)}</div>'
                 f"<noscript>{still}</noscript>")
    return (f'<{level} id="{name}">{escape(figure.title)}</{level}><figure>{shown}'
            f"{badge(figure.warnings, len(figure.cases or []), stated)}<figcaption>{escape(figure.caption)}</figcaption>"
            f'<p class="files">For papers, next to this page: <a href="{name}.png">{name}.png</a>, '
            f'<a href="{name}.pdf">{name}.pdf</a></p></figure>')


def problem_list(selection: Selection, problems: list[Any], state: str = "") -> str:
    """The cases without results and the figures that could not be drawn, with their reasons."""
    items = []
    for case in thinning.missing(selection):
        label = f"{case.id}{' (reference)' if case.is_reference else ''} {labels.settings_text(selection, case)}".strip()
        items.append(f"<li><b>{escape(case.status)}</b> <code>{escape(label)}</code>: "
                     f"{escape(case.reason)}</li>")
    more = sum(not case.is_complete for case in selection.cases) - len(items)
    items += [f"<li>{counted(more, 'more case')} without a result</li>"] if more else []
    items += [f"<li>{escape(p)}</li>" for p in problems]
    if not items:
        return ""
    return folded("missing", "Not in the figures", counted(len(items) + max(0, more - 1), "item"),
                  f'<div class="problems"><ul>{"".join(items)}</ul></div>', state)


def moment(stamp: str) -> str:
    try:
        return datetime.strptime(stamp, "%Y-%m-%dT%H:%M:%SZ").strftime("%Y-%m-%d %H:%M:%S UTC")
    except ValueError:
        return stamp


def provenance(selection: Selection) -> str:
    every = [c for c in selection.cases if c.is_complete]
    names = [*(attribute for _, attribute in FACTS), "started", "ended"]
    complete = [stored.attributes(c.path, names) for c in thinning.listed(selection) if c.is_complete]
    rows = [] if len(complete) == len(every) else [("read from", f"{len(complete)} of {counted(len(every), 'case file')}")]
    for name, attribute in FACTS:
        values = list(dict.fromkeys(str(a[attribute]) for a in complete if attribute in a))
        if values:
            rows.append((name, ", ".join(values)))
    started = sorted(a["started"] for a in complete if "started" in a)
    ended = sorted(a["ended"] for a in complete if "ended" in a)
    if started and ended:
        rows.append(("computed", f"{moment(started[0])} to {moment(ended[-1])}"))
    rows.append(("total time (s)", number(sum(c.wall_s for c in every), 3)))
    rows.append(("folder", selection.sweep.folder.resolve().name))
    rows.append(("interactive figures", f"uPlot {read('uplot/VERSION').strip()}, MIT licence"))
    cells = "".join(f"<dt>{escape(n)}</dt><dd>{escape(v)}</dd>" for n, v in rows)
    return f"<details><summary>Provenance</summary><dl>{cells}</dl></details>"


def job(selection: Selection) -> str:
    if not selection.sweep.job_text:
        return ""
    lines = escape(selection.sweep.job_text).splitlines()
    changed = sum(CHANGED in line for line in lines)
    title = f"Job file, with {counted(changed, 'value')} of the command line (-S)" if changed else "Job file"
    text = "\n".join(f"<mark>{line}</mark>" if CHANGED in line else line for line in lines)
    return f"<details><summary>{title}</summary><pre>{text}</pre></details>"


def read(name: str) -> str:
    """A file of this folder that becomes part of the page."""
    return (HERE / name).read_text(encoding="utf-8")


def scripts() -> str:
    """uPlot with its licence, and the scripts of the page."""
    uplot = read("uplot/uPlot.iife.min.js").partition("*/")[2]  # without the comment with its address
    licence = read("uplot/LICENSE").replace("*/", "")
    own = "\n".join(read(name) for name in ("charts.js", "maps.js", "page.js", "player.js"))
    return f"<script>/* uPlot {read('uplot/VERSION').strip()}\n{licence}*/{uplot}</script><script>{own}</script>"


def anchor(title: str) -> str:
    return "topic-" + "-".join(title.lower().split())


def parts(selection: Selection, figures: list[Figure], problems: list[Any], moving: str) -> list[tuple[str, str, str, list[Any]]]:
    """The parts of the page in their order: (id, title in the contents, HTML, links within)."""
    made: list[Any] = []
    stated: set[int] = set()  # warnings
    asked = answer.column(selection)
    receptors_first = bool(layout.receptor_classes(selection)) and (asked.endswith(warnings_of.RATE) or not valid(selection, "eta_period_1"))
    first = headlines(figures, receptors_first, asked.startswith("felt_"))
    drawn = [f for f in first if f.name == "optimise_mean"]  # the wake at one instant hardly shows which shape is drawn
    made += [(f.name, f.title, picture(f, "h2", stated), []) for f in drawn]
    if moving:
        shown = [c.id for c in player.cases_of(selection)]
        notice = badge(warnings_of.of_figure(selection, "player", shown), len(shown), stated)
        plane = layout.plane_name(player.cases_of(selection))
        title = f"{plane[:1].upper()}{plane[1:]} seen from above"
        made.append(("player", title, f'<h2 id="player">{escape(title)}</h2>{notice}{moving}', []))
    made += [(f.name, f.title, picture(f, "h2", stated), []) for f in first if f not in drawn]
    if optima.is_study(selection):
        made.append(("optima", "Optima", f'<h2 id="optima">Optima</h2>{optima.section(selection)}', []))
    state = "" if made else "open"
    if notice := problem_list(selection, problems, state):
        made.append(("missing", "Not in the figures", notice, []))
    if listed := warning_list(selection, state):
        made.append(("warnings", "Warnings", listed, []))
    for title, members in topics(figures, first):
        inner = "".join(picture(f, "h3", stated) for f in members)
        made.append((anchor(title), title, folded(anchor(title), title, counted(len(members), "figure"), inner),
                     [(f.name, f.title) for f in members]))
    title = "Cases" if thinning.sentence(selection) else "All cases"
    made.append(("table", title, f'<h2 id="table">{title}</h2>{table.table(selection, figures)}', []))
    return made


def contents(made: list[tuple[str, str, str, list[Any]]]) -> str:
    """Links to all parts of the page in its order; the links of a topic are folded."""
    items = ""
    for name, title, _, within in made:
        items += f'<li><a href="#{escape(name)}">{escape(title)}</a>'
        if within:
            inner = "".join(f'<li><a href="#{escape(n)}">{escape(t)}</a></li>' for n, t in within)
            items += f"<details><summary>{counted(len(within), 'figure')}</summary><ul>{inner}</ul></details>"
        items += "</li>"
    return f'<nav aria-label="contents"><details class="contents" open><summary>On this page</summary><ul>{items}</ul></details></nav>'


def head(selection: Selection) -> str:
    """The question, the answer, three numbers, and the rest of the summary."""
    asked, (first, others) = answer.question(selection), opening.first_sentence(summary(selection))
    if "plain STM" in first:
        others = f"Plain STM (spatiotemporal modulation): the focus moves along its path at constant speed and strength. {others}"
    items = ""
    for value, meaning, versus in opening.numbers(selection):
        items += (f"<div><dt>{escape(meaning)}</dt><dd><b>{escape(value)}</b></dd>"
                  + (f"<dd>{escape(versus)}</dd>" if versus else "") + "</div>")
    if items:
        items = f'<dl class="numbers">{items}</dl>'
    return (f"<h1>{escape(selection.sweep.title or selection.sweep.name)}</h1>" + (f'<p class="question">{escape(asked)}</p>' if asked else "")
            + f'<p class="lead">{escape(first)}</p>{items}<p class="counts">{escape(others)} {escape(counts(selection))}</p>')


def page(selection: Selection, figures: list[Figure], problems: list[str], moving: str = "") -> str:
    lone = "" if selection.x or not layout.ordinary(selection) else (
        "<p>The job sweeps no key, so there are no curves over a swept key.</p>")
    made = parts(selection, figures, problems, moving)
    return "\n".join([
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(selection.sweep.title or selection.sweep.name)}</title><style>{read('uplot/uPlot.min.css')}\n{read('page.css')}</style>"
        "</head><body>",
        f'<a class="skip" href="#results">Skip to the results</a><header>{losses(selection)}{head(selection)}{notices(selection, problems)}</header>',
        f'<div class="columns">{contents(made)}<main id="results">', lone, *(content for _, _, content, _ in made),
        "</main></div><footer>", job(selection), provenance(selection), "</footer>", scripts(), "</body></html>\n"])
