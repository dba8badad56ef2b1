# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program and parses its output."""
import json
import re
import subprocess
from pathlib import Path

from .. import program

ENGINES = ("layered", "spectral")
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
        """[(name, time relative to the FFTs alone)], and the seconds of the FFTs of the first case of engine layered."""
        found, layered_s = [], None
        for engine in ENGINES:
            code, output = self("bench", engine, "--json")
            for m in json.loads(output)["measurements"] if code == 0 else ():
                if m["fft_s"] > 0.0:
                    found.append((f"{engine}, {m['name']}: time relative to its FFTs", m["time_s"] / m["fft_s"]))
                    layered_s = layered_s or m["fft_s"]
        return found, layered_s
