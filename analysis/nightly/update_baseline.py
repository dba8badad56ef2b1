#!/usr/bin/env python3
"""Makes the last night's table of a job its baseline; shows what changes first, and asks."""
import argparse
import csv
import os
import sys
from pathlib import Path

import night
import table
from shearwake_program import Program

ROOT = Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/update-baseline", description="Makes the table of the last "
                                     "night the baseline of a job. Shows the difference first, and asks.")
    parser.add_argument("job", metavar="JOB", help="as given to scripts/nightly")
    parser.add_argument("--yes", action="store_true", help="do not ask")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "nightly", metavar="DIR",
                        help="of scripts/nightly (default: out/nightly)")
    parser.add_argument("--baselines", type=Path, default=ROOT / "tests" / "baselines", metavar="DIR",
                        help="default: tests/baselines")
    return parser.parse_args()


def write_baseline(source, target):
    """The table without what depends on the machine. Whole or not at all."""
    columns, rows = table.read_rows(source)
    kept = [c for c in columns if c not in table.NOT_COMPARED]
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(target.name + ".part")
    with open(part, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, kept, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    part.replace(target)


def agreed():
    print("take this for the baseline? [y/N] ", end="", flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def update(chosen, watched):
    source = watched.table()
    if source is None:
        print(f"{watched.run} has no table of {watched.name}; next: scripts/nightly {chosen.job}", file=sys.stderr)
        return 6
    _, rows = table.read_rows(source)
    bad = [row["id"] for row in rows if row["status"] != "complete"]
    if bad:
        print(f"{watched.name}: {len(bad)} of {len(rows)} cases are not whole ({', '.join(bad[:5])}): no baseline",
              file=sys.stderr)
        return 4
    if watched.baseline.is_file():
        program = Program(os.environ.get("SHEARWAKE", ROOT / "build" / "shearwake"), os.devnull)
        code, said, _ = night.compare(program, watched)
        print(said, end="")
        if code == 0:
            print("the baseline stands as it is")
            return 0
        if code != 5 and not chosen.yes:
            print("they cannot be compared; --yes takes the new table all the same", file=sys.stderr)
            return code
    else:
        print(f"{watched.name} has no baseline yet; this one has {len(rows)} cases")
    if not chosen.yes and not agreed():
        print("left as it was")
        return 5
    write_baseline(source, watched.baseline)
    print(f"written: {watched.baseline}")
    return 0


def main():
    chosen = arguments()
    chosen.out, chosen.baselines = chosen.out.resolve(), chosen.baselines.resolve()
    try:
        watched = night.watched_jobs([chosen.job], ROOT, chosen.out, chosen.baselines)[0]
        return update(chosen, watched)
    except ValueError as problem:
        print(problem, file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"the baseline cannot be updated: {problem}", file=sys.stderr)
        return 6


if __name__ == "__main__":
    sys.exit(main())
