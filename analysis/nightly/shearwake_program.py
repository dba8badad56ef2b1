"""Starts the program and reads what it says."""
import os
import re
import subprocess
from dataclasses import dataclass

BENCHES = {"layered": (), "spectral": ("--grid", "192x128x25", "--steps", "20")}
FLOOR = re.compile(r"^\s*floor: (?P<floor>.+?)\s+(?P<s>[0-9.]+) s\s+.*? takes (?P<ratio>[0-9.]+) times that", re.M)


@dataclass
class Outcome:
    code: int  # -1: it took too long
    said: str


def environment():
    found = dict(os.environ)
    if os.geteuid() == 0:  # a container
        found.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return found


class Program:
    def __init__(self, path, log, held=()):
        """`held`: open files that its processes hold too: a lock outlives us while one of them runs."""
        self.path, self.log, self.held = str(path), log, held

    def __call__(self, *arguments, ranks=1, limit_s=3600):
        """Runs to the end, or to the limit; its words go to the log as well."""
        # Unbound: others may use the cores that mpirun would choose.
        launch = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)] if ranks > 1 else []
        command = [*launch, self.path, *map(str, arguments)]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8", errors="replace",
                              env=environment(), pass_fds=self.held) as process:
            try:
                said, _ = process.communicate(timeout=limit_s)
                outcome = Outcome(process.returncode, said)
            except BaseException as problem:  # mpirun takes its ranks with it
                process.terminate()
                try:
                    said, _ = process.communicate(timeout=20)
                except subprocess.TimeoutExpired:
                    process.kill()
                    said, _ = process.communicate()
                if not isinstance(problem, subprocess.TimeoutExpired):
                    raise
                outcome = Outcome(-1, f"{said}\nended after {limit_s:g} s")
        with open(self.log, "a", encoding="utf-8") as log:
            log.write(f"$ {' '.join(command)}\n{outcome.said}exit {outcome.code}\n\n")
        return outcome

    def git_id(self):
        match = re.search(r"^git\s+(\S+)", self("--version").said, re.M)
        return match.group(1) if match else "unknown"

    def speeds(self):
        """[(name, ratio to the floor)], and the seconds of the floor of engine layered."""
        found, floor_s = [], None
        for engine, options in BENCHES.items():
            for match in FLOOR.finditer(self("bench", engine, *options).said):
                found.append((f"{engine}: its time over that of {match['floor']}", float(match["ratio"])))
                if engine == "layered":
                    floor_s = float(match["s"])
        return found, floor_s
