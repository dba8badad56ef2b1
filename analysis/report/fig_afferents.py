# SPDX-License-Identifier: BSD-3-Clause
"""The responses of each class of afferents against the swept key."""
import math

import fig_curves as curves_module
import layout
import style
from figure import Figure
from validity import invalid_caption
from words import key_name

CLASSES = ["SA1", "RA", "PC"]
PANELS = [("spikes_1", "spikes"), ("rate_Hz", "rate of the\nactive (Hz)"),
          ("spread_mm", "spread (mm)"), ("vector_strength_1", "vector strength (1)")]


def class_figure(sweep, folder, kind):
    columns = [(f"{kind}_{name}", label) for name, label in PANELS]
    columns = [c for c in columns if curves_module.has_any(sweep, c[0])]
    if not columns or not any(c.value(f"{kind}_spikes_1") > 0 for c in layout.ordinary(sweep)):
        return None
    name, curves = f"afferents_{kind}", curves_module.curves_of(sweep)
    figure, made = curves_module.panels(len(columns), curves, height_in=1.35)
    for axes, (column, label) in zip(made, columns):
        for group, colour, marker in curves:
            curves_module.draw_curve(axes, sweep, group, column, name, marker=marker, color=colour,
                                     linestyle="-" if layout.is_numeric(sweep) else "none")
        labels = curves_module.reference_lines(axes, sweep, curves, column, name)
        low, high = axes.get_ylim()
        axes.set_ylim(min(0.0, low), max(1.06 * high, 1e-9))
        axes.set_ylabel(label)
        style.label_right(axes, labels)
    curves_module.set_x_axis(made[-1], sweep)
    curves_module.legend_above(figure, sweep, curves)
    style.save(figure, folder / f"{name}.png")
    title = f"{kind} afferents against {key_name(sweep.x)}"
    return Figure(name, title,
                  f"Response of the {kind} afferents: the number of spikes, the mean rate of the afferents that "
                  "fire, the rms distance of the spikes from the path of the focus, and the vector strength of the "
                  "spikes at the modulation frequency (1: all spikes have the same phase). Panels without a "
                  "value in any case are omitted." + invalid_caption(sweep, name, *(c for c, _ in columns)), title)


def figures(sweep, folder):
    if not sweep.x or len(layout.groups(sweep)) > style.CURVES:
        return []
    values = {layout.x_position(sweep, c) for c in layout.ordinary(sweep) if c.whole}
    if len([v for v in values if not math.isnan(v)]) < 2:
        return []
    return [f for kind in CLASSES if (f := class_figure(sweep, folder, kind))]
