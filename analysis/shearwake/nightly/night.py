# SPDX-License-Identifier: BSD-3-Clause
"""Runs and reduces a job, compares its table with the baseline, and states the result in a line and in rows of one line."""
import json
import shlex
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..plan import first_line, read_plan
from ..report.words import counted
from ..sweep import Sweep
from . import table
from .documents import ROOT
from .history import History
from .shearwake_program import TIMED_OUT, Program

FAILED, DIFFERS, BROKEN, NO_BASELINE, SLOWER, EQUAL = "failed", "differs", "broken", "no baseline", "slower", "equal"
VERDICTS = {FAILED: "failed", DIFFERS: "differs from the baseline", BROKEN: "failed", NO_BASELINE: "has no baseline",
            SLOWER: "is slower", EQUAL: "equal to the baseline"}  # the most severe one first
NAMED = 6  # columns in a row
BENCH = "shearwake bench"


@dataclass
class Watched:
    """A job and the paths of its files."""
    job: Path
    name: str  # name of the job file without .toml
    run: Path
    baseline: Path
    arguments: list[str]  # that select this job in the scripts

    @property
    def tolerances(self) -> Path:
        return self.baseline.with_suffix(".tolerances.toml")

    def command(self, script: str) -> str:
        """The command of a script for this job."""
        path = ROOT / "scripts" / script
        return shlex.join([str(path.relative_to(ROOT) if Path.cwd() == ROOT else path), *self.arguments])

    def table(self) -> Path | None:
        """The path of the run's table (CSV), or None. Raises NotAnOutputFolder."""
        if not (self.run / "plan.json").is_file():
            return None
        path = self.run / "tables" / f"{read_plan(self.run)[0]['name']}.csv"
        return path if path.is_file() else None


@dataclass
class Result:
    """The result of a job, or of the measurement of speeds. `reason` continues the headline, `rows` are the details, and
    `slower` states which times have increased."""
    name: str
    verdict: str = EQUAL
    code: int = 0  # exit code of the night if this were its only job
    reason: str = ""
    rows: list[str] = field(default_factory=list)
    slower: list[str] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)  # names of cases and their reasons
    differences: dict[str, Any] = field(default_factory=dict)  # as `shearwake compare --json` writes them
    readings: list[tuple[str, str, float]] = field(default_factory=list)
    seconds: float = 0.0
    speeds: dict[str, float] = field(default_factory=dict)

    def end(self, verdict: str, code: int, reason: str, *rows: str) -> "Result":
        self.verdict, self.code, self.reason, self.rows = verdict, code, reason, [*rows, *self.rows]
        return self

    def fail(self, command: str, code: int, output: str) -> "Result":
        """Ends with the first error in the output of a command, and with its last lines."""
        lines = output.strip().splitlines() or [f"exit {code}"]
        reason = next((line for line in lines if "error" in line), lines[-1])
        return self.end(BROKEN, code if 0 < code < TIMED_OUT else 1, f"{command}: {reason}", *lines[-12:])

    @property
    def state(self) -> str:
        return "measured" if self.name == BENCH and self.verdict == EQUAL else VERDICTS[self.verdict]

    @property
    def headline(self) -> str:
        """'tiny differs from the baseline: +1 % in peak_um'"""
        return f"{self.name} {self.state}" + (f": {self.reason}" if self.reason else "") + (
            f", and is slower: {self.slower[0]}" if self.slower and self.verdict != SLOWER else "")


def job_of_baseline(baselines: Path, name: str) -> Path:
    """The job of a baseline, which is jobs/NAME.toml unless the file NAME.job names another one."""
    path = baselines / f"{name}.job"
    return ROOT / (path.read_text(encoding="utf-8").strip() if path.is_file() else f"jobs/{name}.toml")


def store_job(watched: Watched) -> None:
    """Stores the path of a job outside of jobs/ next to its baseline."""
    path, job = watched.baseline.with_suffix(".job"), watched.job
    if job == ROOT / "jobs" / f"{watched.name}.toml":
        path.unlink(missing_ok=True)
    else:
        path.write_text(f"{job.relative_to(ROOT) if job.is_relative_to(ROOT) else job}\n", encoding="utf-8")


def watched_jobs(names: Sequence[str], out: Path, baselines: Path, folders: Sequence[str] = ()) -> list[Watched]:
    """The jobs with these names, which are names of baselines, of files in jobs/, or paths. `folders` are the options of the
    folders. Raises ValueError if two jobs have the same name."""
    found: dict[str, Watched] = {}
    for text in names:
        job = (Path(text) if text.endswith(".toml") else job_of_baseline(baselines, text)).resolve()
        new = Watched(job, job.stem, out / "runs" / job.stem, baselines / f"{job.stem}.csv",
                      [job.stem if job.parent == ROOT / "jobs" else str(job), *folders])
        if found.setdefault(job.stem, new).job != job:
            raise ValueError(f"{found[job.stem].job} and {job} have the same name: names must differ, since a baseline "
                             "belongs to one job")
    return list(found.values())


def compare(program: Program, watched: Watched) -> tuple[int, str, dict[str, Any]]:
    """(exit code, output, differences) of `shearwake compare` for the run and the baseline."""
    options: list[str | Path] = ["--tolerance", watched.tolerances] if watched.tolerances.is_file() else []
    code, output = program("compare", watched.run, watched.baseline, "--json", *options)
    if code not in (0, 1):
        return code, output, {}
    differences = json.loads(output)
    return 5 if code else 0, differences["text"], differences


