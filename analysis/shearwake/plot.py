# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a case with Matplotlib."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import wake
from .errors import NotRecorded

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

COLOURS = "RdBu_r"
LABEL = "$u_z$ (µm), positive into the tissue"
PLAYED_s = 6.0  # duration of an animation at the default speed
INTERVAL_ms = 40.0  # between pictures of an animation


class Plot:
    """Draws a case. Each function returns the axes, so that they can be changed, or the animation."""

    def __init__(self, case: wake.CaseInterface) -> None:
        self.case = case

    def surface(self, t: float | None = None, *, axes: Axes | None = None, end_um: float | None = None) -> Axes:
        """The surface at the recorded time nearest to t in s, by default the last one, seen from above. `end_um` is the end of
        the colour scale, by default the largest displacement. Raises NotRecorded."""
        return self._draw(*self._snapshot(t), axes, end_um)

    def wake(self, t: float | None = None, *, axes: Axes | None = None, end_um: float | None = None) -> Axes:
        """The surface with the path of the focus, the focal disc and the theoretical Mach lines. By default the colour scale
        ends at the largest displacement farther than four focal radii from the focus, at least at a fifth of the peak.
        Raises NotRecorded."""
        t_s, x, y, u = self._snapshot(t)
        if "focus_x" not in self.case.over_time:
            raise NotRecorded(f"case {self.case.id} has no focus; use plot.surface()")
        axes = self._draw(t_s, x, y, u, axes, end_um or wake.scale_end([(self.case, t_s, x, y, u)]))
        wake.draw_theory(axes, self.case, t_s)
        axes.set_xlim(x[0], x[-1])
        axes.set_ylim(y[0], y[-1])
        return axes

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
        axes = self.surface(float(times[0]), end_um=end_um)

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
        axes.set(xlabel="x (mm)", ylabel="y (mm)")
        axes.set_title(title(t_s) + ("" if self.case.is_valid else " (not valid)"), loc="left")
        return axes


def title(t_s: float) -> str:
    return f"t = {1e3 * t_s:.4g} ms"
