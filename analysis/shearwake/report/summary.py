# SPDX-License-Identifier: BSD-3-Clause
"""Summarises the result of a sweep: a sentence that answers its question, and others."""
from __future__ import annotations

import math

from ..case import Case
from ..tables import read_adaptive
from . import contrast, labels, layout, optima, sample, warnings_of
from .answer import NOTICEABLE_dB, Quantity, asks_for_receptors, column, quantity
from .caveats import caveats, estimate, is_incomplete
from .load import Selection, remembered
from .numerical_error import is_numerical, relative_error, settings_that_differ, spread_of, sweeps_numbers_only, valid
from .places import NAMED, capital, keys_of, named, placed, places, where
from .ranking import Ranking, caution, change, edges, rank, reference_for, region_mm2, shape
from .warnings_of import RATE, figure_of
from .words import counted, listed, number

ETA, STRENGTH = "eta_period_1", "focal_rms_um"


def shown(selection: Selection, of: Quantity, case: Case) -> str:
    """The value of a case, with its numerical error if that of this very case was estimated."""
    value = case.value(of.column, math.nan)
    relative, source = relative_error(selection, case, of.column)
    return of.text(value, relative * abs(value) if source is case else math.nan)


def name_of(selection: Selection, case: Case, reference: Case) -> str:
    """'plain STM', or what distinguishes a reference that is a case of the sweep: 'STM', 'without bone'."""
    if reference.is_reference:
        return layout.reference_name([reference])
    keys = [k for k in layout.axes(selection) if reference.settings.get(k) != case.settings.get(k) and k in reference.settings]
    return contrast.absent(selection)[1] if contrast.counterpart(selection, case) is reference else where(selection, reference, keys)


def of_name(name: str) -> str:
    """'of plain STM', 'without bone'."""
    return name if name.startswith(contrast.ABSENT) else f"of {name}"


def relation(selection: Selection, of: Quantity, case: Case) -> str:
    """The comparison of a case with its reference: ', 1.8 times the 28 % of plain STM'; '' without a reference."""
    if (reference := reference_for(selection, case, of.column)) is None:
        return ""
    value, other, name = case.value(of.column), reference.value(of.column), name_of(selection, case, reference)
    if of.is_level:
        apart = change(of, value, other)
        if abs(apart) < NOTICEABLE_dB:
            return f", without a noticeable difference from {name} ({of.difference(abs(apart))})"
        return f", {of.difference(abs(apart))} {'above' if apart > 0 else 'below'} the {of.difference(other)} {of_name(name)}"
    if not other:
        return ""
    ratio = number(value / other, 3)
    text = f", the same as that {of_name(name)}" if ratio == "1" else f", {ratio} times the {of.text(other)} {of_name(name)}"
    error = relative_error(selection, case, f"{of.column.removesuffix('_1')}_over_reference_1")[0]
    return text + ("; this difference does not exceed the numerical error" if ratio != "1" and abs(value / other - 1.0) <= error else "")


def parts_of_ratio(selection: Selection, of: Quantity, case: Case) -> str:
    """' (18.5 % instead of 17.4 %)' for a ratio to the reference; '' for another column."""
    under = next((c.over_reference_of for c in selection.sweep.columns if c.name == of.column), "")
    reference = reference_for(selection, case, under) if under else None
    if reference is None:
        return ""
    plain = quantity(selection, under)
    return f" ({plain.text(case.value(under))} instead of {plain.text(reference.value(under))})"


def without_result(selection: Selection, of: Quantity) -> str:
    """Why no value of a column is stated."""
    cases = layout.ordinary(selection)
    if not any(warnings_of.is_valid(c, figure_of(of.column)) for c in cases):
        return f"No result is stated, because no case has valid readings: {warnings_of.reasons(cases, figure_of(of.column))}."
    notes = list(dict.fromkeys(c.notes.get(of.column, "") for c in cases))
    reason = f": {notes[0]}" if notes and notes[0] else ""
    return f"{of.title} has no value{' over complete periods' if of.column == ETA else ''} in any case{reason}."


def span(of: Quantity, cases: list[Case]) -> str:
    low, high = (f(c.value(of.column) for c in cases) for f in (min, max))
    return of.range(low, high)


