# SPDX-License-Identifier: BSD-3-Clause
"""Runs the jobs, compares their tables with the baselines, stores all numbers in the history, and writes an HTML page and a JUnit
file. scripts/nightly builds the program and then runs this script."""
import argparse
import fcntl
import os
import socket
import sqlite3
import statistics
import sys
import traceback
from collections.abc import Callable
from datetime import datetime, timezone
from pathlib import Path

from .. import program
from ..errors import ShearwakeError
from . import documents, night, page
from .documents import ROOT, Test
from .history import History
from .night import Result, Watched
from .shearwake_program import Program

SLOWER_PERCENT = 25.0
LEAST_s = 1.0  # shorter differences of a job are noise


class UsageError(Exception):
    """An argument is not valid."""


class Parser(argparse.ArgumentParser):
    def error(self, message: str) -> None:  # type: ignore[override]
        raise UsageError(f"{message}; see {self.prog} --help")


def add_folders(parser: argparse.ArgumentParser) -> None:
    documents.add_out(parser)
    parser.add_argument("--baselines", type=Path, default=ROOT / "tests" / "baselines", metavar="DIR",
                        help="folder of the baselines (default: tests/baselines)")


def folder_options(parser: argparse.ArgumentParser, chosen: argparse.Namespace) -> list[str]:
    """The options of folders that are not the default, which the commands of the next steps repeat."""
    return [word for name in ("out", "baselines") if (folder := getattr(chosen, name)) != parser.get_default(name)
            for word in (f"--{name}", str(folder.resolve()))]


def arguments() -> argparse.Namespace:
    parser = Parser(prog="scripts/nightly", description="Builds the program, runs the jobs and compares their tables with the "
                    "baselines; exit 4 if a case failed, exit 5 if a table differs.")
    parser.add_argument("jobs", nargs="*", metavar="JOB", help="name of a file in jobs/ or of a baseline, or a path to a job that "
                        "ends in .toml (default: all jobs with a baseline)")
    add_folders(parser)
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="ranks of each run (default: 2)")
    parser.add_argument("--hours", type=float, default=6.0, metavar="H", help="time limit per job (default: 6)")
    parser.add_argument("--nights", type=int, default=60, metavar="N", help="number of nights on the page "
                        "(default: 60)")
    parser.add_argument("--no-bench", action="store_true", help="do not measure the speeds of the engines")
    parser.add_argument("--fail-slower", type=float, metavar="PERCENT", help="exit 5 if a job takes longer by more than PERCENT than "
                        f"in earlier nights (default: only report jobs that are slower by {SLOWER_PERCENT:g} %%)")
    parser.add_argument("--build-failed", metavar="LOG", help=argparse.SUPPRESS)
    chosen = parser.parse_intermixed_args()
    if chosen.ranks < 1 or chosen.nights < 1 or chosen.hours <= 0:
        parser.error("--ranks, --nights and --hours must be greater than 0")
    chosen.jobs = chosen.jobs or sorted(path.stem for path in chosen.baselines.glob("*.csv"))
    if not chosen.jobs:
        parser.error(f"{chosen.baselines} contains no baselines: specify the jobs")
    chosen.folders = folder_options(parser, chosen)
    chosen.out, chosen.baselines = chosen.out.resolve(), chosen.baselines.resolve()
    return chosen


def lock(folder: Path) -> int | None:
    """The lock of this night, held until its last process has ended; None if another night is running."""
    handle = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o666)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(handle)
        return None
    return handle


def slower(speeds: dict[str, float], earlier: dict[str, dict[int, float]], percent: float) -> list[str]:
    """Which times exceed the median of the earlier nights by more than `percent`; those in seconds also by LEAST_s."""
    found = []
    for name, value in speeds.items():
        if before := list(earlier.get(name, {}).values()):
            median = statistics.median(before)
            if value > (1.0 + percent / 100.0) * median and (value > median + LEAST_s or not name.endswith("(s)")):
                found.append(f"{100 * (value / median - 1):+.0f} % in {name}: {value:.3g} instead of {median:.3g}, the median of "
                             + night.counted(len(before), "earlier night"))
    return found


def measured(measure: Callable[[], Result], earlier: dict[str, dict[int, float]], fail_percent: float | None) -> Result:
    """The result of a job. If it is slower than before, it is run a second time, since other processes may have delayed it, and the
    shorter times count."""
    percent = SLOWER_PERCENT if fail_percent is None else fail_percent
    result = measure()
    if slower(result.speeds, earlier, percent):
        first, result = result.speeds, measure()
        result.speeds = {name: min(value, first.get(name, value)) for name, value in result.speeds.items()}
    if found := slower(result.speeds, earlier, percent):
        result.slower = found
        if result.verdict == night.EQUAL:
            result.end(night.SLOWER, 0, found[0])
        if fail_percent is not None and result.verdict in (night.SLOWER, night.NO_BASELINE):
            result.code = 5
    return result


