#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs all attacks in full numbers and writes the outcomes to docs/attacks.md.

Usage: long_form.py [WORD ...]     SHEARWAKE names the program (build/shearwake)
                                   WORD: only the tests whose name contains one of these words

Takes about an hour. Exit code 1 when an attack has succeeded; then nothing is written.
"""
import os
import sys
import unittest
from pathlib import Path

os.environ["SHEARWAKE_ATTACKS"] = "long"
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from attacks import LEDGER  # noqa: E402

ABOUT = """\
# Attacks

What `tests/integrity/long_form.py` did to the program, and what became of it. Written by that script;
the short form runs with `scripts/test`.

"""


def main():
    loader = unittest.TestLoader()
    if sys.argv[1:]:
        loader.testNamePatterns = [f"*{word}*" for word in sys.argv[1:]]
    result = unittest.TextTestRunner(verbosity=2).run(loader.discover(str(HERE)))
    print(LEDGER.markdown())
    if not result.wasSuccessful():
        return 1
    if not sys.argv[1:]:
        (HERE.parent.parent / "docs" / "attacks.md").write_text(ABOUT + LEDGER.markdown(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
