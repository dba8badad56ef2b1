# SPDX-License-Identifier: BSD-3-Clause
"""The frame of the page and the JUnit file, which state the result of a night in their first line.

With a reason and the arguments of scripts/nightly, this file replaces both by ones that state why the night could not run. It
imports the standard library only, so that any Python runs it: python3 documents.py REASON [ARGUMENTS OF scripts/nightly]
"""
import argparse
import html
import sys
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CSS = """
:root { color-scheme: light; } * { box-sizing: border-box; }
body { margin: 0 auto; max-width: 66rem; padding: 1.5rem 1rem 4rem; background: #fff; color: #222;
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.4rem; margin: 0 0 .3rem; border-left: 5px solid #009E73; padding: .2rem 0 .2rem .9rem; }
h1.bad { border-color: #D55E00; } h2 { font-size: 1.2rem; margin: 2.4rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1.4rem 0 .4rem; } p { margin: .4rem 0; } h1, li { overflow-wrap: anywhere; }
.small, figcaption { color: #555; font-size: .85rem; } ul { padding-left: 1.2rem; font-size: .9rem; white-space: nowrap; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem .25rem 0; text-align: left; border-bottom: 1px solid #e4e4e4; vertical-align: top; }
th { border-bottom: 1.5px solid #888; } .scroll { overflow-x: auto; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 1rem 1.2rem; }
figure { margin: 0; } figure.moved figcaption b { color: #B34700; }
figcaption { overflow-wrap: anywhere; line-height: 1.3; } figcaption b { color: #222; }
svg { width: 100%; height: 4.5rem; display: block; overflow: visible; border: solid #999; border-width: 0 0 1px 1px; }
svg * { vector-effect: non-scaling-stroke; fill: none; stroke-width: 1.4; stroke-linecap: round; }
svg .band { fill: #009E73; fill-opacity: .16; stroke: none; } svg .last { stroke-width: 6; }
"""


@dataclass
class Test:
    """An entry of the JUnit file. `kind` is `error` if no result was obtained, `failure` for another result than expected, and
    empty otherwise."""
    suite: str
    name: str
    time_s: float
    kind: str = ""
    message: str = ""
    details: list[str] = field(default_factory=list)


def replace(path: Path, text: str) -> None:
    """Replaces a file once its content is complete."""
    part = path.with_name(path.name + ".part")
    part.unlink(missing_ok=True)  # writing to a pipe would block
    part.write_text(text, encoding="utf-8")
    part.replace(path)


def page(headline: str, is_good: bool, stamp: str, body: str) -> str:
    title = html.escape(headline)
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
            f'<meta name="viewport" content="width=device-width"><style>{CSS}</style></head><body>'
            f"<h1{'' if is_good else ' class=bad'}>{title}</h1><p class='small'>{html.escape(stamp)}</p>{body}</body></html>\n")


def junit(headline: str, tests: list[Test]) -> str:
    root = ET.Element("testsuites", name=printable(headline))
    for name in dict.fromkeys(test.suite for test in tests):
        members = [test for test in tests if test.suite == name]
        failures, errors = (str(sum(test.kind == kind for test in members)) for kind in ("failure", "error"))
        suite = ET.SubElement(root, "testsuite", name=printable(name), tests=str(len(members)), failures=failures, errors=errors)
        for test in members:
            case = ET.SubElement(suite, "testcase", classname=printable(name), name=printable(test.name), time=f"{test.time_s:.3f}")
            if test.message:
                found = ET.SubElement(case, test.kind or "system-out", {"message": printable(test.message)} if test.kind else {})
                found.text = printable("\n".join(test.details if test.kind else [test.message, *test.details]))
    return ET.tostring(root, encoding="unicode") + "\n"


def printable(text: str) -> str:
    """XML does not allow control characters."""
    return "".join(letter if letter.isprintable() or letter == "\n" else "?" for letter in text)


def subject(headline: str) -> str:
    """The first line of the output, which is that of a mail."""
    return "Subject: shearwake nightly: " + printable(headline).replace("\n", " ")


def add_out(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "nightly", metavar="DIR",
                        help="folder for history, runs and page (default: out/nightly)")


def cannot_run(reason: str, arguments: list[str]) -> None:
    """Prints why a night cannot run, and replaces page and JUnit file."""
    parser = argparse.ArgumentParser(add_help=False)
    add_out(parser)
    folder: Path = parser.parse_known_args(arguments)[0].out
    reason = reason.strip() or "unknown reason"
    first, *lines = reason.splitlines()
    headline = f"the night could not run: {first}"
    print(subject(headline), "", reason, sep="\n")
    stamp = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M:%S UTC")
    body = "".join(f"<p>{html.escape(line)}</p>" for line in lines)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        replace(folder / "index.html", page(headline, False, stamp, body))
        replace(folder / "junit.xml", junit(headline, [Test("shearwake nightly", "night", 0.0, "error", reason, lines)]))
    except OSError as error:
        print(f"page and JUnit file cannot be replaced: {error}", file=sys.stderr)


if __name__ == "__main__":
    cannot_run(sys.argv[1], sys.argv[2:])
