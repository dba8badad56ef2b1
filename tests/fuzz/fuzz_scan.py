#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Changes files of scans at random and reads them: each gives a scan or a reason, in limited memory.

Usage: PYTHONPATH=analysis tests/fuzz/fuzz_scan.py [SECONDS] [SEED]
An input that breaks the reader is stored in a file, whose name is printed, and the exit code is 1.
"""
import io
import random
import resource
import sys
import tempfile
import time
import traceback
from pathlib import Path

import numpy as np

from shearwake.laboratory.scan import BadScan, Scan
from shearwake.laboratory.scan_files import read_scan, write_scan

MOST_B = 3 << 30
KINDS = {"uff": ".uff", "uffb": ".uff", "csv": ".csv", "mat": ".mat", "five": ".mat"}
TOKENS = (b"-1", b"58", b"NaN", b"1e999", b"1250000000", b"99999999999", b"\x00" * 8, b"\xff" * 8, b"    -1\n", b"m/s", b"MATLAB 5.0")


def examples(folder):
    """One valid file of each kind, as bytes."""
    import scipy.io

    rng = np.random.default_rng(1)
    scan = Scan(np.arange(20) / 1e4, rng.normal(size=4) * 1e-2, rng.normal(size=4) * 1e-2, rng.normal(size=(4, 20)) * 1e-4)
    found = {}
    for kind in ("uff", "uffb", "csv", "mat"):
        write_scan(folder / "example", scan, kind)
        found[kind] = (folder / "example").read_bytes()
    five = io.BytesIO()
    scipy.io.savemat(five, {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s})
    found["five"] = five.getvalue()
    return found


def changed(content, rng):
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 5, 30))):
        at, what = rng.randrange(len(data) + 1), rng.random()
        if what < 0.4 and at < len(data):
            data[at] = rng.randrange(256)
        elif what < 0.6:
            token = rng.choice(TOKENS)
            data[at:at + len(token)] = token
        elif what < 0.8:
            del data[at:at + rng.randrange(1, 80)]
        else:
            start = rng.randrange(len(data) + 1)
            data[at:at] = data[start:start + rng.randrange(1, 200)]
        if not data:
            data = bytearray(b"\n")
    return bytes(data)


def reason_of_failure(path):
    """Why an input breaks the reader; empty if it does not."""
    try:
        scan = read_scan(path)
        if scan.velocity_m_s.shape != (len(scan.x_m), len(scan.time_s)):
            return f"a scan of the shape {scan.velocity_m_s.shape}"
    except BadScan as error:
        if not str(error) or "\n" in str(error):
            return f"the reason is not one line: {error!r}"
    except Exception:  # noqa: BLE001 - any other exception is an error of the reader
        return traceback.format_exc()
    return ""


def main(seconds=600.0, seed=0):
    resource.setrlimit(resource.RLIMIT_AS, (MOST_B, MOST_B))
    rng, count, end = random.Random(seed), 0, time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as folder:
        good = examples(Path(folder))
        for kind, content in good.items():
            path = Path(folder) / f"good{KINDS[kind]}"
            path.write_bytes(content)
            read_scan(path)
        while time.monotonic() < end:
            kind = rng.choice(list(good))
            path = Path(folder) / f"input{KINDS[kind]}"
            path.write_bytes(changed(good[kind], rng))
            reason = reason_of_failure(path)
            count += 1
            if reason:
                kept = Path(f"scan-{seed}-{count}{KINDS[kind]}")
                kept.write_bytes(path.read_bytes())
                print(f"{kept}: {reason}")
                return 1
    print(f"no failure in {count} inputs")
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:3])))
