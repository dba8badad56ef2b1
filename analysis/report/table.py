"""The compact table of the page: the columns of `shearwake reduce`'s Markdown table."""
import html
import math

import layout
import wake
from words import number, value_text

MEASURES = [  # and every share_..._1
    "eta_at_1", "eta_period_1", "eta_period_over_reference_1", "ipr_at_1", "ipr_period_1",
    "ipr_abs_period_mm2", "participation_period_mm2", "peak_um", "focal_rms_um",
    "focal_rms_over_reference_1", "impulse_mN_ms", "peak_frequency_Hz", "rms_40_400_um",
    "mach_angle_deg",
]
SHAPES = "sharpness_1"  # where a shape is drawn and no line crossed once
RATIOS = {"eta_period_over_reference_1": "eta_period_1",
          "focal_rms_over_reference_1": "focal_rms_um"}


def value(sweep, case, column):
    """A measure, or its ratio to the reference."""
    if column not in RATIOS:
        return case.value(column)
    reference = sweep.by_id(case.reference_id) if case.reference_id else None
    below = reference.value(RATIOS[column]) if reference else math.nan
    return case.value(RATIOS[column]) / below if below else math.nan


def note(case):
    """Why cells are empty, columns of one reason together; or why the whole row is."""
    if not case.whole:
        return case.reason
    by_reason = {}
    for column, reason in case.notes.items():
        if math.isnan(case.value(column)):
            by_reason.setdefault(reason, []).append(column)
    return "; ".join(f"{', '.join(columns)}: {reason}" for reason, columns in by_reason.items())


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
    """The table and, below it, the notes that its last column numbers."""
    keys = layout.axes(sweep)
    followers = [k for k in sweep.swept_keys if k not in keys]  # zipped with them: at the end
    held = dict.fromkeys(name for c in sweep.cases for name in c.scalars)
    measures = [m for m in MEASURES if RATIOS.get(m, m) in held]
    measures += [name for name in held if name.startswith(("share_", "velocity_"))]
    if SHAPES in held and not all(wake.runs_straight_on(c) for c in layout.ordinary(sweep)):
        measures.append(SHAPES)
    notes, rows = {}, []
    for case in sweep.cases:
        words = note(case)
        mark = ""
        if words:
            n = notes.setdefault(words, len(notes) + 1)
            mark = f'<a href="#note-{n}">{n}</a>'
        cells = [f'<td><code>{html.escape(case.id)}</code></td>',
                 f'<td>{"yes" if case.is_reference else ""}</td>']
        cells += [setting_cell(case, k) for k in keys]
        cells += [numeric_cell(value(sweep, case, m)) for m in measures]
        cells += [setting_cell(case, k) for k in followers]
        wall = case.attributes.get("wall_s", math.nan) if case.whole else math.nan
        cells += [numeric_cell(wall),
                  f"<td>{html.escape(case.status)}</td>", f'<td class="n">{mark}</td>']
        kind = ' class="reference"' if case.is_reference else ""
        rows.append(f"<tr{kind}>{''.join(cells)}</tr>")
    columns = ["id", "reference", *keys, *measures, *followers, "wall_s", "status", "note"]
    body = ('<p class="counts">A heading sorts by its column, once more the other way round.</p>'
            f'<div class="scroll tall" tabindex="0"><table class="sortable">{head(columns)}'
            f'<tbody>{"".join(rows)}</tbody></table></div>')
    listed = "".join(f'<li id="note-{n}">{html.escape(w)}</li>' for w, n in notes.items())
    return body + (f'<ol class="notes">{listed}</ol>' if notes else "")
