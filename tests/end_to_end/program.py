# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program in temporary folders, for the tests in this folder."""
import atexit
import contextlib
import csv
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from shearwake import Job, program as launcher
from shearwake.checksum import with_line
from shearwake.keys import put

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = Path(os.environ.get("SHEARWAKE", ROOT / "build" / "shearwake"))

# Time limit of a single command. It distinguishes a hang from a slow or busy machine and does not express an
# expectation of speed. It is shorter than the limit of a group in cmake/test_groups.cmake, so that the test reports the
# condition for which it has waited.
PATIENCE_s = 1800.0

# A 3 mm focus at 7 m/s for 4 ms: three frequencies and the reference, a fraction of a second each.
JOB = """\
schema = 1

[job]
name = "small"
title = "a small sweep, \u03b7 against frequency"

[medium]
base = "rigid"

[[medium.layer]]
name = "tissue"
thickness_mm = 20.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 1.0

[load]
peak_Pa = 100.0
footprint = { shape = "gaussian", fwhm_mm = 4.5 }

[load.modulation]
kind = "AM-STM"
path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }
speed_m_s = 7.0
am_frequency_Hz = 500.0

[domain]
extent_mm = [64.0, 48.0]
spacing_mm = 1.5

[time]
duration_ms = 4.0
output_interval_us = 100.0

[solver]
engine = "layered"

[measure]
at_ms = 4.0
settled_after_ms = 1.0

[record]
traces_mm = [[0.0, 0.0], [3.2, 1.1]]
frames = true

[sweep]
"load.modulation.am_frequency_Hz" = [400, 500, 1000]

[table]
x = "load.modulation.am_frequency_Hz"
reference = { kind = "STM" }
"""

SWEEP = '"load.modulation.am_frequency_Hz" = [400, 500, 1000]'
AM = "load.modulation.am_frequency_Hz"
SPECTRAL, PSTD = {"solver.engine": "spectral"}, {"solver.engine": "pstd"}
ONE_CASE = {"sweep": None, "table": None}
NO_FRAMES = {"record.frames": None}
NO_REFERENCE = {"table.reference": None}
OPEN = {"domain.edges": "open"}
PERIODIC = {"time.duration_ms": None, "time.regime": "periodic", "measure": {}}
HALF_SPACE = {"medium.base": "half-space", "medium.layer[1].thickness_mm": None}


def changed_job(base, *changes):
    """The TOML of a job, given by its path or its text, with changed keys. None removes a key."""
    def present(value):
        if isinstance(value, dict):
            return {key: present(part) for key, part in value.items() if part is not None}
        return list(map(present, value)) if isinstance(value, list) else value

    tables = Job(base).tables
    for change in changes:
        for key, value in change.items():
            put(tables, key, value)
    return Job(present(tables)).text


def small_job(*changes):
    """The TOML of the small job with changed keys: small_job({"time.duration_ms": 1.2, "record": None})."""
    return changed_job(JOB, *changes)


def without_reference(*changes):
    return small_job(NO_REFERENCE, *changes)


def swept(*values, key=AM):
    """The change to a sweep over some values of a key."""
    return {"sweep": {key: list(values)}}


def csv_path(file):
    """The change to a path that is read from a file."""
    return {"load.modulation.path": {"shape": "csv", "file": file}}


def peaks(*values_Pa):
    """The change to a sweep over the peak pressure without reference cases."""
    return {**swept(*values_Pa, key="load.peak_Pa"), "table": {"x": "load.peak_Pa"}}


