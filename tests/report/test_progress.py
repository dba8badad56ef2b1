# SPDX-License-Identifier: BSD-3-Clause
"""Tests the progress of a report and the processes that draw it."""
import functools
import io
import os
import signal
import unittest
from concurrent.futures.process import BrokenProcessPool

from shearwake.report.progress import Progress, parallel_map


class Terminal(io.StringIO):
    def isatty(self):
        return True


class ProgressTest(unittest.TestCase):
    def test_a_terminal_has_one_line_that_is_replaced(self):
        stream = Terminal()
        progress = Progress(stream)
        progress.show("reading case 1 of 2")
        progress.show("reading case 2 of 2")
        progress.end()
        lines = [line for line in stream.getvalue().split("\r\033[K") if line]
        self.assertEqual(lines, ["report: reading case 1 of 2", "report: reading case 2 of 2"])

    def test_elsewhere_there_is_one_line_per_minute(self):
        stream, seconds = io.StringIO(), iter(range(0, 100000, 20))
        progress = Progress(stream, lambda: next(seconds))
        for n in range(8):
            progress.show(f"case {n}")
        progress.end()
        self.assertGreaterEqual(stream.getvalue().count("\n"), 2)
        self.assertLess(stream.getvalue().count("\n"), 4)


class ParallelMapTest(unittest.TestCase):
    def test_results_have_the_order_of_the_functions(self):
        counts = []
        self.assertEqual(parallel_map([lambda n=n: n * n for n in range(50)], counts.append), [n * n for n in range(50)])
        self.assertEqual(counts, list(range(1, 51)))

    def test_an_exception_of_a_function_is_raised(self):
        with self.assertRaises(FileNotFoundError):
            parallel_map([int, functools.partial(open, "/nonexistent"), int], lambda n: None)

    def test_a_killed_process_is_an_error(self):
        with self.assertRaises(BrokenProcessPool):
            parallel_map([lambda: os.kill(os.getpid(), signal.SIGKILL)], lambda n: None)