def headline_of(results: list[Result]) -> str:
    """The results that are not equal to their baselines, failed ones first."""
    severity = list(night.VERDICTS)
    found = [r.headline for r in sorted(results, key=lambda r: severity.index(r.verdict)) if r.verdict != night.EQUAL]
    return "; ".join(found) or "all tables equal their baselines"


def code_of(results: list[Result]) -> int:
    """4 if a case failed, 5 if a table differs, otherwise the first code other than 0."""
    codes = [r.code for r in results]
    return next((code for code in (4, 5, *codes) if code in codes and code), 0)


def tests_of(results: list[Result]) -> list[Test]:
    """The entries of the JUnit file: one per job and one per failed case."""
    kinds = {night.FAILED: "error", night.BROKEN: "error", night.NO_BASELINE: "error", night.DIFFERS: "failure"}
    tests = []
    for r in results:
        kind = kinds.get(r.verdict, "failure" if r.code else "")
        tests.append(Test(r.name, r.name, r.seconds, kind, r.headline if kind or r.slower else "", [*r.slower, *r.rows]))
        tests += [Test(r.name, case, 0.0, "error", reason) for case, reason in r.failed.items()]
    return tests


def the_night(chosen: argparse.Namespace, watched: list[Watched], handle: int) -> list[Result]:
    log = chosen.out / "nightly.log"
    log.unlink(missing_ok=True)  # writing to a pipe would block
    os.environ.update(program.SHARED_CORES)
    shearwake, host = Program(log, (handle,)), socket.gethostname()
    history = History(chosen.out / "history.sqlite")
    started = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%S")
    git_id = "not built" if chosen.build_failed else shearwake.git_id()
    number = history.begin(started, git_id, host)
    if chosen.build_failed:
        output = Path(chosen.build_failed).read_text(encoding="utf-8", errors="replace")
        results = [Result(w.name).fail("build", 1, output) for w in watched]
    else:
        earlier = history.speeds(number - chosen.nights, host)
        tasks: list[Callable[[], Result]] = [
            lambda w=w: night.run_job(shearwake, w, chosen.ranks, 3600.0 * chosen.hours) for w in watched]  # type: ignore[misc]
        if not chosen.no_bench:
            tasks.append(lambda: night.bench(shearwake))
        results = [measured(task, earlier, chosen.fail_slower) for task in tasks]
    for result in results:
        if result.verdict not in (night.EQUAL, night.NO_BASELINE) and result.name != night.BENCH:
            result.rows += night.commits(history, result.name, git_id)
    headline = headline_of(results)
    verdict = min((r.verdict for r in results), key=list(night.VERDICTS).index)
    history.finish(number, verdict, [(r.name, r.verdict, r.reason) for r in results if r.name != night.BENCH or r.slower],
                   [(r.name, *reading) for r in results for reading in r.readings],
                   [speed for r in results for speed in r.speeds.items()])
    text = page.page(headline, results, {w.name: w.baseline for w in watched}, history, history.nights(chosen.nights))
    documents.replace(chosen.out / "index.html", text)
    documents.replace(chosen.out / "junit.xml", documents.junit(headline, tests_of(results)))
    history.close()
    return results


def run_night() -> list[Result]:
    """Runs a night and prints its results. Raises what prevents it."""
    chosen = arguments()
    try:
        watched = night.watched_jobs(chosen.jobs, chosen.out, chosen.baselines, chosen.folders)
    except ValueError as problem:
        raise UsageError(str(problem)) from problem
    chosen.out.mkdir(parents=True, exist_ok=True)
    handle = lock(chosen.out)
    if handle is None:
        raise OSError(f"another night is running in {chosen.out}; wait for its end, or choose another --out")
    try:
        results = the_night(chosen, watched, handle)
    except sqlite3.Error as problem:
        raise OSError(f"{chosen.out / 'history.sqlite'}: {problem}; if the file is damaged, move it away: the next night creates a "
                      "new one") from problem
    print(documents.subject(headline_of(results)), end="\n\n")
    for result in results:
        print(f"{result.name}: {result.state}", *result.slower, *result.rows, sep="\n  ")
    print(f"page: {chosen.out / 'index.html'}")
    return results


def main() -> int:
    try:
        return code_of(run_night())
    except (UsageError, OSError, ValueError, ShearwakeError) as problem:  # ValueError: tables or histories with other contents
        documents.cannot_run(str(problem), sys.argv[1:])
        return 2 if isinstance(problem, UsageError) else 6
    except Exception as problem:
        traceback.print_exc()
        documents.cannot_run(f"internal error: {problem!r}", sys.argv[1:])
        return 1


if __name__ == "__main__":
    sys.exit(main())
