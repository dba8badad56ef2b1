# SPDX-License-Identifier: BSD-3-Clause
"""Arranges the figures of the page: the result first, then the other figures by topic."""
import functools
from collections.abc import Iterable

from ..figure import Figure

EFFICIENCY = ("optimise_front", "uncertain_bands", "eta", "heat_eta_period_1", "multiples_eta_period_1", "eta_time")
LEVEL = ("felt", "heat_felt_path_dB", "multiples_felt_path_dB")
STRENGTH = ("displacement", "strength", "heat_focal_rms_um", "heat_focal_rms_over_reference_1")

# Title of a topic and the beginnings of the names of its figures; the first match counts.
SENSATION = "Level of sensation"
TOPICS = [
    ("The best modulation", ("optimise_",)),
    ("Uncertainty and sensitivity", ("uncertain_",)),
    ("Adaptive axes", ("adaptive",)),
    (SENSATION, ("sensation", "felt", "heat_felt", "multiples_felt")),
    ("Snapshots and profiles", ("surface", "profiles", "intensity")),
    ("Receptors", ("heat_RA", "heat_PC", "heat_SA1")),
    ("Efficiency and strength", ("gain", "strength", "displacement", "heat_eta", "heat_focal", "multiples_eta",
                                 "multiples_focal", "eta")),
    ("Spread of the vibration", ("ipr_abs", "participation", "ipr", "sharpness", "heat_", "multiples_")),
    ("Displacement and spectra at the trace points", ("traces", "spectra", "spectrograms", "frequency")),
    ("Motion and force of the focus", ("drive",)),
    ("Medium and volumes", ("medium", "volume")),
    ("Receptors", ("",)),
]


def first_of(figures: list[Figure], names: Iterable[str]) -> Figure | None:
    found = {figure.name: figure for figure in figures}
    return next((found[name] for name in names if name in found), None)


def headlines(figures: list[Figure], receptors_first: bool = False, level_first: bool = False) -> list[Figure]:
    """What an optimum draws, and the figures of efficiency and of strength, as far as they exist. Those of the receptors or of the
    level of sensation precede them if they answer the question."""
    names = [("optimise_mean",), LEVEL if level_first else (), EFFICIENCY, STRENGTH]
    found = [f for f in (first_of(figures, n) for n in names) if f]
    receptors = [f for f in figures if f.name.startswith(("afferents_", "hand_", "receptors"))] if receptors_first else []
    return [*receptors[:2], *found]


@functools.cache
def topic_of(name: str) -> str:
    return next(title for title, beginnings in TOPICS if name.startswith(beginnings))


def topics(figures: list[Figure], first: list[Figure]) -> list[tuple[str, list[Figure]]]:
    """The figures that do not come first as pairs (title, figures), in the order of TOPICS."""
    rest = [f for f in figures if f not in first]
    titles = reversed(dict.fromkeys(title for title, _ in reversed(TOPICS)))
    grouped = [(title, [f for f in rest if topic_of(f.name) == title]) for title in titles]
    return [(title, members) for title, members in grouped if members]
