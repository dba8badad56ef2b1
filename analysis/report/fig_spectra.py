"""Spectra of the displacement at the trace nearest to the centre, every case over the reference."""
import math

import matplotlib.pyplot as plt
import numpy as np

import fig_time
import layout
import style
from figure import Figure
from words import key_name, listed, number, split_unit, value_text

SHOWN_Hz = 1000.0
MODULATIONS = ("am_frequency", "sm_frequency", "draw_frequency")


def own_frequency_Hz(sweep, case):
    """The frequency of the case's modulation where x is one; else NaN."""
    name, unit = split_unit(sweep.x or "")
    factor = {"Hz": 1.0, "kHz": 1e3}.get(unit)
    value = case.settings.get(sweep.x)
    if name not in MODULATIONS or factor is None or not layout.is_number(value):
        return math.nan
    return factor * value


def spectrum(case):
    """Without the mean: one-sided, it counts half and would look like a step."""
    frequency, amplitude = case.spectrum
    return frequency[frequency > 0], amplitude[frequency > 0]


def unit_of(cases):
    """nm for a spectrum that fits it, um above."""
    largest = max(np.nanmax(spectrum(c)[1], initial=0.0) for c in cases)
    return ("µm", 1e6) if largest >= 1e-6 else ("nm", 1e9)


def draw_case(axes, sweep, case, factor, colour, **look):
    frequency, amplitude = spectrum(case)
    axes.plot(frequency, factor * amplitude, color=colour, **look)
    own = own_frequency_Hz(sweep, case)
    if own <= SHOWN_Hz:
        axes.plot([own, own], [0.0, 0.035], color=colour, linewidth=2.0, clip_on=False,
                  transform=axes.get_xaxis_transform())


def draw_group(axes, sweep, group, colours, factor, few):
    for reference in layout.references(sweep, group):
        if reference.spectrum:
            frequency, amplitude = spectrum(reference)
            axes.plot(frequency, factor * amplitude, color="black", linewidth=1.8,
                      label=layout.reference_name([reference]) if few else None)
    for case in group.cases:
        if case.spectrum:
            word = value_text(sweep.x, case.settings[sweep.x]) if sweep.x else "this case"
            draw_case(axes, sweep, case, factor, colours[case.id], linewidth=1.3 if few else 0.7,
                      label=word if few else None)
    axes.set_xlim(0.0, SHOWN_Hz)


def figures(sweep, folder):
    found = [g for g in layout.groups(sweep) if any(c.spectrum for c in g.cases)]
    cases = [c for g in found for c in g.cases if c.spectrum]
    if not cases:
        return []
    colours = fig_time.colours_by_x(sweep, cases)
    few = len(layout.x_values(sweep)) <= style.DIRECT_LABELS if sweep.x else True
    unit, factor = unit_of(cases + [r for r in layout.all_references(sweep) if r.spectrum])
    height = 3.4 if len(found) == 1 else 2.3
    figure, made = plt.subplots(len(found), 1, sharex=True, sharey=True, squeeze=False,
                                figsize=(style.WIDTH_in, 0.75 + height * len(found)),
                                layout="constrained")
    for axes, group in zip(made[:, 0], found):
        draw_group(axes, sweep, group, colours, factor, few)
        axes.set_ylabel(f"amplitude of $u_z$ ({unit})")
        axes.set_ylim(bottom=0.0)
        axes.set_title(group.label, loc="left", color="#555555")
    made[-1, 0].set_xlabel("frequency (Hz)")
    if few:
        made[0, 0].legend(loc="upper left", bbox_to_anchor=(1.01, 1.03), handlelength=1.4)
    else:
        fig_time.add_x_bar(figure, list(made[:, 0]), sweep, colours)
    style.save(figure, folder / "spectra.png")
    return [Figure("spectra", "Spectra at the centre", caption(sweep, cases), "Amplitude spectra of "
                   "the displacement at the centre, one line a case")]


def passing_ms(case):
    """When the moving focus comes nearest to the trace, if it covers it once; else None."""
    radius = case.setting("measure", "focal_radius_m")
    distance = np.hypot(case.series["focus_x"] - case.trace_at_m[0],
                        case.series["focus_y"] - case.trace_at_m[1])
    covered = distance <= radius
    entries = np.count_nonzero(np.diff(covered.astype(int)) == 1) + int(covered[0])
    return None if entries != 1 or covered.all() else 1e3 * case.series["time"][distance.argmin()]


def caption(sweep, cases):
    places = sorted({tuple(number(1e3 * v) for v in c.trace_at_m) for c in cases})
    duration = {round(c.series["time"][-1], 9) for c in cases}
    text = (f"One-sided amplitude of u at {listed(f'({x}, {y}) mm' for x, y in places)} over the "
            f"whole run, up to {number(SHOWN_Hz)} Hz.")
    if len(duration) == 1:
        run = duration.pop()
        text += (f" A run of {number(1e3 * run)} ms separates nothing closer than "
                 f"{number(1 / run, 2)} Hz.")
    passing = {number(t, 3) if (t := passing_ms(c)) is not None else None for c in cases}
    if len(passing) == 1 and None not in passing:
        text += (f" The focus passes this point once, at {passing.pop()} ms: the curves show that "
                 "passage, and their heights the phase that the modulation has just then.")
    if any(not math.isnan(own_frequency_Hz(sweep, c)) for c in cases):
        text += f" Ticks on the axis: each case's own {key_name(sweep.x)}."
    if layout.all_references(sweep):
        text += f" Black: {layout.reference_name(layout.all_references(sweep))}."
    return text
