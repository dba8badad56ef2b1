# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program and parses its output."""
import json
import re
import subprocess
from pathlib import Path

from .. import program

ENGINES = ("layered", "spectral")
TIMED_OUT = 124  # exit code of timeout
# What mpirun adds to the output of the program: blocks between lines of dashes or equals signs, and counts of suppressed blocks.
OF_MPIRUN = re.compile(r"^([-=]{60,})\n.*?^\1\n?|^\[\S+:\d+\] [^\n]*help[^\n]*\n?", re.M | re.S)


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
        return process.returncode, OF_MPIRUN.sub("", output)

    def git_id(self) -> str:
        match = re.search(r"^git\s+(\S+)", self("--version")[1], re.M)
        return match.group(1) if match else "unknown"

    def speeds(self) -> tuple[dict[str, float], str]:
        """The times of the engines relative to those of their FFTs, by name, and the output of a measurement that failed."""
        found: dict[str, float] = {}
        for engine in ENGINES:
            code, output = self("bench", engine, "--json")
            if code != 0:
                return found, output
            found |= {f"{engine}, {m['name']}: time relative to its FFTs": m["time_s"] / m["fft_s"]
                      for m in json.loads(output)["measurements"] if m["fft_s"] > 0.0}
        return found, ""
