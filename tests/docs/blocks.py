# SPDX-License-Identifier: BSD-3-Clause
"""The fenced blocks of the pages of docs/, and a folder in which a reader could execute them."""
import os
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from program import PROGRAM, ROOT, environment

DOCS = ROOT / "docs"
# A block begins with ```language at the start of a line, or indented in a list.
_FENCE = re.compile(r"^(?P<indent> *)```(?P<language>[\w{}-]*)\n(?P<text>.*?)^(?P=indent)```$", re.MULTILINE | re.DOTALL)
# Languages whose blocks a test executes or validates, and those that are shown only. A block in any other
# language is an error: it would be neither.
EXECUTED = {"sh", "python", "octave"}
VALIDATED = {"toml"}
SHOWN = {"text", "console", "cpp", "cmake", "csv", "ini", "json", "matlab", "{toctree}", "{eval-rst}"}
FRAGMENT = "# part of a job"


@dataclass(frozen=True)
class Block:
    page: Path
    line: int
    language: str
    text: str

    def __str__(self):
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def pages():
    return sorted(DOCS.rglob("*.md"))


def blocks(page):
    """All blocks of a page in order, without the indentation of the list that holds them."""
    content = page.read_text(encoding="utf-8")
    found = []
    for match in _FENCE.finditer(content):
        indent = match["indent"]
        text = "".join(line.removeprefix(indent) for line in match["text"].splitlines(keepends=True))
        found.append(Block(page, content.count("\n", 0, match.start()) + 1, match["language"], text))
    return found


def make_reader_folder(folder):
    """What a reader has after a build: jobs, scripts, docs and the program on the PATH."""
    for name in ("jobs", "scripts", "analysis", "docs"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "build").mkdir()
    (folder / "build" / "shearwake").symlink_to(PROGRAM)
    return {**environment(), "PATH": f"{folder / 'build'}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(folder / "analysis"), "SHEARWAKE_PYTHON": sys.executable, "MPLBACKEND": "Agg"}


_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?(?!\w)")  # no part of an id


def _last_digit(number):
    """The value of one in the last digit of a printed number; 0 for an integer."""
    mantissa, _, exponent = number.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals) if exponent or decimals else 0.0


def _is_shown(shown, printed):
    """Whether a word of a page is the printed one; numbers agree within one in the last digit shown."""
    pairs = list(zip(_NUMBER.findall(shown), _NUMBER.findall(printed), strict=False))
    return _NUMBER.sub("0", shown) == _NUMBER.sub("0", printed) and all(
        abs(float(a) - float(b)) <= 1.01 * _last_digit(a) for a, b in pairs)


def first_difference(shown, printed):
    """The first passage of an output on a page that the program does not print; empty: it prints all. Line breaks do not count, and
    `...` stands for any words."""
    words, at = printed.split(), 0
    for passage in re.split(r"(?:^|\s)\.\.\.(?=\s|$)", shown):
        wanted = passage.split()
        found = next((i for i in range(at, len(words) - len(wanted) + 1)
                      if all(map(_is_shown, wanted, words[i:i + len(wanted)]))), None)
        if found is None:
            return passage.strip()
        at = found + len(wanted)
    return ""
