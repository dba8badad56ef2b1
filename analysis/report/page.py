# SPDX-License-Identifier: BSD-3-Clause
"""Writes one HTML page that contains all figures, loads nothing from elsewhere, and escapes all text."""
import base64
import html
from collections import Counter
from datetime import datetime
from pathlib import Path

import layout
import table
from summary import summary
from words import counted, number, value_text


HERE = Path(__file__).resolve().parent
FACTS = [("program", "program"), ("git id", "git_id"), ("compiler", "compiler"),
         ("build", "build_type"), ("MPI", "mpi_version"), ("FFTW", "fftw_version"),
         ("HDF5", "hdf5_version"), ("host", "host"), ("ranks per case", "ranks")]


def escape(text):
    return html.escape(str(text))


def counts(sweep):
    """For example '8 cases (of them 1 reference): 8 complete.'"""
    by_status = Counter(c.status for c in sweep.cases)
    references = sum(c.is_reference for c in sweep.cases)
    parts = [f"{n} {status}" for status, n in by_status.most_common()]
    kinds = f" (of them {counted(references, 'reference')})" if references else ""
    return f"{counted(len(sweep.cases), 'case')}{kinds}: {', '.join(parts)}."


def warnings(figure):
    """The warnings about the cases of a figure."""
    return "".join(f'<p class="warning">{escape(w)}</p>' for w in figure.warnings)


def picture(figure, folder):
    data = base64.b64encode((folder / (figure.name + ".png")).read_bytes()).decode("ascii")
    return (f'<h2 id="{escape(figure.name)}">{escape(figure.title)}</h2><figure>'
            f'<div class="scroll"><img alt="{escape(figure.alternative)}" '
            f'src="data:image/png;base64,{data}"></div>'
            f"{warnings(figure)}<figcaption>{escape(figure.caption)}</figcaption>"
            f'<p class="files">{escape(figure.name)}.png, {escape(figure.name)}.pdf</p></figure>')


def trouble(sweep, problems):
    """The cases without results and the figures that could not be drawn, with their reasons."""
    items = []
    for case in sweep.cases:
        if not case.whole:
            settings = ", ".join(value_text(k, v) for k, v in case.settings.items())
            label = f"{case.id}{' (reference)' if case.is_reference else ''} {settings}".strip()
            items.append(f"<li><b>{escape(case.status)}</b> <code>{escape(label)}</code>: "
                         f"{escape(case.reason)}</li>")
    items += [f"<li>{escape(p)}</li>" for p in problems]
    if not items:
        return ""
    return f'<h2>Not in the figures</h2><div class="trouble"><ul>{"".join(items)}</ul></div>'


def moment(stamp):
    try:
        return datetime.strptime(stamp, "%Y-%m-%dT%H:%M:%SZ").strftime("%Y-%m-%d %H:%M:%S UTC")
    except ValueError:
        return stamp


def provenance(sweep):
    whole = [c.attributes for c in sweep.cases if c.whole]
    rows = []
    for name, attribute in FACTS:
        values = list(dict.fromkeys(str(a[attribute]) for a in whole if attribute in a))
        if values:
            rows.append((name, ", ".join(values)))
    started = sorted(a["started"] for a in whole if "started" in a)
    ended = sorted(a["ended"] for a in whole if "ended" in a)
    if started and ended:
        rows.append(("computed", f"{moment(started[0])} to {moment(ended[-1])}"))
    rows.append(("total time (s)", number(sum(a.get("wall_s", 0.0) for a in whole), 3)))
    rows.append(("folder", sweep.folder.resolve().name))
    cells = "".join(f"<dt>{escape(n)}</dt><dd>{escape(v)}</dd>" for n, v in rows)
    return f"<details><summary>Provenance</summary><dl>{cells}</dl></details>"


def job(sweep):
    if not sweep.job_text:
        return ""
    return f"<details><summary>Job file</summary><pre>{escape(sweep.job_text)}</pre></details>"


def read(name):
    """A file of this folder that becomes part of the page."""
    return (HERE / name).read_text(encoding="utf-8")


def body(figures, folder, moving):
    """The figures, with the player of the surface before its snapshots."""
    parts = [picture(f, folder) for f in figures]
    names = [f.name for f in figures]
    parts.insert(names.index("surface") if "surface" in names else len(parts), moving)
    return parts


def contents(figures, moving):
    """Links to all parts of the page."""
    links = [(f.name, f.title) for f in figures]
    if moving:
        links.append(("player", "The surface over time"))
    links.append(("table", "All cases"))
    items = "".join(f'<li><a href="#{escape(n)}">{escape(t)}</a></li>' for n, t in links)
    return f"<details><summary>On this page</summary><ul>{items}</ul></details>"


def page(sweep, figures, folder, problems, moving=""):
    lone = "" if sweep.x or not layout.ordinary(sweep) else (
        "<p>The job sweeps no key, so there are no curves over a swept key.</p>")
    return "\n".join([
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(sweep.title)}</title><style>{read('page.css')}</style></head><body>",
        f'<header><h1>{escape(sweep.title)}</h1><p class="lead">{escape(summary(sweep))}</p>',
        f'<p class="counts">{escape(counts(sweep))}</p>'
        '<p class="hint">Figures and the table can be scrolled sideways.</p>',
        contents(figures, moving), "</header><main>", lone,
        trouble(sweep, problems), *body(figures, folder, moving),
        '<h2 id="table">All cases</h2>', table.table(sweep), "</main><footer>",
        job(sweep), provenance(sweep), "</footer>",
        f'<script>{read("page.js")}</script></body></html>\n'])
