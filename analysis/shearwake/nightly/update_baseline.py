# SPDX-License-Identifier: BSD-3-Clause
"""Replaces the baseline of a job by the table of the last night, after showing the differences and asking
for confirmation."""
import argparse
import csv
import os
import sys
from pathlib import Path

from ..errors import ShearwakeError
from . import night, table
from .__main__ import add_folders, folder_options
from .shearwake_program import Program


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/update-baseline", description="Replaces the baseline of a "
                                     "job by the table of the last night. Shows the differences and asks for "
                                     "confirmation first.")
    parser.add_argument("job", metavar="JOB", help="name or path of the job, as given to scripts/nightly")
    parser.add_argument("--yes", action="store_true", help="do not ask for confirmation")
    add_folders(parser)
    chosen = parser.parse_args()
    chosen.folders = folder_options(parser, chosen)
    return chosen


def write_baseline(source: Path, target: Path) -> None:
    """Writes the table without the columns that depend on the machine. The file is replaced atomically."""
    cases = table.read_cases(source)
    compared = [column for column in cases.columns if column not in table.NEVER_COMPARED]
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(target.name + ".part")
    with open(part, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, compared, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(cases.rows)
    part.replace(target)


def agreed() -> bool:
    print("make this table the baseline? [y/N] ", end="", flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def update(chosen: argparse.Namespace, watched: night.Watched) -> int:
    source = watched.table()
    if source is None:
        print(f"{watched.run} has no table of {watched.name}; next: {watched.command('nightly')}", file=sys.stderr)
        return 6
    rows = table.read_cases(source).rows
    bad = [row["id"] for row in rows if row["status"] != "complete"]
    if bad:
        print(f"{watched.name}: {len(bad)} of {len(rows)} cases are not complete ({', '.join(bad[:5])}): the "
              "baseline is not written", file=sys.stderr)
        return 4
    if watched.baseline.is_file():
        code, output, _ = night.compare(Program(os.devnull), watched)
        print(output, end="")
        if code == 0:
            night.store_job(watched)
            print("the baseline is up to date")
            return 0
        if code != 5 and not chosen.yes:
            print("the tables cannot be compared; use --yes to replace the baseline nevertheless", file=sys.stderr)
            return code
    else:
        print(f"{watched.name} has no baseline yet; the new one has {len(rows)} cases")
    if not chosen.yes and not agreed():
        print("the baseline is unchanged")
        return 5
    write_baseline(source, watched.baseline)
    night.store_job(watched)
    print(f"written: {watched.baseline}")
    return 0


def main() -> int:
    chosen = arguments()
    chosen.out, chosen.baselines = chosen.out.resolve(), chosen.baselines.resolve()
    try:
        watched = night.watched_jobs([chosen.job], chosen.out, chosen.baselines, chosen.folders)[0]
        return update(chosen, watched)
    except ValueError as problem:
        print(problem, file=sys.stderr)
        return 2
    except (OSError, ShearwakeError) as problem:
        print(f"the baseline cannot be updated: {problem}", file=sys.stderr)
        return 6


if __name__ == "__main__":
    sys.exit(main())
