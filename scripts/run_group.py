#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs one group of tests. CTest calls this script, see cmake/test_groups.cmake.

Usage: run_group.py BUILD KIND NAME COMMAND...     KIND of the test reports: catch, unittest, none

Prints a line with the counts, and the text of each failure; exit 1 if a test failed. A group that reports no
progress for a long time is ended, see test_runner/supervise.py.
"""
import os
import signal
import sys
import threading
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent / "analysis" / "nightly"))

import ranks  # noqa: E402
from test_runner.groups import COUNTS, Group, run_group  # noqa: E402


def main():
    build, kind, name, *command = sys.argv[1:]
    build = Path(build).resolve()
    results = build / "test-results"
    results.mkdir(exist_ok=True)
    os.environ["SHEARWAKE"] = str(build / "shearwake")
    os.environ.setdefault("SHEARWAKE_PYTHON", sys.executable)
    os.environ.update(ranks.environment())
    # All ranks are on this machine: without a search for networks they start in half the time.
    os.environ.setdefault("OMPI_MCA_pml", "ob1")
    os.environ.setdefault("OMPI_MCA_btl", "self,vader")
    stopping = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stopping.set())
    result = run_group(Group(name, command, COUNTS[kind]), results, stopping)
    print(result.text)
    return 1 if result.failed else 0


if __name__ == "__main__":
    sys.exit(main())
