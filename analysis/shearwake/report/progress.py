# SPDX-License-Identifier: BSD-3-Clause
"""Reports the progress of a report or a movie: a line that is replaced on a terminal, one line per minute elsewhere."""
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
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


def parallel_map(tasks: Sequence[Callable[[], Any]], report: Callable[[int], None]) -> list[Any]:
    """The results of functions that forked processes on up to two cores call; only the results are pickled. `report` is called
    with the number of results. Raises what a function raises."""
    results: list[Any] = []
    inherited[:] = tasks
    with ProcessPoolExecutor(min(2, len(os.sched_getaffinity(0))), multiprocessing.get_context("fork")) as pool:
        for result in pool.map(call_inherited, range(len(tasks))):
            results.append(result)
            report(len(results))
    return results


inherited: list[Callable[[], Any]] = []  # by forked processes


def call_inherited(number: int) -> Any:
    return inherited[number]()
