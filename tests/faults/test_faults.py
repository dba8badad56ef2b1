# SPDX-License-Identifier: BSD-3-Clause
"""Runs under adverse conditions: stop requests, time limits, temporary and persistent file errors, refused memory, and a
folder that is removed."""
import errno
import os
import shutil
import signal
import time
import unittest
import unittest.mock

import h5py
import numpy
import pytest

from faults import FaultTest, both_engines, command, journal, table_bytes
from program import (AM, JOB, LONG, NO_FRAMES, SPECTRAL, case_files, changed_job, faulty_environment, large_job, plan_ids, seal,
                     small_job, started, table, without_reference)


class Stops(FaultTest):
    @pytest.mark.long
    def test_a_stop_file_stops_runs_until_it_is_removed(self):
        self.write_job(LONG)
        process = self.start_and_stop("run", "job.toml", ranks=2)
        (self.out / "STOP").touch()
        self.signal_and_continue(process)
        output = self.output_of(process, 75)
        self.contains(output, "STOP stops all runs: remove it to continue", "next: shearwake run")
        there = len(case_files(self.out))
        self.assertLess(there, 12)
        self.assertEqual(journal(self.out)[-1]["how"], "stopped")
        self.contains(self.shearwake("run", "job.toml", expect=75).output, "0 computed now", "STOP")
        self.contains(self.shearwake("status", self.out).output, "STOP stops all runs", "remove it")
        (self.out / "STOP").unlink()
        self.contains(self.shearwake("run", "job.toml", ranks=2).output, f"{there} already complete")
        self.assertEqual(len(started(self.out)), 12)

    @pytest.mark.extended
    def test_a_run_beside_a_stop_file_starts_no_case(self):
        self.write_job(without_reference(SPECTRAL))
        self.out.mkdir(parents=True)
        (self.out / "STOP").touch()
        output = self.shearwake("run", "job.toml", expect=75, ranks=2).output
        self.contains(output, "0 computed now", "STOP stops all runs", "stopped early")
        self.assertEqual([line["event"] for line in journal(self.out)], ["run_started", "run_ended"])
        (self.out / "STOP").unlink()
        self.contains(self.shearwake("run", "job.toml", ranks=2).output, "3 computed now")

    def test_a_run_stops_at_its_time_limit(self):
        self.write_job(LONG)
        self.contains(self.shearwake("run", "job.toml", "--walltime", "half an hour", expect=2).output,
                      "must be seconds or days-hours:minutes:seconds", "1:30:00")
        # An hour passes when the second case of each run has been computed.
        for words, variables, complete in ((("--walltime", "1:00:00"), {}, 2),
                                           ((), {"SLURM_JOB_END_TIME": str(int(time.time()) + 3600)}, 4)):
            env = {**faulty_environment(PATH="/cases/*.h5", CALL="rename", HOUR_AT=2), **variables}
            self.contains(self.call(*command("run", "job.toml", *words), env=env, expect=75).output, "stopped early", "12 cases")
            self.assertEqual(len(case_files(self.out)), complete)
            self.assertEqual(len(started(self.out)), complete)

    @pytest.mark.extended
    def test_the_journal_records_the_engine_and_the_time_of_a_case(self):
        self.compute_some(LONG, 1)
        times = [line for line in journal(self.out) if line["event"] == "finished"]
        self.assertEqual(len(times), 1)
        self.assertEqual(times[0]["engine"], "layered")
        self.assertGreater(times[0]["seconds"], 0.0)


class LargeCase(FaultTest):
    """A case of engine layered that takes minutes. It writes no checkpoints, so it has some seconds to end when a
    stop is requested."""

    def setUp(self):
        super().setUp()
        self.write_job(large_job(5.0))

    def assert_stops(self, ranks, after_s):
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.start("run", "job.toml", "--ranks-per-case", ranks, ranks=ranks)
        self.wait_for(lambda: (self.out / "plan.json").exists() and started(self.out), "the case")
        time.sleep(after_s)
        process.send_signal(signal.SIGTERM if ranks == 1 else signal.SIGUSR1)
        self.contains(self.output_of(process, 75), "0 computed now", "stopped early")
        self.assertEqual(case_files(self.out), [], "it was too fast to be stopped")
        self.assert_nothing_left(self.out)

    @pytest.mark.long
    def test_a_stop_request_ends_a_long_case_on_one_and_two_ranks(self):
        for ranks, after_s in ((2, 0.0), (1, 2.0)):
            with self.subTest(ranks=ranks, after_s=after_s):
                self.assert_stops(ranks, after_s)


