# SPDX-License-Identifier: BSD-3-Clause
"""Arranges the cases of a sweep for the figures: x, one group per curve, and the references."""
import functools
import math
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..case import Case
from ..keys import follows
from . import words
from .labels import is_number, labels, ordinary, setting_text, swept_cases, values_of
from .load import Selection, remembered


@dataclass
class Group:
    """One curve: the complete cases that share their series settings, in the order of x."""
    label: str
    cases: list
    values: tuple = ()  # of the keys that distinguish curves


def repeats(case: Case) -> bool:
    """Whether the load has always repeated (time.regime = "periodic")."""
    return case.setting("time", "regime", default="") == "periodic"


@remembered
def recordings(selection: Selection) -> list[Case]:
    """The first of the complete cases that have the same path of the focus, times and trace points according to their parameters."""
    found: dict[str, Case] = {}
    for case in ordinary(selection):
        load = case.setting("load", "modulation", default={})
        path = [load.get("trajectory", case.id), load.get("foci_x_m"), load.get("foci_y_m")]
        found.setdefault(str([path, *(case.setting(name, default={}) for name in ("time", "measure", "record"))]), case)
    return list(found.values())


@remembered
def is_numeric(selection: Selection) -> bool:
    values = [c.settings.get(selection.x) for c in selection.cases if not c.is_reference]
    return bool(selection.x) and bool(values) and all(is_number(v) and (selection.x, v) not in labels(selection) for v in values)


@remembered
def group_keys(selection: Selection) -> list[str]:
    """The keys that distinguish curves; all other swept keys if cases would otherwise share an x."""
    if selection.label_keys is not None:
        return selection.label_keys
    vary = [k for k in axes(selection) if k != selection.x]
    keys = [k for k in vary if k in selection.sweep.series_keys]
    seen = [tuple(str(c.settings.get(k)) for k in [selection.x, *keys]) for c in ordinary(selection)]
    return vary if len(set(seen)) < len(seen) else keys


@remembered
def groups(selection: Selection) -> list[Group]:
    keys = group_keys(selection)
    found: dict[str, Group] = {}
    text_of = functools.cache(functools.partial(setting_text, selection))
    for case in ordinary(selection):
        values = [case.settings.get(k, "") for k in keys]
        label = ", ".join(text_of(k, v) for k, v in zip(keys, values) if v != "")
        found.setdefault(label, Group(label, [], tuple(values))).cases.append(case)
    if is_numeric(selection):
        for group in found.values():
            group.cases.sort(key=lambda c: c.settings[selection.x])
    made = list(found.values())
    if all(is_number(v) for group in made for v in group.values):
        made.sort(key=lambda group: group.values)
    return made


@remembered
def x_values(selection: Selection) -> list:
    """All values of x of the complete cases: sorted numbers, or strings in the order of the plan."""
    cases = [c for c in ordinary(selection) if selection.x in c.settings]
    values = list(dict.fromkeys(c.settings[selection.x] for c in cases))
    return sorted(values) if is_numeric(selection) else values


def x_position(selection: Selection, case: Case) -> float:
    """The position of a case on the x axis: its number, or the index of its string."""
    value: Any = case.settings.get(selection.x)
    return float(value) if is_numeric(selection) else float(x_values(selection).index(value))


def is_logarithmic(values: Any) -> bool:
    """Whether the numbers span a decade or more and have more uniform ratios than differences."""
    values = np.asarray(values, dtype=float)
    if len(values) < 3 or values.min() <= 0 or values.max() < 10 * values.min():
        return False
    steps, ratios = np.diff(values), np.diff(np.log(values))
    return np.std(ratios) / np.mean(ratios) < np.std(steps) / np.mean(steps)


def medium_label(selection: Selection, case: Case) -> str:
    """The swept keys of the medium with their values; the label of the case if no such key is swept."""
    keys = [k for k in axes(selection) if k.startswith("medium.") and k in case.settings]
    return ", ".join(setting_text(selection, k, case.settings[k]) for k in keys) or case_label(selection, case)


ONLY_CASE = "this case"  # of a job without swept keys


@remembered
def case_label(selection: Selection, case: Case) -> str:
    """The swept keys of a case with their values: 'AM frequency 200 Hz, focus FWHM 3 mm'."""
    if case.is_reference:
        keys = [k for k in axes(selection) if k in case.settings and not is_reading(k)]
        return ", ".join([reference_name([case]), *(setting_text(selection, k, case.settings[k]) for k in keys)])
    if not selection.sweep.swept_keys:
        return ", ".join([ONLY_CASE, *(setting_text(selection, k, v) for k, v in case.settings.items() if not is_reading(k))])
    keys = ([selection.x] if selection.x in case.settings else []) + group_keys(selection)
    return ", ".join(setting_text(selection, k, case.settings[k]) for k in keys if k in case.settings)