def changed(*changes, text=JOB):
    """The text of the small job with each (old, new) replaced, for tests of texts."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def job_text(name="small", **tables):
    """The TOML of a job from dictionaries."""
    return Job({"schema": 1, "job": {"name": name}, **tables}).text


def gaussian(fwhm_mm):
    return {"shape": "gaussian", "fwhm_mm": fwhm_mm}


def read_by(time_ms, settled_ms=1.0):
    """The change to a case that ends at its time of reading."""
    return {"time.duration_ms": time_ms, "measure": {"at_ms": time_ms, "settled_after_ms": settled_ms}}


# The text of the small job with a misspelt key.
MISSPELT = changed(("peak_Pa", "peek_Pa"))

# Without traces and frames, a report draws few figures.
UNRECORDED = small_job({"record": {}})


def long_job(cases=12):
    """Many cases of a fraction of a second each, for tests that interrupt a run."""
    return without_reference({"sweep": {AM: {"linspace": [300, 1000, cases]}}, "domain": {"extent_mm": [144.0, 128.0], "spacing_mm": 0.5},
                              "record.frames": None, "record.snapshots_ms": [4.0]})


LONG = long_job()


def large_job(interval_us):
    """A long case of engine layered, which saves no checkpoints."""
    return without_reference(NO_FRAMES, swept(500), {
        "domain": {"extent_mm": [640.0, 640.0], "spacing_mm": 0.5}, "time.output_interval_us": interval_us})


def environment():
    return {**launcher.environment(), **launcher.SHARED_CORES}


def command(*arguments, ranks=1):
    return launcher.launched(list(map(str, arguments)), ranks)


@functools.cache
def failing_library():
    """Compiles faults/failing.cpp."""
    folder = tempfile.mkdtemp(prefix="shearwake-fault-")
    atexit.register(shutil.rmtree, folder)
    subprocess.run([os.environ.get("CXX", "g++"), "-shared", "-fPIC", "-O1", "-w", "-o", f"{folder}/failing.so",
                    str(ROOT / "tests" / "faults" / "failing.cpp"), "-ldl"], check=True)
    return f"{folder}/failing.so"


def faulty_environment(**faults):
    """The environment in which programs meet the given faults of faults/failing.cpp."""
    return {**environment(), "LD_PRELOAD": failing_library(), **{f"FAULT_{name}": str(value) for name, value in faults.items()}}


# Programs stop themselves when their second case is computed and has not got its name yet.
SECOND_CASE = {"PATH": "/cases/*.h5$", "CALL": "rename", "STOP_AT": 2}


def state_of(pid):
    """The state of a process as in /proc: T is stopped, Z is a zombie; empty if there is no such process."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()[0]
    return ""


def alive(pid):
    return state_of(pid) not in ("", "Z")


def descendants(pid):
    found = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in map(int, (task / "children").read_text(encoding="utf-8").split()):
                found += [child, *descendants(child)]
    return found


def stopped(pid):
    """The stopped processes among a process and its descendants."""
    return [each for each in (pid, *descendants(pid)) if state_of(each) == "T"]


def is_pending(pid, number):
    """Whether a stopped process has received this signal."""
    text = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    return any(int(mask, 16) >> (number - 1) & 1 for mask in re.findall(r"(?:Sig|Shd)Pnd:\s*(\w+)", text))


class Interrupting(unittest.TestCase):
    """Waits for processes and interrupts them."""

    def wait_for(self, condition, what):
        end = time.monotonic() + PATIENCE_s
        while not condition():
            self.assertLess(time.monotonic(), end, f"waited in vain for {what}")
            time.sleep(0.005)

    def wait_for_stop(self, process, count=1):
        self.wait_for(lambda: process.poll() is not None or len(stopped(process.pid)) == count, "the programs to stop")
        self.assertIsNone(process.poll(), "it ended before it stopped")

    def signal_and_continue(self, process, number=None, forwarded=None):
        """Sends a signal to a process, and lets its stopped programs continue once they have received it, or the signal that the
        process forwards instead."""
        programs, expected = stopped(process.pid), forwarded or number
        if number is not None:
            process.send_signal(number)
            self.wait_for(lambda: all(is_pending(pid, expected) for pid in programs), f"{signal.strsignal(expected)} to arrive")
        for pid in programs:
            os.kill(pid, signal.SIGCONT)

    def kill(self, process):
        """Kills a command with all ranks."""
        pids = [process.pid, *descendants(process.pid)]
        for pid in pids:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)  # those whose parent has ended
        process.wait()
        self.wait_for(lambda: not any(map(alive, pids)), "the ranks to end")