def numbers_only(selection: Selection, of: Quantity, cases: list[Case]) -> str:
    """The spread over numerical parameters, of which none is the best."""
    text = f"{of.title} is {shown(selection, of, cases[0]) if len(cases) == 1 else span(of, cases)}"
    if len(cases) == 1:
        return text + "."
    apart = of.difference(spread_of(cases, of.column)[0]) if of.is_level else f"{number(100 * spread_of(cases, of.column)[1], 2)}\u00a0%"
    return f"{text}: {settings_that_differ(cases)} differ by {apart}."


def group_words(selection: Selection, ranking: Ranking, group: list[Case]) -> str:
    """'with AM (a point)', 'at radius 5 mm (36 cm²)', 'in 3 cases (a circle)'."""
    mark = shape(group[0]) if "shapes" in ranking.reason else (
        f"{number(region_mm2(group[0]) / 100, 3)}\u00a0cm²" if "regions" in ranking.reason else "")
    place = f"in {len(group)} cases" if len(group) > 1 else placed(selection, group).strip()
    return f"{place} ({mark})" if mark else place


def not_ranked(selection: Selection, ranking: Ranking) -> list[str]:
    """The values of groups of cases that cannot be compared."""
    of, groups = ranking.quantity, ranking.groups
    if len(groups) > NAMED:
        return [f"{of.title} is {span(of, ranking.cases)} in {len(ranking.cases)} cases; {ranking.reason} are not ranked."]
    parts = [f"{span(of, group)} {group_words(selection, ranking, group)}" for group in groups]
    return [f"{of.title} is {listed(parts)}; {ranking.reason} are not ranked."]


def with_and_without(selection: Selection, ranking: Ranking) -> list[str]:
    """What a body changes: the place where it changes most, and the other places."""
    of, most = ranking.quantity, ranking.best
    assert most is not None
    key, without = contrast.absent(selection)
    keys = [k for k in layout.axes(selection) if k != key and not is_numerical(k)]

    def amount(case: Case, other: Case) -> str:
        apart = change(of, ranking.value(case), ranking.value(other))
        return of.difference(apart) if of.is_level else number(1.0 + apart, 3)
    other = next(o for c, o in ranking.pairs if c is most)

    def at(case: Case) -> str:
        return labels.placed(selection, case.settings, keys, where(selection, case, keys)) if keys else ""
    changes = " changes most" if len(ranking.pairs) > 1 else " is"
    changes += f"{at(most)}:" if at(most) or len(ranking.pairs) > 1 else ""
    times = amount(most, other) + ("" if of.is_level else " times")
    lead = (f"{capital(contrast.present(selection))} {of.name}{changes} {of.text(ranking.value(most))} instead of the "
            f"{of.text(ranking.value(other))} {without} ({times}).")
    what = "difference" if of.is_level else "ratio"
    rest = [(c, o) for c, o in ranking.pairs if c is not most]
    if 0 < len(rest) <= 4:
        texts = [f"{amount(c, o)}{at(c)}" for c, o in rest]
        if len(keys) == 1 and not labels.is_nominal(selection, keys[0], most.settings[keys[0]]):
            texts[1:] = [f"{amount(c, o)} at {labels.amount_text(selection, keys[0], c.settings[keys[0]])}" for c, o in rest[1:]]
        return [lead, f"The {what} is {listed(texts)}."]
    if rest:
        low, high = (f(rest, key=lambda pair: change(of, ranking.value(pair[0]), ranking.value(pair[1]))) for f in (min, max))
        return [lead, f"In the other {len(rest)} pairs the {what} is {amount(*low)} to {amount(*high)}."]
    return [lead]


def found_by_search(selection: Selection, of: Quantity) -> str:
    """'AM frequency 147.2 Hz (between 146.5 and 147.9 Hz)' if an adaptive axis has found the extremum of a column, else ''."""
    for axis in selection.sweep.adaptive_axes:
        rows = [r for r in read_adaptive(selection.sweep.folder, selection.sweep.name) if r["key"] == axis["key"]]
        if axis["column"] == of.column and axis["goal"] in ("maximum", "minimum") and len(rows) == 1 and not math.isnan(rows[0]["location"]):
            place, low, high = (float(number(rows[0][end], 4).replace("\N{MINUS SIGN}", "-")) for end in ("location", "from", "to"))
            between = f" (between {number(low, 4)} and {labels.amount_text(selection, axis['key'], high)})" if low < high else ""
            return layout.setting_text(selection, axis["key"], place) + between
    return ""


