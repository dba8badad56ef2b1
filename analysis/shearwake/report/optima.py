# SPDX-License-Identifier: BSD-3-Clause
"""The results of `shearwake optimise` in words and tables: the first sentence of the page, the optima with their upper bounds,
and their robustness."""
from __future__ import annotations

import csv
import html
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..case import Case
from ..keys import follows
from ..tables import Optima
from . import layout
from .answer import quantity
from .load import Selection, bilinear, mean_square
from .warnings_of import is_valid
from .words import number, value_text

COMPARED = (("no modulation", "unmodulated"), ("best AM-STM", "am"), ("best SM-STM tried", "sm"), ("optimum found", "optimum"))


def optima(selection: Selection) -> Any:
    return Optima(selection.sweep.folder)


def is_study(selection: Selection) -> bool:
    return optima(selection).exists


def by_case(selection: Selection) -> dict[str, list[dict[str, Any]]]:
    """{id of the optimised case: rows}."""
    found: dict[str, Any] = {}
    for row in optima(selection).rows:
        found.setdefault(row["case"], []).append(row)
    return found


def swept(row: dict[str, Any]) -> list[str]:
    """The swept keys: the columns before the strength."""
    names = list(row)
    return names[1:names.index("strength_at_least_1")]


def title_of(selection: Selection, row: dict[str, Any]) -> str:
    """The swept values of an optimised case, without those that follow from the values before them."""
    rows = optima(selection).rows
    keys: list[str] = []
    for key in swept(row):
        if len({r[key] for r in rows}) > 1 and not any(follows(rows, key, other) for other in keys):
            keys.append(key)
    return ", ".join(_value(selection, key, row[key]) for key in keys) or "the case of the job"


def _value(selection: Selection, key: str, text: str) -> str:
    """A number with its key, and other values alone: 'periodic', 'focus speed 7 m/s'."""
    try:
        return layout.setting_text(selection, key, float(text))
    except ValueError:
        return value_text(key, text)


