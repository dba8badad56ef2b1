#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the failures of a run of CTest and, last, `N passed, N failed`; exit 1 if a test failed.

Usage: count_tests.py BUILD

Reads BUILD/test-results: ctest.xml of CTest, and the JUnit reports of its groups (cmake/test_groups.cmake). A test on
several ranks, which have a report each, passes if it passes on all of them. A group that crashed, was ended at its time
limit, or left no report is a failure.
"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def read(report):
    """Name, verdict (passed, failed or skipped) and text of each test in a JUnit report."""
    for case in ElementTree.parse(report).iter("testcase"):
        verdict, texts = "passed", []
        for child in case:
            if child.tag in ("failure", "error", "skipped"):
                verdict = "skipped" if child.tag == "skipped" else "failed"
                texts += [child.get("message") or "", child.text or ""]
        yield f"{case.get('classname')} {case.get('name')}", verdict, "\n".join(filter(None, texts))


def count(build):
    """Numbers of passed and failed tests, and texts."""
    results = build / "test-results"
    passed, failed, texts = 0, 0, []
    for group in ElementTree.parse(results / "ctest.xml").iter("testcase"):
        name = group.get("name")
        verdicts, lost = {}, ""
        reports = sorted(results.glob(re.sub(r"\W", "_", name) + ".xml*"))
        for report in reports:
            try:
                for test, verdict, text in read(report):
                    if verdict != "passed":
                        texts.append(f"{verdict.upper()}  {test} ({name})\n" + re.sub("(?m)^", "    ", text))
                    if verdicts.get(test) != "failed":
                        verdicts[test] = verdict
            except ElementTree.ParseError:
                lost = f"{report.name} is incomplete"
        bad = list(verdicts.values()).count("failed")
        if not reports:
            lost = "it left no report"
        elif not lost and not bad and group.get("status") != "run":
            message = group.find("failure")
            lost = "it did not end well" if message is None else message.get("message") or "it failed"
        if lost:
            bad += 1
            tail = (group.findtext("system-out") or "").splitlines()[-40:]
            texts.append("\n    | ".join([f"FAILED  {name} as a whole: {lost}", *tail]))
        passed += list(verdicts.values()).count("passed")
        failed += bad
    return passed, failed, texts


def main():
    try:
        passed, failed, texts = count(Path(sys.argv[1]))
    except OSError as error:
        passed, failed, texts = 0, 1, [f"ctest left no results: {error}"]
    if passed + failed == 0:
        failed, texts = 1, ["the selection matches no test"]
    for text in dict.fromkeys(texts):
        print(text)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
