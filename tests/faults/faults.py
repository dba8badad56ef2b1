# SPDX-License-Identifier: BSD-3-Clause
"""Common parts of the tests of faults: sweeps of both engines, kills, and injected failures."""
import contextlib
import csv
import os
import random
import signal
import subprocess
import time

from program import (AM, PATIENCE_s, ProgramTest, alive, command, descendants, environment, faulty_environment, journal,
                     plan, read_by, without_reference)


def both_engines(frequencies):
    """A sweep over frequencies and engines; the cases of engine spectral iterate and write checkpoints."""
    axes = {AM: [300 + 35 * i for i in range(frequencies)], "solver.engine": ["layered", "spectral"]}
    return without_reference(read_by(2.0, settled_ms=0.0), {"solver.spectral.time_step_us": 2.5, "sweep": axes})


def table_bytes(out):
    """The printed cells of the table without its column of times; it contains no hosts."""
    path = out / "tables" / f"{plan(out)['name']}.csv"
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    at = rows[0].index("wall_s")
    return "\n".join("\x1f".join(row[:at] + row[at + 1:]) for row in rows)


class FaultTest(ProgramTest):
    """Runs that are ended in different ways and always rerun with the same command."""

    def run_words(self, ranks_per_case, out):
        return ("run", "job.toml", "--out", out, "--ranks-per-case", ranks_per_case, "--checkpoint-steps", 20)

    def undisturbed(self, ranks_per_case, ranks=2):
        out = self.folder / f"whole-{ranks_per_case}"
        self.shearwake(*self.run_words(ranks_per_case, out), ranks=ranks)
        self.shearwake("reduce", out)
        return table_bytes(out)

    def kill_once(self, chance, words, longest_s, ranks=2):
        """Starts and kills a run; returns the kind of the kill, or None if the run ended before."""
        how = chance.choice(["all", "one", "writing", "launcher"])
        env = environment()
        if how == "writing":
            env = faulty_environment(PATH="/out/", RANK=chance.randrange(ranks), KILL_AT=chance.randint(1, 250))
        process = subprocess.Popen(command(*words, ranks=ranks), cwd=self.folder, env=env,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        end = time.monotonic() + (PATIENCE_s if how == "writing" else chance.uniform(0.3, longest_s))
        while time.monotonic() < end and process.poll() is None:
            time.sleep(0.005)
        pids = [process.pid, *descendants(process.pid)]
        if process.poll() is None:
            # The processes of the program have higher ids than those of mpirun.
            programs = [pid for pid in pids[1:] if self.is_program(pid)]
            victims = {"one": programs and [chance.choice(programs)], "launcher": pids[:1]}
            for pid in victims.get(how) or pids:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        code = process.wait(PATIENCE_s)
        self.wait_for(lambda: not any(map(alive, pids)), "the ranks to end")
        return how if code != 0 else None

    @staticmethod
    def is_program(pid):
        with contextlib.suppress(OSError):
            return os.readlink(f"/proc/{pid}/exe").endswith("/shearwake")
        return False

    def assert_nothing_twice(self, out, kills, teams):
        """Asserts that no complete case was started again, and that each kill cost each team at most one case."""
        ended, begun = set(), {}
        for line in journal(out):
            if line["event"] == "finished":
                ended.add(line["id"])
            if line["event"] == "started":
                self.assertNotIn(line["id"], ended, "a case that had ended was begun again")
                begun[line["id"]] = begun.get(line["id"], 0) + 1
        self.assertLessEqual(sum(begun.values()) - len(begun), kills * teams)

    def assert_nothing_left(self, out):
        self.assertEqual(list(out.rglob("*.part")), [])
        self.assertEqual(list((out / "checkpoints").glob("*")), [])
        self.assertEqual(list((out / "failed").glob("*")), [])

    def survive(self, seed, ranks_per_case, kills, reference, longest_s):
        """Runs a sweep with the given number of kills and asserts that it is complete; returns the kinds of the
        kills."""
        chance = random.Random(seed)
        out = self.folder / "out" / f"killed-{seed}"
        words = self.run_words(ranks_per_case, out)
        done = []
        while len(done) < kills:
            how = self.kill_once(chance, words, longest_s)
            if how is None:
                break
            done.append(how)
        self.shearwake(*words, ranks=2)
        self.shearwake("reduce", out)
        self.assertEqual(table_bytes(out), reference)
        self.assert_nothing_left(out)
        self.assert_nothing_twice(out, len(done), 2 // ranks_per_case)
        return done
