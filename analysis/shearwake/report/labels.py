# SPDX-License-Identifier: BSD-3-Clause
"""Names of swept keys, and labels of their values."""
import re
from typing import Any

from ..case import Case
from ..keys import label
from . import words
from .load import Selection, remembered

KIND = "load.modulation.kind"
BODY = re.compile(r"^(medium\.body\[(\d+)\])\.(c_s|c_p|density|viscosity)_")
DEPTH = re.compile(r"medium\.body\[\d+\]\.depth_")
MATERIAL = ("c_s_m_s", "c_p_m_s", "density_kg_m3", "viscosity_Pa_s")


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


@remembered
def ordinary(selection: Selection) -> list[Case]:
    return [c for c in selection.cases if c.is_complete and not c.is_reference]


@remembered
def swept_cases(selection: Selection) -> list[Case]:
    """All cases except references, with or without a result: heat maps have a cell for each."""
    return [c for c in selection.cases if not c.is_reference]


@remembered
def values_of(selection: Selection, key: str) -> list:
    """All values of a key: sorted numbers, or strings in the order of the plan."""
    values = list(dict.fromkeys(c.settings[key] for c in swept_cases(selection) if key in c.settings))
    return sorted(values) if all(map(is_number, values)) else values


@remembered
def displayed_key(selection: Selection, key: str) -> str:
    """The key itself, or the common key of a frequency or a phase that AM and SM share."""
    for what in ("frequency_Hz", "phase_deg"):
        am, sm = f"load.modulation.am_{what}", f"load.modulation.sm_{what}"
        if key in (am, sm) and {am, sm} <= set(selection.sweep.swept_keys):
            same = all(c.settings.get(am) == c.settings.get(sm) for c in swept_cases(selection))
            return f"load.modulation.modulation_{what}" if same else key
    return key


def name(selection: Selection, key: str) -> str:
    """The name of a key, with its table if another swept key has the same name and other values: 'AM depth, carrier'. AM
    and SM frequencies that are swept together have a common name, since a case has only one of them."""
    shown = displayed_key(selection, key)
    title = with_body_name(selection, key, label(shown))
    alike = [k for k in selection.sweep.swept_keys if k != key and label(displayed_key(selection, k)) == title]
    if shown != key or all(c.settings.get(k) == c.settings.get(key) for k in alike for c in swept_cases(selection)):
        return title
    return f"{title}, {key.split('.')[-2]}" if "." in key else title


def with_body_name(selection: Selection, key: str, title: str) -> str:
    """The name of a key in which the name of a body stands for its number: 'depth, metacarpal'. The keys of a material that a
    label describes have the name of the body alone."""
    place = re.search(r"\bbody\[(\d+)\]", key)
    found = ordinary(selection) if place else []
    bodies = [c.setting("medium", "body", default=[]) for c in found]
    names = {b[int(place[1]) - 1].get("name", "") if place and len(b) >= int(place[1]) else "" for b in bodies}
    if len(names) == 1 and (own := names.pop()) and place:
        title = title.replace(f"body {place[1]}", own)
    if BODY.match(key) and any((key, v) in labels(selection) for v in values_of(selection, key)):
        return title.partition(", ")[2] or title
    return title


def axis_label(selection: Selection, key: str) -> str:
    """The name of a key, with its unit if the values are numbers."""
    if all(is_number(v) and (key, v) not in labels(selection) for v in values_of(selection, key)):
        return words.axis_label(displayed_key(selection, key), name(selection, key))
    text = name(selection, key)
    return text[:1].upper() + text[1:]


def setting_text(selection: Selection, key: str, value: Any) -> str:
    """The label of a value, or key, value and unit: 'AM frequency 400 Hz'."""
    return labels(selection).get((key, value)) or words.setting_text(name(selection, key), key, rounded(selection, key, value))


def value_text(selection: Selection, key: str, value: Any) -> str:
    """The label of a value, or the value and its unit: '400 Hz'."""
    return labels(selection).get((key, value)) or words.value_text(key, rounded(selection, key, value))


def amount_text(selection: Selection, key: str, value: Any) -> str:
    """The label of a value, or the value and its unit as they stand next to the name of the key."""
    return labels(selection).get((key, value)) or words.amount_text(key, rounded(selection, key, value))


