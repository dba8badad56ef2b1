"""One night's work on one job: run, reduce, compare."""
import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import table

EQUAL, DIFFERS, NO_BASELINE, BROKEN = "equal", "differs", "no baseline", "broken"


@dataclass
class Watched:
    """A job and where its things are."""
    job: Path
    name: str  # of the job file, without .toml
    run: Path
    baseline: Path
    tolerances: Path

    def table(self):
        """The CSV of the run, or None."""
        plan = self.run / "plan.json"
        if not plan.is_file():
            return None
        path = self.run / "tables" / (json.loads(plan.read_text(encoding="utf-8"))["name"] + ".csv")
        return path if path.is_file() else None


@dataclass
class Result:
    watched: Watched
    verdict: str
    code: int  # what it would have the night exit with
    message: str = ""
    differences: dict = field(default_factory=dict)  # as `shearwake diff --json` writes them
    readings: list = field(default_factory=list)
    seconds: float | None = None  # of the median case

    @property
    def name(self):
        return self.watched.name


def watched_jobs(names, root, out, baselines):
    """Names of files in jobs/, or paths. Raises ValueError with what is wrong."""
    found = {}
    for name in names:
        path = Path(name) if name.endswith(".toml") else root / "jobs" / f"{name}.toml"
        if not path.is_file():
            raise ValueError(f"{path}: there is no such job; jobs/ has "
                             + ", ".join(sorted(p.stem for p in (root / "jobs").glob("*.toml"))))
        if path.stem in found:
            raise ValueError(f"two jobs are called {path.stem}; a baseline belongs to one")
        found[path.stem] = Watched(path.resolve(), path.stem, out / "runs" / path.stem,
                                   baselines / f"{path.stem}.csv",
                                   baselines / f"{path.stem}.tolerances.toml")
    return list(found.values())


def compare(program, watched):
    """(exit code, words, differences) of the run against the baseline."""
    moved = watched.run / "differences.json"
    options = ["--tolerances", watched.tolerances] if watched.tolerances.is_file() else []
    done = program("diff", watched.run, watched.baseline, "--json", moved, *options)
    differences = json.loads(moved.read_text(encoding="utf-8")) if done.code in (0, 5) else {}
    return done.code, done.said, differences


def last_words(said):
    return "\n".join(said.strip().splitlines()[-12:])


def run_job(program, watched, ranks, limit_s):
    """The whole sweep anew: nothing of another night is taken for this one's."""
    shutil.rmtree(watched.run, ignore_errors=True)
    done = program("run", watched.job, "--out", watched.run, "--quiet", ranks=ranks, limit_s=limit_s)
    if done.code not in (0, 4):
        return Result(watched, BROKEN, done.code if done.code > 0 else 1, "run: " + last_words(done.said))
    failed = done.code == 4
    reduced = program("reduce", watched.run)
    path = watched.table()
    if reduced.code != 0 or path is None:
        return Result(watched, BROKEN, reduced.code or 1, "reduce: " + last_words(reduced.said))
    result = Result(watched, EQUAL, 0, readings=table.readings(path), seconds=table.median_seconds(path))
    if not watched.baseline.is_file():
        result.verdict, result.code = NO_BASELINE, 6
        result.message = f"there is no {watched.baseline}; next: scripts/update-baseline {watched.name}"
        return result
    code, said, result.differences = compare(program, watched)
    if code == 5:
        result.verdict, result.code, result.message = DIFFERS, 5, said
    elif code != 0:
        result.verdict, result.code, result.message = BROKEN, code, "diff: " + last_words(said)
    elif failed:  # as in the baseline, but no result
        result.verdict, result.code, result.message = BROKEN, 4, "some cases failed, as in the baseline"
    return result
