# SPDX-License-Identifier: BSD-3-Clause
"""scripts/submit with Slurm on this host: arrays, time limits, killed ranks, changed files, and reports of incomplete sweeps."""
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
from unittest import mock

import pytest

from program import (AM, JOB, PATIENCE_s, PROGRAM, ROOT, case_files, environment, is_pending, journal, large_job, long_job, peaks,
                     plan, small_job, started, without_reference)

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
        cls.job.write_text(long_job(24), encoding="utf-8")
        whole = cls.folder / "whole"
        # As on a laptop.
        cls.command(["mpirun", "-n", "2", str(PROGRAM), "run", "job.toml", "--out", whole, "--ranks-per-case", "1"])
        cls.command([str(PROGRAM), "reduce", whole])
        cls.reference = table_bytes(whole)

    @classmethod
    def command(cls, words, expect=0, errors=False):
        done = subprocess.run(list(map(str, words)), cwd=cls.folder, env=cls.env, capture_output=True,
                              encoding="utf-8", check=False, timeout=PATIENCE_s)
        assert done.returncode == expect, f"{words}:\n{done.stdout}{done.stderr}"
        return done.stdout + (done.stderr if errors else "")

    def submit(self, out, *words, job="job.toml", report="--no-report"):
        """The ids of the job that computes and of the job that reduces."""
        output = self.command([ROOT / "scripts" / "submit", job, "--out", out, *([report] if report else []),
                             "--run=--ranks-per-case 1", *words])
        computes, reduces = re.search(r"submitted: job (\d+) computes, job (\d+) reduces", output).groups()
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
        done = subprocess.run(["scontrol", "show", "job", job], env=self.env, capture_output=True, text=True, check=False)
        return re.findall(r"JobState=(\w+)", done.stdout)

    def shown(self, job, what):
        """What scontrol shows of a job."""
        return re.search(rf"\b{what}=(\S+)", self.command(["scontrol", "show", "job", job]))[1]

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return name

    def log(self, out, job):
        path, = (out / "slurm").glob(f"*-{job}.log")
        return path.read_text(encoding="utf-8")

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

    @pytest.mark.long
    def test_a_dependency_and_an_array_of_the_user_leave_one_report_after_all_tasks(self):
        out = self.folder / "dependent"
        blocker = self.command(["sbatch", "--parsable", "--hold", "--wrap", "true"]).strip()
        tasks, table = self.submit(out, "--throttle", 1, "--", "-d", f"afterok:{blocker}", "--array=1-3")
        self.assertEqual(self.shown(table, "Dependency"), f"afterany:{tasks}_*(unfulfilled),afterok:{blocker}(unfulfilled)")
        self.assertEqual(self.shown(tasks, "ArrayTaskThrottle"), "1")
        self.assertEqual(len(self.state(table)), 1)
        output = self.command([ROOT / "scripts" / "submit", "job.toml", "--out", out, "--array", 3], expect=2, errors=True)
        self.assertIn(f"job {tasks} computes", output)
        self.command(["scontrol", "release", blocker])
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the table")
        self.assert_same(out)

    @pytest.mark.long
    def test_the_submitted_job_runs_although_its_files_are_changed_or_removed(self):
        out, job = self.folder / "unchanged", self.write("edited.toml", long_job(24))
        computes, table = self.submit(out, "--", "--hold", job=job)
        self.write(job, JOB)
        self.command(["scontrol", "release", computes])
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the table")
        self.assert_same(out)

    @pytest.mark.long
    def test_starts_without_progress_end_after_two(self):
        job = self.write("endless.toml", large_job(1.0))
        out = self.folder / "endless"
        with mock.patch.dict(self.env, {"SHEARWAKE_CACHE": str(self.folder / "new")}):  # no recorded rate
            computes, table = self.submit(out, job=job)
        for start in (1, 2):
            self.wait_for(lambda count=start: len(started(out)) == count, f"start {start}")
            self.command(["scancel", "--signal=USR1", "--batch", computes])
        self.wait_for(lambda: self.state(computes) == ["FAILED"], "the end of the job")
        self.assertEqual(self.shown(computes, "ExitCode"), "3:0")
        self.assertIn("the last two starts completed no case", self.log(out, computes))
        self.wait_for(lambda: self.state(table) == ["FAILED"], "the end of the report")

    @pytest.mark.long
    def test_a_failed_case_stands_first_on_the_page_and_fails_the_report(self):
        job = self.write("failing.toml", small_job(peaks(100, 200, 1e200)))
        out = self.folder / "failing"
        _, table = self.submit(out, job=job, report="")
        self.wait_for(lambda: self.state(table) == ["FAILED"], "the report")
        self.assertEqual(self.shown(table, "ExitCode"), "4:0")
        page = (out / "report" / "index.html").read_text(encoding="utf-8")
        self.assertRegex(re.sub("<[^>]*>", "", page.partition("<header>")[2]).strip(), r"^1 of 3 cases failed: \S+")

    @pytest.mark.long
    def test_a_killed_rank_is_retried_once(self):
        out = self.folder / "killed"
        computes, table = self.submit(out, "--ranks", 2, "--time", "10")
        self.wait_for(lambda: case_files(out), "the first case")
        for restarts in (0, 1):
            self.wait_for(lambda: self.ranks_of(out), "the ranks")
            self.assertEqual(self.shown(computes, "Restarts"), str(restarts))
            for pid in self.ranks_of(out):
                os.kill(pid, signal.SIGKILL)
            self.wait_for(lambda: not self.ranks_of(out), "the end of the ranks")
        self.wait_for(lambda: self.state(computes) == ["FAILED"], "the end of the job")
        self.assertIn("retry 1 of 1", self.log(out, computes))
        self.wait_for(lambda: self.state(table) == ["FAILED"], "the end of the report")
        self.assertEqual(self.shown(table, "ExitCode"), "4:0")

    @pytest.mark.long
    def test_each_task_of_an_array_requeues_itself_alone(self):
        out = self.folder / "warned"
        tasks, table = self.submit(out, "--array", 2, "--time", "10")
        self.wait_for(lambda: len(self.ranks_of(out)) == 2, "both tasks")
        ranks = self.stopped_ranks(out)
        self.command(["scancel", "--signal=USR1", "--batch", tasks])
        self.wait_for(lambda: all(is_pending(pid, signal.SIGUSR1) for pid in ranks), "the signal")
        for pid in ranks:
            os.kill(pid, signal.SIGCONT)
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the table")
        self.assertEqual(re.findall(r"Restarts=(\d+)", self.command(["scontrol", "show", "job", tasks])), ["1", "1"])
        self.assert_same(out)

    @pytest.mark.long
    def test_each_task_of_an_adaptive_array_computes_all_rounds_in_one_start(self):
        axis = {"find": "maximum", "in": [300, 1000], "column": "eta_at_1", "tolerance": 50.0}
        job = self.write("adaptive.toml", without_reference({"sweep": {AM: axis}}))
        out = self.folder / "adaptive"
        tasks, table = self.submit(out, "--array", 2, job=job)
        self.wait_for(lambda: self.state(table) == ["COMPLETED"], "the table")
        self.assertEqual(set(re.findall(r"Restarts=(\d+)", self.command(["scontrol", "show", "job", tasks]))), {"0"})
        self.assertTrue((out / "tables" / "small-adaptive.json").exists() or list((out / "tables").glob("*adaptive*")))
