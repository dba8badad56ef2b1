# SPDX-License-Identifier: BSD-3-Clause
"""Runs a command and ends it if its tests stop making progress."""
import os
import signal
import subprocess
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Patience:
    """Time limits of tests. They are generous and do not express an expectation of speed. The longest
    silence of a passing test has not been measured."""

    silence_s: float = 600.0  # without any line of progress
    one_test_s: float = 3600.0  # with lines of progress, but without the start or end of a test
    poll_s: float = 0.1


@dataclass(frozen=True)
class Outcome:
    code: int | None  # None: the command was ended by supervise()
    why: str = ""


def descendants(pid):
    """The children of the process `pid`, and their descendants."""
    children = {}
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{int(entry)}/stat", encoding="utf-8", errors="replace") as file:
                parent = int(file.read().rpartition(")")[2].split()[1])
        except (ValueError, OSError):
            continue  # not a process, or a process that has just ended
        children.setdefault(parent, []).append(int(entry))
    found = [pid]
    for one in found:
        found += children.get(one, [])
    return found[1:]


def end(process, grace_s=10.0):
    """Ends the process and all its descendants, since ranks and programs have process groups of their own."""
    below = descendants(process.pid)
    process.terminate()
    try:
        process.wait(grace_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for pid in below:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass


def supervise(command, log, progress, patience, stopping, **options):
    """Runs `command` until it ends, hangs, or `stopping` is set."""
    with open(log, "w", encoding="utf-8") as out:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, start_new_session=True, **options)
        last_sign = last_event = time.monotonic()
        while True:
            try:
                return Outcome(process.wait(patience.poll_s))
            except subprocess.TimeoutExpired:
                pass
            kinds, now = progress.poll(), time.monotonic()
            if kinds:
                last_sign = now
            if kinds - {"alive"}:
                last_event = now
            why = ""
            if stopping.is_set():
                why = "it was interrupted"
            elif now - last_sign > patience.silence_s:
                why = f"it hung: no sign of progress for {patience.silence_s:.0f} s"
            elif now - last_event > patience.one_test_s:
                why = f"it hung: no test began or ended for {patience.one_test_s:.0f} s"
            if why:
                end(process)
                return Outcome(None, why)
