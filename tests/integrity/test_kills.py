# SPDX-License-Identifier: BSD-3-Clause
"""Kills in every phase of a run: the following runs give the same table and bitwise the same datasets."""
import random
import signal
import subprocess

import h5py
import pytest

from limits import times
from faults import both_engines, table_bytes
from program import AM, PATIENCE_s, ProgramTest, case_files, changed_job, command, faulty_environment, journal

# Phases, identified by a write, flush or rename of a file: part of its path, the call (None: any), and the largest number
# of the call at which to kill. Lines of the journal accompany the whole run, from its start to its end.
PHASES = {
    "plan": ("/plan.json", None, 3),
    "journal": ("/journal", "write", 30),
    "checkpoint": ("/checkpoints/", None, 60),
    "write": ("/cases/", None, 60),
    "rename": (".h5", "rename", 8),
    "index": ("/index", "write", 2),
}


def numbers(out):
    """All datasets of all case files as bytes, except computing times."""
    found = {}
    for path in case_files(out):
        with h5py.File(path) as file:
            file.visititems(lambda name, item: found.__setitem__((path.name, name), item[()].tobytes())  # noqa: B023
                            if isinstance(item, h5py.Dataset) else None)
    return found


class EveryPhase(ProgramTest):
    def words(self, out):
        return ("run", "job.toml", "--out", out, "--checkpoint-steps", 40)

    def is_killed(self, out, phase, chance):
        """Runs the job; whether it has reached the call at which it is killed."""
        path, call, most = PHASES[phase]
        env = faulty_environment(PATH=path, KILL_AT=chance.randint(1, most), **({"CALL": call} if call else {}))
        process = subprocess.run(command(*self.words(out)), cwd=self.folder, env=env, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=PATIENCE_s, check=False)
        return process.returncode == -signal.SIGKILL

    @pytest.mark.long
    def test_kills_in_every_phase_leave_every_number_as_it_is(self):
        self.write_job(both_engines(2))
        whole = self.folder / "whole"
        self.shearwake(*self.words(whole))
        self.shearwake("reduce", whole)
        reference, chance = numbers(whole), random.Random(4)
        for phase in PHASES:
            killed, tries = 0, 0
            while killed < times(1, 20):
                tries += 1
                self.assertLess(tries, times(12, 100), f"no run could be killed in the phase {phase}")
                out = self.folder / "out" / f"{phase}-{tries}"
                if not self.is_killed(out, phase, chance):
                    continue  # it has ended before
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

    JOB = changed_job(both_engines(1), {"sweep": {AM: [300], "solver.engine": ["spectral"]}})

    def interrupted(self):
        """The folder of a run that was killed after some checkpoints, with the unfinished file."""
        self.kill(self.start_and_stop("run", "job.toml", "--checkpoint-steps", 20,
                                      faults={"PATH": "/checkpoints/*.h5", "CALL": "rename", "STOP_AT": 7}))
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

        def restore(content):
            """The state at the kill, with this content of the unfinished file."""
            for path, kept in {**saved, part: content}.items():
                path.write_bytes(kept)
            for path in case_files(self.out):
                path.unlink()

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
            restore(damaged)
            self.contains(self.shearwake("run", "job.toml").output, ".part", "1 computed now")
            self.assertEqual(numbers(self.out), reference)
        # The sound one is resumed.
        restore(sound)
        before = len([e for e in journal(self.out) if e["event"] == "resumed"])
        self.shearwake("run", "job.toml")
        resumed = [e for e in journal(self.out) if e["event"] == "resumed"][before:]
        self.assertEqual(len(resumed), 1)
        self.assertIn(resumed[0]["step"], steps)
        self.assertEqual(numbers(self.out), reference)
