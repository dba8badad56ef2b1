# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program and parses its output."""
import re
import subprocess
from pathlib import Path

from .. import program

BENCHES = {"layered": (), "spectral": ("--grid", "192x128x25", "--steps", "20")}
LOWER_BOUND = re.compile(r"^\s*lower bound: (?P<name>.+?)\s+(?P<s>[0-9.]+) s\s+.*? takes (?P<ratio>[0-9.]+) "
                         "times as long", re.M)
PART = re.compile(r"^(?P<name>[a-z ,]+): \d+ x \d+ points, \d+ frames$", re.M)  # of the benchmark of layered
TIMED_OUT = 124  # exit code of timeout


class Program:
    def __init__(self, log: str | Path, inherited: tuple[int, ...] = ()) -> None:
        """`inherited`: file descriptors that the processes inherit, so that a lock is held until the last
        of them has ended."""
        self.log, self.inherited = log, inherited

    def __call__(self, *arguments: str | Path, ranks: int = 1, limit_s: float = 3600) -> tuple[int, str]:
        """Exit code and output of a command, which is ended after the time limit. The output is appended to the log."""
        launch = ["timeout", "--foreground", "--kill-after=20", f"{limit_s:f}", *(["mpirun", "-n", str(ranks)] if ranks > 1 else [])]
        words = list(map(str, arguments))
        with program.start(words, launch=launch, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           encoding="utf-8", errors="replace", pass_fds=self.inherited) as process:
            output = process.communicate()[0]
        if process.returncode == TIMED_OUT:
            output += f"\nended after {limit_s:g} s"
        with open(self.log, "a", encoding="utf-8") as log:
            log.write(f"$ {' '.join([*launch, 'shearwake', *words])}\n{output}exit {process.returncode}\n\n")
        return process.returncode, output

    def git_id(self) -> str:
        match = re.search(r"^git\s+(\S+)", self("--version")[1], re.M)
        return match.group(1) if match else "unknown"

    def speeds(self) -> tuple[list[tuple[str, float]], float | None]:
        """[(name, time over the lower bound)], and the seconds of the lower bound of engine layered."""
        found, layered_s = [], None
        for engine, options in BENCHES.items():
            output = self("bench", engine, *options)[1]
            parts = [(match.start(), match["name"]) for match in PART.finditer(output)]
            for match in LOWER_BOUND.finditer(output):
                part = next((name for start, name in reversed(parts) if start < match.start()), "periodic edges")
                of = engine if part == "periodic edges" else f"{engine}, {part}"
                found.append((f"{of}: time relative to {match['name']}", float(match["ratio"])))
                if of == "layered":
                    layered_s = float(match["s"])
        return found, layered_s
