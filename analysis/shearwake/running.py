# SPDX-License-Identifier: BSD-3-Clause
"""Runs a job and watches its progress."""
from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import program

INTERVAL_s = 0.2  # between looks at the progress


@dataclass(frozen=True)
class Progress:
    """The progress of a run: numbers of cases, and the estimated remaining time in s (None: unknown)."""

    total: int
    done: int
    running: int
    failed: int
    left_s: float | None

    def __str__(self) -> str:
        left = "" if self.left_s is None or self.done == self.total else f", {self.left_s:.0f} s left"
        failed = f", {self.failed} failed" if self.failed else ""
        return f"{self.done} of {self.total} cases complete{failed}{left}"


class Line:
    """Shows the progress on one line of a terminal or of the output of a notebook."""

    def __init__(self) -> None:
        self.width = 0

    def __call__(self, progress: Progress) -> None:
        text = str(progress)
        print("\r" + text.ljust(self.width), end="", flush=True, file=sys.stdout)
        self.width = len(text)

    def end(self) -> None:
        if self.width:
            print(flush=True)


def ignore(progress: Progress) -> None:
    """Reports nothing."""


def last_progress(text: str) -> Progress | None:
    """The last complete line of the progress as JSON; None if there is none."""
    for line in reversed(text.splitlines()):
        try:
            found: dict[str, Any] = json.loads(line)
            return Progress(found["total"], found["done"], found["running"], found["failed"], found.get("left_s"))
        except (ValueError, KeyError):
            continue
    return None


def run_and_watch(arguments: Sequence[str], ranks: int, launch: Sequence[str] | None,
                  progress: bool | Callable[[Progress], None]) -> None:
    """Runs a command to its end and reports the progress. Raises ProgramError with the text of the program. If the call
    is interrupted, requests an orderly stop and waits for it."""
    line = Line()
    report: Callable[[Progress], None] = ignore
    if progress is True:
        report = line
    elif callable(progress):
        report = progress
    with tempfile.TemporaryDirectory(prefix="shearwake-") as folder:
        log, said = Path(folder) / "progress.jsonl", Path(folder) / "text"
        log.touch()
        with open(said, "w", encoding="utf-8") as text:
            # In a group of its own, so that the interrupt of a terminal does not kill it before it has stopped.
            process = program.start([*arguments, "--log-json", str(log)], ranks, launch, stdout=text, stderr=text,
                                    start_new_session=True, preexec_fn=program.stop_with_caller)
        try:
            watch(process, log, report)
        except BaseException:
            if process.poll() is None:
                process.send_signal(signal.SIGUSR1)
                process.wait()
            raise
        finally:
            if progress is True:
                line.end()
        if process.returncode != 0:
            raise program.error_of(process.returncode, relevant(said.read_text(encoding="utf-8", errors="replace")))


def watch(process: subprocess.Popen[bytes], log: Path, report: Callable[[Progress], None]) -> None:
    """Reports each change of the progress until the process has ended."""
    last: Progress | None = None
    ended = False
    while not ended:
        try:
            process.wait(INTERVAL_s)
            ended = True
        except subprocess.TimeoutExpired:
            pass
        found = last_progress(log.read_text(encoding="utf-8", errors="replace"))
        if found is not None and found != last:
            report(found)
            last = found


def relevant(text: str) -> str:
    """The text of the program without the lines that state progress."""
    other_lines = [line for line in text.splitlines() if " cases done, " not in line and "cases to compute on" not in line]
    return "\n".join(other_lines)