class Failing(FaultTest):
    def setUp(self):
        super().setUp()
        self.write_job(both_engines(1))

    def run_with(self, ranks=1, words=(), **faults):
        return self.call(*command("run", "job.toml", *words, ranks=ranks), env=faulty_environment(**faults), expect=None)

    def use_own_cache(self):
        """A cache that no other program changes meanwhile, since the allocations of a run depend on its contents."""
        cache = unittest.mock.patch.dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        cache.start()
        self.addCleanup(cache.stop)

    def allocations(self, ranks, words):
        """The number of allocations of the last rank in a new run. The first call fills the cache: otherwise a
        probe would meet the refusals of later runs, and the cases none."""
        count = self.folder / "allocations"
        for _ in range(2):
            shutil.rmtree(self.out, ignore_errors=True)
            rank = {"RANK": ranks - 1} if ranks > 1 else {}
            done = self.run_with(ranks, words, NEW_COUNT=count, **rank)
            self.assertEqual(done.returncode, 0, done.output)
        return int(count.read_text())

    def assert_goes_on(self, reference, *words, ranks=1):
        self.reduced(self.out, *words, ranks=ranks)
        self.assertEqual(table_bytes(self.out), reference)
        self.assert_nothing_left(self.out)

    def reference(self, *words, ranks=1):
        whole = self.folder / "whole"
        self.reduced(whole, *words, ranks=ranks)
        return table_bytes(whole)

    @pytest.mark.extended
    def test_temporary_file_errors_are_retried(self):
        reference = self.reference()
        again = 0
        for path, at, count in (("/out/small/", 20, 1), ("/out/small/", 50, 1), ("/out/small/cases/", 3, 5)):
            shutil.rmtree(self.out, ignore_errors=True)
            done = self.run_with(PATH=path, EIO_AT=at, EIO_COUNT=count)
            self.assertEqual(done.returncode, 0, done.output)
            again += "is tried again in 1 s" in done.output
            self.shearwake("reduce", self.out)
            self.assertEqual(table_bytes(self.out), reference)
        self.assertGreater(again, 0, "no case has met a failure")

    def test_a_file_is_flushed_before_it_gets_its_name(self):
        for ranks, path, words, code in ((1, "cases/*.h5", (), 6), (2, "cases/*.h5", ("--ranks-per-case", 2), 6),
                                         (1, "checkpoints/", ("--checkpoint-steps", 20), 0), (1, "journal", (), 6)):
            with self.subTest(path=path, ranks=ranks):
                shutil.rmtree(self.out, ignore_errors=True)
                done = self.run_with(ranks, words, PATH=f"/out/small/{path}", CALL="fsync", EIO_AT=1, EIO_COUNT=1000000,
                                     ERRNO=errno.ENOSPC)
                self.assertEqual(done.returncode, code, done.output)
                self.assertRegex(done.output, f"cannot flush out/small/{path.replace('*', '.*')}.*: No space left")

    @pytest.mark.long
    def test_persistent_file_errors_are_reported_and_the_next_run_continues(self):
        reference = self.reference()
        done = self.run_with(PATH="/out/small/cases/", EIO_AT=3, EIO_COUNT=1000000, words=("--fail-fast",))
        self.assertEqual(done.returncode, 6, done.output)
        self.contains(done.output, "is tried again in 5 s", "failed", "Input/output error", "because of files or disks")
        failed = sorted((self.out / "failed").iterdir())
        self.assertEqual(len(failed), 1)
        self.assertIn(failed[0].stem, plan_ids(self.out))
        self.contains(failed[0].read_text(encoding="utf-8"), "reason:", "Input/output error", "to retry:", "log:",
                      "is tried again", "settings:", "[medium]")
        self.assert_goes_on(reference)

    @pytest.mark.extended
    def test_a_requested_stop_after_a_file_error_exits_with_75(self):
        self.write_job(LONG)
        process = self.start_and_stop("run", "job.toml", faults={
            "PATH": "/cases/", "EIO_AT": 3, "ERRNO": errno.ENOSPC, "STOP_AT": 20})
        self.assertEqual(len(list((self.out / "failed").glob("*.txt"))), 1)
        self.signal_and_continue(process, signal.SIGTERM)
        self.contains(self.output_of(process, 75), "No space left", "1 failed", "stopped early", "next: shearwake run")

    @pytest.mark.long
    def test_a_failure_of_one_rank_fails_one_case_and_the_run_continues(self):
        """Memory is refused to one of two ranks that compute a case together."""
        together = ("--ranks-per-case", 2)
        self.use_own_cache()
        allocations = self.allocations(2, together)
        reference = self.reference(*together, ranks=2)
        failures = 0
        for part in (0.5, 0.7, 0.9):
            shutil.rmtree(self.out, ignore_errors=True)
            done = self.run_with(2, together, RANK=1, NEW_AT=int(part * allocations))
            if done.returncode == 0 or not started(self.out):
                continue  # it failed while reading the job, or did without this memory
            failures += 1
            self.assertEqual(done.returncode, 4, done.output)
            self.contains(done.output, "1 computed now", "1 failed")
            failed = [line["id"] for line in journal(self.out) if line["event"] == "failed"]
            self.assertEqual(len(failed), 1)
            self.contains((self.out / "failed" / f"{failed[0]}.txt").read_text(encoding="utf-8"), "out of memory")
            output = self.shearwake("run", "job.toml", *together, ranks=2, expect=4).output
            self.contains(output, "1 failed", "1 already complete")
            self.assertEqual(started(self.out).count(failed[0]), 1)
            self.assert_goes_on(reference, *together, "--retry-failed", ranks=2)
        self.assertGreater(failures, 0, "no case has failed")

    @pytest.mark.long
    def test_refused_memory_at_any_allocation_ends_one_case_without_deadlock(self):
        text = small_job({"afferents": {}}, NO_FRAMES)
        met = 0
        self.use_own_cache()
        for job, ranks, together in ((JOB, 1, 1), (JOB, 2, 2), (text, 2, 2), (text, 2, 1)):
            self.write_job(job)
            words = ("--ranks-per-case", together)
            allocations = self.allocations(ranks, words)
            for part in (0.35, 0.45, 0.6, 0.75, 0.9):
                with self.subTest(afferents=job is text, ranks=ranks, together=together, part=part):
                    shutil.rmtree(self.out, ignore_errors=True)
                    rank = {"RANK": 1} if ranks > 1 else {}
                    done = self.run_with(ranks, words, NEW_AT=int(part * allocations), **rank)
                    if done.returncode == 1 and not started(self.out):
                        continue  # it failed while reading the job
                    if done.returncode == 0:
                        continue  # it did without this memory
                    met += 1
                    self.assertEqual(done.returncode, 4, done.output)
                    failed = [line for line in journal(self.out) if line["event"] == "failed"]
                    self.assertEqual(len(failed), 1, done.output)
                    self.contains(failed[0]["reason"], "out of memory")
                    self.assertEqual(len(case_files(self.out)), 3, done.output)
        self.assertGreaterEqual(met, 12, "few cases have met it")

    def test_a_diverging_field_is_reported_with_step_time_and_remedies(self):
        self.write_job(changed_job(both_engines(1), SPECTRAL, {"sweep": {AM: [300], "load.peak_Pa": [1e200, 100.0]}}))
        output = self.shearwake("run", "job.toml", expect=4).output
        self.contains(output, "1 computed now", "1 failed")
        self.assertNotIn("is tried again", output)
        bad, good = plan_ids(self.out)
        reason = next(line["reason"] for line in journal(self.out) if line["event"] == "failed")
        self.assertRegex(reason, r"step \d+ at [\d.e+-]+ ms: the field .*; .* may help")
        self.contains((self.out / "failed" / f"{bad}.txt").read_text(encoding="utf-8"), reason, "log:", "[medium]")
        self.shearwake("reduce", self.out)
        rows = {row["id"]: row for row in table(self.out)}
        self.assertEqual((rows[bad]["status"], rows[bad]["note"]), ("failed", reason))
        self.assertEqual(rows[good]["status"], "complete")

    @pytest.mark.extended
    def test_file_systems_without_locks_permissions_and_flushes_of_folders_suffice(self):
        self.reduced(self.out)
        rows = table_bytes(self.out)
        refused_locks = 524  # ENOTSUPP, which NFS returns, is not among the errors of errno
        for folders, locks in ((errno.EINVAL, errno.ENOLCK), (errno.ENOTSUP, refused_locks)):
            with self.subTest(folders=folders, locks=locks):
                shutil.rmtree(self.out)
                env = faulty_environment(FOLDERS=folders, CHMOD=errno.EPERM, LOCKS=locks, LOCKS_IN="/")
                for words, ranks in ((("run", "job.toml"), 2), (("reduce", self.out), 1), (("report", self.out), 1), (("verify", self.out), 1)):
                    self.call(*command(*words, ranks=ranks), env=env)
                self.assertEqual(table_bytes(self.out), rows)
                self.assertTrue((self.out / "report" / "index.html").exists())
        done = self.call(*command("run", "job.toml", "--out", "broken"), env=faulty_environment(FOLDERS=errno.EIO), expect=6)
        self.contains(done.output, "cannot flush", os.strerror(errno.EIO))

    @pytest.mark.long
    def test_removal_of_the_folder_during_a_run_is_reported(self):
        self.write_job(LONG)
        process = self.start_and_stop("run", "job.toml", ranks=2)
        shutil.move(self.out, self.folder / "elsewhere")
        self.signal_and_continue(process)
        output = self.output_of(process, 6)
        self.contains(output, "the output folder", "was removed during the run")
        self.assertNotIn("internal error", output)
        self.assertFalse((self.out / "cases").exists())
        there = len(case_files(self.folder / "elsewhere"))
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.move(self.folder / "elsewhere", self.out)
        self.contains(self.shearwake("status", self.out).output, f"{there} done", "0 running")

    @pytest.mark.extended
    def test_removal_of_case_files_during_a_run_is_reported_and_the_next_run_continues(self):
        self.write_job(LONG)
        # A write that races `rm -rf` may leave folders, journal and index without the plan.
        for removed in (("plan.json", "cases/*"), ("cases",)):
            with self.subTest(removed=removed):
                shutil.rmtree(self.out, ignore_errors=True)
                process = self.start_and_stop("run", "job.toml")
                for path in [path for name in removed for path in self.out.glob(name)]:
                    shutil.rmtree(path) if path.is_dir() else path.unlink()
                (self.out / "cases").mkdir(exist_ok=True)
                self.signal_and_continue(process)
                output = self.output_of(process, 6)
                self.contains(output, "during the run", "rerun the command")
                self.assertNotIn("12 computed now", output)
                self.shearwake("run", "job.toml")
                self.assertEqual(len(case_files(self.out)), 12)

    @pytest.mark.extended
    def test_changes_of_the_system_clock_have_no_effect(self):
        reference = self.reference()
        for seconds in (-90000, 90000):
            shutil.rmtree(self.out, ignore_errors=True)
            done = self.run_with(words=("--walltime", "10:00"), CLOCK=seconds)
            self.assertEqual(done.returncode, 0, done.output)
            self.contains(self.shearwake("status", self.out).output, "2 done", "0 failed")
            self.shearwake("reduce", self.out)
            self.assertEqual(table_bytes(self.out), reference)


