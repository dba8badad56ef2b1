# SPDX-License-Identifier: BSD-3-Clause
"""An animation that notebooks show with a player."""
import re

from matplotlib.animation import FuncAnimation

# Of the icons of Font Awesome, which Matplotlib loads from another site.
SIGNS = {"minus": "\u2212", "fast-backward": "|\u25c0", "step-backward": "\u25c0|", "play fa-flip-horizontal": "\u25c0", "pause": "\u275a\u275a",
         "play": "\u25b6", "step-forward": "|\u25b6", "fast-forward": "\u25b6|", "plus": "+"}


class Player(FuncAnimation):
    """A Matplotlib animation whose representation in a notebook is its player, which needs no network and begins with the
    picture in the middle."""

    def _repr_html_(self) -> str:
        text = re.sub("<link[^>]*>", "", self.to_jshtml())
        text = re.sub('<i class="fa fa-([a-z -]+)"></i>', lambda icon: SIGNS[icon[1]], text)
        return re.sub(r"(\w+) = new Animation\(.*?\);", r"\g<0> \1.set_frame(frames.length >> 1);", text, flags=re.DOTALL)
