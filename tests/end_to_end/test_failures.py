# SPDX-License-Identifier: BSD-3-Clause
"""Failing cases, damaged files, and disks that are full or not writable."""
import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from unittest import mock

import h5py
import pytest

from program import (NO_FRAMES, PATIENCE_s, PROGRAM, ProgramTest, case_files, changed_job, environment, peaks, plan, plan_ids,
                     small_job, started, swept, table, without_reference)
from table_comparison import assert_same_table

OVERFLOWING = small_job(peaks(100.0, 1e200))
ABSURD = small_job(swept(1.5, 0.005, key="domain.spacing_mm"), {"table": {"x": "domain.spacing_mm"}, "domain.extent_mm": [60.0, 60.0]}, NO_FRAMES)
NOBODY = 65534


@pytest.mark.extended
class JoinedWorlds(ProgramTest):
    """Runs that a program with MPI has started become ranks of one world."""

    def joined(self, *words):
        done = self.call("mpirun", *words, expect=None)
        return done.returncode, done.output

    def test_ranks_with_other_arguments_or_folders_end_at_once(self):
        self.write_job()
        other = self.folder / "other"
        other.mkdir()
        (other / "job.toml").write_text((self.folder / "job.toml").read_text())
        # By the shell: mpirun of Open MPI 5 in Debian 13 crashes if programs are separated by a colon (open-mpi/ompi issue 13303).
        other_rank, run = '[ "$OMPI_COMM_WORLD_RANK" = 1 ]', f"exec {PROGRAM} run job.toml"
        code, output = self.joined("-n", "2", "sh", "-c", f"if {other_rank}; then {run} --out b; else {run} --out a; fi")
        self.assertEqual(code, 2, output)
        self.contains(output, "have different arguments", "env -u OMPI_COMM_WORLD_SIZE")
        code, output = self.joined("-n", "2", "sh", "-c", f"if {other_rank}; then cd other; fi; {run}")
        self.assertEqual(code, 2, output)
        self.contains(output, "have different working folders")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["job.toml", "other"])

    def test_remedy_of_the_message_starts_separate_runs(self):
        for name in ("job", "other"):
            self.write_job(small_job({"job.name": name}), f"{name}.toml")
        split = "if [ $OMPI_COMM_WORLD_RANK = 0 ]; then j=job; else j=other; fi; exec {} check $j.toml"
        code, output = self.joined("-n", "2", "sh", "-c", split.format(PROGRAM))
        self.assertEqual(code, 2, output)
        remedy = output[output.index("env -u"):output.index(" shearwake ...")]
        code, output = self.joined("-n", "2", "sh", "-c", split.format(f"{remedy} {PROGRAM}"))
        self.assertEqual(code, 0, output)
        self.contains(output, "job.toml: ", "other.toml: ")

    def test_run_that_a_rank_with_mpi_starts_ends_at_once(self):
        self.write_job()
        driver = ("import ctypes, subprocess, sys\n"
                  "mpi = ctypes.CDLL('libmpi.so.40', ctypes.RTLD_GLOBAL)\n"
                  "mpi.MPI_Init(None, None)\n"
                  "done = subprocess.run(sys.argv[1:], capture_output=True, text=True)\n"
                  "print(done.returncode, done.stderr)\n"
                  "mpi.MPI_Finalize()\n")
        try:
            ctypes.CDLL("libmpi.so.40")
        except OSError:
            self.skipTest("the library of Open MPI 4 has another name")
        code, output = self.joined("-n", "2", sys.executable, "-c", driver, str(PROGRAM), "check", "job.toml")
        self.assertEqual(code, 0, output)
        self.assertEqual(output.count("2 a rank of another MPI program has started this run"), 2, output)

    def test_tasks_of_slurm_without_mpi_are_warned_of(self):
        self.write_job(without_reference())
        with mock.patch.dict(os.environ, {"SLURM_NTASKS": "8"}):
            self.contains(self.shearwake("run", "job.toml").output, "warning: Slurm has 8 tasks, but this run has one rank")
            self.assertNotIn("Slurm", self.shearwake("check", "job.toml").output)

    @pytest.mark.long
    def test_a_blocked_rank_ends_after_a_stop_signal(self):
        self.write_job(changed_job(ABSURD, swept(1.5, 0.25, key="domain.spacing_mm")))
        with subprocess.Popen(["mpirun", "-n", "2", str(PROGRAM), "run", "job.toml", "--ranks-per-case", "2"], cwd=self.folder,
                              env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, encoding="utf-8") as run:
            self.wait_for(lambda: started(self.out), "the first case")
            ranks = [int(pid) for pid in subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True,
                                                        check=True).stdout.split()]
            os.kill(ranks[1], signal.SIGSTOP)
            os.kill(ranks[0], signal.SIGTERM)
            try:
                # 15 s, and the longest time between two collective calls before.
                output = run.communicate(timeout=PATIENCE_s)[1]
            finally:
                for rank in ranks:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(rank, signal.SIGKILL)
        self.contains(output, "a rank has been blocked since the stop signal")


