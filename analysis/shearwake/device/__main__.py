# SPDX-License-Identifier: BSD-3-Clause
"""Writes the load of a job or case for a device, and states what the device cannot do.

Usage: python3 -m shearwake.device JOB|CASE --to csv|autd3|ultraleap|hjif|wav|stl|phases [--rate HZ] [--distance-mm MM]
       [-S KEY=VALUE] [--no-effect] [--out NAME]    without --to: as shearwake.laboratory.export_scan
Exit 0: written; 2: the device cannot play the load; 3: the job has errors; 6: a file cannot be read or written.
"""
from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from pathlib import Path

from .. import program
from ..errors import ShearwakeError
from ..job import Job
from .load import BadExport, Trace, effect_of, single_case, table_of, trace_of
from .targets import BACK, DISTANCE_mm, TARGETS

USAGE, ENVIRONMENT = 2, 6


def export_lens(job: Job, prefix: str) -> None:
    if job.tables["load"].get("footprint", {}).get("shape") != "lens":
        raise BadExport("the load is not a lens; set load.footprint.shape = \"lens\"")
    with tempfile.TemporaryDirectory() as folder, job._file() as path:
        program.call(["lens", str(path), "--out", folder])
        shutil.copy(Path(folder) / "lens.stl", prefix + ".stl")
    print(f"files: {prefix}.stl")


def export(given: argparse.Namespace, prefix: str) -> None:
    """Raises BadExport, ShearwakeError and OSError."""
    job = single_case(Path(given.source), given.S)
    if given.to == "stl":
        return export_lens(job, prefix)
    known: dict[float, Trace] = {}

    def sample(rate_Hz: float) -> Trace:
        if rate_Hz not in known:
            known[rate_Hz] = trace_of(job, rate_Hz, given.to == "phases")
        return known[rate_Hz]

    made = TARGETS[given.to](sample, given.rate, given.distance_mm or sample(1000.0).distance_mm or DISTANCE_mm)
    for suffix, content in made.files.items():
        Path(prefix + suffix).write_bytes(content if isinstance(content, bytes) else content.encode())
    print("files: " + ", ".join(prefix + suffix for suffix in made.files))
    if back := next((suffix for suffix in BACK if suffix in made.files), ""):
        table = table_of(made, Path(Path(prefix).name + back))
        print("to read it back: [load.modulation] " + ", ".join(f"{key} = {json.dumps(value)}" for key, value in table.items()))
        if back == ".csv" and "update_rate_kHz" in job.tables["load"]["footprint"]:
            print("to read it back, remove load.footprint.update_rate_kHz, since each point is an update")
    for note in made.notes:
        print(note)
    for line in [] if given.no_effect else effect_of(job, made):
        print(f"effect: {line}")


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="shearwake export", allow_abbrev=False)
    parser.add_argument("source")
    parser.add_argument("--to", choices=[*TARGETS, "stl"])
    parser.add_argument("--rate", type=float)
    parser.add_argument("--distance-mm", type=float)
    parser.add_argument("-S", action="append", default=[])
    parser.add_argument("--no-effect", action="store_true")
    parser.add_argument("--out")
    given, other = parser.parse_known_args(arguments)
    if given.to is None:
        from ..laboratory.export_scan import main as export_scan
        return export_scan(arguments)
    if other:
        print(f"{other[0].partition('=')[0]} applies only without --to", file=sys.stderr)
        return USAGE
    try:
        export(given, (given.out or Path(given.source).stem).removesuffix(f".{given.to}"))
    except BadExport as error:
        print(f"{given.source}: {error}", file=sys.stderr)
        return USAGE
    except ShearwakeError as error:
        print(error, file=sys.stderr)
        return getattr(error, "exit_code", ENVIRONMENT)
    except OSError as error:
        print(f"{error.filename or given.source}: {error.strerror or error}", file=sys.stderr)
        return ENVIRONMENT
    except (KeyError, ValueError, ModuleNotFoundError) as error:
        print(f"{given.source}: {error}", file=sys.stderr)
        return ENVIRONMENT
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