def best_place(selection: Selection, ranking: Ranking) -> str:
    """Where the best cases are."""
    return found_by_search(selection, ranking.quantity) or named(selection, ranking.equal)


def alike(selection: Selection, ranking: Ranking) -> str:
    """The sentence about cases without a noticeable difference."""
    of, best = ranking.quantity, ranking.equal[0]
    start = f"No noticeable difference in {of.name}:"
    tail = f", {ranking.margin}" if ranking.margin else ""
    cases = [*ranking.equal, *ranking.near]
    if not ranking.others and len(cases) >= NAMED:
        below = ", below the threshold of perception" if of.is_level and ranking.value(best) < 0 else ""
        return f"{start} all {len(cases)} cases have {span(of, cases)}{below}{tail}."
    if len(cases) <= NAMED:
        texts = [of.difference(ranking.value(best) - ranking.value(c)) + " less" if of.is_level else shown(selection, of, c) for c in cases[1:]]
        found = places(selection, cases)
        near = listed([f"{found[0]} ({shown(selection, of, best)})", *(f"{p} ({t})" for p, t in zip(found[1:], texts))])
    else:
        least = min(map(ranking.value, cases))
        most = f"at most {of.difference(ranking.value(best) - least)} less" if of.is_level else f"at least {of.text(least)}"
        near = f"{places(selection, [best])[0]} ({shown(selection, of, best)}) and {len(cases) - 1} further cases ({most})"
    return f"{start} {near}{tail}{weaker(selection, ranking) if of.is_level else ''}."


def weaker(selection: Selection, ranking: Ranking) -> str:
    """'; AM-STM is 6 dB weaker', '; the other 4 are 2.5 to 9 dB weaker'; '' without other cases."""
    of, others = ranking.quantity, ranking.others
    less = sorted(ranking.value(ranking.equal[0]) - ranking.value(c) for c in others)
    if len(others) == 1:
        return f"; {where(selection, others[0])} is {of.difference(less[0])} weaker"
    if not others:
        return ""
    return f"; the other {len(others)} are {of.range(less[0], less[-1])} weaker"


def among_valid(selection: Selection, ranking: Ranking) -> str:
    """'The efficiency η', or 'Of the 2 valid cases, the efficiency η' if not all cases are."""
    every = len(layout.ordinary(selection)) == len(valid(selection, ranking.quantity.column))
    return ranking.quantity.title if every else f"Of the {len(ranking.cases)} valid cases, {ranking.quantity.name}"


def range_words(selection: Selection, ranking: Ranking, keys: list[str]) -> str:
    """The range at whose end the best cases lie: that of the sweep, or that of its valid cases."""
    every = all(c.settings[k] in (min(values), max(values)) for k in keys if (values := layout.values_of(selection, k)) for c in ranking.equal)
    return f"swept range{'s' * (len(keys) > 1)}" if every else "range of valid cases"


def extreme(selection: Selection, ranking: Ranking) -> list[str]:
    """The best cases with their value and their comparison with the reference, and what else is known about the order."""
    of, best = ranking.quantity, ranking.equal[0]
    if len(ranking.cases) == len(ranking.equal) > 1:
        every = "both cases" if len(ranking.cases) == 2 else f"all {len(ranking.cases)} cases"
        return [f"{of.title} is the same in {every}: {shown(selection, of, best)}{relation(selection, of, best)}."]
    if ranking.near:
        return without_best(selection, ranking)
    most, least = ("lowest", "highest") if ranking.seeks_least else ("highest", "lowest")
    place = labels.placed(selection, best.settings, keys_of(selection), best_place(selection, ranking))
    ends = edges(selection, ranking)
    found = [f"{among_valid(selection, ranking)} is {most}{place}{ending(selection, ranking, ends)}: {shown(selection, of, best)}"
             f"{parts_of_ratio(selection, of, best)}{relation(selection, of, best)}."]
    if ends:
        found.append(f"The optimum may lie beyond th{'ese ends' if len(ends) > 1 else 'is end'}.")
    if of.is_level and not ranking.seeks_least:
        return [*found, capital(weaker(selection, ranking).removeprefix("; ")) + "."]
    return [*found, *other_end(selection, ranking, least)]