class FailingCase(ProgramTest):
    def test_a_failing_case_does_not_affect_other_cases(self):
        self.write_job(OVERFLOWING)
        for ranks in (1, 2):
            out = self.folder / f"on {ranks}"
            output = self.shearwake("run", "job.toml", "--out", out, ranks=ranks, expect=4).output
            good, bad = plan_ids(out)
            self.contains(output, f"case {bad} failed", "not finite", "1 computed now", "1 failed")
            self.assertEqual([path.stem for path in case_files(out)], [good])
            output = self.shearwake("status", out).output
            self.contains(output, "1 done", "1 failed", f"failed {bad}", "not finite", "--retry-failed")
            self.shearwake("reduce", out)
            self.shearwake("reduce", out, "--complete", expect=4)
            rows = {row["id"]: row for row in table(out)}
            self.assertEqual(rows[good]["status"], "complete")
            self.assertEqual(rows[bad]["status"], "failed")
            self.assertIn("not finite", rows[bad]["note"])
            self.assertEqual(rows[bad]["eta_at_1"], "")

            output = self.shearwake("run", "job.toml", "--out", out, ranks=ranks, expect=4).output
            self.contains(output, "0 computed now", "only retried with --retry-failed")
            self.assertEqual(started(out).count(bad), 1)
            self.shearwake("run", "job.toml", "--out", out, "--retry-failed", ranks=ranks, expect=4)
            self.assertEqual((started(out).count(bad), started(out).count(good)), (2, 1))
            self.assertEqual(list(out.rglob("*.part")), [])

    @pytest.mark.extended
    def test_fail_fast_stops_at_the_first_failure(self):
        self.write_job(small_job(peaks(1e200, 1e201, 100.0)))
        output = self.shearwake("run", "job.toml", "--fail-fast", expect=4).output
        self.assertEqual(len(started(self.out)), 1, output)
        self.contains(output, "2 cases were not started: shearwake run job.toml computes them")
        bad, = (self.out / "failed").iterdir()
        self.contains(bad.read_text(encoding="utf-8"), f"to retry: shearwake run job.toml --only {bad.stem} --retry-failed\n")

    def test_a_case_larger_than_the_memory_is_rejected_before_it_allocates(self):
        self.write_job(ABSURD)
        limit = ["prlimit", "--as=3000000000"]  # simulates a small machine
        output = self.shearwake("run", "job.toml", prefix=limit, expect=6).output
        self.assertRegex(output, r"the largest case needs \d+ MB per rank, and a rank may use \d+ MB.*--force")
        self.assertFalse(self.out.exists(), "a refused job leaves nothing")
        output = self.shearwake("run", "job.toml", "--force", prefix=limit, expect=4).output
        good, bad = plan_ids(self.out)
        self.contains(output, f"case {bad} failed", "out of memory", "GB", "domain.spacing_mm")
        self.assertEqual([path.stem for path in case_files(self.out)], [good])
        self.contains(self.shearwake("status", self.out).output, "out of memory")


