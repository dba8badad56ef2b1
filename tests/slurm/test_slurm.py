# SPDX-License-Identifier: BSD-3-Clause
"""jobs/slurm/ and scripts/submit with Slurm on this host: an array, an allocation that is signalled before its
time limit and requeues itself, and an allocation that is cancelled."""
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import pytest

from program import (LONG, PATIENCE_s, PROGRAM, ROOT, case_files, environment, is_pending, journal,
                     plan, started)

HERE = Path(__file__).resolve().parent
MISSING = [name for name in ("sbatch", "srun", "slurmctld", "slurmd", "munged", "squeue", "scontrol")
           if shutil.which(name) is None and not Path(f"/usr/sbin/{name}").exists()]


def free_ports(count):
    """The first port of a sequence of free ports."""
    for port in range(21000 + os.getpid() % 5000, 60000, 16):
        sockets = [socket.socket() for _ in range(count)]
        try:
            for i, one in enumerate(sockets):
                one.bind(("127.0.0.1", port + i))
            return port
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
    raise OSError("no free ports")


def table_bytes(out):
    text = (out / "tables" / f"{plan(out)['name']}.csv").read_text(encoding="utf-8").splitlines()
    at = text[0].split(",").index("wall_s")
    return [row.split(",")[:at] + row.split(",")[at + 1:] for row in text]


@unittest.skipIf(MISSING, f"Slurm is not installed ({', '.join(MISSING)}): apt-get install slurm-wlm munge")
@unittest.skipIf(os.geteuid() != 0, "only root can start a Slurm of its own")
class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-slurm-", ignore_cleanup_errors=True)
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.folder.chmod(0o755)  # munge requires that others can reach its socket
        base = cls.folder / "slurm"
        cls.env = {**environment(), "SLURM_CONF": str(base / "etc" / "slurm.conf"), "SHEARWAKE": str(PROGRAM),
                   "PATH": os.environ["PATH"] + ":/usr/sbin:/usr/bin"}
        cls.addClassCleanup(subprocess.run, [HERE / "sandbox.sh", "stop", base], env=cls.env, check=False)
        began = subprocess.run([HERE / "sandbox.sh", "start", base, str(free_ports(3)), "2", "4"], env=cls.env,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if began.returncode != 0:
            raise unittest.SkipTest(f"Slurm does not start here: {began.stdout.decode()[-300:]}")
        cls.job = cls.folder / "job.toml"
        cls.job.write_text(LONG.replace("1000, 12]", "1000, 24]"), encoding="utf-8")
        whole = cls.folder / "whole"
        # As on a laptop.
        cls.command(["mpirun", "-n", "2", str(PROGRAM), "run", "job.toml",
                     "--out", whole, "--ranks-per-case", "1"])
        cls.command([str(PROGRAM), "reduce", whole])
        cls.reference = table_bytes(whole)

    @classmethod
    def command(cls, words, expect=0):
        done = subprocess.run(list(map(str, words)), cwd=cls.folder, env=cls.env, capture_output=True,
                              encoding="utf-8", check=False, timeout=PATIENCE_s)
        assert done.returncode == expect, f"{words}:\n{done.stdout}{done.stderr}"
        return done.stdout

    def submit(self, out, *words):
        """The ids of the job that computes and of the job that reduces."""
        said = self.command([ROOT / "scripts" / "submit", "job.toml", "--out", out, "--no-report",
                             "--run=--ranks-per-case 1", *words])
        computes, reduces = re.search(r"submitted: job (\d+) computes, job (\d+) reduces", said).groups()
        return computes, reduces

    def wait_for(self, condition, what):
        end = time.monotonic() + PATIENCE_s
        while not condition():
            self.assertLess(time.monotonic(), end, f"waited in vain for {what}\n{self.messages()}")
            time.sleep(0.1)

    def messages(self):
        """The queue and all logs, for the message of a failure."""
        logs = "\n".join(f"{path}:\n{path.read_text(encoding='utf-8', errors='replace')[-1500:]}"
                         for path in self.folder.rglob("slurm/*.log"))
        return self.command(["squeue"]) + logs

    def state(self, job):
        done = subprocess.run(["scontrol", "show", "job", job], env=self.env, capture_output=True, text=True,
                              check=False)
        return re.findall(r"JobState=(\w+)", done.stdout)

    def assert_same(self, out, cases=24):
        self.assertEqual(table_bytes(out), self.reference)
        self.assertEqual(list(out.rglob("*.part")), [])
        self.assertEqual(len(started(out)), cases, "a case was computed twice")

    def stopped_ranks(self, out):
        """Stops the ranks of a run on two ranks after its first case, so that a signal arrives during the run."""
        self.wait_for(lambda: case_files(out), "the first case")
        ranks = self.ranks_of(out)
        self.assertEqual(len(ranks), 2)
        for pid in ranks:
            os.kill(pid, signal.SIGSTOP)
        self.assertLess(len(case_files(out)), 24, "it was too fast to be stopped")
        return ranks

    def ranks_of(self, out):
        found = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
                except OSError:
                    continue
                if Path(words[0]).parent == (out / "slurm").resolve() and str(out) in words:
                    found.append(int(entry.name))
        return found

    @pytest.mark.long
    def test_array_time_limit_and_cancellation(self):
        """A single test, since Slurm takes seconds to start."""
        limited, array, cancelled = (self.folder / name for name in ("limited", "array", "cancelled"))
        # Slurm checks every half minute whether to send the signal, and sends it up to half a minute early: at least 59 s
        # are left.
        warned, its_table = self.submit(limited, "--ranks", 2, "--time", "2", "--warning", 59)
        ranks = self.stopped_ranks(limited)
        self.wait_for(lambda: all(is_pending(pid, signal.SIGUSR1) for pid in ranks), "the warning")
        for pid in ranks:
            os.kill(pid, signal.SIGCONT)

        tasks, table = self.submit(array, "--array", 3, "--time", "10")
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the array and its table")
        self.assertEqual(set(self.state(tasks)), {"COMPLETED"})
        self.assert_same(array)
        self.assertEqual(len(list(array.glob("journal*"))), 3)

        job, _ = self.submit(cancelled, "--ranks", 2, "--time", "10")
        self.stopped_ranks(cancelled)
        self.command(["scancel", job])  # which lets them continue
        self.wait_for(lambda: self.state(job) == ["CANCELLED"] and not self.ranks_of(cancelled), "its end")
        self.assertLess(len(case_files(cancelled)), 24)
        _, table = self.submit(cancelled, "--ranks", 2, "--time", "10")
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the table after a cancelled job")
        self.assertEqual(table_bytes(cancelled), self.reference)
        self.assertLessEqual(len(started(cancelled)), 24 + 2)

        self.wait_for(lambda: self.state(its_table) == ["COMPLETED"], "the table of the limited job")
        log = (limited / "slurm" / f"small-{warned}.log").read_text(encoding="utf-8")
        for words in ("SIGUSR1 to the ranks", "exit code 75"):
            self.assertIn(words, log)
        self.assertIn("stopped", [line.get("how") for line in journal(limited)])
        self.assert_same(limited)
