#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs all attacks in full numbers and prints a table of the outcomes.

Usage: long_form.py [--at-once N] [WORD ...]
    SHEARWAKE names the program (build/shearwake).
    --at-once N: run N of the test files at the same time (default 1)
    WORD: only the test files whose name contains one of these words

Takes one to two hours. Exit code 1 when an attack has succeeded.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

os.environ["SHEARWAKE_ATTACKS"] = "long"
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from attacks import LEDGER  # noqa: E402

sys.path.insert(0, str(HERE))  # in front of tests/faults, which has files with equal names


def attack(name):
    """Runs a test file in this process; returns whether all attacks have failed."""
    suite = unittest.TestLoader().discover(str(HERE), pattern=name)
    return unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful()


def attack_in_process(name):
    """The same in another process, whose ledger is added to this one."""
    with tempfile.NamedTemporaryFile(suffix=".json") as ledger:
        done = subprocess.run([sys.executable, __file__, "--only", name, "--ledger", ledger.name], check=False)
        for attempt, outcome, number in json.loads(Path(ledger.name).read_text(encoding="utf-8") or "[]"):
            LEDGER.add(attempt, outcome, number)
    return done.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", metavar="WORD")
    parser.add_argument("--at-once", type=int, default=1, metavar="N")
    parser.add_argument("--only", help=argparse.SUPPRESS)
    parser.add_argument("--ledger", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.only:
        succeeded = attack(chosen.only)
        Path(chosen.ledger).write_text(json.dumps(LEDGER.rows()), encoding="utf-8")
        return 0 if succeeded else 1
    names = sorted(path.name for path in HERE.glob("test_*.py")
                   if not chosen.words or any(word in path.name for word in chosen.words))
    with ThreadPoolExecutor(chosen.at_once) as pool:
        succeeded = all(list(pool.map(attack_in_process, names)))
    print(LEDGER.markdown())
    return 0 if succeeded else 1


if __name__ == "__main__":
    sys.exit(main())
