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
