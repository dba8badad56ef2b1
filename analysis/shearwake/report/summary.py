# SPDX-License-Identifier: BSD-3-Clause
"""Summarises the result of a sweep in one or two sentences."""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..case import Case
from . import contrast, labels, layout, optima, sample, warnings_of
from .load import Selection
from .numerical_error import (choices, estimated_at, is_measurement, is_numerical, known, numerical_variants, relative_error,
                              settings_that_differ, spread_of, valid, with_error)
from .warnings_of import is_valid
from .words import counted, listed, number

EQUAL = 1e-6  # relative: below the error of every engine, above the rounding of its sums
NAMED = 3     # largest number of cases with the same value that are named
LISTED = 5    # largest number of ratios that are listed


KIND = "load.modulation.kind"


def where(selection: Selection, case: Case) -> str:
    """'AM frequency 400 Hz, focus FWHM 3 mm', or 'SM-STM at AM frequency 400 Hz' if the modulation is swept."""
    keys = [k for k in [selection.x, *layout.group_keys(selection)] if k and k in case.settings]
    text = ", ".join(layout.setting_text(selection, k, case.settings[k]) for k in keys if k != KIND)
    kind = labels.value_text(selection, KIND, case.settings[KIND]) if KIND in keys else ""
    return f"{kind} at {text}" if kind and text else kind or text


def at(selection: Selection, place: str) -> str:
    """'at AM frequency 400 Hz', or 'with SM-STM at AM frequency 400 Hz'."""
    return f"{'with' if KIND in [selection.x, *layout.group_keys(selection)] else 'at'} {place}"


def alike(case: Case, cases: list[Case], value: Callable[..., Any]) -> list[Case]:
    """The cases with the same value as a case, itself first."""
    own = value(case)
    return [case, *(c for c in cases if c is not case and abs(value(c) - own) <= EQUAL * abs(own))]


def places(selection: Selection, cases: list[Case]) -> str:
    """Where the cases are: 'AM frequency 400 Hz and AM frequency 800 Hz'; only the first ones of many, and their number."""
    found = list(dict.fromkeys(where(selection, c) for c in cases))
    if len(found) > NAMED:
        found = [*found[:NAMED - 1], f"{len(found) - NAMED + 1} further cases"]
    return listed(found)


def subject(selection: Selection, cases: list[Case]) -> str:
    """For example 'AM-STM at AM frequency 400 Hz'."""
    kind = cases[0].setting("load", "modulation", "kind", default="")
    place = places(selection, cases)
    if KIND in cases[0].settings or not kind:
        return place or "the case"
    return f"{kind} at {place}" if place else kind


def reference_for(selection: Selection, case: Case) -> Case | None:
    """The reference of a case, or else the same case without a body, if the readings of both are valid, else None; None for a
    reference."""
    found = selection.reference_of(case) or contrast.counterpart(selection, case)
    return found if found and found is not case and is_valid(case) and is_valid(found) else None


def of_reference(selection: Selection, case: Case) -> str:
    """What a case is compared with: 'of plain STM', or 'without bone'."""
    own = selection.reference_of(case)
    return f"of {layout.reference_name([own])}" if own else contrast.absent(selection)[1]


def gain(selection: Selection, case: Case) -> float:
    """eta relative to that of the reference of the case; NaN for a reference, or if one of them is not valid."""
    reference = reference_for(selection, case)
    below = reference.value("eta_period_1", math.nan) if reference else math.nan
    return case.value("eta_period_1", math.nan) / below if below else math.nan


def comparison(value: float, reference: float, name: str) -> str:
    """For example '1.8 times the 0.28 of plain STM' or '13 % more than the 0.24 of plain STM'."""
    factor = value / reference
    if factor >= 1.5:
        return f"{number(factor, 2)} times the {number(reference, 3)} of {name}"
    percent = f"{number(100 * abs(factor - 1.0), 2)} % {'more' if factor >= 1.0 else 'less'}"
    return f"{percent} than the {number(reference, 3)} of {name}"


