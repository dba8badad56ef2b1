# SPDX-License-Identifier: BSD-3-Clause
"""Interrupted runs and their resumption."""
import signal

import h5py
import pytest

from program import LONG, PATIENCE_s, ProgramTest, alive, case_files, descendants, journal, started, table
from table_comparison import assert_same_table


class Resume(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_job(LONG)

    def assert_undamaged(self):
        for path in case_files(self.out):
            with h5py.File(path) as file:
                self.assertIn(file.attrs["status"], ("complete", b"complete"))
                self.assertGreater(file["surface/u_z"][()].size, 0)

    def assert_finishes_as_if_undisturbed(self):
        there = len(case_files(self.out))
        self.contains(self.shearwake("run", "job.toml").output, f"{there} already complete", f"{12 - there} computed now")
        self.assertEqual(list(self.out.rglob("*.part")), [])
        whole = self.folder / "whole"
        self.shearwake("run", "job.toml", "--out", whole)
        for out in (self.out, whole):
            self.shearwake("reduce", out)
        assert_same_table(self, table(whole), table(self.out))

    @pytest.mark.extended
    def test_a_run_killed_on_two_ranks_is_resumed(self):
        self.kill(self.start_and_stop("run", "job.toml", "--ranks-per-case", 2, ranks=2))
        self.assertEqual(len(case_files(self.out)), 1)
        self.assert_undamaged()
        self.assert_finishes_as_if_undisturbed()

    @pytest.mark.extended
    def test_a_run_interrupted_under_mpirun_is_resumed(self):
        # On Ctrl-C, mpirun lets stopped ranks continue, terminates all after a short time, and exits with its own code.
        process = self.start_and_stop("run", "job.toml", "--ranks-per-case", 2, ranks=2)
        ranks = descendants(process.pid)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE_s)
        self.assertNotEqual(process.returncode, 0)
        self.wait_for(lambda: not any(map(alive, ranks)), "the ranks to end")
        self.assert_undamaged()
        self.assert_finishes_as_if_undisturbed()

    def test_a_signal_stops_a_run_after_the_current_case(self):
        for kind in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(kind.name):
                there = len(case_files(self.out))
                process = self.start_and_stop("run", "job.toml")
                self.signal_and_continue(process, kind)
                output = self.output_of(process, 75)
                self.contains(output, "stopped early", "next: shearwake run job.toml")
                self.assertEqual(len(case_files(self.out)), there + 2)
                self.assertEqual(len(case_files(self.out)), len(set(started(self.out))))
                self.assertEqual(journal(self.out)[-1]["how"], "stopped")
                self.assertEqual(list(self.out.rglob("*.part")), [])
                self.contains(self.shearwake("status", self.out).output, "0 running", "0 failed")
        self.assert_finishes_as_if_undisturbed()

    @pytest.mark.extended
    def test_a_stopped_run_prints_the_command_that_resumes_it(self):
        process = self.start_and_stop("run", "job.toml", "--out", "else where", "-S", "load.peak_Pa=20")
        self.signal_and_continue(process, signal.SIGTERM)
        self.contains(self.output_of(process, 75), "next: shearwake run job.toml", "-S load.peak_Pa=20", "--out 'else where'")

    @pytest.mark.extended
    def test_a_second_signal_ends_a_run_immediately(self):
        process = self.start_and_stop("run", "job.toml")
        process.send_signal(signal.SIGTERM)
        self.signal_and_continue(process, signal.SIGINT)
        process.communicate(timeout=PATIENCE_s)
        self.assertIn(process.returncode, (75, -signal.SIGTERM, -signal.SIGINT))
        self.assert_undamaged()

    def test_partial_files_of_a_killed_run_are_removed(self):
        ids = self.compute_some(LONG)
        part = self.out / "cases" / f"{ids[1]}.h5.elsewhere-17.part"
        part.write_bytes(b"half")
        with open(next(self.out.glob("journal*")), "a", encoding="utf-8") as file:
            file.write('{"event":"star')  # truncated, without an end of line
        self.contains(self.shearwake("run", "job.toml", "--only", ids[2]).output, "1 computed now")
        self.assertFalse(part.exists())
        self.contains(self.shearwake("run", "job.toml", "--only", ids[0]).output, "1 already complete")
