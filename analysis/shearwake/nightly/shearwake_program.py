# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program and parses its output."""
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from .. import program

BENCHES = {"layered": (), "spectral": ("--grid", "192x128x25", "--steps", "20")}
LOWER_BOUND = re.compile(r"^\s*lower bound: (?P<name>.+?)\s+(?P<s>[0-9.]+) s\s+.*? takes (?P<ratio>[0-9.]+) "
                         "times as long", re.M)
PART = re.compile(r"^(?P<name>[a-z ,]+): \d+ x \d+ points, \d+ frames$", re.M)  # of the benchmark of layered


@dataclass
class Outcome:
    code: int  # -1: ended after the time limit
    output: str  # standard output and standard error


class Program:
    def __init__(self, path: str | Path, log: str | Path, inherited: tuple[int, ...] = ()) -> None:
        """`inherited`: file descriptors that the processes inherit, so that a lock is held until the last
        of them has ended."""
        self.path, self.log, self.inherited = str(path), log, inherited

    def __call__(self, *arguments: str | Path, ranks: int = 1, limit_s: float = 3600) -> Outcome:
        """Runs the program to its end or to the time limit; the output is appended to the log."""
        command = [*(["mpirun", "-n", str(ranks)] if ranks > 1 else []), self.path, *map(str, arguments)]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8", errors="replace",
                              env={**program.environment(), **program.SHARED_CORES}, pass_fds=self.inherited) as process:
            try:
                output, _ = process.communicate(timeout=limit_s)
                outcome = Outcome(process.returncode, output)
            except BaseException as problem:  # when mpirun is terminated, it terminates its ranks
                process.terminate()
                try:
                    output, _ = process.communicate(timeout=20)
                except subprocess.TimeoutExpired:
                    process.kill()
                    output, _ = process.communicate()
                if not isinstance(problem, subprocess.TimeoutExpired):
                    raise
                outcome = Outcome(-1, f"{output}\nended after {limit_s:g} s")
        with open(self.log, "a", encoding="utf-8") as log:
            log.write(f"$ {' '.join(command)}\n{outcome.output}exit {outcome.code}\n\n")
        return outcome

    def git_id(self) -> str:
        match = re.search(r"^git\s+(\S+)", self("--version").output, re.M)
        return match.group(1) if match else "unknown"

    def speeds(self) -> tuple[list[tuple[str, float]], float | None]:
        """[(name, time over the lower bound)], and the seconds of the lower bound of engine layered."""
        found, layered_s = [], None
        for engine, options in BENCHES.items():
            output = self("bench", engine, *options).output
            parts = [(match.start(), match["name"]) for match in PART.finditer(output)]
            for match in LOWER_BOUND.finditer(output):
                part = next((name for start, name in reversed(parts) if start < match.start()), "periodic edges")
                of = engine if part == "periodic edges" else f"{engine}, {part}"
                found.append((f"{of}: time relative to {match['name']}", float(match["ratio"])))
                if of == "layered":
                    layered_s = float(match["s"])
        return found, layered_s