def without_best(selection: Selection, ranking: Ranking) -> list[str]:
    """Several cases without a noticeable difference, their comparison with the reference, and the other cases."""
    of, best = ranking.quantity, ranking.equal[0]
    found, place = [alike(selection, ranking)], capital(named(selection, ranking.equal))
    own = selection.reference_of(best)
    if own and own.is_reference and (text := relation(selection, of, best)):
        found.append(f"{place} has {shown(selection, of, best)}{text}.")
    if not of.is_level:
        found += other_end(selection, ranking, "lowest")
    if ranking.others and (ends := edges(selection, ranking)):
        values = capital(listed(layout.setting_text(selection, k, best.settings[k]) for k in ends))
        found.append(f"{values} {'are ends' if len(ends) > 1 else 'is the end'} of the {range_words(selection, ranking, ends)}, beyond which the "
                     "optimum may lie.")
    return found


def ending(selection: Selection, ranking: Ranking, ends: list[str]) -> str:
    """', the end of the swept range', which names its key if there are others; '' if the best case lies inside."""
    amounts = [k for k in keys_of(selection) if not labels.is_nominal(selection, k, ranking.equal[0].settings.get(k))]
    of_keys = f" of {listed(labels.name(selection, k).replace(', ', ' of ') for k in ends)}" if len(amounts) > len(ends) > 0 else ""
    return f", the {'ends' if len(ends) > 1 else 'end'} of the {range_words(selection, ranking, ends)}{of_keys}" if ends else ""


def other_end(selection: Selection, ranking: Ranking, least: str) -> list[str]:
    """'The efficiency η is lowest at AM frequency 100 Hz (30 %).'"""
    if not ranking.others:
        return []
    last = (max if least == "highest" else min)(ranking.others, key=ranking.value)
    return [f"{ranking.quantity.title} is {least}{placed(selection, [last])} ({ranking.quantity.text(ranking.value(last))})."]


def gains(selection: Selection, ranking: Ranking) -> list[str]:
    """The case that gains most over its reference, if it is another one than the best, and whether no case gains."""
    of = ranking.quantity
    ratio = {c.id: ranking.value(c) / r.value(of.column) for c in ranking.cases
             if (r := reference_for(selection, c, of.column)) and r.value(of.column)} if not of.is_level else {}
    if not ratio or not ranking.equal:
        return []
    most = max((c for c in ranking.cases if c.id in ratio), key=lambda c: ratio[c.id])
    reference = reference_for(selection, most, of.column)
    assert reference is not None
    name = name_of(selection, most, reference)
    if ratio[most.id] < 1.0 and number(ratio[most.id], 3) != "1":
        return [f"No case exceeds {name} under the same conditions."]
    own = [number(ratio[c.id], 3) for c in ranking.equal if c.id in ratio]
    if most in ranking.equal or number(ratio[most.id], 3) in own or number(ratio[most.id], 3) == "1":
        return []
    return [f"Relative to {name} it gains most{placed(selection, [most])} ({number(ratio[most.id], 3)} times)."]


def sentences(selection: Selection, name: str) -> list[str]:
    """The result of a column, the answer first."""
    ranking = rank(selection, name)
    of, cases = ranking.quantity, ranking.cases
    if not cases:
        return [without_result(selection, of)]
    if sweeps_numbers_only(selection):
        return [numbers_only(selection, of, valid(selection, name))]
    if is_incomplete(selection):
        missing = sum(not c.is_complete for c in selection.cases)
        noun = "complete case" if all(map(warnings_of.is_valid, layout.ordinary(selection))) else "valid case"
        return [f"{of.title} of the {counted(len(cases), noun)} is {span(of, cases)}; no case is called the best, because {missing} of "
                f"{counted(len(selection.cases), 'case')} {'has' if missing == 1 else 'have'} no result."]
    if len(cases) == 1:
        best = cases[0]
        value = shown(selection, of, best)
        if of.is_level:
            value = f"{of.difference(abs(best.value(of.column)))} {'above' if best.value(of.column) >= 0 else 'below'} the threshold of perception"
        only = f" of the only valid case,{placed(selection, [best])}," if len(layout.ordinary(selection)) > 1 else ""
        return [f"{of.title}{only} is {value}{parts_of_ratio(selection, of, best)}{relation(selection, of, best)}."]
    if len(ranking.groups) > 1 and of.column == name:
        return not_ranked(selection, ranking)
    if not of.seeks_most:
        low, high = (f(cases, key=ranking.value) for f in (min, max))
        return [f"{of.title} is {of.text(ranking.value(low))} ({where(selection, low)}) to {of.text(ranking.value(high))} "
                f"({where(selection, high)}){times_reference(selection, of)}."]
    if ranking.pairs:
        return with_and_without(selection, ranking)
    return [*extreme(selection, ranking), *gains(selection, ranking)]


