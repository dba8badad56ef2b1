# SPDX-License-Identifier: BSD-3-Clause
"""Prints the progress of a report or a movie, a line that is replaced on a terminal, one line per minute elsewhere, and results."""
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


def print_result(text: str, prefix: str) -> bool:
    """Prints a text; if that fails, prints an error with this prefix and returns False. A reader that closes the pipe, such as head,
    has read enough."""
    try:
        print(text, flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # discards what is not flushed yet
        if not isinstance(error, BrokenPipeError):
            print(f"{prefix}: the output cannot be written: {error.strerror}", file=sys.stderr)
            return False
    return True


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
