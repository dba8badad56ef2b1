# SPDX-License-Identifier: BSD-3-Clause
"""The opening of the page: the answer and three numbers."""
from __future__ import annotations

import math

from ...case import Case
from ...tables import read_statistics
from .. import answer, layout, optima, sample, summary
from ..caveats import is_incomplete
from ..load import Selection
from ..numerical_error import sweeps_numbers_only
from ..places import NAMED, named, where
from ..ranking import rank, reference_for
from ..warnings_of import RATE
from ..words import number

MEANINGS = {"eta_period_1": "of the energy is at the focus (η)", "felt_path_dB": "level of sensation on the path (0 dB: threshold)",
            "focal_rms_um": "rms of the displacement at the focus (strength)",
            "participation_period_mm2": "area that vibrates (spread)"}
Number = tuple[str, str, str]  # value, meaning, comparison


def meaning(of: answer.Quantity) -> str:
    if of.column.endswith(RATE):
        return f"of all {of.column.removesuffix(RATE)} afferents together"
    return MEANINGS.get(of.column, of.name + (" (0 dB: threshold)" if of.is_level else ""))


def first_sentence(text: str) -> tuple[str, str]:
    """The first sentence of a summary, and the others."""
    first, *others = answer.SENTENCE.split(text, maxsplit=1)
    return first, "".join(others)


def of_case(selection: Selection, case: Case, column: str, place: str = "") -> Number:
    """A value of a case, where it is and what its reference has."""
    of = answer.quantity(selection, column)
    reference = reference_for(selection, case, column)
    versus = ""
    if reference and not column.endswith(RATE):
        name = summary.name_of(selection, case, reference)
        versus = f"{of.text(reference.value(column))} {name if name.startswith(('with ', 'without ')) else f'with {name}'}"
    return of.difference(case.value(column)), meaning(of), "; ".join(filter(None, [place, versus]))


def of_receptors(selection: Selection) -> list[Number]:
    """The largest rate of each class of receptors that fires, and where."""
    found: list[Number] = []
    for kind in layout.receptor_classes(selection):
        ranking = rank(selection, kind + RATE)
        if ranking.best and ranking.value(ranking.best):
            place = named(selection, ranking.equal) if len(ranking.cases) > len(ranking.equal) else ""
            found.append((ranking.quantity.difference(ranking.value(ranking.best)), meaning(ranking.quantity), place))
    return found


def of_answer(selection: Selection, column: str) -> list[Number]:
    """The value of the best case, or the range of cases that are not ranked or do not differ noticeably."""
    ranking = rank(selection, column)
    of, best = ranking.quantity, ranking.best
    if NAMED >= len(ranking.groups) > 1 and of.column == column:
        return [(summary.span(of, group), meaning(of), summary.group_words(selection, ranking, group))
                for group in ranking.groups]
    if best is None or (ranking.near and not ranking.others and len(ranking.cases) >= NAMED):
        return [(summary.span(of, ranking.cases), meaning(of), f"{len(ranking.cases)} cases")] if ranking.cases else []
    return [of_case(selection, best, of.column, summary.best_place(selection, ranking) if len(ranking.cases) > 1 else "")]


def of_samples(selection: Selection) -> list[Number]:
    """Probability, median and range of a job with [uncertain]."""
    median = sample.median(selection)
    if median is None:
        return []
    of, rows = median.quantity, median.rows[median.highest]
    if median.difference:
        return [(median.range, f"medians of {of.name}", f"{len(median.rows)} swept values")]
    place = sample.placed(selection, median.highest).strip()
    if median.is_highest and place:
        place += ", the highest median"
    found: list[Number] = []
    statistics = read_statistics(selection.sweep.folder, selection.sweep.name)
    for threshold, value in selection.sweep.uncertain["exceedance"].items():
        if likely := sample.likeliest(selection, statistics, threshold, value):
            where, row = likely
            doubt = f" ({row['note']})" if row["note"] else ""
            exceeded = answer.quantity(selection, threshold)
            found.append((f"{number(100 * row['low_95'], 2)} to {number(100 * row['high_95'], 2)}\u00a0%",
                          f"probability that {exceeded.name} exceeds {exceeded.difference(value)} (95 % confidence interval)",
                          sample.placed(selection, where).strip() + doubt))
    return [*found, (of.difference(rows["q50"]["value"]), f"median of {of.name}", place),
            (of.range(rows["q05"]["value"], rows["q95"]["value"]), f"{of.name} in 90 % of the samples", place)]


def of_optima(selection: Selection) -> list[Number]:
    """Efficiency, upper bound and strength of the optimum that the answer names."""
    rows = next(iter(optima.by_case(selection).values()))
    row = next(r for r in rows if r["strength_at_least_1"] == optima.middle(rows))
    of = answer.quantity(selection, optima.optima(selection).maximised)

    def plain(value: str) -> str:
        return "" if "unmodulated" in optima.invalid(selection) else f"{value} without modulation"
    uniformity, drawn = (row.get(f"uniformity_{name}_1", math.nan) for name in ("optimum", "unmodulated"))
    last = ((number(uniformity, 2), "uniformity: smallest rms along the path relative to its mean",
             plain(number(drawn, 2)) if math.isfinite(drawn) else "") if math.isfinite(uniformity) else  # nan: the focus rests
            (number(row["strength_at_least_1"], 3), "strength at least, relative to the load without modulation", ""))
    return [(of.text(row["eta_optimum_1"]), f"{of.name} of the optimum", plain(of.text(row["eta_unmodulated_1"]))),
            (of.text(row["eta_ceiling_1"]), "proven upper bound for its path", f"{number(row['ceiling_over_optimum_1'], 3)} times the optimum"),
            last]


def numbers(selection: Selection) -> list[Number]:
    """At most three numbers that state the result: the answer, the receptors, and the energy, strength and spread of the best case."""
    if not layout.ordinary(selection):
        return []
    if selection.sweep.uncertain:
        return of_samples(selection)[:3]
    if optima.is_study(selection):
        return of_optima(selection) if "optimum" not in optima.invalid(selection) else []
    if is_incomplete(selection) or sweeps_numbers_only(selection):
        return []
    column = answer.column(selection)
    ranking, receptors, found = rank(selection, column), of_receptors(selection), of_answer(selection, column)
    if column.endswith(RATE):  # that of the answer precedes the other classes
        receptors.sort(key=lambda number: number not in found)
        found = receptors or found
    else:
        found += receptors
    if ranking.best is None or (not ranking.others and ranking.near and len(ranking.cases) >= NAMED):
        return found[:3]
    stated = {column, ranking.quantity.column}
    more = [name for name in MEANINGS if not math.isnan(ranking.best.value(name, math.nan)) and not stated & {name, selection.ratio_of(name)}
            and not (name.startswith("felt_") and column.startswith("felt_"))]
    place = where(selection, ranking.best) if len(ranking.cases) > 1 and not summary.found_by_search(selection, ranking.quantity) else ""
    return [*found, *(of_case(selection, ranking.best, name, place) for name in more)][:3]
