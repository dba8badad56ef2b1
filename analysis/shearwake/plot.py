# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of sweeps and cases with Matplotlib."""
from __future__ import annotations

import contextlib
import functools
import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from . import figure_style, wake
from .errors import NotRecorded, suggestion

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


COLOURS = "RdBu_r"
LABEL = "$u_z$ (µm), positive into the tissue"
PLAYED_s = 6.0  # duration of an animation at the default speed
INTERVAL_ms = 40.0  # between pictures of an animation


# Figures of the report by the name of the function that draws them, and the module below shearwake.report.figures.
OF_CASES = {"drive": "fig_drive", "hand": "fig_hand", "intensity": "fig_intensity", "medium": "fig_medium", "over_time": "fig_time",
            "profiles": "fig_profiles", "receptors": "fig_receptors", "slices": "fig_volume", "snapshots": "fig_surface",
            "spectra": "fig_spectra", "spectrogram": "fig_spectrogram", "traces": "fig_traces"}
OF_SWEEPS = {"adaptive": "fig_adaptive", "afferents": "fig_afferents", "frequencies": "fig_frequency", "heat_maps": "fig_heat",
             "measures": "fig_measures", "optima": "fig_optimise", "samples": "fig_uncertain", "small_multiples": "fig_multiples"}


def report_module(name: str) -> Any:
    """A module of the report, which lies above this one and is loaded when a figure is drawn."""
    return importlib.import_module(f".report.{name}", __package__)


def finished(figure: Figure) -> Figure:
    """The figure with ticks and places of the current style. A notebook shows it once: as the result of its cell."""
    from matplotlib import pyplot
    figure.draw_without_rendering()
    if "inline" in pyplot.get_backend():
        pyplot.close(figure)
    return figure


class ReportFigures:
    """Functions that draw the figures of the report and return a Figure of Matplotlib, in the style of shearwake.style()."""

    _modules: dict[str, str] = {}

    def _selection(self) -> Any:
        raise NotImplementedError

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._modules]

    def __getattr__(self, name: str) -> Callable[..., Figure]:
        if name not in self._modules:
            raise AttributeError(f"{name} is not a figure; the figures are {', '.join(self._modules)}")
        return functools.partial(self._draw_report, name)

    def _draw_report(self, name: str, which: str = "") -> Figure:
        """A figure of the report: `which` is its name in the folder of the report, by default the first one. Raises NotRecorded."""
        selection, style, module = self._selection(), report_module("style"), report_module(f"figures.{self._modules[name]}")
        with figure_style.current():
            made = {figure.name: figure.drawn for figure in module.figures(selection)}
            if not made or which not in ("", *made):
                known = f"the figures of this name are {', '.join(made)}" if made else "what it shows was not recorded or not swept"
                raise NotRecorded(f"there is no figure {' '.join(filter(None, (name, which)))}: {known}")
            chosen = made[which or next(iter(made))]
            for figure in made.values():
                if figure is not chosen:
                    style.plt.close(figure)
            style.finish(chosen)
            return finished(chosen)


class SweepPlot(ReportFigures):
    """Draws a sweep: `sweep.plot("eta_period_1")` draws a column of the table against the swept key. The figures of the report
    are functions: adaptive, afferents, drive, frequencies, hand, heat_maps, intensity, measures, medium, optima, over_time, profiles,
    receptors, samples, slices, small_multiples, snapshots, spectra, spectrogram and traces. All return a Figure of Matplotlib."""

    _modules = OF_CASES | OF_SWEEPS

    def __init__(self, sweep: Any) -> None:
        self.sweep = sweep

    def _selection(self) -> Any:
        return report_module("load").Selection(self.sweep, self.sweep.every_case, self.sweep.x)

    def __call__(self, column: str, *, axes: Axes | None = None) -> Figure:
        """One curve of the column per combination of the other swept keys, with error bars, and the references as dashed lines. Readings
        that are not valid are grey crosses. Raises KeyError, and NotRecorded without a swept key."""
        style, warnings_of, curve_chart, fig_curves, chart_figure = map(
            report_module, ("style", "warnings_of", "page.curve_chart", "figures.fig_curves", "figures.chart_figure"))
        selection = self._selection()
        if not selection.x or not fig_curves.has_any(selection, self._known(column)):
            raise NotRecorded(f"there is no curve of {column}: no key is swept, or no case has a value")
        chart = curve_chart.curve_chart(selection, warnings_of.figure_of(column), column)
        with figure_style.current() if axes is None else contextlib.nullcontext():
            if axes is None:
                _, axes = style.plt.subplots(layout="constrained")
            chart_figure.draw(axes, chart, chart_figure.markers([chart]))
            axes.set(xlabel=chart.x_label, ylabel=chart.y_label)
            if len(handles := chart_figure.legend_handles([chart])) > 1:
                axes.legend(handles=handles)
            figure: Any = axes.figure
            style.finish(figure)
            return finished(figure)

    def _known(self, column: str) -> str:
        known = [found.name for found in self.sweep.columns]
        if column not in known:
            raise KeyError(f"{column} is not a column{suggestion(column, known)}")
        return column