def rounded(selection: Selection, key: str, value: Any) -> Any:
    """The value; that of an uncertain key with four digits, since it is drawn at random."""
    return float(f"{value:.4g}") if selection.sweep.uncertain and key in selection.sweep.uncertain["keys"] else value


def settings_text(selection: Selection, case: Case) -> str:
    """All settings of a case. Keys of the same name and value, which are swept together, appear once; of the material of a body
    that has a label, only the label."""
    labelled = {m[1]: k for k, v in case.settings.items() if (k, v) in labels(selection) and (m := BODY.match(k))}
    return ", ".join(dict.fromkeys(setting_text(selection, k, v) for k, v in case.settings.items()
                                   if not (m := BODY.match(k)) or labelled.get(m[1], k) == k))


def labels(selection: Selection) -> dict[tuple[str, Any], str]:
    """{(swept key, value): label}: those of [table] labels and, for a body that is swept between a material and that of its
    surroundings, 'with metacarpal' and 'without metacarpal'. For keys that change together, those of the first stand for all."""
    found = selection.sweep.__dict__.get("_labels_of_values")
    if found is None:
        found = {**_body_labels(selection), **selection.sweep.labels}
        selection.sweep.__dict__["_labels_of_values"] = found
    return found


def _body_labels(selection: Selection) -> dict[tuple[str, Any], str]:
    found: dict[tuple[str, Any], str] = {}
    keys = {m[1]: (k, int(m[2])) for k in reversed(selection.sweep.swept_keys) if (m := BODY.match(k))}
    for key, index in keys.values():
        present: dict[Any, set[bool]] = {}
        title = ""
        for case in (c for c in selection.cases if c.is_complete and key in c.settings):
            bodies, layers = case.setting("medium", "body", default=[]), case.setting("medium", "layer", default=[])
            if index > len(bodies) or len(layers) != 1:
                return {}  # several layers: the surroundings of the body are not a single material
            body = bodies[index - 1]
            title = str(body.get("name") or body.get("preset") or f"body {index}")
            differs = any(body.get(k) != layers[0].get(k) for k in MATERIAL)
            present.setdefault(case.settings[key], set()).add(differs)
        if all(len(kinds) == 1 for kinds in present.values()) and {b for kinds in present.values() for b in kinds} == {True, False}:
            several = sum(True in kinds for kinds in present.values()) > 1
            found |= {(key, value): f"{'with' if True in kinds else 'without'} {title}" for value, kinds in present.items()
                      if not (several and True in kinds)}
    return found


def is_nominal(selection: Selection, key: str, value: Any) -> bool:
    """Whether a value is a name, not an amount."""
    return not is_number(value) or (key, value) in labels(selection)


def place_text(selection: Selection, settings: dict[str, Any], keys: list[str]) -> str:
    """'AM frequency 400 Hz', or 'SM-STM at AM frequency 400 Hz' if a value is a name; 'with bone, 8 mm deep'."""
    shown = {k: settings[k] for k in keys if k and k in settings}
    names = [value_text(selection, k, v) if k == KIND else setting_text(selection, k, v) for k, v in shown.items() if is_nominal(selection, k, v)]
    numbers = {k: v for k, v in shown.items() if not is_nominal(selection, k, v)}
    if any(text.startswith("with ") for text in names):
        names += [f"{amount_text(selection, k, numbers.pop(k))} deep" for k in list(numbers) if DEPTH.match(k)]
    amounts = [setting_text(selection, k, v) for k, v in numbers.items()]
    return " at ".join(filter(None, [", ".join(names), ", ".join(amounts)]))


def placed(selection: Selection, settings: dict[str, Any], keys: list[str], place: str) -> str:
    """' at AM frequency 400 Hz', ' with SM-STM at AM frequency 400 Hz', ' with bone', ' with the metacarpal 8 mm deep'; '' without a
    place."""
    if not place or place.startswith(("with ", "without ")):
        return f" {place}".rstrip()
    first = next((k for k in keys if k and k in settings), "")
    if DEPTH.match(first) and not is_nominal(selection, first, settings[first]):
        return f" with {'' if place.startswith('body ') else 'the '}{place}"
    return f" {'with' if any(is_nominal(selection, k, settings[k]) for k in keys if k and k in settings) else 'at'} {place}"