class ProgramTest(Interrupting):
    """Runs each test in a separate temporary folder."""

    maxDiff = 4000

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-test-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.out = self.folder / "out" / "small"

    def write_job(self, text=JOB, name="job.toml"):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def shearwake(self, *arguments, ranks=1, expect=0, prefix=()):
        """Runs a command of the program to its end; `expect` is the exit code (None: any)."""
        return self.call(*prefix, *command(*arguments, ranks=ranks), expect=expect)

    def call(self, *words, expect=0, variables=None, **options):
        """Runs a command to its end in the folder of the test, with further variables of the environment."""
        done = subprocess.run(list(map(str, words)), check=False, **{
            "cwd": self.folder, "env": {**environment(), **(variables or {})}, "capture_output": True, "encoding": "utf-8",
            "errors": "replace", "timeout": PATIENCE_s, **({} if "input" in options else {"stdin": subprocess.DEVNULL}), **options})
        done.output = done.stdout + done.stderr
        if expect is not None:
            self.assertEqual(done.returncode, expect, f"{words}:\n{done.output}")
        return done

    def compute(self, text=JOB):
        """Runs a job and writes its table."""
        self.write_job(text)
        self.reduced(self.out)

    def reduced(self, out, *options, job="job.toml", ranks=1):
        """Runs a job and writes its table, whose rows are returned."""
        self.shearwake("run", job, "--out", out, *options, ranks=ranks)
        self.shearwake("reduce", out)
        return table(self.folder / out)

    def compute_some(self, text=JOB, count=1, words=(), prefix=()):
        """Runs the first cases of a job and returns the ids of all of them."""
        self.write_job(text)
        ids = [case["id"] for case in json.loads(self.shearwake("plan", "job.toml", "--json").stdout)["cases"]]
        self.shearwake("run", "job.toml", "--only", ",".join(ids[:count]), *words, prefix=prefix)
        return ids

    def start(self, *arguments, ranks=1, faults=None):
        """Starts a command in a separate process group without waiting for its end."""
        process = subprocess.Popen(command(*arguments, ranks=ranks), cwd=self.folder,
                                   env=faulty_environment(**faults) if faults else environment(), stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   encoding="utf-8", start_new_session=True)
        self.addCleanup(self._end, process)
        return process

    def start_and_stop(self, *arguments, ranks=1, count=1, faults=SECOND_CASE):
        """Starts a command whose programs stop themselves at a call, and waits until `count` of them have: what the test does then
        happens during the run, irrespective of the speed of the machine."""
        process = self.start(*arguments, ranks=ranks, faults=faults)
        self.wait_for_stop(process, count)
        return process

    def output_of(self, process, expect):
        """The output of a started command at its end with this exit code."""
        output = process.communicate(timeout=PATIENCE_s)[0]
        self.assertEqual(process.returncode, expect, output)
        return output

    def _end(self, process):
        self.kill(process)
        process.stdout.close()

    def contains(self, text, *words):
        for word in words:
            self.assertIn(word, text)


def seal(path):
    """Updates the checksum line at the end of a case file if a test has changed the file."""
    lines = Path(path).read_bytes()
    content = re.sub(rb"\n?shearwake checksum 1 XXH3-128 [0-9a-f]{32} of \d{20} bytes\n\Z", b"", lines)
    if lines != with_line(content):
        Path(path).write_bytes(with_line(content))


def case_files(out):
    return sorted((out / "cases").glob("*.h5"))


def plan(out):
    return json.loads((out / "plan.json").read_text(encoding="utf-8"))


def plan_ids(out):
    return [case["id"] for case in plan(out)["cases"]]


def journal(out):
    """The events of all journals in chronological order, without truncated lines."""
    lines = []
    for path in sorted(out.glob("journal*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            with contextlib.suppress(ValueError):
                lines.append(json.loads(line))
    return sorted(lines, key=lambda line: line["unix_s"])


def started(out):
    return [line["id"] for line in journal(out) if line["event"] == "started"]


def read_csv(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def table(out):
    """The rows of the CSV table with the sentences of notes, without the column that depends on the machine."""
    path = out / "tables" / f"{plan(out)['name']}.csv"
    rows = read_csv(path)
    notes = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))["notes"]
    for row in rows:
        del row["wall_s"]
        row["note"] = "; ".join(notes[int(number) - 1] for number in row["note"].split(", ") if number)
    return rows
