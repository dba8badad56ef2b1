# SPDX-License-Identifier: BSD-3-Clause
"""Kills in every phase of a run: the following runs give the same table and bitwise the same datasets."""
import contextlib
import os
import random
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import pytest

from attacks import times
from faults import both_engines, failing_library, table_bytes
from program import PATIENCE_s, ProgramTest, case_files, command, environment, journal

# Phases that are identified by a write, flush or rename of a file: part of its path, the call (None: any), and the
# largest number of the call at which to kill.
MARKED = {
    "plan": ("/plan.json", None, 3),
    "checkpoint": ("/checkpoints/", None, 60),
    "write": ("/cases/", None, 60),
    "rename": (".h5", "rename", 8),
    "index": ("/index", "write", 2),
}
WATCHED = ["start", "claim", "compute", "end"]


def numbers(out):
    """All datasets of all case files as bytes, except computing times."""
    found = {}
    for path in case_files(out):
        with h5py.File(path) as file:
            file.visititems(lambda name, item: found.__setitem__((path.name, name), item[()].tobytes())  # noqa: B023
                            if isinstance(item, h5py.Dataset) else None)
    return found


class EveryPhase(ProgramTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-kill-")
        cls.addClassCleanup(folder.cleanup)
        cls.library = failing_library(Path(folder.name))

    def words(self, out):
        return ("run", "job.toml", "--out", out, "--checkpoint-steps", 40)

    def begin(self, out, **faults):
        env = {**environment(), **({"LD_PRELOAD": str(self.library)} if faults else {}),
               **{f"FAULT_{name}": str(value) for name, value in faults.items()}}
        return subprocess.Popen(command(*self.words(out)), cwd=self.folder, env=env, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def killed_by_call(self, out, phase, chance):
        path, call, most = MARKED[phase]
        faults = {"PATH": path, "KILL_AT": chance.randint(1, most), **({"CALL": call} if call else {})}
        return self.begin(out, **faults).wait(PATIENCE_s) == -signal.SIGKILL

    def killed_when_seen(self, out, phase, chance, wait_s):
        """Kills the run shortly after the phase has begun."""
        begun = len([e for e in journal(out) if e["event"] == "started"])
        process = self.begin(out)
        seen = {"start": lambda: True,
                "claim": lambda: (out / "locks" / "cases").exists(),
                "compute": lambda: len([e for e in journal(out) if e["event"] == "started"]) > begun,
                "end": lambda: len(case_files(out)) == self.cases}[phase]
        while process.poll() is None and not seen():
            time.sleep(0.0005)
        time.sleep(chance.uniform(0.0, wait_s[phase]))
        with contextlib.suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGKILL)
        return process.wait(PATIENCE_s) == -signal.SIGKILL

    @pytest.mark.long
    def test_kills_in_every_phase_leave_every_number_as_it_is(self):
        self.write_job(both_engines(2))
        whole = self.folder / "whole"
        self.shearwake(*self.words(whole))
        self.shearwake("reduce", whole)
        reference, self.cases = numbers(whole), len(case_files(whole))
        chance = random.Random(4)
        wait_s = {"start": 0.3, "claim": 0.01, "compute": 0.1, "end": 0.01}
        for phase in [*MARKED, *WATCHED]:
            killed, tries = 0, 0
            while killed < times(1, 20):
                tries += 1
                self.assertLess(tries, times(12, 100), f"no run could be killed in the phase {phase}")
                out = self.folder / "out" / f"{phase}-{tries}"
                done = (self.killed_by_call(out, phase, chance) if phase in MARKED
                        else self.killed_when_seen(out, phase, chance, wait_s))
                if not done:
                    continue  # it had ended before
                killed += 1
                self.shearwake(*self.words(out))
                self.shearwake("verify", out)
                self.shearwake("reduce", out)
                self.assertEqual(table_bytes(out), table_bytes(whole), phase)
                now = numbers(out)
                self.assertEqual(sorted(now), sorted(reference))
                changed = [name for name, values in now.items() if values != reference[name]]
                self.assertEqual(changed, [], phase)
                self.assertEqual(list(out.rglob("*.part")), [])


class PartialFiles(ProgramTest):
    """The unfinished case file that belongs to a checkpoint."""

    JOB = both_engines(1).replace('["layered", "spectral"]', '["spectral"]')

    def interrupted(self):
        """The folder of a run that was killed after some checkpoints, with the unfinished file."""
        process = self.start("run", "job.toml", "--checkpoint-steps", 20)
        self.wait_for(lambda: len([e for e in journal(self.out) if e["event"] == "checkpointed"]) >= 6,
                      "checkpoints")
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        part, = (self.out / "cases").glob("*.part")
        return part

    @pytest.mark.long
    def test_a_damaged_partial_file_is_started_from_scratch(self):
        self.write_job(self.JOB)
        whole = self.folder / "whole"
        self.shearwake("run", "job.toml", "--out", whole)
        reference = numbers(whole)
        chance = random.Random(30)
        part = self.interrupted()
        sound = part.read_bytes()
        saved = {path: path.read_bytes() for path in (self.out / "checkpoints").iterdir()}
        steps = [e["step"] for e in journal(self.out) if e["event"] == "checkpointed"]
        with h5py.File(part) as file:
            field = file["surface/u_z"]
            begin, planes = field.id.get_offset(), field.shape[0]
            plane_B = field.size * 8 // planes
        for n in range(times(6, 60)):
            damaged = bytearray(sound)
            if n % 3 == 0:  # HDF5's own metadata
                at = [chance.randrange(begin) for _ in range(30)]
            elif n % 3 == 1:  # frames that are there
                at = [chance.randrange(begin, begin + 4 * plane_B) for _ in range(30)]
            else:
                at = []
                del damaged[chance.randrange(begin + plane_B):]
            for place in at:
                damaged[place] ^= 1 << chance.randrange(8)
            part.write_bytes(damaged)
            for path, content in saved.items():
                path.write_bytes(content)
            for path in case_files(self.out):
                path.unlink()
            said = self.shearwake("run", "job.toml").said
            self.says(said, ".part", "1 computed now")
            self.assertEqual(numbers(self.out), reference)
        # The sound one is resumed.
        part.write_bytes(sound)
        for path, content in saved.items():
            path.write_bytes(content)
        for path in case_files(self.out):
            path.unlink()
        before = len([e for e in journal(self.out) if e["event"] == "resumed"])
        self.shearwake("run", "job.toml")
        resumed = [e for e in journal(self.out) if e["event"] == "resumed"][before:]
        self.assertEqual(len(resumed), 1)
        self.assertIn(resumed[0]["step"], steps)
        self.assertEqual(numbers(self.out), reference)


if __name__ == "__main__":
    unittest.main()