class Folders(FaultTest):
    def test_results_of_another_version_are_rejected_unless_allowed(self):
        self.compute_some(LONG, 1)
        with h5py.File(case_files(self.out)[0], "r+") as file:
            file.attrs["git_id"] = numpy.bytes_("0123456")
        seal(case_files(self.out)[0])
        output = self.shearwake("run", "job.toml", expect=2).output
        self.contains(output, "another version of this program, 0123456", "--allow-mixed", "--out")
        self.shearwake("run", "job.toml", "--allow-mixed")
        starts = [line for line in journal(self.out) if line["event"] == "run_started"]
        self.assertTrue(starts[-1]["allow_mixed"])
        self.contains(self.shearwake("reduce", self.out).output, "two versions of the program", "0123456")

    @pytest.mark.extended
    def test_files_respect_the_umask(self):
        self.write_job(both_engines(1))
        before = os.umask(0o077)
        self.addCleanup(os.umask, before)
        process = self.start_and_stop("run", "job.toml", "--checkpoint-steps", 20,
                                      faults={"PATH": "/checkpoints/*.h5", "CALL": "rename", "STOP_AT": 2})
        self.signal_and_continue(process, signal.SIGTERM)
        self.output_of(process, 75)
        self.reduced(self.out, "--log-json", self.out / "progress.jsonl")
        for path in (self.out, *self.out.rglob("*")):
            self.assertEqual(path.stat().st_mode & 0o077, 0, path)