def middle(rows: list[dict[str, Any]]) -> float:
    """The strength that is shown where only one is."""
    return rows[(len(rows) - 1) * 2 // 3]["strength_at_least_1"]


def words(column: str) -> str:
    """The maximised column in words."""
    return {"eta_period_1": "efficiency η"}.get(column, column)


def invalid(selection: Selection) -> set[str]:
    """Which modulations of the case that the sentence names have readings that are not valid."""
    rows = next(iter(by_case(selection).values()))
    return {name for name, case in compared(selection, rows, middle(rows)).items() if not is_valid(case)}


def relation(ratio: float) -> str:
    times = number(ratio, 3)
    return "the same as that of" if times == "1" else f"{times} times that of"


def compared(selection: Selection, rows: list[dict[str, Any]], strength: float) -> dict[str, Case]:
    """{modulation: case} of one optimised case and strength, unmodulated first. A case that several strengths share has
    the settings of the first one."""
    ordinary = [c for c in layout.ordinary(selection)
                if all(str(c.settings.get(key)) == rows[0][key] or c.settings.get(key) == rows[0][key] for key in swept(rows[0]))]
    found: dict[str, Any] = {}
    for name in ("unmodulated", "AM-STM", "SM-STM", "optimum"):
        of = [c for c in ordinary if c.settings.get("optimise.modulation") == name]
        exact = [c for c in of if c.settings.get("optimise.strength_at_least") == strength]
        if exact or (of and name != "optimum"):
            found[name] = (exact or of)[0]
    return found


def sentence(selection: Selection) -> str:
    """The result for the first case, and how close all optima are to their upper bounds."""
    rows = next(iter(by_case(selection).values()))
    row = next(r for r in rows if r["strength_at_least_1"] == middle(rows))
    wrong = invalid(selection)
    if "optimum" in wrong:
        return "No optimum is stated, because its readings are not valid."
    best, of = row["eta_optimum_1"], quantity(selection, optima(selection).maximised)
    where = f"{title_of(selection, row)}, strength {number(row['strength_at_least_1'], 3)}" if swept(row) else (
        f"strength {number(row['strength_at_least_1'], 3)}")
    if least := optima(selection).uniformity:
        where += f", uniformity at least {number(least, 3)}"
    others = [f"{relation(best / row[f'eta_{name}_1'])} {text} ({of.text(row[f'eta_{name}_1'])}"
              + (f", strength {number(row[f'strength_{name}_1'], 3)})" if name == "sm" else ")")
              for text, name, modulation in (("the load without modulation", "unmodulated", "unmodulated"),
                                             ("the best AM-STM", "am", "AM-STM"), ("the best SM-STM tried", "sm", "SM-STM"))
              if row[f"eta_{name}_1"] > 0 and modulation not in wrong]
    gaps = [r["ceiling_over_optimum_1"] for r in optima(selection).rows]
    more = (f"In all {len(gaps)} optima, the bound is {number(min(gaps), 3)} to {number(max(gaps), 3)} times the optimum."
            if len(gaps) > 1 else "")
    return (f"{of.title} of the optimum ({where}) is {of.text(best)}{': ' if others else ''}{', '.join(others)}. The upper bound for its "
            f"path is {of.text(row['eta_ceiling_1'])}, {number(row['ceiling_over_optimum_1'], 3)} times the optimum. {more}").rstrip()


@dataclass
class AlongPath:
    """The rms of u over time along the drawn path: distances in mm, values in um, and the smallest relative to their mean."""
    distance_mm: np.ndarray
    rms_um: np.ndarray

    @property
    def uniformity(self) -> float:
        return float(self.rms_um.min() / self.rms_um.mean())


def along_path(case: Case) -> AlongPath | None:
    """None if the case has no mean over periods or the focus rests."""
    found = mean_square(case)
    if found is None:
        return None
    x, y, squared, lines = found
    points = np.concatenate([line for line in lines if len(line) > 1] or [np.empty((0, 2))])
    value = bilinear(x, y, squared, *points.T)
    inside = np.isfinite(value)
    if inside.sum() < 2 or not value[inside].any():
        return None
    distance = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return AlongPath(1e3 * distance[inside], 1e6 * np.sqrt(value[inside]))


def cell(value: float | str) -> str:
    if isinstance(value, str):
        return f"<td>{html.escape(value)}</td>"
    return f'<td class="n" title="{value:.9g}">{number(value, 4)}</td>' if not math.isnan(value) else '<td class="n empty">–</td>'


def table(names: list[str], rows: list[list[float | str]]) -> str:
    head = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in names)
    body = "".join(f"<tr>{''.join(cell(v) for v in row)}</tr>" for row in rows)
    return f'<div class="scroll" tabindex="0"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def results(selection: Selection) -> str:
    names = ["case", "strength at least", *(text for text, _ in COMPARED), "strength of SM-STM", "upper bound", "bound / optimum"]
    exported = any("eta_exported_1" in row for row in optima(selection).rows)
    names += ["exported", "its strength"] if exported else []
    uniform = [(text, f"uniformity_{name}_1") for text, name in COMPARED] + [("exported", "uniformity_exported_1")] * exported
    rows = [[title_of(selection, r), r["strength_at_least_1"], *(r[f"eta_{name}_1"] for _, name in COMPARED), r["strength_sm_1"],
             r["eta_ceiling_1"], r["ceiling_over_optimum_1"],
             *((r["eta_exported_1"], r["strength_exported_1"]) if exported else ())] for r in optima(selection).rows]
    along = [[title_of(selection, r), r["strength_at_least_1"], *(r.get(column, math.nan) for _, column in uniform)]
             for r in optima(selection).rows]
    return table(names, rows) + "<h3>Uniformity along the path</h3>" + table([*names[:2], *(text for text, _ in uniform)], along)


def robustness(selection: Selection) -> str:
    """Each optimum in other tissues and at other speeds; '' if these were not computed."""
    path = optima(selection).folder / "robustness.csv"
    if not path.is_file():
        return ""
    with open(path, newline="", encoding="utf-8") as file:
        read = list(csv.DictReader(file))
    columns = ("strength_at_least_1", "eta_unmodulated_1", "eta_found_1", "found_over_unmodulated_1", "strength_1")
    cases = {rows[0]["case"]: title_of(selection, rows[0]) for rows in by_case(selection).values()}

    def difference(text: str) -> Any:
        return f"tissue of: {cases[text.split()[-1]]}" if text.split()[-1] in cases else text
    rows = [[cases[r["case"]], difference(r["difference"]), *(float(r[c] or "nan") for c in columns)] for r in read]
    names = ["optimised for", "difference", "strength at least", "no modulation", "the same envelope", "relative to no modulation",
             "strength"]
    return f"<h3>The same envelopes in other tissues and at other speeds</h3>{table(names, rows)}"


def section(selection: Selection) -> str:
    """The tables of the page."""
    note = ("<p>The strength is the rms over the focal disc, relative to that without modulation. All columns without "
            f"another name are the {html.escape(words(optima(selection).maximised))}. The optimum is the best of a local search from several starts. The upper bound "
            "is a proof for all envelopes from 0 to 1 that are linear between the knots (scripts/verify_certificate.py verifies it), on the same path and at the same "
            "speed as the optimum. The uniformity is the smallest rms over time along the path relative to its mean: an optimum "
            "with a small uniformity leaves gaps in the drawn shape.</p>")
    return note + results(selection) + robustness(selection)
