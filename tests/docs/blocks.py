# SPDX-License-Identifier: BSD-3-Clause
"""The fenced blocks of the pages of docs/, a folder in which a reader could execute them, and their execution."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from program import PATIENCE_s, PROGRAM, ROOT, environment

DOCS = ROOT / "docs"
# A block begins with ```language at the start of a line, or indented in a list.
_FENCE = re.compile(r"^(?P<indent> *)```(?P<language>[\w{}-]*)\n(?P<text>.*?)^(?P=indent)```$", re.MULTILINE | re.DOTALL)
# Languages whose blocks a test executes or validates, and those that are shown only. A block in any other
# language is an error: it would be neither.
EXECUTED = {"sh", "python", "octave"}
VALIDATED = {"toml"}
SHOWN = {"text", "console", "cpp", "cmake", "csv", "ini", "json", "matlab", "{toctree}", "{eval-rst}"}
FRAGMENT = "# part of a job"
# Blocks that need more than the program and a shell, by their beginning.
NEEDS = {
    "scripts/quickstart\nscripts/test": "the first command is executed before all pages, and the second one executes this script",
    "$ module load": "modules of a cluster",
    "$ prefix=": "sources of libraries",
    "$ cmake --preset release -DSHEARWAKE_TESTS=OFF -DCMAKE_PREFIX_PATH": "libraries built before",
    "$ scripts/submit": "a cluster",
    "$ mpirun -n 8 shearwake run big.toml": "a job of the reader",
    "$ shearwake explore": "a server that Ctrl-C ends",
    "$ ssh": "another machine",
    "$ mpirun -n 2 shearwake kwave -i in.h5": "a file written by MATLAB",
    "$ shearwake fit": "a measured scan",
    "$ shearwake kwave -i in.h5 -o out.h5 --device gpu": "a GPU",
    "$ scripts/nightly": "hours, and a job of the reader",
    "$ sqlite3": "the history of nightly runs",
    "$ scripts/update-baseline": "the history of nightly runs",
}


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
    """All blocks of a page in order, without the indentation of the list that holds them; the code of a notebook is one block."""
    content = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        cells = ["".join(cell["source"]) for cell in json.loads(content)["cells"] if cell["cell_type"] == "code"]
        return [Block(page, 1, "python", "\n".join(cells))]
    found = []
    for match in _FENCE.finditer(content):
        indent = match["indent"]
        text = "".join(line.removeprefix(indent) for line in match["text"].splitlines(keepends=True))
        found.append(Block(page, content.count("\n", 0, match.start()) + 1, match["language"], text))
    return found


def needs(block):
    """What a block needs that is missing here; None: nothing."""
    if block.language == "octave":
        return None if shutil.which("octave-cli") else "octave-cli"
    return next((need for begin, need in NEEDS.items() if block.text.startswith(begin)), None)


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


PRINTED = re.compile(r"^print\(.*\) +# (\S.*)$", re.MULTILINE)  # Python that states its result in a comment
_PROMPT = re.compile(r"^[$>] ?")


def _split_console(text):
    """The commands of a `console` block, whose lines begin with `$ ` or continue with `> `, and the other lines, their output."""
    lines = text.splitlines()
    return ("\n".join(_PROMPT.sub("", line) for line in lines if _PROMPT.match(line)),
            "\n".join(line for line in lines if not _PROMPT.match(line)))


def _arguments(language, text, state):
    """The arguments that execute a block. A shell keeps its exported variables in the file `state`."""
    if language in ("sh", "console"):
        return ["sh", "-eu", "-c", f'. "$0"\n{text}\nexport -p >"$0"', state]
    interpreter = {"python": [sys.executable, "-c"], "octave": ["octave-cli", "--quiet", "--eval"]}[language]
    return ["sh", "-c", '. "$0"; exec "$@"', state, *interpreter, text]


def execute(page, folder, variables, executed, is_left_out):
    """Executes the blocks of a page in these languages in order, in a folder and with these environment variables, as a reader who
    copies them; yields what fails or prints something else than the page shows. is_left_out(block): whether a block is not executed."""
    session = {"python": "", "octave": ""}  # the blocks of one page share their variables
    output = None  # of the preceding block, if it was executed
    with tempfile.NamedTemporaryFile() as state:
        for block in blocks(page):
            text, shown = block.text, ""
            if block.language in executed and not is_left_out(block):
                if block.language in session:
                    text = session[block.language] = session[block.language] + block.text
                elif block.language == "console":
                    text, shown = _split_console(block.text)
                done = subprocess.run(_arguments(block.language, text, state.name), cwd=folder, env=variables,
                                      stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
                                      errors="replace", timeout=PATIENCE_s, check=False)
                output = done.stdout + done.stderr
                if done.returncode != 0:
                    yield f"{block} fails:\n{block.text}\n{output}"
                if "NotValid: " in done.stderr:
                    yield f"{block}: an example has readings that are not valid"
                for printed in PRINTED.findall(block.text):
                    if printed not in done.stdout.splitlines():
                        yield f"{block} states another result than it prints: {printed}\n{output}"
            elif block.language == "text" and output is not None and page.parent.name in ("tutorial", "how-to"):
                shown = block.text
            else:
                output = None
            if difference := first_difference(shown, output or ""):
                yield f"{block} shows what its commands do not print:\n{difference}\n\nThey print:\n{output}"
