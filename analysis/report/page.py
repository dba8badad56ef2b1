"""One HTML page that holds everything: figures inside, nothing fetched, everything escaped."""
import base64
import html
from collections import Counter
from datetime import datetime

import layout
import table
from summary import summary
from words import counted, number, value_text

CSS = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 52rem; padding: 1.5rem 1rem 4rem; background: #fff; color: #222;
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .4rem; font-weight: 650; }
h2 { font-size: 1.1rem; margin: 2.6rem 0 .5rem; font-weight: 650; }
p { margin: .5rem 0; overflow-wrap: anywhere; }
.lead { font-size: 1.08rem; }
.counts, figcaption, .notes, footer { color: #555; font-size: .9rem; }
figure { margin: 0; }
figure .scroll { margin-left: -.3rem; }
img { display: block; width: 100%; max-width: 730px; height: auto; }
figcaption { max-width: 44rem; margin-top: .3rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .82rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .55rem; text-align: left; vertical-align: bottom;
  border-bottom: 1px solid #e4e4e4; }
th { font-weight: 600; min-width: 5.6rem; max-width: 9rem; line-height: 1.35;
  border-bottom: 1.5px solid #888; }
td { white-space: nowrap; }
.n { text-align: right; }
td.empty { color: #999; }
tr.reference td { background: #f6f6f6; }
code, pre { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: .82rem; }
pre { overflow-x: auto; background: #f6f6f6; padding: .8rem; line-height: 1.4; }
.notes { padding-left: 1.4rem; overflow-wrap: anywhere; }
.trouble { border-left: 3px solid #D55E00; padding: .1rem 0 .1rem .9rem; }
.trouble ul { padding-left: 1.1rem; margin: .4rem 0; }
details { margin: .6rem 0; border-top: 1px solid #e4e4e4; padding-top: .6rem; }
summary { cursor: pointer; font-weight: 600; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; font-size: .9rem; }
dt { color: #555; } dd { margin: 0; overflow-wrap: anywhere; }
a { color: #0072B2; }
.hint { display: none; }
@media (max-width: 700px) { figure img { min-width: 32rem; } body { padding-top: 1rem; }
  .hint { display: block; color: #555; font-size: .9rem; } }
"""

FACTS = [("program", "program"), ("git id", "git_id"), ("compiler", "compiler"),
         ("build", "build_type"), ("MPI", "mpi_version"), ("FFTW", "fftw_version"),
         ("HDF5", "hdf5_version"), ("host", "host"), ("ranks a case", "ranks")]


def escape(words):
    return html.escape(str(words))


def counts(sweep):
    """'8 cases: 7 swept, 1 reference; 8 complete.'"""
    by_status = Counter(c.status for c in sweep.cases)
    references = sum(c.is_reference for c in sweep.cases)
    parts = [f"{n} {status}" for status, n in by_status.most_common()]
    kinds = f" (of them {counted(references, 'reference')})" if references else ""
    return f"{counted(len(sweep.cases), 'case')}{kinds}: {', '.join(parts)}."


def picture(figure, folder):
    data = base64.b64encode((folder / (figure.name + ".png")).read_bytes()).decode("ascii")
    return (f'<h2>{escape(figure.title)}</h2><figure id="{escape(figure.name)}">'
            f'<div class="scroll"><img alt="{escape(figure.alternative)}" '
            f'src="data:image/png;base64,{data}"></div>'
            f"<figcaption>{escape(figure.caption)}</figcaption></figure>")


def trouble(sweep, problems):
    """Cases without results and figures that could not be drawn, with their reasons."""
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
    rows.append(("seconds in all", number(sum(a.get("wall_s", 0.0) for a in whole), 3)))
    rows.append(("folder", sweep.folder.resolve().name))
    cells = "".join(f"<dt>{escape(n)}</dt><dd>{escape(v)}</dd>" for n, v in rows)
    return f"<details><summary>How it was computed</summary><dl>{cells}</dl></details>"


def job(sweep):
    if not sweep.job_text:
        return ""
    return f"<details><summary>The job</summary><pre>{escape(sweep.job_text)}</pre></details>"


def page(sweep, figures, folder, problems):
    lone = "" if sweep.x or not layout.ordinary(sweep) else (
        "<p>Nothing is swept, so there are no curves against a swept key.</p>")
    return "\n".join([
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(sweep.title)}</title><style>{CSS}</style></head><body>",
        f'<header><h1>{escape(sweep.title)}</h1><p class="lead">{escape(summary(sweep))}</p>',
        f'<p class="counts">{escape(counts(sweep))}</p>'
        '<p class="hint">Figures and the table scroll sideways.</p></header><main>', lone,
        *[picture(f, folder) for f in figures],
        "<h2>All cases</h2>", table.table(sweep), trouble(sweep, problems), "</main><footer>",
        job(sweep), provenance(sweep), "</footer></body></html>\n"])
