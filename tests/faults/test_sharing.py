# SPDX-License-Identifier: BSD-3-Clause
"""Equal commands in one output folder share its cases, also when one of them ends, or where files cannot be locked."""
import errno
import re
import shutil
import signal
import time

import pytest

from faults import FaultTest, both_engines, table_bytes
from program import LONG, SECOND_CASE, case_files, journal, started

WORDS = ("run", "job.toml", "--ranks-per-case", 1, "--checkpoint-steps", 200)
SECOND_CHECKPOINT = {"PATH": "/checkpoints/*.h5", "CALL": "rename", "STOP_AT": 2}
ENDED = re.compile(r"(\d+) cases: (\d+) computed now, (\d+) already complete, (\d+) failed(?:, (\d+) computed by other runs)?")


class EqualCommands(FaultTest):
    def start_equal(self, count, ranks=2, faults=None):
        return [self.start(*WORDS, ranks=ranks, faults=faults) for _ in range(count)]

    def counts(self, process, code=0):
        """What a command prints at its end: cases, computed, complete before, failed, and computed by others."""
        return [int(text or 0) for text in ENDED.search(self.output_of(process, code)).groups()]

    def assert_shared(self, processes, cases, reference, most_twice=0):
        ended = [self.counts(process) for process in processes]
        for counts in ended:
            self.assertEqual((counts[0], sum(counts[1:])), (cases, cases))
        self.assertEqual(len(case_files(self.out)), cases)
        self.assertEqual(len(set(started(self.out))), cases)
        self.assertLessEqual(len(started(self.out)), cases + most_twice)
        self.shearwake("reduce", self.out)
        self.shearwake("verify", self.out)
        self.assertEqual(table_bytes(self.out), reference)
        self.assert_nothing_left(self.out)
        return ended

    def test_three_commands_compute_each_case_once(self):
        self.write_job(LONG)
        reference = self.undisturbed(1)
        self.assertEqual(sum(counts[1] for counts in self.assert_shared(self.start_equal(3), 12, reference)), 12)
        self.assertEqual(len(list(self.out.glob("journal.*.jsonl"))), 3)
        self.assertEqual([path.name for path in (self.out / "locks").iterdir()], [])

    @pytest.mark.extended
    def test_a_command_without_a_case_left_waits_for_the_others(self):
        self.write_job(both_engines(1))
        first = self.start_and_stop(*WORDS, faults=SECOND_CASE)
        second = self.start(*WORDS)
        self.wait_for(lambda: len(list(self.out.glob("journal.*"))) == 2, "the second run")
        self.contains(self.shearwake("status", self.out).output, "1 done, 1 running", "2 runs are active", "next: wait for the active runs")
        time.sleep(2.0)
        self.assertIsNone(second.poll())
        self.signal_and_continue(first)
        self.assertEqual(self.counts(second), [2, 0, 1, 0, 1])
        self.assertEqual(self.counts(first)[1], 2)

    def test_the_cases_of_a_killed_command_are_taken_over_within_a_minute(self):
        self.write_job(both_engines(3))
        reference = self.undisturbed(1)
        first = self.start_and_stop(*WORDS, ranks=2, faults={**SECOND_CHECKPOINT, "RANK": 1})
        others = self.start_equal(2)
        self.wait_for(lambda: len(case_files(self.out)) == 5, "the other cases")
        killed_s = time.time()
        self.kill(first)
        self.assert_shared(others, 6, reference, most_twice=1)
        resumed = [line["unix_s"] for line in journal(self.out) if line["event"] == "resumed"]
        self.assertEqual(len(resumed), 1)
        self.assertLess(resumed[0] - killed_s, 60.0)  # the others look every half second

    @pytest.mark.extended
    def test_a_stopped_command_leaves_its_case_to_the_others(self):
        self.write_job(both_engines(1))
        first = self.start_and_stop(*WORDS, faults=SECOND_CHECKPOINT)
        second = self.start(*WORDS)
        self.signal_and_continue(first, signal.SIGINT)
        self.counts(first, code=75)
        self.counts(second)
        self.contains(self.shearwake("status", self.out).output, "2 done")

    @pytest.mark.extended
    def test_a_case_that_fails_is_computed_once(self):
        self.write_job()
        failing = [self.start(*WORDS, "-S", "load.peak_Pa=1e200") for _ in range(2)]
        for counts in [self.counts(process, code=4) for process in failing]:
            self.assertEqual(counts[:2] + counts[3:], [4, 0, 4, 0])
        self.assertEqual(len(started(self.out)), 4)

    @pytest.mark.extended
    def test_files_without_locks_are_not_damaged(self):
        """Locks fail, or exclude nobody. A command stands still before a case gets its name, for so long that the others compute the
        case, and then continues."""
        self.write_job(both_engines(2))
        reference = self.undisturbed(1)
        for error in (errno.ENOLCK, -1):
            with self.subTest(error=error):
                faults = {"LOCKS": error, "LOCKS_IN": "/out/"}
                still = self.start_and_stop(*WORDS, faults={**SECOND_CASE, "STOP_AT": 1, **faults})
                self.assertEqual(sum(self.counts(process)[1] for process in self.start_equal(2, faults=faults)), 4)
                self.signal_and_continue(still)
                self.assert_shared([still], 4, reference, most_twice=1)
                shutil.rmtree(self.out)
