# SPDX-License-Identifier: BSD-3-Clause
"""Calls functions on two processor cores."""
from __future__ import annotations

import os
import pickle
import signal
from collections.abc import Callable, Sequence
from typing import Any


def in_two(tasks: Sequence[Callable[[], Any]], before: Callable[[int], None] = lambda n: None) -> list[Any]:
    """The results of up to 256 functions, which a copy of this process and this process call in turn. They must be picklable.
    `before` is called with the index of each function that this process calls. Functions whose results are lost because the copy
    was killed are called here. On a single core this process calls all of them."""
    done: dict[int, Any] = {}
    order = range(len(tasks))
    if len(os.sched_getaffinity(0)) > 1 and len(tasks) > 1:
        source, sink = os.pipe()
        os.write(sink, bytes(order))  # one byte per function; a read of a byte takes it
        os.close(sink)
        results, to_results = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.close(results)  # otherwise it would wait for its own reading if this process ended
                with os.fdopen(to_results, "wb") as file:
                    pickle.dump(_call(tasks, source, lambda n: None), file)
            finally:
                os._exit(0)
        os.close(to_results)
        try:
            done = _call(tasks, source, before)
        except BaseException:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise
        os.close(source)
        with os.fdopen(results, "rb") as file:
            try:
                done |= pickle.load(file)
            except (EOFError, pickle.UnpicklingError):
                pass  # the copy was killed
        os.waitpid(child, 0)
    for n in order:
        if n not in done:
            before(n)
            done[n] = tasks[n]()
    return [done[n] for n in order]


def _call(tasks: Sequence[Callable[[], Any]], source: int, before: Callable[[int], None]) -> dict[int, Any]:
    done: dict[int, Any] = {}
    while token := os.read(source, 1):
        before(token[0])
        done[token[0]] = tasks[token[0]]()
    return done
