# SPDX-License-Identifier: BSD-3-Clause
"""Writes the load of a job or case for a device, and states what the device cannot do.

Usage: python3 -m shearwake.device JOB|CASE --to csv|autd3|ultraleap|hjif|wav|stl|phases [--rate HZ] [--distance-mm MM]
       [-S KEY=VALUE] [--no-effect] [--out NAME]    without --to: as shearwake.laboratory.export_scan
Exit 0: written; 2: the device cannot play the load; 3: the job has errors; 6: a file cannot be read or written.
"""
from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from ..errors import ProgramError, ShearwakeError
from .load import Load, effect_of, single_case
from .targets import BACK, TARGETS


def export(given: argparse.Namespace, prefix: str) -> None:
    """Raises BadExport, ShearwakeError and OSError."""
    job = single_case(Path(given.source), given.S)
    made = TARGETS[given.to](Load(job, given.distance_mm), given.rate)
    for suffix, content in made.files.items():
        Path(prefix + suffix).write_bytes(content if isinstance(content, bytes) else content.encode())
    print("files: " + ", ".join(prefix + suffix for suffix in made.files))
    if back := next((suffix for suffix in BACK if suffix in made.files), ""):
        table = made.table(Path(Path(prefix).name + back))
        print("to read it back: [load.modulation] " + ", ".join(f"{key} = {json.dumps(value)}" for key, value in table.items()))
        if back == ".csv" and "update_rate_kHz" in job.tables["load"]["footprint"]:
            print("to read it back, remove load.footprint.update_rate_kHz, since each point is an update")
    for note in [*made.notes, *([] if given.no_effect or given.to == "stl" else effect_of(made))]:
        print(note)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="shearwake export", allow_abbrev=False)
    parser.add_argument("source")
    parser.add_argument("--to", choices=TARGETS)
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
        parser.error(f"{other[0].partition('=')[0]} applies only without --to")
    try:
        export(given, (given.out or Path(given.source).stem).removesuffix(f".{given.to}"))
    except (ShearwakeError, OSError, KeyError, ValueError, ModuleNotFoundError) as error:
        place = "" if isinstance(error, ProgramError) else f"{getattr(error, 'filename', None) or given.source}: "
        print(f"{place}{getattr(error, 'strerror', None) or error}", file=sys.stderr)
        return getattr(error, "exit_code", 6)  # the environment
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