CHARACTERS = 12  # of a title per inch


def wrapped(title: str, width_in: float) -> str:
    """The title, wrapped to the width of a panel, but not between the two sides of an equals sign."""
    title = re.sub(r" (?:\d+ )?= ", lambda match: match.group(0).replace(" ", "\u00a0"), title)
    return textwrap.fill(title, int(CHARACTERS * width_in), break_on_hyphens=False)


def place_words(places: Iterable[tuple]) -> str:
    """'at the centre', 'at (25, 0) mm', or 'at a trace point' if the points in m differ."""
    found = {tuple(words.millimetres(1e3 * v + 0.0) for v in place) for place in places}
    if len(found) != 1:
        return "at a trace point"
    x, y = found.pop()
    return "at the centre" if (x, y) == ("0", "0") else f"at ({x}, {y}) mm"


def plane_name(cases: list[Case]) -> str:
    """'the surface', or the plane at the first of measure.depths_mm, in which surfaces, traces and measures are recorded."""
    depths = sorted({round(1e3 * c.setting("measure", "depths_m", default=[0.0])[0], 6) for c in cases})
    if not depths or depths == [0.0]:
        return "the surface"
    low, high = words.number(depths[0]), words.number(depths[-1])
    return f"the plane z = {low if low == high else f'{low} to {high}'}\u00a0mm"


def is_reading(key: str) -> bool:
    """Whether the key affects only the measurement of a field, not the field itself."""
    return key.startswith("measure.")


@remembered
def axes(selection: Selection) -> list[str]:
    """The keys that vary independently, x first. A key that follows another one (zip) is not an axis."""
    settings = [case.settings for case in swept_cases(selection)]
    independent: list[str] = []
    for key in dict.fromkeys([selection.x, *selection.sweep.series_keys, *selection.sweep.swept_keys]):
        if not key or len(values_of(selection, key)) < 2:
            continue
        if not any(follows(settings, key, other) for other in independent):
            independent.append(key)
    return independent


def evenly(items: Sequence, most: int) -> list:
    """At most `most` items, including the first and the last."""
    if len(items) <= most:
        return list(items)
    picks = np.unique(np.round(np.linspace(0, len(items) - 1, most)).astype(int))
    return [items[i] for i in picks]


def only(selection: Selection, ids: Sequence[str]) -> Selection:
    """The selection with the cases of these ids and their references."""
    remaining = {*ids, *(selection.by_id[i].reference_id for i in ids)}
    return replace(selection, cases=[c for c in selection.cases if c.id in remaining],
                   label_keys=group_keys(selection))  # keys that no longer vary remain in the labels


