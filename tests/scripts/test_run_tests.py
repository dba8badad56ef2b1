# SPDX-License-Identifier: BSD-3-Clause
"""The test runner itself: how it distinguishes groups that hang, crash or are merely slow."""
import contextlib
import io
import os
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

from run_tests import run_ctest  # noqa: E402
from test_runner.groups import Group, run_group  # noqa: E402
from test_runner.progress import Progress  # noqa: E402
from test_runner.screen import Screen  # noqa: E402
from test_runner.supervise import Patience, supervise  # noqa: E402
from test_runner.verdicts import count_catch, count_unittest  # noqa: E402

# A process that reports progress like a runner of tests.
PREAMBLE = """\
import os, subprocess, sys, time
def report(line):
    with open(os.environ["SHEARWAKE_TEST_PROGRESS"], "a") as file:
        file.write(line + "\\n")
report("total 2")
"""
HANGS = PREAMBLE + """\
report("begin the first")
report("end the first")
report("begin the second")
child = subprocess.Popen(["sleep", "600"], start_new_session=True)
open(sys.argv[1], "w").write(str(child.pid))
while True:  # like a rank that polls for a message that never arrives
    pass
"""
# Reports progress every 0.1 s, for more than twice the time limit of these tests.
SLOW = PREAMBLE + """\
report("begin the first")
for _ in range(90):
    time.sleep(0.1)
    report("alive")
report("end the first")
"""
FOREVER = PREAMBLE + """\
report("begin the first")
while True:
    time.sleep(0.1)
    report("alive")
"""
# 40 times the interval between two lines of progress, which is longer on a busy machine.
IMPATIENT = Patience(silence_s=4.0, one_test_s=60.0, poll_s=0.02)


