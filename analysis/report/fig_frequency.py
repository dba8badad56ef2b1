"""The dominant frequency at the centre and the share of its energy in bands, against x."""
import math

import numpy as np

import fig_curves
import layout
import style
import wake
from figure import Figure
from words import listed

BANDS_Hz = [(40.0, 400.0)]  # vibration that is felt, where the job has no `measure.bands_Hz`


def bands(sweep):
    """(low, high) in Hz: those that the job asked for, else what is felt."""
    for case in layout.ordinary(sweep):
        edges = case.setting("measure", "bands_Hz", default=[])
        if edges:
            return list(zip(edges[::2], edges[1::2]))
    return BANDS_Hz


def energy_share(u, interval_s, low, high):
    """Of the spectrum of u above one period a run; padded fourfold, so that bands end where they
    should."""
    energy = np.abs(np.fft.rfft(u, n=4 * len(u))) ** 2
    frequency = np.fft.rfftfreq(4 * len(u), interval_s)
    above = frequency > 1.0 / (len(u) * interval_s)
    total = energy[above].sum()
    inside = above & (frequency >= low) & (frequency <= high)
    return float(energy[inside].sum() / total) if total > 0 else math.nan


def share(case, low, high, of=""):
    """The column `share_...`, or the same from the trace; NaN where there is neither. `of`:
    "velocity_" for du/dt."""
    name = f"{of}share_{low:g}_{high:g}_1"
    if name in case.scalars:
        return case.value(name)
    time = case.series["time"]
    if of or not case.traces or len(time) < 2 or high > 0.5 / (time[1] - time[0]):
        return math.nan
    nearest = min(case.traces, key=lambda trace: math.hypot(*trace[0]))[1]
    return energy_share(nearest, time[1] - time[0], low, high)


def peaks(sweep):
    """(column, whose spectrum) of the dominant frequencies that most cases have."""
    cases = layout.ordinary(sweep)
    both = [("peak_frequency_Hz", "u"), ("velocity_peak_frequency_Hz", "du/dt")]
    return [(column, of) for column, of in both
            if 2 * sum(not math.isnan(c.value(column)) for c in cases) > len(cases)]


def draw_peaks(axes, sweep, curves, column, of):
    numeric = layout.is_numeric(sweep)
    for (group, colour, marker), aside in zip(curves, fig_curves.asides(sweep, curves)):
        x, y = fig_curves.points(sweep, group, column, aside)
        axes.plot(x, y, marker=marker, color=colour, markersize=6, zorder=3,
                  linestyle="-" if numeric else "none")
    labels = fig_curves.reference_lines(axes, sweep, curves, column, "--")
    axes.set_ylabel("frequency (Hz)")
    axes.set_title(f"dominant frequency of {of}", loc="left", color="#555555")
    axes.set_ylim(0.0, 1.15 * axes.get_ylim()[1])
    style.label_right(axes, labels)


def draw_band(axes, sweep, curves, band):
    """Filled: of u; open and dashed: of du/dt."""
    numeric = layout.is_numeric(sweep)
    for (group, colour, marker), aside in zip(curves, fig_curves.asides(sweep, curves)):
        x = [layout.x_position(sweep, c) + aside for c in group.cases]
        for of, line, face in (("", "-", colour), ("velocity_", "--", "white")):
            axes.plot(x, [share(c, *band, of) for c in group.cases], marker=marker, color=colour,
                      markersize=5, zorder=3, markerfacecolor=face,
                      linestyle=line if numeric else "none")
    axes.set_ylim(-0.02, 1.04)
    axes.set_ylabel("share (1)")
    axes.set_title("energy within {:g} to {:g} Hz".format(*band), loc="left", color="#555555")


def caption(sweep, found, shown):
    text = []
    if found:
        text.append("Where the spectrum at the centre, of "
                    + listed("the displacement u" if of == "u" else "the velocity du/dt"
                             for _, of in found) + ", is highest above one period a run.")
    if shown:
        text.append("What share of the energy above one period a run lies in a band.")
        if any(not math.isnan(share(c, *b, "velocity_")) for c in layout.ordinary(sweep)
               for b in shown):
            text.append("Filled markers: of u; open ones, dashed: of du/dt.")
    if "u" not in [of for _, of in found] and found:
        text.append("u itself is largest at 0 Hz in most cases and so has no dominant frequency.")
    kinds = {c.setting("load", "modulation", "kind", default="") for c in layout.ordinary(sweep)}
    if kinds != {"STM"} and all(wake.passing_ms(c) is not None for c in layout.ordinary(sweep)):
        text.append("The focus passes the centre once, so that this is one passage and depends on "
                    "the phase that the modulation has just then.")
    return " ".join(text)


def figures(sweep, folder):
    cases = layout.ordinary(sweep)
    if not sweep.x or len(layout.groups(sweep)) > style.CURVES:
        return []
    found = peaks(sweep)
    shown = [b for b in bands(sweep) if any(not math.isnan(share(c, *b)) for c in cases)]
    if not found and not shown:
        return []
    curves = fig_curves.curves_of(sweep)
    figure, made = fig_curves.panels(len(found) + len(shown), curves, height_in=1.75)
    for axes, (column, of) in zip(made, found):
        draw_peaks(axes, sweep, curves, column, of)
    for axes, band in zip(made[len(found):], shown):
        draw_band(axes, sweep, curves, band)
    fig_curves.set_x_axis(made[-1], sweep)
    fig_curves.legend_above(figure, sweep, curves)
    style.save(figure, folder / "frequency.png")
    parts = ["dominant frequency"] * bool(found) + ["energy in bands"] * bool(shown)
    title = f"{' and '.join(parts)} against {layout.name(sweep, sweep.x)}"
    title = title[:1].upper() + title[1:]
    return [Figure("frequency", title, caption(sweep, found, shown), title)]
