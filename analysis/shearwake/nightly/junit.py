# SPDX-License-Identifier: BSD-3-Clause
"""Writes a night as JUnit XML, with one suite per job and one test per column."""
from pathlib import Path
from xml.etree import ElementTree

from . import night


def add_case(suite: ElementTree.Element, name: str, kind: str | None = None, message: str = "") -> None:
    case = ElementTree.SubElement(suite, "testcase", classname=suite.get("name", ""), name=name)
    if kind:
        first = message.strip().splitlines()[0] if message.strip() else name
        ElementTree.SubElement(case, kind, message=printable(first)).text = printable(message)


def printable(text: str) -> str:
    """The text with control characters, which XML does not allow, replaced."""
    return "".join(c if c >= " " or c in "\n\t" else "?" for c in text)


def worst_line(column: dict) -> str:
    cell = column["cells"][0]
    return (f"{column['column']}: {cell['words']}: {cell['reference'] or '(empty)'} -> "
            f"{cell['now'] or '(empty)'} at {cell['case']}; {len(column['cells'])} cases differ")


def suite_of(root: ElementTree.Element, result: night.Result) -> None:
    suite = ElementTree.SubElement(root, "testsuite", name=result.name)
    if result.verdict in (night.BROKEN, night.NO_BASELINE):
        add_case(suite, "the sweep", "error", result.message or result.verdict)
    found = result.differences
    if found:
        moved = {column["column"]: column for column in found["moved"]}
        for name in found["tolerances"]:
            if name in moved:
                add_case(suite, name, "failure", worst_line(moved[name]))
            else:
                add_case(suite, name)
        for kind in ("missing_columns", "extra_columns", "missing_cases", "extra_cases"):
            items = "\n".join(found[kind])
            add_case(suite, kind.replace("_", " "), "failure" if items else None, items)
    for kind in ("failure", "error"):
        suite.set(kind + "s", str(len(suite.findall(f"testcase/{kind}"))))
    suite.set("tests", str(len(suite.findall("testcase"))))


def write(path: Path, results: list[night.Result]) -> None:
    root = ElementTree.Element("testsuites", name="nightly")
    for result in results:
        suite_of(root, result)
    for kind in ("tests", "failures", "errors"):
        root.set(kind, str(sum(int(suite.get(kind, 0)) for suite in root)))
    ElementTree.indent(root)
    part = path.with_name(path.name + ".part")
    ElementTree.ElementTree(root).write(part, encoding="utf-8", xml_declaration=True)
    part.replace(path)
