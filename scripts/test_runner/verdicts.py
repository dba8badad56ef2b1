# SPDX-License-Identifier: BSD-3-Clause
"""Reads the results of tests from the reports of the runners.

Each function returns the numbers of passed and failed tests, texts about tests, and errors of the report
itself.
"""
import json
import re
import xml.etree.ElementTree as ElementTree


def message(element):
    """The message of Catch2 for a failed assertion or an exception."""
    at = f"{element.get('filename', '?')}:{element.get('line', '?')}"
    parts = [" ".join((child.text or "").split()) for child in element.iter() if child is not element]
    own = " ".join((element.text or "").split())
    return f"    {at}: " + "\n        ".join(part for part in [own, *parts] if part)


def count_catch(path):
    """Reads Catch2's XML reports, one per rank. A test case passes if it passes on all ranks."""
    verdicts, texts, broken = {}, [], []
    for report in sorted(path.parent.glob(path.name + "*")):
        ended = False
        try:
            for _, element in ElementTree.iterparse(report):
                ended = ended or element.tag == "OverallResults"
                if element.tag != "TestCase":
                    continue
                name = element.get("name")
                fine = element.find("OverallResult").get("success") == "true"
                if not fine and verdicts.get(name, True):
                    bad = [e for e in element.iter("Expression") if e.get("success") == "false"]
                    bad += [tag for kind in ("Exception", "Failure", "FatalErrorCondition")
                            for tag in element.iter(kind)]
                    texts.append("\n".join([f"FAILED  {name}", *map(message, bad)]))
                verdicts[name] = verdicts.get(name, True) and fine
        except ElementTree.ParseError:
            pass
        if not ended:
            broken.append(f"  {report.name} is incomplete")
    if not verdicts:
        broken.append("  the group reports no count")
    passed = sum(verdicts.values())
    return passed, len(verdicts) - passed, texts, broken


def count_unittest(path):
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return 0, 0, [], ["  the group reports no count"]
    failed = result["failed"]
    texts = [f"  skipped {name}: {reason}" for name, reason in result["skipped"]]
    texts += [f"FAILED  {name}\n" + re.sub("(?m)^", "    ", text) for name, text in failed]
    return result["passed"], len({name for name, _ in failed}), texts, []
