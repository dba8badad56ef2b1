# SPDX-License-Identifier: BSD-3-Clause
"""Runs the jobs, compares their tables with the baselines, stores all numbers in the history, and writes
an HTML page. scripts/nightly builds the program and then runs this script."""
import argparse
import fcntl
import os
import socket
import sqlite3
import statistics
import sys
from datetime import datetime, timezone
from pathlib import Path

from .. import program
from ..errors import ShearwakeError
from . import night, page
from .history import History
from .night import Result, Watched
from .shearwake_program import Program

ROOT = Path(__file__).resolve().parents[3]
# A speed is reported as slower if its ratio exceeds the median of the earlier nights by this factor in two
# consecutive nights. Other processes on the machine have changed a ratio by a factor of 1.7 for one night.
SLOWER = 1.25


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/nightly", description="Builds the program, runs "
                                     "the jobs and compares their tables with the baselines; exit 5 if one "
                                     "differs.")
    parser.add_argument("jobs", nargs="*", metavar="JOB", help="name of a file in jobs/, or a path to one "
                        "that ends in .toml (default: all jobs with a baseline)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "nightly", metavar="DIR",
                        help="folder for history, runs and page (default: out/nightly)")
    parser.add_argument("--baselines", type=Path, default=ROOT / "tests" / "baselines", metavar="DIR",
                        help="folder of the baselines (default: tests/baselines)")
    parser.add_argument("--ranks", type=int, default=2, metavar="N", help="ranks of each run (default: 2)")
    parser.add_argument("--hours", type=float, default=6.0, metavar="H", help="time limit per job (default: 6)")
    parser.add_argument("--nights", type=int, default=60, metavar="N", help="number of nights on the page "
                        "(default: 60)")
    parser.add_argument("--no-bench", action="store_true", help="do not measure speeds")
    parser.add_argument("--build-failed", metavar="LOG", help=argparse.SUPPRESS)
    chosen = parser.parse_intermixed_args()
    if chosen.ranks < 1 or chosen.nights < 1 or chosen.hours <= 0:
        parser.error("--ranks, --nights and --hours must be greater than 0")
    chosen.jobs = chosen.jobs or sorted(path.stem for path in chosen.baselines.glob("*.csv"))
    if not chosen.jobs:
        parser.error(f"{chosen.baselines} contains no baselines: specify the jobs")
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


def speeds_of(shearwake: Program, results: list[Result]) -> list[tuple[str, float]]:
    """The speeds of the engines, and per job the time of its median case over that of the FFTs of a
    case of engine layered."""
    speeds, layered_s = shearwake.speeds()
    for result in results:
        if layered_s and result.seconds:
            speeds.append((f"{result.name}: median case relative to FFTs of layered", result.seconds / layered_s))
    return speeds


def slower_than_before(history: History, number: int, nights: list[tuple]) -> list[str]:
    """Names of the speeds that were slower in this night and the night before than in the nights before
    these two, of which there must be at least three."""
    found = []
    for name, values in history.speeds(nights[0][0]).items():
        ratios = [values[n] for n in sorted(values)]
        before, now = ratios[:-2], ratios[-2:]
        if number in values and len(before) >= 3 and min(now) > SLOWER * statistics.median(before):
            found.append(name)
    return found


def write(path: Path, text: str) -> None:
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)


def verdict_of(results: list[Result]) -> str:
    for verdict in (night.DIFFERS, night.BROKEN, night.NO_BASELINE):
        if any(r.verdict == verdict for r in results):
            return verdict
    return night.EQUAL


def code_of(results: list[Result]) -> int:
    """5 if one job differs, otherwise the first code other than 0."""
    codes = [r.code for r in results]
    return 5 if 5 in codes else next((code for code in codes if code), 0)


def broken_build(log: Path, watched: list[Watched]) -> list[Result]:
    output = Path(log).read_text(encoding="utf-8", errors="replace")
    return [night.Result(w, night.BROKEN, 1, "the build failed: " + night.last_lines(output)) for w in watched]


def the_night(chosen: argparse.Namespace, watched: list[Watched], handle: int) -> tuple[list[Result], list[str]]:
    log = chosen.out / "nightly.log"
    for name in (log.name, "index.html.part"):
        (chosen.out / name).unlink(missing_ok=True)  # writing to a pipe would block
    os.environ.update(program.SHARED_CORES)
    shearwake = Program(log, (handle,))
    history = History(chosen.out / "history.sqlite")
    started = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%S")
    git_id = "not built" if chosen.build_failed else shearwake.git_id()
    number = history.begin(started, git_id, socket.gethostname())
    speeds: list[tuple[str, float]] = []
    if chosen.build_failed:
        results = broken_build(chosen.build_failed, watched)
    else:
        results = [night.run_job(shearwake, w, chosen.ranks, 3600.0 * chosen.hours) for w in watched]
        if not chosen.no_bench:
            speeds = speeds_of(shearwake, results)
    verdict = verdict_of(results)
    history.finish(number, verdict, [(r.name, r.verdict, r.message) for r in results],
                   [(r.name, *reading) for r in results for reading in r.readings], speeds)
    nights = history.nights(chosen.nights)
    slower = slower_than_before(history, number, nights)
    write(chosen.out / "index.html", page.page(verdict, results, history, nights, slower))
    history.close()
    return results, slower


def main() -> int:
    chosen = arguments()
    chosen.out, chosen.baselines = chosen.out.resolve(), chosen.baselines.resolve()
    try:
        watched = night.watched_jobs(chosen.jobs, ROOT, chosen.out, chosen.baselines)
    except ValueError as problem:
        print(problem, file=sys.stderr)
        return 2
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        handle = lock(chosen.out)
        if handle is None:
            print(f"another night is running in {chosen.out}; wait for its end, or choose another --out",
                  file=sys.stderr)
            return 6
        results, slower = the_night(chosen, watched, handle)
    except (OSError, ValueError, ShearwakeError) as problem:  # ValueError: tables or histories with other contents
        print(f"the night cannot continue: {problem}", file=sys.stderr)
        return 6
    except sqlite3.Error as problem:
        print(f"{chosen.out / 'history.sqlite'}: {problem}; if the file is damaged, move it away: the next "
              "night creates a new one", file=sys.stderr)
        return 6
    for result in results:
        print(f"{result.name}: {page.VERDICTS[result.verdict]}")
        if result.message:
            print("  " + result.message.strip().replace("\n", "\n  "))
    for name in slower:
        print(f"slower: {name}")
    print(f"page: {chosen.out / 'index.html'}")
    return code_of(results)


if __name__ == "__main__":
    sys.exit(main())
