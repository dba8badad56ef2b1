"""Which measures are drawn against the swept key, and what their captions say."""
import math

import layout
import fig_curves as curves_module
import style
from figure import Figure
from words import key_name, number

MEASURES = [
    {"name": "eta", "title": "Reconstruction efficiency against {x}",
     "period": "eta_period_1", "instant": "eta_at_1", "label": "efficiency η (1)",
     "caption": "η is the share of Σu² of the whole surface that lies inside the focal disc: the "
                "larger, the better the vibration stays where the focus is."},
    {"name": "ipr_abs", "title": "Spread of the vibration (IPR of |u|) against {x}",
     "period": "ipr_abs_period_mm2", "instant": "ipr_abs_at_mm2", "label": "(Σ|u|)² / Σu² (mm²)",
     "caption": "The area over which the displacement is spread, (Σ|u|)²/Σu² times the cell: it "
                "grows with spread, and weak, wide waves count much."},
    {"name": "participation", "title": "Participation area against {x}",
     "period": "participation_period_mm2", "instant": "participation_at_mm2",
     "label": "(Σu²)² / Σu⁴ (mm²)",
     "caption": "The area over which the energy is spread, (Σu²)²/Σu⁴ times the cell: it grows "
                "with spread, and strong spots count much."},
    {"name": "ipr", "title": "Literal inverse participation ratio against {x}",
     "period": "ipr_period_mm2", "instant": "ipr_at_mm2", "label": "(Σu)² / Σu² (mm²)",
     "log": True,
     "caption": "Read with care: the literal (Σu)²/Σu² measures compressibility, not spread. "
                "Nearly incompressible tissue keeps its volume, so what sinks in one place rises "
                "in another and Σu is close to zero; the value is then tiny whatever the pattern "
                "is. The two areas above measure the spread."},
]


def strength_figure(sweep, folder):
    """rms over the focal disc relative to the reference; in micrometres where there is none."""
    if not sweep.x or not curves_module.has_any(sweep, "focal_rms_um"):
        return None
    relative = bool(layout.all_references(sweep))
    curves = curves_module.curves_of(sweep)
    figure, (axes,) = curves_module.panels(1, curves, height_in=2.6)
    for group, colour, marker in curves:
        x, y = curves_module.points(sweep, group, "focal_rms_um")
        if relative:
            y = y / [focal_rms(sweep.reference_of(c)) for c in group.cases]
        axes.plot(x, y, marker=marker, color=colour, markersize=6, zorder=3,
                  linestyle="-" if layout.is_numeric(sweep) else "none")
    name = layout.reference_name(layout.all_references(sweep)) if relative else ""
    axes.margins(y=0.12)
    curves_module.widen(axes)
    if relative:
        axes.axhline(1.0, color=style.INK, linestyle="--", linewidth=1.3, zorder=1.5)
        low, high = axes.get_ylim()
        axes.set_ylim(max(0.0, min(low, 0.8)), max(high, 1.05))
        axes.set_ylabel(f"focal rms / {name} (1)")
        style.label_right(axes, [(1.0, name, style.INK)])
    else:
        axes.set_ylabel("focal rms (µm)")
    curves_module.set_x_axis(axes, sweep)
    curves_module.legend_above(figure, sweep, curves)
    style.save(figure, folder / "strength.png")
    title = f"Strength at the focus against {key_name(sweep.x)}"
    caption = ("The rms of u over the focal disc and whole modulation periods"
               + (f", relative to {name}." if relative else ".") + impulse_words(sweep, name))
    return Figure("strength", title, caption, title)


def focal_rms(reference):
    return reference.value("focal_rms_um") if reference else math.nan


def impulse_words(sweep, name):
    """A modulation that halves the mean force halves the displacement: say what was delivered."""
    shares = [c.value("impulse_mN_ms") / sweep.reference_of(c).value("impulse_mN_ms")
              for c in layout.ordinary(sweep)
              if sweep.reference_of(c) and sweep.reference_of(c).value("impulse_mN_ms")]
    shares = [s for s in shares if not math.isnan(s)]
    if not shares or (min(shares) > 0.99 and max(shares) < 1.01):
        return ""
    low, high = number(min(shares), 2), number(max(shares), 2)
    amount = low if low == high else f"{low} to {high}"
    return f" The impulse delivered to the skin (mean force times time) is {amount} of {name}'s."


def figures(sweep, folder):
    if len(layout.groups(sweep)) > style.CURVES:
        return []  # they are small multiples and heat maps
    made = [curves_module.measure_figure(sweep, folder, m) for m in MEASURES[:1]]
    made.append(strength_figure(sweep, folder))
    made += [curves_module.measure_figure(sweep, folder, m) for m in MEASURES[1:]]
    return [f for f in made if f]