class Plot(ReportFigures):
    """Draws a case. `surface` and `wake` draw a snapshot; the figures of the report are functions: drive, hand, intensity, medium,
    over_time, profiles, receptors, slices, snapshots, spectra, spectrogram and traces. All return a Figure of Matplotlib."""

    _modules = OF_CASES

    def __init__(self, case: Any) -> None:
        self.case = case

    def _selection(self) -> Any:
        if self.case.sweep is None:
            raise NotRecorded(f"figures of the report need the sweep of the case: shearwake.open(FOLDER)[{self.case.id!r}].plot")
        return report_module("layout").only(SweepPlot(self.case.sweep)._selection(), [self.case.id])

    def surface(self, t: float | None = None, *, axes: Axes | None = None, end_um: float | None = None) -> Figure:
        """The surface at the recorded time nearest to t in s, by default the last one, seen from above. `end_um` is the end of
        the colour scale, by default the largest displacement. Raises NotRecorded."""
        with figure_style.current() if axes is None else contextlib.nullcontext():
            return finished(self._draw(*self._snapshot(t), axes, end_um).figure)

    def wake(self, t: float | None = None, *, axes: Axes | None = None, end_um: float | None = None) -> Figure:
        """The surface with the path of the focus, the focal disc and the theoretical Mach lines. By default the colour scale
        ends at the largest displacement farther than four focal radii from the focus, at least at a fifth of the peak.
        Raises NotRecorded."""
        t_s, x, y, u = self._snapshot(t)
        if "focus_x" not in self.case.over_time:
            raise NotRecorded(f"case {self.case.id} has no focus; use plot.surface()")
        with figure_style.current() if axes is None else contextlib.nullcontext():
            axes = self._draw(t_s, x, y, u, axes, end_um or wake.scale_end([(self.case, t_s, x, y, u)]))
            wake.draw_theory(axes, self.case, t_s)
            axes.set_xlim(x[0], x[-1])
            axes.set_ylim(y[0], y[-1])
            return finished(axes.figure)

    def animate(self, *, slow_down: float | None = None, end_um: float | None = None) -> FuncAnimation:
        """The recorded surfaces as an animation, `slow_down` times slower than the motion, by default such that it takes six
        seconds. Notebooks show it with a player; `.save("a.mp4")` writes a movie with ffmpeg. Raises NotRecorded."""
        import matplotlib.pyplot as plt

        from .animation import Player
        times = self.case.array("surface/time")
        if len(times) < 2:
            raise NotRecorded(f"case {self.case.id} contains fewer than two surfaces: set record.frames in the job")
        run_ms = 1e3 * float(times[-1] - times[0])
        played_ms = run_ms * slow_down if slow_down else 1e3 * PLAYED_s
        count = max(2, min(len(times), round(played_ms / INTERVAL_ms)))
        indices = np.unique(np.linspace(0, len(times) - 1, count).round().astype(int))
        if end_um is None:
            end_um = max(float(np.abs(self._values(int(i))).max()) for i in indices)
        with figure_style.current():
            axes = self._draw(*self._snapshot(float(times[0])), None, end_um)

        def show(index: int) -> list[Any]:
            axes.images[0].set_data(self._values(int(index)).T)
            axes.set_title(title(float(times[index])) + ("" if self.case.is_valid else " (not valid)"), loc="left")
            return [axes.images[0]]
        figure: Any = axes.figure  # not a part of another one
        made = Player(figure, show, frames=indices, interval=played_ms / len(indices), blit=False)
        plt.close(figure)  # a notebook would show it in addition to the animation
        return made

    def _values(self, index: int) -> np.ndarray:
        """u_z(x, y) in um."""
        return 1e6 * self.case.snapshot(index)[3]

    def _snapshot(self, t: float | None) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """t in s, x and y in mm, u_z(x, y) in um."""
        times = self.case.array("surface/time")
        t_s, x, y, u = self.case.snapshot(int(np.abs(times - t).argmin()) if t is not None and len(times) else -1)
        return t_s, 1e3 * x, 1e3 * y, 1e6 * u

    def _draw(self, t_s: float, x: np.ndarray, y: np.ndarray, u: np.ndarray, axes: Axes | None, end_um: float | None) -> Axes:
        import matplotlib.pyplot as plt
        if axes is None:
            _, axes = plt.subplots(layout="constrained")
        peak = float(np.abs(u).max())
        end = end_um or peak or 1.0
        image = axes.imshow(u.T, origin="lower", cmap=COLOURS, vmin=-end, vmax=end, interpolation="bicubic",
                            interpolation_stage="data", extent=wake.extent(x, y))
        axes.figure.colorbar(image, ax=axes, label=LABEL, shrink=0.8, extend="both" if peak > 1.001 * end else "neither")
        axes.grid(False)
        axes.set(xlabel="x (mm)", ylabel="y (mm)")
        axes.set_title(title(t_s) + ("" if self.case.is_valid else " (not valid)"), loc="left")
        return axes


def title(t_s: float) -> str:
    return f"t = {1e3 * t_s:.4g} ms"
