# SPDX-License-Identifier: BSD-3-Clause
"""The warnings that are stored with the cases, and the figures that they concern.

`of_figure(sweep, name)` gives the sentences to print next to a figure.
"""
import re

import layout
import topics
from words import counted

OF_DRIVE = ("drive",)  # shows the prescribed load alone
OF_SURFACES = ("surface", "intensity", "player", "slices", "medium")  # show fields, not readings


def starts_with(name, beginnings):
    return any(name.startswith(b) for b in beginnings)


def is_of_receptors(name):
    """Whether a figure belongs to the last topic, which has all figures that belong to no other."""
    return name != "player" and not any(starts_with(name, beginnings) for _, beginnings in topics.TOPICS[:-1])


def concerns(case, key, name):
    """Whether a warning about this key of a case concerns the figure of this name."""
    if key.startswith("afferents."):
        return is_of_receptors(name)
    if is_of_receptors(name) and case.setting("afferents", "input", default="") == "carrier":
        return False  # the pins move as prescribed, independently of the simulated skin
    if starts_with(name, OF_DRIVE):
        return False
    if key.startswith("measure."):  # at_ms is also the default time of the snapshots
        return not is_of_receptors(name) and (key == "measure.at_ms" or not starts_with(name, OF_SURFACES))
    return True


def kind(warning):
    """Equal for warnings that differ only in their numbers."""
    return warning["severity"], warning["key"], re.sub(r"[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?", "#", warning["message"])


def sentences(sweep, cases, name=None):
    """One sentence for each kind of warning, with its first wording and the number of cases."""
    found = {}
    for case in cases:
        for warning in case.warnings:
            if name is None or concerns(case, warning["key"], name):
                found.setdefault(kind(warning), []).append((case, warning))
    lines = []
    for (severity, _, _), entries in sorted(found.items(), key=lambda item: item[0][0] != "error"):
        case, warning = entries[0]
        start = "Not valid" if severity == "error" else "Warning"
        where = ""
        if len(cases) > 1:
            where = f" ({layout.case_label(sweep, case)}"
            if len(entries) > 1:
                where += f", and {counted(len(entries) - 1, 'more case')}"
            where += ")"
        lines.append(f"{start}: {warning['message']}{where}.")
    return lines


def of_figure(sweep, name):
    """The sentences to print next to the figure `name`, about the complete cases of the sweep."""
    return sentences(sweep, [c for c in sweep.cases if c.whole], name)