def times_reference(selection: Selection, of: Quantity) -> str:
    """', 0.4 to 1.03 times that of plain STM'; '' without references."""
    pairs = [(c, r) for c in valid(selection, of.column) if (r := reference_for(selection, c, of.column)) and r.value(of.column)]
    if not pairs or of.is_level:
        return ""
    ratios = [c.value(of.column) / r.value(of.column) for c, r in pairs]
    low, high = number(min(ratios), 3), number(max(ratios), 3)
    return f", {low if low == high else f'{low} to {high}'} times that {of_name(name_of(selection, *pairs[0]))}"


def strength(selection: Selection) -> list[str]:
    """The strength at the focus relative to the reference."""
    cases = valid(selection, STRENGTH)
    ratio = {c.id: c.value(STRENGTH) / r.value(STRENGTH) for c in cases if (r := reference_for(selection, c, STRENGTH)) and r.value(STRENGTH)}
    if not ratio:
        return [f"The focal rms is {span(quantity(selection, STRENGTH), cases)}."] if cases else []
    first = selection.by_id[next(iter(ratio))]
    reference = reference_for(selection, first, STRENGTH)
    assert reference is not None
    versus = f"that {of_name(name_of(selection, first, reference))}"
    low, high = (f(ratio, key=lambda i: ratio[i]) for f in (min, max))
    if number(ratio[low], 2) == number(ratio[high], 2):
        times = number(ratio[high], 2)
        return [f"The focal rms is {f'{times} times {versus}' if times != '1' else f'the same as {versus}'}."]
    return [f"The focal rms is {number(ratio[low], 2)} ({where(selection, selection.by_id[low])}) to "
            f"{number(ratio[high], 2)} ({where(selection, selection.by_id[high])}) times {versus}."]


def fired(selection: Selection, without: str = "") -> list[str]:
    """The rates of the classes of receptors, except that of a column."""
    parts, silent = [], []
    for kind in layout.receptor_classes(selection):
        ranking = rank(selection, kind + RATE)
        if not ranking.cases or kind + RATE == without:
            continue
        of, high = ranking.quantity, max(map(ranking.value, ranking.cases))
        if not high:
            silent.append(kind)
            continue
        most = f", most{placed(selection, ranking.equal)}" if len(ranking.groups) == 1 and len(ranking.equal) < len(ranking.cases) else ""
        parts.append(f"the {kind} afferents fire {span(of, ranking.cases)} together{most}")
    if silent:
        count = len(rank(selection, silent[0] + RATE).cases)
        parts.append(f"the {listed(silent)} afferents are silent" + (f" in each of the {count} cases" if count > 1 else ""))
    text = "; ".join(parts)
    return [f"{capital(text)}."] if parts else []


@remembered
def summary(selection: Selection) -> str:
    """The answer to the question of the job first."""
    if not layout.ordinary(selection):
        return "No case is complete yet, so there is nothing to draw."
    if selection.sweep.uncertain:
        return " ".join([*sample.sentences(selection), *filter(None, [caution(selection)])])
    if optima.is_study(selection):
        return " ".join([optima.sentence(selection), *caveats(selection, is_used=True)])
    answer = column(selection)
    level = "felt_path_dB" if not answer.startswith("felt_") and valid(selection, "felt_path_dB") else ""
    others = [name for name in (ETA, level) if name and name != answer and valid(selection, name)
              and rank(selection, answer).quantity.column != selection.ratio_of(name)]
    receptors = fired(selection, answer)
    found = sentences(selection, answer)
    silent_first = answer == ETA and asks_for_receptors(selection)
    parts = [*receptors, *found] if silent_first else [*found, *receptors]
    for name in others:
        parts += sentences(selection, name)[:1]
    parts += [*strength(selection), *estimate(selection, rank(selection, answer)), *filter(None, [caution(selection)]), *caveats(selection)]
    return " ".join(parts)
