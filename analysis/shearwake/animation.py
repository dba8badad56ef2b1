# SPDX-License-Identifier: BSD-3-Clause
"""An animation that notebooks show with a player."""
from matplotlib.animation import FuncAnimation


class Player(FuncAnimation):
    """A Matplotlib animation whose representation in a notebook is its player."""

    def _repr_html_(self) -> str:
        return self.to_jshtml()
