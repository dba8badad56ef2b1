#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the scan of the vibrometer of a case as UFF 58, CSV or HDF5 for MATLAB and Octave.

Usage: export_scan.py CASE KIND FILE
KIND is uff, uffb (binary), csv or mat. Exit 0: written; 2: the case has no scan; 6: a file cannot be read or written.
"""
import sys

from scan import BadScan, read_scan, write_scan

USAGE, ENVIRONMENT = 2, 6


def main(case, kind, file):
    try:
        scan = read_scan(case)
        write_scan(file, scan, kind)
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
    sys.exit(main(*sys.argv[1:]))