def caveats(selection: Selection, is_used: bool = False) -> str:
    """Why no case may be called the best, or why no ratio is stated: cases without a result, and readings that are not
    valid, which are used in the tables of the optima."""
    missing = [c for c in selection.cases if not c.is_complete]
    complete = [c for c in selection.cases if c.is_complete]
    invalid = [c for c in complete if not is_valid(c)]
    text = ""
    if missing:
        has = "has" if len(missing) == 1 else "have"
        text += f" {counted(len(missing), 'case')} of {len(selection.cases)} {has} no result yet."
    if invalid:
        among = layout.references_among(invalid)
        them = f" ({among})" if among else ""
        are = "is" if len(invalid) == 1 else "are"
        text += (f" {len(invalid)} of {counted(len(complete), 'complete case')} {are} not valid{'' if is_used else f' and {are} not used'}{them}: "
                 f"{warnings_of.reasons(invalid)}.")
    without = [c for c in layout.ordinary(selection) if is_valid(c) and math.isnan(c.value("eta_period_1", math.nan))]
    if without and len(without) < len(layout.ordinary(selection)):
        text += (f" {counted(len(without), 'case')} {'has' if len(without) == 1 else 'have'} no mean over complete periods "
                 "and cannot be compared.")
    if alone := [c for c in valid(selection, "eta_period_1") if (r := selection.reference_of(c)) and r is not c and not is_valid(r)]:
        text += (f" No ratio is stated for {counted(len(alone), 'valid case')}, because the readings of the reference are "
                 "not valid.")
    return text


def range_of(selection: Selection, cases: list[Case], column: str = "eta_period_1") -> str:
    low, high = (f(c.value(column, math.nan) for c in cases) for f in (min, max))
    return span(low, high)


def only_numerical(selection: Selection, cases: list[Case]) -> Any:
    """For a sweep over numerical parameters alone."""
    if len(cases) == 1:
        return f"The efficiency η is {with_error(selection, cases[0], 'eta_period_1')}." + estimate(selection, cases[0])
    return (f"The efficiency η is {range_of(selection, cases)}: {settings_that_differ(cases)} differ by "
            f"{number(100 * spread_of(cases, 'eta_period_1')[1], 2)} %." + estimate(selection, cases[0]))


def estimate(selection: Selection, case: Case, column: str = "eta_period_1") -> str:
    """States the numerical error of a column and, if that of a ratio is unknown, of eta."""
    relative = relative_error(selection, case, column)[0]
    if is_measurement(selection):
        return (" The uncertainty is unknown: measure with --repetitions." if math.isnan(relative) else
                f" Noise and gaps of the scan cause an uncertainty of {quantity(column)} of {number(100 * relative, 2)} %.")
    if not math.isnan(relative):
        return (f" The numerical error of {quantity(column)} is {number(100 * relative, 2)} %"
                f"{estimated_at(selection, case, column)}.")
    if column == "eta_period_1" or math.isnan(relative_error(selection, case, "eta_period_1")[0]):
        return " Numerical error not estimated: run shearwake converge."
    return estimate(selection, case)[:-1] + f"; that of {quantity(column)} is not estimated."


def quantity(column: str) -> str:
    return "the ratio" if "over_reference" in column else "η"


def without_best(selection: Selection, cases: list[Case]) -> Any:
    """For a sweep in which no case may be called the best."""
    noun = "complete case" if all(map(is_valid, layout.ordinary(selection))) else "valid case"
    return (f"The efficiency η of {counted(len(cases), noun)} is {range_of(selection, cases)}; no case "
            "is called the best until all are complete.")


