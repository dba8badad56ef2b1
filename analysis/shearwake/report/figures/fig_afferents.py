# SPDX-License-Identifier: BSD-3-Clause
"""The responses of each class of afferents against the swept key."""
from __future__ import annotations

import math
from dataclasses import replace

from ...case import Case
from .. import labels, layout, style
from ..figure import Figure
from ..load import Selection
from ..page.curve_chart import curve_chart
from . import fig_curves

PANELS = ("total_rate_Hz", "peak_rate_Hz", "active_1", "rate_Hz", "near_path_1", "spread_mm", "vector_strength_1")


# Spikes per firing afferent: random phases alone give a vector strength of sqrt(pi / 4n) on average, 0.40 for n = 5. The
# column `_locking_1` has the same limit.
FEWEST = 5


class Without(Case):
    """A case with an empty value in place of that of a column."""

    def __init__(self, case: Case, column: str) -> None:
        self.__dict__.update(vars(case))
        self.column = column

    @property
    def values(self) -> dict[str, float]:
        return {**super().values, self.column: math.nan}


def with_enough_spikes(selection: Selection, kind: str) -> tuple[Selection, list[Case]]:
    """The selection without the vector strengths of cases with too few spikes, and the number of these cases."""
    few = [c for c in selection.cases if not math.isnan(c.value(f"{kind}_vector_strength_1", math.nan))
           and not c.value(f"{kind}_spikes_1", math.nan) >= FEWEST * c.value(f"{kind}_active_1", math.nan)]
    rest = [Without(c, f"{kind}_vector_strength_1") if c in few else c for c in selection.cases]
    return replace(selection, cases=rest), few


def class_figure(selection: Selection, kind: str) -> Figure | None:
    selection, few = with_enough_spikes(selection, kind)
    name = f"afferents_{kind}"
    charts = {column: curve_chart(selection, name, column) for panel in PANELS if fig_curves.has_any(selection, column := f"{kind}_{panel}")}
    if not charts or not any(c.value(f"{kind}_spikes_1", math.nan) > 0 for c in layout.ordinary(selection)):
        return None
    for chart in charts.values():
        chart.begin_at_zero()
    return fig_curves.curves_figure(
        selection, name, f"{kind} afferents against {labels.name(selection, selection.x)}", charts,
        f"Response of the {kind} afferents: the spikes per second of all of them together, on average and in the 50 ms with most spikes, "
        "the number of afferents that respond and their mean rate, the fraction of the spikes whose receptors are at most a focal radius "
        "from the path of the focus, the rms distance of the spikes from the path, and the vector strength of the spikes at the modulation "
        "frequency (1: all spikes have the same phase)." + few_caption(few) + " Panels without a value in any case are omitted.", 1.35)


def few_caption(few: list[Case]) -> str:
    """States which vector strengths are not drawn, and why."""
    if not few:
        return ""
    return (f" The vector strength of {layout.count_of(few)} with fewer than {FEWEST} spikes per firing afferent is not drawn: "
            "that of n spikes with random phases is 0.89/√n on average, 0.4 for five.")


def figures(selection: Selection) -> list[Figure]:
    if not selection.x or len(layout.groups(selection)) > style.CURVES:
        return []
    values = {layout.x_position(selection, c) for c in layout.ordinary(selection) if c.is_complete}
    if len([v for v in values if not math.isnan(v)]) < 2:
        return []
    return [f for kind in layout.receptor_classes(selection) if (f := class_figure(selection, kind))]
