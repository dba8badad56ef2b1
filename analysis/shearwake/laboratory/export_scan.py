# SPDX-License-Identifier: BSD-3-Clause
"""Writes the scan of the vibrometer of a case as UFF 58, CSV or HDF5 for MATLAB and Octave.

Usage: python3 -m shearwake.laboratory.export_scan CASE [--format uff|csv|mat] [--binary] [--out FILE]
Exit 0: written; 2: the case has no scan; 6: a file cannot be read or written.
"""
import argparse
import sys
from pathlib import Path

from .scan import BadScan
from .scan_files import read_scan, write_scan

USAGE, ENVIRONMENT = 2, 6


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="shearwake export")
    parser.add_argument("case")
    parser.add_argument("--format", default="uff")
    parser.add_argument("--binary", action="store_true")
    parser.add_argument("--out")
    given = parser.parse_args(arguments)
    if given.binary and given.format != "uff":
        print("--binary applies only with --format uff", file=sys.stderr)
        return USAGE
    case, file = given.case, given.out or f"{Path(given.case).stem}.{given.format}"
    try:
        scan = read_scan(case)
        write_scan(file, scan, "uffb" if given.binary else given.format)
    except BadScan as error:
        print(f"{case}: {error}; a case has a scan if its job has [vibrometer]", file=sys.stderr)
        return USAGE
    except OSError as error:
        print(f"{error.filename or file}: {error.strerror or error}", file=sys.stderr)
        return ENVIRONMENT
    print(f"scan: {len(scan.x_m)} points, {len(scan.time_s)} samples at {scan.rate_Hz:g} Hz")
    print(f"file: {file}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