def indistinct(selection: Selection, equal: list[Case], cases: list[Case], column: str) -> str:
    """Relates the differences between cases to those between engines and to the numerical error of a column. `equal`: the
    best cases, which have the same value."""
    best, variants = equal[0], numerical_variants(selection, equal[0], column)
    rest = [c for c in cases if c not in variants and c not in equal]
    text, relative = "", relative_error(selection, best, column)[0]
    if len(variants) > 1:
        range_, share = spread_of(variants, column)
        who = settings_that_differ(variants)
        text += f" {who[:1].upper()}{who[1:]} differ by {number(100 * share, 2)} % in {quantity(column)} there"
        near = [c for c in rest if abs(c.value(column, math.nan) - best.value(column, math.nan)) <= range_]
        text += f"; {further(near)} from this case by no more than that." if near else "."
    near = [c for c in rest if abs(c.value(column, math.nan) - best.value(column, math.nan)) <= 2 * relative * abs(best.value(column, math.nan))]
    if not near:
        return text + estimate(selection, best, column)
    return (f"{text} {further(near)} from this case by no more than the numerical error of both, "
            f"{number(100 * relative, 2)} % of {quantity(column)} each{estimated_at(selection, best, column)}.")


def further(cases: list[Case]) -> str:
    return f"{counted(len(cases), 'further case')} {'differs' if len(cases) == 1 else 'differ'}"


def best_case(selection: Selection) -> Case | None:
    """The case with the largest efficiency relative to its reference, among valid cases with a valid reference; with a body
    that some cases lack, the case whose efficiency the body changes most; without these the valid case with the largest efficiency."""
    cases = valid(selection, "eta_period_1")
    compared = [c for c in cases if not math.isnan(gain(selection, c))]
    if compared and not any(selection.reference_of(c) for c in compared):
        return max(compared, key=lambda c: abs(gain(selection, c) - 1.0))
    if compared:
        return max(compared, key=lambda c: gain(selection, c))
    return max(cases, key=lambda c: c.value("eta_period_1", math.nan)) if cases else None


