# SPDX-License-Identifier: BSD-3-Clause
"""The sortable table of the page, with the main columns of the table of `shearwake reduce`."""
import html
import math

import layout
import wake
from words import number, value_text


def measures(sweep):
    """The columns that the table of measures (src/measures/measure_table.cpp) lists for the page; columns of
    shapes only if the focus draws a shape, not a straight line."""
    shapes = not all(wake.runs_straight_on(c) for c in layout.ordinary(sweep))
    return [c["name"] for c in sweep.columns
            if c["shown"] == "page" or (c["shown"] == "shapes" and shapes)]


def numeric_cell(amount):
    if amount is None or math.isnan(amount):
        return '<td class="n empty">–</td>'
    return f'<td class="n" data-v="{amount:.9g}" title="{amount:.9g}">{number(amount)}</td>'


def setting_cell(case, key):
    setting = case.settings.get(key)
    if isinstance(setting, str):
        return f'<td title="{html.escape(setting)}">{html.escape(value_text(key, setting))}</td>'
    return numeric_cell(math.nan if setting is None else float(setting))


def head(columns):
    cells = ""
    for column in columns:
        kind = "" if column in ("id", "reference", "status") else ' class="n"'
        words = html.escape(column).replace("_", "_<wbr>").replace(".", ".<wbr>")
        cells += f'<th scope="col"{kind}><button type="button">{words}</button></th>'
    return f"<thead><tr>{cells}</tr></thead>"


def table(sweep):
    """The table and, below it, the notes to which its last column refers."""
    keys = layout.axes(sweep)
    followers = [k for k in sweep.swept_keys if k not in keys]  # zipped with other keys; placed at the end
    shown = measures(sweep)
    notes, rows = {}, []
    for case in sweep.cases:
        words = case.reason
        mark = ""
        if words:
            n = notes.setdefault(words, len(notes) + 1)
            mark = f'<a href="#note-{n}">{n}</a>'
        cells = [f'<td><code>{html.escape(case.id)}</code></td>',
                 f'<td>{"yes" if case.is_reference else ""}</td>']
        cells += [setting_cell(case, k) for k in keys]
        cells += [numeric_cell(case.value(m)) for m in shown]
        cells += [setting_cell(case, k) for k in followers]
        cells += [numeric_cell(case.wall_s),
                  f"<td>{html.escape(case.status)}</td>", f'<td class="n">{mark}</td>']
        kind = ' class="reference"' if case.is_reference else ""
        rows.append(f"<tr{kind}>{''.join(cells)}</tr>")
    columns = ["id", "reference", *keys, *shown, *followers, "wall_s", "status", "note"]
    body = ('<p class="counts">Select a heading to sort by its column; select it again to reverse the order.</p>'
            f'<div class="scroll tall" tabindex="0"><table class="sortable">{head(columns)}'
            f'<tbody>{"".join(rows)}</tbody></table></div>')
    listed = "".join(f'<li id="note-{n}">{html.escape(w)}</li>' for w, n in notes.items())
    return body + (f'<ol class="notes">{listed}</ol>' if notes else "")
