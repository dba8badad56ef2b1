# SPDX-License-Identifier: BSD-3-Clause
"""The responses of each class of afferents against the swept key."""
from __future__ import annotations

import math
from dataclasses import replace

from ...case import Case
from .. import labels as labels_module, layout, style
from ..figure import Figure
from ..load import Selection
from ..validity import invalid_caption
from . import fig_curves as curves_module, fig_heat

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
    columns = [column for name in PANELS if curves_module.has_any(selection, column := f"{kind}_{name}")]
    if not columns or not any(c.value(f"{kind}_spikes_1", math.nan) > 0 for c in layout.ordinary(selection)):
        return None
    name, curves = f"afferents_{kind}", curves_module.curves_of(selection)
    figure, made = curves_module.panels(len(columns), curves, height_in=1.35)
    for axes, column in zip(made, columns):
        for group, colour, marker in curves:
            curves_module.draw_curve(axes, selection, group, column, name, marker=marker, color=colour,
                                     linestyle="-" if layout.is_numeric(selection) else "none")
        labels = curves_module.reference_lines(axes, selection, curves, column, name)
        low, high = axes.get_ylim()
        axes.set_ylim(min(0.0, low), max(1.06 * high, 1e-9))
        axes.set_ylabel(fig_heat.measure_label(selection, column, 20))
        style.label_right(axes, labels)
    curves_module.set_x_axis(made[-1], selection)
    curves_module.legend_above(figure, curves)
    title = f"{kind} afferents against {labels_module.name(selection, selection.x)}"
    return Figure(figure, name, title,
                  f"Response of the {kind} afferents: the spikes per second of all of them together, on average and in the 50 ms "
                  "with most spikes, the number of afferents that respond and their mean rate, the fraction of the spikes whose receptors are at most a "
                  "focal radius from the path of the focus, the rms distance of the spikes from the path, and the vector strength of "
                  "the spikes at the modulation frequency (1: all spikes have the same phase)." + few_caption(few)
                  + " Panels without a value in any case are omitted." + invalid_caption(selection, name, *columns), title)


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