def middle_case(selection: Selection) -> Case | None:
    """The valid case with the median of the efficiency."""
    cases = sorted(valid(selection, "eta_period_1"), key=lambda c: c.value("eta_period_1", math.nan))
    return cases[len(cases) // 2] if cases else None


def sweeps_numbers_only(selection: Selection) -> bool:
    """Whether all swept keys are numerical settings, of which none is the best."""
    keys = layout.axes(selection)
    return bool(keys) and all(is_numerical(key) for key in keys)


def is_incomplete(selection: Selection) -> bool:
    return bool(selection.x) and any(not c.is_complete for c in selection.cases)


def efficiency(selection: Selection) -> str:
    """The case that keeps the vibration best at the focus, and its advantage over its reference."""
    if not known(selection, "eta_period_1"):
        return "No case has an efficiency η over complete periods."
    cases = valid(selection, "eta_period_1")
    if not cases:
        return "No efficiency is stated, because no case has valid readings." + caveats(selection)
    notes = caveats(selection)
    if sweeps_numbers_only(selection):
        return only_numerical(selection, cases) + notes
    if is_incomplete(selection):
        return without_best(selection, cases) + notes
    compared = [c for c in cases if not math.isnan(gain(selection, c))]
    if not compared:
        return highest(selection, cases) + notes
    best = best_case(selection)
    assert best is not None
    if not any(selection.reference_of(c) for c in compared):
        return with_and_without(selection, compared, best) + estimate(selection, best) + notes
    same = alike(best, compared, lambda c: gain(selection, c))
    equal = alike(best, same, lambda c: c.value("eta_period_1", math.nan))
    text = against_reference(choices(selection), equal, compared)
    relate = indistinct(selection, equal, compared, "eta_period_over_reference_1") if selection.x else estimate(
        selection, best, "eta_period_over_reference_1")
    return text + relate + notes


def highest(selection: Selection, cases: list[Case]) -> str:
    """The case with the largest efficiency, of cases without valid references."""
    best = max(cases, key=lambda c: c.value("eta_period_1", math.nan))
    value = with_error(selection, best, "eta_period_1")
    if not selection.x:
        return f"The efficiency η is {value}." + estimate(selection, best)
    equal = alike(best, cases, lambda c: c.value("eta_period_1", math.nan))
    place = places(choices(selection), equal)
    if len(cases) == 1:
        return f"The efficiency η of the only valid case, {place}, is {value}." + estimate(selection, best)
    same = " and the same" if place != where(choices(selection), best) else ""
    return (f"The efficiency η is highest{same}, {value}, {at(selection, place)}{of_the_valid(selection, cases)}."
            + indistinct(selection, equal, cases, "eta_period_1"))


def place_of(selection: Selection, case: Case) -> str:
    """Where a case is, apart from the body that other cases lack."""
    key = contrast.absent(selection)[0]
    if len(labels.values_of(selection, key)) == 2:
        chosen = choices(selection)
        keys = [k for k in [chosen.x, *layout.group_keys(chosen)] if k != key]
        return where(replace(chosen, x="", label_keys=keys), case)
    return where(choices(selection), case)


def with_and_without(selection: Selection, compared: list[Case], most: Case) -> str:
    """How a body changes the efficiency at each of a few places, or between which ends. `most` is changed most."""
    ratio, without = {c.id: gain(selection, c) for c in compared}, contrast.absent(selection)[1]
    reference = reference_for(selection, most)
    assert reference is not None
    values = f"{number(most.value('eta_period_1', math.nan), 3)} instead of {number(reference.value('eta_period_1', math.nan), 3)}"
    low, high = (f(compared, key=lambda c: ratio[c.id]) for f in (min, max))
    ends = [low, high] if ratio[high.id] - ratio[low.id] > 0.005 * ratio[high.id] else [most]
    shown = compared if len({place_of(selection, c) for c in compared}) == len(compared) <= LISTED else ends
    parts: list[str] = []
    for case in shown:
        text = f"{number(ratio[case.id], 3)} times"
        place = place_of(selection, case)
        name = place_of(selection, shown[0]).partition(" = ")[0] + " = "
        text += f" at {place.removeprefix(name)}" if parts else f" that {without}" + (f" at {place}" if place else "")
        parts.append(f"{text} ({values})" if case is most else text)
    names = contrast.present(selection)
    span = f"between {listed(parts)}" if shown is ends and len(ends) == 2 else listed(parts)
    return f"{names[:1].upper()}{names[1:]} the efficiency η is {span}{of_the_valid(selection, valid(selection, 'eta_period_1'))}."


def of_the_valid(selection: Selection, cases: list[Case]) -> str:
    """' of the 9 valid cases', or '' if these are all cases."""
    return "" if len(cases) == len(layout.ordinary(selection)) else f" of the {counted(len(cases), 'valid case')}"


def against_reference(selection: Selection, equal: list[Case], compared: list[Case]) -> str:
    """The best of the compared cases, which have the same values, and the reference."""
    best, who = equal[0], subject(selection, equal)
    several = who != subject(selection, [best])
    value = best.value("eta_period_1", math.nan)
    of_best = selection.reference_of(best)
    reference = of_best.value("eta_period_1", math.nan) if of_best else math.nan
    name = layout.reference_name(layout.all_references(selection))
    versus = (f"{'the' if several else 'its'} efficiency η {'of each ' if several else ''}is {with_error(selection, best, 'eta_period_1')}, "
              f"{comparison(value, reference, name)}.")
    ratio, _ = relative_error(selection, best, "eta_period_over_reference_1")
    if abs(value / reference - 1.0) <= ratio:
        versus += f" This difference does not exceed its numerical error of {number(100 * ratio, 2)} %."
    if not selection.x:
        return f"{who}: {versus}"
    if value < reference:
        count = len(compared)
        kind = "" if count == len(layout.ordinary(selection)) else "valid "
        none = f"None of the {count} {kind}cases focuses" if count > 1 else f"The only {kind}case does not focus"
        return f"{none} better than {name}. The best {'are' if several else 'is'} {who}: {versus}"
    among = of_the_valid(selection, compared)
    if len(layout.all_references(selection)) > 1:
        return f"{who} {'improve' if several else 'improves'} most on {name} under the same conditions{among}: {versus}"
    return f"{who} {'focus' if several else 'focuses'} best{among}: {versus}"


def strength(selection: Selection) -> str:
    """The strength at the focus relative to the reference; '' if no reading is valid."""
    ratio = {}
    for case in valid(selection, "focal_rms_um"):
        reference = reference_for(selection, case)
        if reference and reference.value("focal_rms_um", math.nan):
            ratio[case.id] = case.value("focal_rms_um", math.nan) / reference.value("focal_rms_um", math.nan)
    ratio = {k: v for k, v in ratio.items() if not math.isnan(v)}
    if not ratio:
        cases = valid(selection, "focal_rms_um")
        if not cases:
            return ""
        return f" The focal rms is {range_of(selection, cases, 'focal_rms_um')} µm."
    versus = f"that {of_reference(selection, selection.by_id[next(iter(ratio))])}"
    low, high = (f(ratio.values()) for f in (min, max))
    if len(ratio) == 1 or high - low < 0.005 * high:
        return f" The focal rms is {number(high, 2)} times {versus}."
    at_low, at_high = ([selection.by_id[i] for i, r in ratio.items() if abs(r - end) <= EQUAL * end] for end in (low, high))
    return (f" The focal rms is {number(low, 2)} ({places(selection, at_low)}) to "
            f"{number(high, 2)} ({places(selection, at_high)}) times {versus}.")


def span(low: float, high: float) -> str:
    ends = number(low, 3), number(high, 3)
    return ends[0] if ends[0] == ends[1] else f"{ends[0]} to {ends[1]}"


def spikes_of(selection: Selection) -> dict[str, list[tuple[Case, int]]]:
    """{class of receptors: valid cases with the number of their spikes}; only classes with such cases."""
    cases = [c for c in layout.ordinary(selection) if warnings_of.is_valid(c, warnings_of.OF_RECEPTORS)]
    found = {kind: [(c, int(n)) for c in cases if not math.isnan(n := c.value(f"{kind}_spikes_1", math.nan))]
             for kind in layout.receptor_classes(selection)}
    return {kind: spikes for kind, spikes in found.items() if spikes}


def fired(selection: Selection) -> str:
    """The spikes of the receptors; '' if no case has valid spikes."""
    spikes = spikes_of(selection)
    firing = {kind: found for kind, found in spikes.items() if any(n for _, n in found)}
    silent = [kind for kind, found in spikes.items() if found and kind not in firing]
    parts = [f"the {kind} afferents fire {spikes_text(selection, found)}" for kind, found in firing.items()]
    if silent:
        parts.append(f"the {listed(silent)} afferents are silent")
    text = "; ".join(parts)
    return f"{text[:1].upper()}{text[1:]}." if parts else ""


def spikes_text(selection: Selection, found: list[tuple[Case, int]]) -> str:
    """'324 spikes at AM depth 0, 23293 spikes at AM depth 1'; the range for more than three cases."""
    if len(found) > 3:
        low, high = (f(n for _, n in found) for f in (min, max))
        most = places(selection, [c for c, n in found if n == high])
        return f"{low} to {counted(high, 'spike')}, most {at(selection, most)}" if low != high else f"{counted(high, 'spike')} in each case"
    return listed(spikes_at(selection, [case], count) for case, count in found)


def spikes_at(selection: Selection, cases: list[Case], count: int) -> str:
    place = places(selection, cases)
    return counted(count, "spike") + (f" {at(selection, place)}" if place else "")


def summary(selection: Selection) -> str:
    if not layout.ordinary(selection):
        return "No case is complete yet, so there is nothing to draw."
    if selection.sweep.uncertain:
        return sample.sentence(selection)
    if optima.is_study(selection):
        return optima.sentence(selection) + caveats(selection, is_used=True)
    of_field, receptors = efficiency(selection) + strength(choices(selection)), fired(selection)
    parts = [of_field, receptors] if valid(selection, "eta_period_1") else [receptors, of_field]
    return " ".join(part[:1].upper() + part[1:] for part in parts if part)