class Damage(ProgramTest):
    def setUp(self):
        super().setUp()
        self.compute()
        self.before = table(self.out)

    def test_a_file_of_another_case_is_not_accepted(self):
        first, second = case_files(self.out)[:2]
        second.write_bytes(first.read_bytes())
        self.shearwake("reduce", self.out, expect=4)
        rows = {row["id"]: row for row in table(self.out)}
        self.assertEqual(rows[second.stem]["status"], "damaged")
        self.contains(self.shearwake("run", "job.toml").output, "1 computed now")

    @pytest.mark.extended
    def test_a_file_that_is_not_hdf5_is_reported(self):
        for content in (b"", b"\x89HDF\r\n\x1a\n", b"words " * 1000):
            case_files(self.out)[0].write_bytes(content)
            self.contains(self.shearwake("status", self.out).output, "3 done")
            self.shearwake("show", case_files(self.out)[0], expect=6)
            self.shearwake("reduce", self.out, expect=4)
        with h5py.File(case_files(self.out)[0], "w") as file:
            file["something"] = 1.0
        self.contains(self.shearwake("show", case_files(self.out)[0], expect=6).output, "shearwake case")
        self.shearwake("show", self.folder / "nothing.h5", expect=6)
        self.contains(self.shearwake("show", self.folder / "nothing.toml", expect=6).output, "nothing.toml is not a complete case file")
        for folder in (self.out, self.out / "cases"):
            self.contains(self.shearwake("show", folder, expect=6).output, "is a folder; give one of its case files, for example ", ".h5")
        output = self.shearwake("show", self.folder, expect=6).output
        self.contains(output, "is a folder")
        self.assertEqual(len(output.splitlines()), 1, output)
        self.contains(self.shearwake("run", "job.toml").output, "1 computed now", "3 already complete")
        self.shearwake("reduce", self.out)
        assert_same_table(self, self.before, table(self.out))

    def test_folders_that_are_not_output_folders_are_rejected(self):
        for command in ("status", "reduce"):
            for folder, words in (("nowhere", "no such output folder"), (self.folder, "contains no plan.json")):
                self.contains(self.shearwake(command, folder, expect=6).output, words, "run the job first")
            (self.out / "plan.json").write_text('{"schema": 1', encoding="utf-8")
            self.contains(self.shearwake(command, self.out, expect=6).output, "is not a plan")
            (self.out / "plan.json").write_text("[1, 2]", encoding="utf-8")
            self.contains(self.shearwake(command, self.out, expect=6).output, "is not a plan")


