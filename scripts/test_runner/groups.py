# SPDX-License-Identifier: BSD-3-Clause
"""Runs one group of tests, ends it if it hangs, and counts passed and failed tests.

CMake registers each group as a CTest test that calls scripts/run_group.py. In the folder of results, a group
STEM has the files

    STEM.log       the output of the command
    STEM.report    the results of the tests in the format of the runner
    STEM.progress  see progress.py
    STEM.running   while the group runs: its name and the id of the process that runs it
    STEM.result    afterwards: its name, the numbers of passed and failed tests, and a text
"""
import json
import os
import re
import resource
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from .progress import Progress
from .supervise import Patience, supervise
from .verdicts import count_catch, count_unittest

ROOT = Path(__file__).resolve().parent.parent.parent
COUNTS = {"catch": count_catch, "unittest": count_unittest, "none": None}


@dataclass
class Group:
    name: str
    command: list  # REPORT stands for the path of the report
    count: object = None  # reads the report; None: the exit code decides

    def stem(self, results):
        return results / re.sub(r"\W+", "-", self.name).strip("-")


@dataclass
class Result:
    name: str
    passed: int
    failed: int
    text: str


def verdict(group, outcome, report, progress, log):
    """Numbers of passed and failed tests, and the text of each failure."""
    passed, failed, texts, broken = (
        group.count(report) if group.count else (int(outcome.code == 0), 0, [], []))
    if outcome.code is None:
        broken = [f"  {outcome.why}", *(f"    {line}" for line in progress.still_running()), *broken]
    elif outcome.code != 0 and not failed:
        broken.insert(0, f"  the group ended with exit code {outcome.code}")
    if broken:
        failed += 1
        tail = log.read_text(encoding="utf-8", errors="replace").splitlines()[-40:]
        texts.append("\n".join([f"FAILED  {group.name} as a whole", *broken, *("    | " + t for t in tail)]))
    return passed, failed, texts


def processor_time():
    """The processor time of all ended children, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def write_whole(path, value):
    """Writes the file atomically: readers see the complete content or no file."""
    new = path.with_suffix(path.suffix + ".new")
    new.write_text(json.dumps(value), encoding="utf-8")
    new.replace(path)


def run_group(group, results, stopping, patience=Patience()):
    stem = group.stem(results)
    files = {kind: stem.with_name(f"{stem.name}.{kind}") for kind in ("log", "report", "running", "result")}
    for kind in ("report", "result"):
        for old in results.glob(files[kind].name + "*"):
            old.unlink()
    progress = Progress(stem.with_name(stem.name + ".progress"))
    progress.clear()
    write_whole(files["running"], {"name": group.name, "pid": os.getpid()})
    began, used = time.monotonic(), processor_time()
    try:
        environment = {**os.environ, "SHEARWAKE_TEST_PROGRESS": str(progress.stem)}
        command = [word.replace("REPORT", str(files["report"])) for word in group.command]
        outcome = supervise(command, files["log"], progress, patience, stopping, cwd=ROOT, env=environment)
        passed, failed, texts = verdict(group, outcome, files["report"], progress, files["log"])
    except Exception as error:  # a group without a result would count as passed
        passed, failed, texts = 0, 1, [f"FAILED  the runner itself: {error!r}"]
    times = f"{time.monotonic() - began:.0f} s, {processor_time() - used:.0f} s of processor time"
    heading = f"== {group.name}: {passed} passed, {failed} failed, {times}"
    result = Result(group.name, passed, failed, "\n".join([heading, *texts]))
    write_whole(files["result"], asdict(result))
    files["running"].unlink()
    return result
