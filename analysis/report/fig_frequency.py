"""The dominant frequency at the centre and the share of its energy in bands, against x."""
import math

import numpy as np

import fig_curves
import layout
import style
from figure import Figure
from words import key_name, listed

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


def share(case, low, high):
    """The column `share_...`, or the same from the trace; NaN where there is neither."""
    name = f"share_{low:g}_{high:g}_1"
    if name in case.scalars:
        return case.value(name)
    time = case.series["time"]
    if not case.traces or len(time) < 2 or high > 0.5 / (time[1] - time[0]):
        return math.nan
    nearest = min(case.traces, key=lambda trace: math.hypot(*trace[0]))[1]
    return energy_share(nearest, time[1] - time[0], low, high)


def draw_frequencies(axes, sweep, curves):
    numeric = layout.is_numeric(sweep)
    for group, colour, marker in curves:
        x, y = fig_curves.points(sweep, group, "peak_frequency_Hz")
        axes.plot(x, y, marker=marker, color=colour, markersize=6, zorder=3,
                  linestyle="-" if numeric else "none")
    labels = fig_curves.reference_lines(axes, sweep, curves, "peak_frequency_Hz", "--")
    axes.set_ylabel("dominant frequency (Hz)")
    axes.set_ylim(0.0, 1.15 * axes.get_ylim()[1])
    style.label_right(axes, labels)


def draw_band(axes, sweep, curves, band):
    numeric = layout.is_numeric(sweep)
    for group, colour, marker in curves:
        x = [layout.x_position(sweep, c) for c in group.cases]
        axes.plot(x, [share(c, *band) for c in group.cases], marker=marker, color=colour,
                  markersize=5, zorder=3, linestyle="-" if numeric else "none")
    axes.set_ylim(-0.02, 1.04)
    axes.set_ylabel("share (1)")
    axes.set_title("within {:g} to {:g} Hz".format(*band), loc="left", color="#555555")


def figures(sweep, folder):
    cases = layout.ordinary(sweep)
    if (not sweep.x or len(layout.groups(sweep)) > style.CURVES
            or not fig_curves.has_any(sweep, "peak_frequency_Hz")):
        return []
    found = [b for b in bands(sweep) if any(not math.isnan(share(c, *b)) for c in cases)]
    curves = fig_curves.curves_of(sweep)
    figure, made = fig_curves.panels(1 + len(found), curves, height_in=1.75)
    draw_frequencies(made[0], sweep, curves)
    for axes, band in zip(made[1:], found):
        draw_band(axes, sweep, curves, band)
    fig_curves.set_x_axis(made[-1], sweep)
    fig_curves.legend_above(figure, sweep, curves)
    style.save(figure, folder / "frequency.png")
    title = f"Dominant frequency and bands against {key_name(sweep.x)}"
    text = ("Where the spectrum of u at the centre is highest above one period a run, and what "
            "share of the energy above that lies in a band")
    if found:
        text += ": " + listed("{:g} to {:g} Hz".format(*b) for b in found)
    empty = sum(math.isnan(c.value("peak_frequency_Hz")) for c in cases)
    if empty:
        text += (f". {empty} of {len(cases)} cases have no dominant frequency: the reasons stand "
                 "below the table")
    return [Figure("frequency", title, text + ".", title)]