def listed(names: Sequence[str]) -> str:
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def rows_of(differences: dict[str, Any], notes: dict[str, dict[str, str]], failed: dict[str, str]) -> list[str]:
    """The differences in rows of one line, one for each cause: the columns with the same change, or that became empty for the same
    reason. `notes` are the reasons for empty columns by the names of cases. Those of failed cases are no differences."""
    causes: dict[str, list[tuple[str, dict[str, Any], int]]] = {}
    for entry in differences.get("moved", []):
        if cells := [cell for cell in entry["cells"] if cell["case"] not in failed]:
            first = cells[0]
            note = notes.get(first["case"], {}).get(entry["column"], "") if not first["now"] else ""
            cause = f"{first['words']}: {note}" if note else first["words"] if first["change"] is None else f"{100 * first['change']:+.2g} %"
            causes.setdefault(cause, []).append((entry["column"], first, len(cells)))
    rows = []
    for cause, members in causes.items():
        column, cell, _ = members[0]
        values = f": {cell['reference'] or '(empty)'} -> {cell['now'] or '(empty)'}" if cell["reference"] or cell["now"] else ""
        rows.append(f"{cause} in {listed([name for name, _, _ in members])}; {max(n for _, _, n in members)} of "
                    f"{counted(differences['cases'], 'case')}; {column}{values} at {cell['case']}")
    for kind in ("missing_columns", "extra_columns", "missing_cases", "extra_cases"):
        if names := differences.get(kind):
            what, noun = kind[:-1].split("_")
            rows.append(f"{counted(len(names), f'{what} {noun}')}: {listed(names)}")
    if rows and (count := differences["cases_of_other_id"]):
        rows.append(f"{counted(count, 'case')} with other ids than in the baseline: parameters of the job have changed")
    return rows


def commits(history: History, name: str, git_id: str) -> list[str]:
    """The commits since the last night on which a job was equal to its baseline."""
    last = history.last_equal(name)
    if last is None:
        return ["no earlier night was equal to the baseline"]
    then, now = (text.partition("-dirty")[0] for text in (last[1], git_id))
    since = f"since the last equal night, {last[0]} ({last[1]})"
    log = subprocess.run(["git", "-C", str(ROOT), "-c", f"safe.directory={ROOT}", "log", "--oneline", "--no-decorate", f"{then}..{now}", "--"], capture_output=True,
                         encoding="utf-8", errors="replace", check=False)
    if log.returncode != 0:
        return [f"program {git_id}; the commits {since} are not known"]
    lines = log.stdout.splitlines()
    changes = "" if git_id == last[1] or "-dirty" not in git_id + last[1] else ", but uncommitted changes"
    return [f"{counted(len(lines), 'commit') if lines else 'no commit'} {since}{changes}"] + [f"  {line}" for line in lines]


def run_job(program: Program, watched: Watched, ranks: int, limit_s: float) -> Result:
    """Runs the complete sweep. The results of earlier nights are removed first."""
    shutil.rmtree(watched.run, ignore_errors=True)
    started = time.monotonic()
    code, output = program("run", watched.job, "--out", watched.run, "--quiet", ranks=ranks, limit_s=limit_s)
    result = Result(watched.name, seconds=time.monotonic() - started)
    if code not in (0, 4):
        return result.fail("run", code, output)
    code, output = program("reduce", watched.run)
    path = watched.table()
    if code not in (0, 4) or path is None:
        return result.fail("reduce", code, output)
    result.readings = table.readings(path)
    rows, sweep = table.read_cases(path), Sweep(watched.run)
    names = {row["id"]: table.row_name(rows, row) for row in rows.rows}
    result.failed = {names[case.id]: case.reason for case in sweep.every_case if not case.is_complete}
    owner = job_of_baseline(watched.baseline.parent, watched.name)
    if not watched.baseline.is_file():
        result.end(NO_BASELINE, 6, f"{watched.baseline} does not exist", f"next: {watched.command('update-baseline')}")
    elif owner != watched.job and owner.is_file():
        result.end(NO_BASELINE, 6, f"{watched.baseline} belongs to {owner}", f"to replace it: {watched.command('update-baseline')}")
    else:
        code, output, result.differences = compare(program, watched)
        rows_now = rows_of(result.differences, {names[case.id]: case.notes for case in sweep.every_case}, result.failed)
        if code == 5 and rows_now:
            result.end(DIFFERS, 5, rows_now[0].partition(";")[0], *rows_now)
        elif code not in (0, 5):
            result.fail("compare", code, output)
    if result.failed:
        reasons: dict[str, list[str]] = {}
        for name, reason in result.failed.items():
            reasons.setdefault(first_line(reason), []).append(name)
        failures = [f"{listed(members)}: {reason}" for reason, members in reasons.items()]
        count = f"{sum(not case.is_complete for case in sweep.every_case)} of {counted(len(sweep.every_case), 'case')} failed"
        return result.end(FAILED, 4, f"{count}, {failures[0]}", *failures)
    if result.verdict != BROKEN:
        result.speeds = {f"{watched.name} on {counted(ranks, 'rank')} (s)": result.seconds}
    return result


def bench(program: Program) -> Result:
    """Measures the speeds of the engines."""
    started = time.monotonic()
    result = Result(BENCH)
    result.speeds, output = program.speeds()
    result.seconds = time.monotonic() - started
    return result.fail("bench", 1, output) if output else result
