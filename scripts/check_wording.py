#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Finds phrases that readers had to translate into the field's standard terms, in all text that users see:
pages, messages, help, captions and comments of jobs, and in the identifiers of C++ and Python. Prints one line per occurrence
and exits with 1.

Usage: check_wording.py [--count] [FILE ...]    (default: every tracked file)
"""
import argparse
import io
import re
import subprocess
import sys
import tokenize
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Phrase: what to write instead.
PHRASES = {
    r"\b(tell|tells|told|telling)\b": "report, print, list, state",
    r"\b(say|says|said|saying|speaks? of)\b": "report, print, list, state",
    r"\b(mistakes?|findings?)\b": "error, warning, diagnostic",
    r"\bwhole cases?\b": "complete case",
    r"\b(go|goes|going|gone|went) on\b": "resume, continue",
    r"\b(begin|begins|began|begun) anew\b": "start from scratch",
    r"\bverbs?\b": "command, subcommand",
    r"\b(so many|as many as)\b": "N, the number of",
    r"\b(hold|holds|held|holding) (it |them )?to\b": "verify against, capped at",
    r"(?<!there )\bis no\b(?! (more|longer|less)\b)": "is not a valid ...",
    r"\b(what lies in|that which)\b": "the noun itself",
    r"\blikewise\b": "repeat the noun",
    r"\bbeside\b": "compared with, next to, in addition to",
    r"\d ?%? off\b": "in error by, differs by",
    r"\b(believes?|heard|knows)\b": "assumes, is configured with, recorded",
    r"\bfloors?\b": "lower bound",
    r"\bplans? of FFTW\b": "FFTW plan",
    r"\b\d+(\.\d+)? ?(s|ms|us|min|[kMGT]i?B|bytes|points|samples|%)? an? (case|step|rank|point|second|run)\b": "per case, per step, per rank",
    r"\bsays it all\b": "specify only one",
}
# The same for identifiers, as parts between underscores.
IDENTIFIERS = {
    r"trouble": "error, reason",
    r"is_whole|told": "is_complete; integer; reported",
    r"anew|begin_anew|go_on": "fresh, resume",
    r"(?<!_)must_(be|fit|exist|survive)\w*": "require_...",
    r"passed_over": "skipped",
    r"way_m|recalled|blame": "path_length_m, loaded, cause",
    r"StopAsked|folder_gone": "StopRequested, folder_removed",
}
IDENTIFIER = {re.compile(rf"(?<![A-Za-z0-9])({phrase})(?![A-Za-z0-9])"): instead for phrase, instead in IDENTIFIERS.items()}
# (end of a path, text of the line): occurrences in another, correct sense.
EXCEPTIONS = [
    ("scripts/check_wording.py", ""),
    ("analysis/shearwake/report/page/player.py", "as many as fit"),
]
_STRING = re.compile(r'R"(?P<mark>[^(]*)\((?P<raw>.*?)\)(?P=mark)"|"(?P<text>(?:[^"\\\n]|\\.)*)"', re.DOTALL)


def cpp_strings(text):
    for match in _STRING.finditer(re.sub(r"^\s*#.*$|//.*$", lambda m: " " * len(m[0]), text, flags=re.MULTILINE)):
        yield text.count("\n", 0, match.start()) + 1, match["raw"] or match["text"] or ""


def python_strings(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.STRING:
            for offset, line in enumerate(token.string.splitlines()):
                yield token.start[0] + offset, line


def cpp_code(text):
    """The lines of C++ without comments and strings."""
    plain = _STRING.sub(lambda match: '""' + "\n" * match[0].count("\n"), re.sub(r"//.*$", "", text, flags=re.MULTILINE))
    yield from enumerate(plain.splitlines(), 1)


def python_names(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NAME:
            yield token.start[0], token.string


def identifiers(path):
    """The lines of a file with its identifiers."""
    if path.suffix in (".cpp", ".hpp"):
        return cpp_code(path.read_text(encoding="utf-8"))
    return python_names(path.read_text(encoding="utf-8")) if path.suffix == ".py" else ()


def comments(text):
    for number, line in enumerate(text.splitlines(), 1):
        if "#" in line:
            yield number, line[line.index("#"):]


def shell(text):
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"\s*(#|echo|printf)", line):
            yield number, line


def prose(text):
    """The lines of a page outside of blocks and inline code."""
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
        elif not inside:
            yield number, re.sub(r"`[^`]*`|\]\([^)]*\)", " ", line)


def texts(path):
    content = path.read_text(encoding="utf-8")
    first = content.partition("\n")[0]
    if path.suffix == ".md":
        return prose(content)
    if path.suffix in (".cpp", ".hpp"):
        return cpp_strings(content)
    if path.suffix == ".py" or (first.startswith("#!") and "python" in first):
        return python_strings(content)
    if path.suffix == ".toml":
        return comments(content)
    if path.suffix == ".sh" or first.startswith("#!"):
        return shell(content)
    return ()


def is_user_visible(name):
    return name.endswith(".md") or name.startswith(("src/", "scripts/", "analysis/", "jobs/"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", help="files to check")
    parser.add_argument("--count", action="store_true", help="print the number of occurrences of each phrase")
    options = parser.parse_args()
    names = options.files or subprocess.run(
        ["git", "-c", f"safe.directory={ROOT}", "ls-files"], cwd=ROOT, check=True, capture_output=True,
        encoding="utf-8").stdout.split()
    phrases = {re.compile(phrase, re.IGNORECASE): instead for phrase, instead in PHRASES.items()}
    counts = dict.fromkeys([*phrases, *IDENTIFIER], 0)
    for name in names:
        path = ROOT / name
        if not path.is_file() or path.suffix in (".png", ".h5", ".csv"):
            continue
        checks = [(identifiers(path), IDENTIFIER)]
        if is_user_visible(name):
            checks.append((texts(path), phrases))
        for lines, table in checks:
            for number, line in lines:
                for phrase, instead in table.items():
                    for match in phrase.finditer(line):
                        if any(name.endswith(end) and part in line for end, part in EXCEPTIONS):
                            continue
                        counts[phrase] += 1
                        if not options.count:
                            print(f"{name}:{number}: \"{match[0]}\": {instead}: {line.strip()[:100]}")
    total = sum(counts.values())
    if options.count:
        for phrase, count in counts.items():
            print(f"{count:6} {phrase.pattern}")
        print(f"{total:6} in all")
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