def is_alive(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


class RunnerTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-test-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.stopping = threading.Event()

    def run_group(self, group, patience=IMPATIENT):
        """Numbers of passed and failed tests, and the text of the result."""
        result = run_group(group, self.folder, self.stopping, patience)
        return (result.passed, result.failed), result.text

    def assert_ends(self, pid):
        """A killed process ends shortly after the signal."""
        last = time.monotonic() + 60.0
        while is_alive(pid):
            self.assertLess(time.monotonic(), last, "the child of an ended group is still running")
            time.sleep(0.02)

    def script(self, text, *words, count=None, name="a group"):
        return Group(name, [sys.executable, "-c", text, *words], count)


class Hangs(RunnerTest):
    def test_a_group_that_spins_without_progress_is_ended_and_reported(self):
        child = self.folder / "child"
        counts, text = self.run_group(self.script(HANGS, str(child)))
        self.assertEqual(counts, (0, 1))
        self.assertIn("it hung: no sign of progress for 4 s", text)
        self.assertIn('in "the second"', text)
        self.assertNotIn('in "the first"', text)
        self.assert_ends(int(child.read_text(encoding="utf-8")))

    def test_a_slow_group_that_makes_progress_is_not_ended(self):
        began = time.monotonic()
        counts, text = self.run_group(self.script(SLOW))
        self.assertEqual(counts, (1, 0), text)
        self.assertGreater(time.monotonic() - began, 2.0 * IMPATIENT.silence_s)

    def test_the_time_of_a_single_test_is_limited(self):
        patience = Patience(silence_s=60.0, one_test_s=1.0, poll_s=0.02)
        counts, text = self.run_group(self.script(FOREVER), patience=patience)
        self.assertEqual(counts, (0, 1))
        self.assertIn("no test began or ended for 1 s", text)

    def test_an_interrupt_ends_the_group(self):
        child = self.folder / "child"

        def interrupt():
            while not (child.exists() and child.read_text(encoding="utf-8")):
                time.sleep(0.02)
            self.stopping.set()

        threading.Thread(target=interrupt).start()
        patience = Patience(silence_s=60.0, one_test_s=60.0, poll_s=0.02)
        counts, text = self.run_group(self.script(HANGS, str(child)), patience=patience)
        self.assertEqual(counts, (0, 1))
        self.assertIn("it was interrupted", text)
        self.assert_ends(int(child.read_text(encoding="utf-8")))


class Crashes(RunnerTest):
    def test_a_group_that_crashes_is_a_failure(self):
        counts, text = self.run_group(self.script("import os; print('last words'); os.abort()"))
        self.assertEqual(counts, (0, 1))
        self.assertIn("exit code -6", text)

    def test_a_runner_that_crashes_between_two_tests_is_a_failure(self):
        report = """<Catch><TestCase name="the first"><OverallResult success="true"/></TestCase>"""
        script = f"import os, sys\nopen(sys.argv[1], 'w').write({report!r})\nos._exit(0)"
        counts, text = self.run_group(self.script(script, "REPORT", count=count_catch))
        self.assertEqual(counts, (1, 1))
        self.assertIn("is incomplete", text)

    def test_a_runner_without_a_report_is_a_failure(self):
        for count in (count_catch, count_unittest):
            counts, text = self.run_group(self.script("pass", count=count))
            self.assertEqual(counts, (0, 1))
            self.assertIn("the group reports no count", text)

    def test_a_command_that_does_not_exist_is_a_failure(self):
        counts, text = self.run_group(Group("a group", ["/no/such/program"]))
        self.assertEqual(counts, (0, 1))
        self.assertIn("FAILED", text)


class PythonTests(RunnerTest):
    def test_results_of_a_file_of_python_tests_are_counted(self):
        path = self.folder / "test_sample.py"
        path.write_text(textwrap.dedent("""\
            import unittest
            class Sample(unittest.TestCase):
                def test_passes(self): pass
                def test_fails(self): self.assertEqual(1, 2)
                @unittest.skip("not here")
                def test_is_skipped(self): pass
            """), encoding="utf-8")
        main = ROOT / "scripts" / "test_runner" / "unittest_main.py"
        group = Group("sample", [sys.executable, str(main), str(path), "REPORT"], count_unittest)
        counts, text = self.run_group(group, patience=Patience())
        self.assertEqual(counts, (1, 1))
        self.assertIn("skipped test_is_skipped", text)
        progress = Progress(self.folder / "sample.progress")
        progress.poll()
        self.assertEqual(str(progress), "3/3")


@unittest.skipUnless("SHEARWAKE" in os.environ, "requires a build folder")
class CatchTests(RunnerTest):
    """The listener of tests/catch_main.cpp, in the runner of the unit tests."""

    def test_a_catch_runner_reports_each_test(self):
        tests = Path(os.environ["SHEARWAKE"]).parent / "tests"
        progress = Progress(self.folder / "catch.progress")
        environment = {**os.environ, "SHEARWAKE_TEST_PROGRESS": str(progress.stem)}
        outcome = supervise([str(tests / "unit_tests"), "-#", "[#test_path]"], self.folder / "log", progress,
                            Patience(), self.stopping, env=environment)
        self.assertEqual(outcome.code, 0)
        progress.poll()
        ended, total = str(progress).split("/")
        self.assertEqual(ended, total)
        self.assertGreater(int(total), 1)

    def test_each_file_of_the_slow_tests_is_a_separate_group(self):
        build = Path(os.environ["SHEARWAKE"]).parent
        listed = subprocess.run(["ctest", "--test-dir", str(build), "-N", "-L", "verify"],
                                capture_output=True, text=True, check=True).stdout
        files = {path.stem for path in (ROOT / "tests" / "verify").glob("*.cpp")}
        self.assertGreater(len(files), 10)
        for name in files:
            self.assertRegex(listed, rf"verify_tests {name}\n")


def group_test(name, text, label="unit"):
    """Lines of a CTestTestfile.cmake that register a group which runs a Python script with run_group.py."""
    command = [sys.executable, str(ROOT / "scripts" / "run_group.py"), "BUILD", "none", name, sys.executable,
               "-c", text]
    quoted = " ".join(f"[==[{word}]==]" for word in command)
    return f'add_test([==[{name}]==] {quoted})\nset_tests_properties([==[{name}]==] PROPERTIES LABELS {label})\n'


class CTest(RunnerTest):
    """scripts/run_tests.py on build folders that contain only a list of tests."""

    def run_ctest(self, *tests, selection=()):
        lines = "".join(tests).replace("BUILD", str(self.folder))
        (self.folder / "CTestTestfile.cmake").write_text(lines, encoding="utf-8")
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            counts = run_ctest(self.folder, Screen(output, every_s=0.2), self.stopping, selection)
        return counts, output.getvalue()

    def test_counts_of_all_groups_are_added(self):
        counts, output = self.run_ctest(group_test("good", "pass"), group_test("bad", "raise SystemExit(3)"))
        self.assertEqual(counts, (1, 1))
        self.assertIn("== good: 1 passed, 0 failed", output)
        self.assertIn("the group ended with exit code 3", output)

    def test_a_group_is_shown_while_it_runs(self):
        _, output = self.run_ctest(group_test("a group", SLOW))
        self.assertIn("a group 0/2 the first", output)

    def test_labels_and_words_select_groups(self):
        tests = group_test("one", "pass"), group_test("two", "raise SystemExit(1)", "mpi")
        self.assertEqual(self.run_ctest(*tests, selection=["-L", "^unit$"])[0], (1, 0))
        self.assertEqual(self.run_ctest(*tests, selection=["-R", "two"])[0], (0, 1))

    def test_an_empty_selection_is_a_failure(self):
        self.assertEqual(self.run_ctest(group_test("one", "pass"), selection=["-R", "absent"])[0], (0, 1))

    def test_a_group_without_a_result_is_a_failure(self):
        for command in ("false", "true", "/no/such/program"):
            with self.subTest(command=command):
                counts, output = self.run_ctest(f"add_test(lost {command})\n")
                self.assertEqual(counts, (0, 1))
                self.assertIn("FAILED  lost left no result", output)

    def test_an_interrupt_ends_the_running_groups(self):
        child = self.folder / "child"
        script = HANGS.replace("sys.argv[1]", repr(str(child)))

        def interrupt():
            while not (child.exists() and child.read_text(encoding="utf-8")):
                time.sleep(0.02)
            self.stopping.set()

        threading.Thread(target=interrupt).start()
        counts, text = self.run_ctest(group_test("a group", script))
        self.assertEqual(counts, (0, 1))
        self.assertIn("it was interrupted", text)
        self.assert_ends(int(child.read_text(encoding="utf-8")))


if __name__ == "__main__":
    unittest.main()