class ReadOnly(ProgramTest):
    def as_nobody(self):
        """The prefix that runs a command as nobody if the test runs as root, to which permissions do not apply."""
        os.chmod(self.folder, 0o777)
        if os.geteuid() != 0:
            return []
        prefix = ["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
        if subprocess.run([*prefix, str(PROGRAM), "--version"], capture_output=True, check=False).returncode != 0:
            self.skipTest("nobody cannot start the program where it was built")
        return prefix

    def lock(self, folder):
        """Makes the folder read-only until the end of the test."""
        os.chmod(folder, 0o555)
        self.addCleanup(os.chmod, folder, 0o777)

    @pytest.mark.extended
    def test_a_read_only_parent_folder_is_reported(self):
        self.write_job()
        nobody = self.as_nobody()
        self.lock(self.folder)
        output = self.shearwake("run", "job.toml", prefix=nobody, expect=6).output
        self.contains(output, "cannot create the folder", "out", "Permission denied")

    def test_a_read_only_output_folder_is_reported(self):
        nobody = self.as_nobody()
        self.compute_some(prefix=nobody)
        for folder in (self.out, self.out / "cases"):
            for journal in self.out.glob("journal*.jsonl"):
                os.chmod(journal, 0o444)
            self.lock(folder)
            output = self.shearwake("run", "job.toml", prefix=nobody, expect=6).output
            self.contains(output, "Permission denied", str(self.out.relative_to(self.folder)))
            self.assertLess(len(output), 2000, output)
            self.assertNotIn("internal error", output)
            os.chmod(folder, 0o777)
            for journal in self.out.glob("journal*.jsonl"):
                os.chmod(journal, 0o666)
        self.lock(self.out)
        self.contains(self.shearwake("reduce", self.out, prefix=nobody, expect=6).output, "Permission denied")

    @pytest.mark.extended
    def test_an_unreadable_output_folder_is_reported(self):
        nobody = self.as_nobody()
        self.compute_some(prefix=nobody)
        os.chmod(self.out, 0o000)
        self.addCleanup(os.chmod, self.out, 0o777)
        for command in (["run", "job.toml"], ["status", self.out], ["reduce", self.out]):
            output = self.shearwake(*command, prefix=nobody, expect=6).output
            self.contains(output, "Permission denied")
            self.assertNotIn("internal error", output)


class FullDisk(ProgramTest):
    def mount(self, megabytes):
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "none", disk],
                                 capture_output=True, text=True, check=False)
        if mounted.returncode != 0:
            self.skipTest(f"no small disk can be mounted: {mounted.stderr.strip()}")
        self.addCleanup(subprocess.run, ["umount", "-l", disk], check=False)
        return disk

    def enlarge(self, disk):
        subprocess.run(["mount", "-o", "remount,size=100m", disk], check=True)

    def test_cases_fail_on_a_full_disk_and_are_retried_when_there_is_space(self):
        if os.geteuid() != 0:
            self.skipTest("only root can mount a small disk")
        disk = self.mount(3)
        out = disk / "small"
        self.write_job()
        output = self.shearwake("run", "job.toml", "--out", out, expect=6).output
        self.contains(output, "MB", "left", "failed", "because of files or disks")
        self.assertEqual(list(out.rglob("*.part")), [])
        for path in case_files(out):
            with h5py.File(path) as file:
                self.assertGreater(file["surface/u_z"][()].size, 0)
        self.contains(self.shearwake("status", out).output, f"{len(case_files(out))} done", "failed")
        self.enlarge(disk)
        self.shearwake("run", "job.toml", "--out", out)
        self.assertEqual(len(case_files(out)), 4)
        self.assertEqual(list((out / "failed").iterdir()), [])

    @pytest.mark.extended
    def test_a_disk_that_is_filled_during_the_run_is_reported(self):
        """The disk has space when it is checked, and is full when the files are written."""
        if os.geteuid() != 0:
            self.skipTest("only root can mount a small disk")
        disk = self.mount(12)
        out = disk / "small"
        self.compute_some(words=("--out", out))
        for ranks in (1, 2):
            with open(disk / "filler", "wb", buffering=0) as file:
                try:
                    while file.write(bytes(4096)):
                        pass
                except OSError:
                    pass
            done = self.shearwake("run", "job.toml", "--out", out, "--retry-failed", ranks=ranks, expect=None)
            self.assertEqual(done.returncode, 6, done.output)
            self.assertRegex(done.output, "No space left|MB left")
            self.assertNotIn("internal error", done.output)
            self.shearwake("reduce", out, expect=6)
            self.assertEqual(len(case_files(out)), 1)
            os.remove(disk / "filler")
            self.contains(self.shearwake("status", out).output, "1 done")
        self.enlarge(disk)
        self.reduced(out, "--retry-failed")
        self.assertEqual({row["status"] for row in table(out)}, {"complete"})
        self.assertEqual(len(plan(out)["cases"]), 4)