def few(selection: Selection) -> Selection:
    """The selection; if it has more than 40 cases, reduced to a few that are spread evenly over it."""
    if len(ordinary(selection)) <= 40:
        return selection
    chosen = evenly(groups(selection), 3)
    values = set(evenly(x_values(selection), 24 // len(chosen)))
    return only(selection, [c.id for g in chosen for c in g.cases if c.settings.get(selection.x) in values])


def fewer_lines(selection: Selection) -> Selection:
    """The selection; if it has too many values of x for a line or a panel each, reduced to some of them, spread
    evenly."""
    values = x_values(selection)
    if not selection.x or not is_numeric(selection) or len(values) <= 8:
        return selection
    return with_some(selection, set(evenly(values, 6)))


def with_some(selection: Selection, some: set) -> Selection:
    """The selection with those cases whose x is one of some values, and their references."""
    return only(selection, [c.id for c in ordinary(selection) if c.settings.get(selection.x) in some])


def lines_of_one_panel(selection: Selection) -> Selection:
    """The selection; if its curves have too many cases for the lines of one panel, reduced to some that are spread
    evenly."""
    curves, values = len(groups(selection)), x_values(selection) if selection.x else []
    each = max(1, 7 // max(1, curves))
    if curves < 2 or len(values) <= each:
        return fewer_lines(selection)
    return with_some(selection, set(evenly(values, each)))


def references(selection: Selection, group: Group) -> list[Case]:
    """The distinct complete references of a group, in the order of its cases."""
    found = {}
    for case in group.cases:
        reference = selection.reference_of(case)
        if reference:
            found[reference.id] = reference
    return list(found.values())


@remembered
def field_settings(case: Case) -> str:
    """All settings except those that affect only the measurement."""
    return str({k: v for k, v in case.settings.items() if not is_reading(k)})


def have_same_motion(one: Case, other: Case) -> bool:
    """Whether two references have the same field: their settings differ only in the measurement. The program leaves out the keys that
    change nothing in a reference."""
    return field_settings(one) == field_settings(other)


def motions(cases: Iterable[Case]) -> list[Case]:
    """One case of each set of references that have the same field."""
    found: dict[str, Case] = {}
    for case in cases:
        found.setdefault(field_settings(case), case)
    return list(found.values())


def by_reference(selection: Selection, found: list[Group], column: str) -> list[list[Group]]:
    """The groups of `found` as lists of those whose references have the same values of the column, to nine digits: a
    swept key often changes nothing in a reference."""
    sets: dict[tuple, list[Group]] = {}
    for group in found:
        with_one = [(c, r) for c in group.cases if (r := selection.added_reference_of(c))]
        pairs = [(str(x_position(selection, c)), f"{r.value(column, math.nan):.9g}") for c, r in with_one]
        values = {value for _, value in pairs}
        if pairs:
            sets.setdefault(tuple(values if len(values) == 1 else pairs), []).append(group)
    return list(sets.values())


def references_label(selection: Selection, found: list[Group]) -> str:
    """The name of the references of some groups: with the keys on which they depend, or with the curves to which they belong
    if they differ within a curve."""
    own = motions([r for group in found for r in references(selection, group)])
    if len(own) == 1:
        return case_label(selection, own[0])
    return f"{reference_name(own)}, {' and '.join(group.label for group in found)}"


@remembered
def all_references(selection: Selection) -> list[Case]:
    """The distinct complete references of all groups."""
    found = {r.id: r for group in groups(selection) for r in references(selection, group)}
    return list(found.values())


def added_references(selection: Selection) -> list[Case]:
    """The distinct complete references that are not cases of the sweep, which curves show as dashed lines."""
    return [r for r in all_references(selection) if r.is_reference]


def curve_value(selection: Selection, case: Case, column: str) -> float:
    """The value of a case in a curve. A ratio of a case to itself is part of the dashed line at 1."""
    is_one = selection.is_ratio(column) and selection.reference_of(case) is case
    return math.nan if is_one else case.value(column, math.nan)


@remembered
def with_references(selection: Selection) -> list[Case]:
    """The complete cases, then their references, one of each set with the same field. A case of the sweep that is the
    reference of itself or of others occurs once."""
    return [*ordinary(selection), *motions(added_references(selection))]


def references_among(cases: list[Case]) -> str:
    """'10 of them references', 'a reference' if this is the only case, '' without references."""
    found = sum(c.is_reference for c in cases)
    one = "a reference" if found == 1 else "references"
    if found == len(cases):
        return one if found == 1 else f"all {one}" if found else ""
    return f"{found} of them {one}" if found else ""


def count_of(cases: list[Case]) -> str:
    """The number of cases, which names references: '51 cases, 10 of them references'."""
    if cases and all(c.is_reference for c in cases):
        return words.counted(len(cases), "reference")
    among = references_among(cases)
    return words.counted(len(cases), "case") + (f", {among}" if among else "")


def modulation(selection: Selection) -> str:
    """The kind of modulation of all cases that are no references, if it differs from that of a reference, else ''."""
    kinds, of_references = ({c.setting("load", "modulation", "kind", default="") for c in cases}
                            for cases in (ordinary(selection), all_references(selection)))
    return kinds.pop() if len(kinds) == 1 and of_references - kinds else ""


def reference_name(cases: list[Case]) -> str:
    kinds = {c.setting("load", "modulation", "kind", default="") for c in cases}
    if len(kinds) != 1 or kinds == {""}:
        return "reference"
    kind = kinds.pop()
    return f"plain {kind}" if kind == "STM" else f"reference {kind}"


@dataclass
class Panel:
    """Cases whose lines share a panel, and their references."""
    title: str
    cases: list[Case]
    references: list[Case]

    @property
    def drawn(self) -> list[Case]:
        return [*self.cases, *self.references]


@remembered
def panels(selection: Selection) -> list[Panel]:
    """One panel per group with its references. A case of the sweep that is the only reference of another group is drawn there, too."""
    made = []
    for group in groups(selection):
        found = motions(references(selection, group))
        made.append(Panel(group.label, group.cases, [r for r in found if r.is_reference or (len(found) == 1 and r not in group.cases)]))
    return made


def receptor_classes(selection: Selection) -> list[str]:
    """The classes of receptors with columns in the table."""
    end = "_total_rate_Hz"
    return [column.name.removesuffix(end) for column in selection.sweep.columns if column.name.endswith(end)]
