# SPDX-License-Identifier: BSD-3-Clause
"""Runs one file of Python tests, and writes the progress to one file and the results to another.

Usage: unittest_main.py TESTS.py RESULTS.json    (SHEARWAKE_TEST_PROGRESS is the path of the progress file)
"""
import json
import os
import sys
import unittest
from pathlib import Path


def report(kind, text=""):
    path = os.environ.get("SHEARWAKE_TEST_PROGRESS")
    if path:
        with open(path, "a", encoding="utf-8") as file:
            file.write(f"{kind} {text}".rstrip() + "\n")


class Result(unittest.TextTestResult):
    def startTest(self, test):
        report("begin", test.id().partition(".")[2])
        super().startTest(test)

    def stopTest(self, test):
        super().stopTest(test)
        report("end", test.id().partition(".")[2])


def main():
    path, out = Path(sys.argv[1]), sys.argv[2]
    sys.path.insert(0, str(path.parent))
    suite = unittest.defaultTestLoader.loadTestsFromName(path.stem)
    report("total", str(suite.countTestCases()))
    result = unittest.TextTestRunner(verbosity=2, resultclass=Result).run(suite)
    bad = [(str(test), text) for test, text in result.failures + result.errors]
    bad += [(str(test), "passed unexpectedly") for test in result.unexpectedSuccesses]
    skipped = [(str(test), reason) for test, reason in result.skipped]
    passed = max(0, result.testsRun - len({name for name, _ in bad}) - len(skipped))
    with open(out, "w", encoding="utf-8") as file:
        json.dump({"passed": passed, "failed": bad, "skipped": skipped}, file)


if __name__ == "__main__":
    main()
