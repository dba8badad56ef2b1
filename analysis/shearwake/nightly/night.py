# SPDX-License-Identifier: BSD-3-Clause
"""Runs and reduces one job and compares its table with the baseline."""
import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from ..plan import read_plan
from . import table
from .shearwake_program import TIMED_OUT, Program

EQUAL, DIFFERS, NO_BASELINE, BROKEN = "equal", "differs", "no baseline", "broken"


@dataclass
class Watched:
    """A job and the paths of its files."""
    job: Path
    name: str  # name of the job file without .toml
    run: Path
    baseline: Path
    tolerances: Path

    def table(self) -> Path | None:
        """The path of the run's table (CSV), or None. Raises NotAnOutputFolder."""
        if not (self.run / "plan.json").is_file():
            return None
        path = self.run / "tables" / f"{read_plan(self.run)[0]['name']}.csv"
        return path if path.is_file() else None


@dataclass
class Result:
    watched: Watched
    verdict: str
    code: int  # exit code of the night if this were its only job
    message: str = ""
    differences: dict = field(default_factory=dict)  # as `shearwake compare --json` writes them
    readings: list = field(default_factory=list)
    seconds: float | None = None  # time of the median case

    @property
    def name(self) -> str:
        return self.watched.name


def watched_jobs(names: list[str], root: Path, out: Path, baselines: Path) -> list[Watched]:
    """The jobs with these names, which are names of files in jobs/ or paths. Raises ValueError if a job
    does not exist or a name occurs twice."""
    found = {}
    for name in names:
        path = Path(name) if name.endswith(".toml") else root / "jobs" / f"{name}.toml"
        if not path.is_file():
            raise ValueError(f"{path}: no such job; the jobs in jobs/ are "
                             + ", ".join(sorted(p.stem for p in (root / "jobs").glob("*.toml"))))
        if path.stem in found:
            raise ValueError(f"two jobs are called {path.stem}: names must differ, since a baseline belongs to "
                             "one job")
        found[path.stem] = Watched(path.resolve(), path.stem, out / "runs" / path.stem,
                                   baselines / f"{path.stem}.csv",
                                   baselines / f"{path.stem}.tolerances.toml")
    return list(found.values())


def compare(program: Program, watched: Watched) -> tuple[int, str, dict]:
    """(exit code, output, differences) of `shearwake compare` for the run and the baseline."""
    options: list[str | Path] = ["--tolerance", watched.tolerances] if watched.tolerances.is_file() else []
    code, output = program("compare", watched.run, watched.baseline, "--json", *options)
    if code not in (0, 1):
        return code, output, {}
    differences = json.loads(output)
    return 5 if code else 0, differences["text"], differences


def last_lines(output: str) -> str:
    return "\n".join(output.strip().splitlines()[-12:])


def run_job(program: Program, watched: Watched, ranks: int, limit_s: float) -> Result:
    """Runs the complete sweep. The results of earlier nights are removed first."""
    shutil.rmtree(watched.run, ignore_errors=True)
    code, output = program("run", watched.job, "--out", watched.run, "--quiet", ranks=ranks, limit_s=limit_s)
    if code not in (0, 4):
        return Result(watched, BROKEN, code if 0 < code < TIMED_OUT else 1, "run: " + last_lines(output))
    failed = code == 4
    code, output = program("reduce", watched.run)
    path = watched.table()
    if code != 0 or path is None:
        return Result(watched, BROKEN, code or 1, "reduce: " + last_lines(output))
    result = Result(watched, EQUAL, 0, readings=table.readings(path), seconds=table.median_seconds(path))
    if not watched.baseline.is_file():
        result.verdict, result.code = NO_BASELINE, 6
        result.message = f"{watched.baseline} does not exist; next: scripts/update-baseline {watched.name}"
        return result
    code, output, result.differences = compare(program, watched)
    if code == 5:
        result.verdict, result.code, result.message = DIFFERS, 5, output
    elif code != 0:
        result.verdict, result.code, result.message = BROKEN, code, "compare: " + last_lines(output)
    elif failed:  # equal to the baseline, but incomplete
        result.verdict, result.code, result.message = BROKEN, 4, "some cases failed, as in the baseline"
    return result
