#!/usr/bin/env python3
"""Holds every include to the layers of the program: own folder and lower folders only.

Usage: check_layers.py [SRC] (default: src beside this script). Prints each breach as
file:line and exits 1 if there is one. Tests and analysis/reduce are checked as well.
"""
import re
import sys
from pathlib import Path

# Lowest first; folders of one row are siblings and never include each other.
LAYERS = [
    ["base"],
    ["model"],
    ["parallel"],
    ["fft"],
    ["config", "engines", "measures", "neural", "acoustics", "io"],
    ["reduce"],  # analysis/reduce: reads case files, writes tables
    ["sweep"],
    ["main.cpp"],
]

# Third-party headers and the only places that may include them.
ALLOWED = [
    (r"mpi\.h", ["parallel/", "fft/slab_transform", "io/h5"]),
    (r"fftw3.*\.h", ["fft/"]),
    (r"hdf5\.h|H5.*\.h", ["io/"]),
    (r"toml\+\+/.*", ["config/"]),
    (r"Eigen/.*", ["engines/", "neural/"]),
    (r"Random123/.*", ["neural/"]),
    (r"CLI/.*", ["sweep/", "main.cpp"]),
    (r"nlohmann/.*", ["io/", "reduce/", "sweep/"]),
    (r"spdlog/.*", ["base/", "sweep/", "main.cpp"]),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def level(folder):
    for number, row in enumerate(LAYERS):
        if folder in row:
            return number
    return None


def breaches(root, path):
    relative = path.relative_to(root).as_posix()
    folder = relative.split("/")[0]
    mine = level(folder)
    if mine is None:
        yield 1, f"{folder} has no layer"
        return
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        kind, header = match.groups()
        if kind == "<":
            for pattern, places in ALLOWED:
                if re.fullmatch(pattern, header) and not any(relative.startswith(p) for p in places):
                    yield number, f"<{header}> belongs to {', '.join(places)} only"
            continue
        other = header.split("/")[0]
        theirs = level(other)
        if header == "git_id.hpp":
            continue
        if theirs is None:
            yield number, f'"{header}" is in no layer; write includes from src/ on'
        elif theirs > mine or (theirs == mine and other != folder):
            yield number, f'{folder} must not include {other} ("{header}")'


def main():
    source = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent / "src").resolve()
    roots = [source, source.parent / "analysis"]
    found = 0
    for root in roots:
        for path in sorted(root.rglob("*.[ch]pp")):
            for number, message in breaches(root, path):
                print(f"{path}:{number}: {message}")
                found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
