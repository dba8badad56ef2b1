# SPDX-License-Identifier: BSD-3-Clause
"""Reports the progress of a report or a movie: a line that is replaced on a terminal, one line per minute elsewhere."""
import sys
import time
from collections.abc import Callable
from typing import Any

INTERVAL_s = 60.0
CLEAR = "\r\033[K"


class Progress:
    def __init__(self, stream: Any = None, clock: Callable[[], float] = time.monotonic, name: str = "report") -> None:
        self.stream, self.clock, self.name = stream or sys.stderr, clock, name
        self.live = self.stream.isatty()
        self.last = clock()

    def show(self, text: str) -> None:
        """Reports what is done now, for example 'case 3 of 20'."""
        if self.live:
            print(f"{CLEAR}{self.name}: {text}", end="", file=self.stream, flush=True)
        elif self.clock() - self.last >= INTERVAL_s:
            self.last = self.clock()
            print(f"{self.name}: {text}", file=self.stream, flush=True)

    def end(self) -> None:
        """Removes the line from a terminal."""
        if self.live:
            print(CLEAR, end="", file=self.stream, flush=True)
