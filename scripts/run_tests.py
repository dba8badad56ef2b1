#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests of a build with CTest and counts test cases over all groups.

Usage: run_tests.py BUILD [-L LABEL] [WORD ...]     WORD: only groups whose name contains one of the words

Prints the running groups, then for each group a line and the text of each failure, and finally the line
`N passed, N failed`; exit 1 if a test failed. A group that crashes, hangs or reports no count is a failure.
The output of the groups is kept in BUILD/test-results.
"""
import argparse
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as xml
from pathlib import Path

from test_runner.progress import Progress
from test_runner.screen import Screen


def working_children(parent):
    """The child processes of `parent` that have not ended."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{int(entry)}/stat", encoding="utf-8", errors="replace") as file:
                state, of = file.read().rpartition(")")[2].split()[:2]
        except (ValueError, OSError):
            continue  # not a process, or a process that has just ended
        if int(of) == parent and state != "Z":
            found.append(int(entry))
    return found


class Watcher:
    """Reads the files that groups.py writes, and passes their content to the screen."""

    def __init__(self, results, screen):
        self.results, self.screen = results, screen
        self.running, self.ended = {}, {}  # by stem of the files
        for kind in ("running", "result"):
            for old in results.glob(f"*.{kind}"):
                old.unlink()

    def look(self):
        for path in sorted(self.results.glob("*.running")):
            if path.stem not in self.running:
                content = self.read(path)
                if content:
                    progress = Progress(path.with_suffix(".progress"))
                    self.running[path.stem] = content["pid"], progress
                    self.screen.started(content["name"], progress)
        for path in sorted(self.results.glob("*.result")):
            if path.stem not in self.ended:
                self.ended[path.stem] = result = self.read(path)
                self.screen.ended(result["name"], result["text"])
        for stem, (_, progress) in self.running.items():
            if stem not in self.ended:
                progress.poll()
        self.screen.refresh()

    @staticmethod
    def read(path):
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:  # the group has ended meanwhile
            return None

    def stop(self, ctest):
        """Stops ctest, so that it starts no more groups, and ends the running groups with their processes."""
        os.kill(ctest, signal.SIGSTOP)
        for pid in working_children(ctest):
            os.kill(pid, signal.SIGTERM)
        last = time.monotonic() + 30.0
        while working_children(ctest) and time.monotonic() < last:
            self.look()
            time.sleep(0.1)
        os.kill(ctest, signal.SIGKILL)


def lost_groups(junit, results):
    """Name and output of the groups that have no result, or a result without failures although CTest reports
    a failure."""
    failed = {result["name"]: result["failed"] for result in results}
    for case in xml.parse(junit).iter("testcase"):
        name = case.get("name")
        if name not in failed or (case.get("status") != "run" and not failed[name]):
            yield name, case.findtext("system-out") or ""


def run_ctest(build, screen, stopping, selection=()):
    """Runs CTest and returns the numbers of passed and failed tests."""
    results = build / "test-results"
    results.mkdir(exist_ok=True)
    watcher = Watcher(results, screen)
    junit = results / "ctest.xml"
    junit.unlink(missing_ok=True)
    # Groups wait for files, time limits and browsers: with as many groups as cores a fifth of the cores rests.
    command = ["ctest", "--test-dir", str(build), "--parallel", str(len(os.sched_getaffinity(0)) + 2),
               "--output-junit", str(junit), "--no-tests=error", *selection]
    with open(results / "ctest.log", "w", encoding="utf-8") as log:
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
                              start_new_session=True) as ctest:
            while ctest.poll() is None and not stopping.is_set():
                watcher.look()
                time.sleep(0.1)
            if ctest.poll() is None:
                watcher.stop(ctest.pid)
    watcher.look()
    ended = list(watcher.ended.values())
    passed, failed = sum(r["passed"] for r in ended), sum(r["failed"] for r in ended)
    if stopping.is_set():
        return passed, max(failed, 1)
    if not junit.exists():
        print(f"ctest failed; output: {log.name}")
        return passed, failed + 1
    if not ended and next(xml.parse(junit).iter("testcase"), None) is None:
        print("the selection matches no group of tests")
        return 0, 1
    for name, text in lost_groups(junit, ended):
        print(f"FAILED  {name} left no result\n" + re.sub("(?m)^", "    | ", text))
        failed += 1
    return passed, failed


def main():
    options = argparse.ArgumentParser(usage="run_tests.py BUILD [-L LABEL] [WORD ...]")
    options.add_argument("build", type=Path)
    options.add_argument("-L", dest="label")
    options.add_argument("words", nargs="*")
    chosen = options.parse_args()
    selection = ["-L", f"^{re.escape(chosen.label)}$"] if chosen.label else []
    if chosen.words:
        selection += ["-R", "|".join(re.sub(r"([^\w/ ])", r"\\\1", word) for word in chosen.words)]
    os.environ.update(SHEARWAKE_PYTHON=sys.executable,
                      SHEARWAKE_NEEDS_CHROMIUM="yes")  # scripts/setup --tests installs it
    stopping = threading.Event()
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, lambda *_: stopping.set())
    passed, failed = run_ctest(chosen.build.resolve(), Screen(), stopping, selection)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
