# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/count_tests.py makes of groups that pass, fail, crash or hang under CTest."""
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest
from pathlib import Path

from count_tests import count

ROOT = Path(__file__).resolve().parent.parent.parent

REPORT = """\
<testsuites><testsuite name="group">
<testcase classname="runner" name="first"/><testcase classname="runner" name="second">{}</testcase>
</testsuite></testsuites>"""
FAILED = '<failure message="1 == 2" type="CHECK">at line 7</failure>'


class Groups(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build = Path(folder.name)
        self.results = self.build / "test-results"
        self.results.mkdir()

    def count(self, command="", time_limit_s=60, **reports):
        """Runs a group of CTest that executes `command` after it has written `reports`: name of a file to content."""
        for name, content in reports.items():
            (self.results / name.replace("__", ".")).write_text(content, encoding="utf-8")
        (self.build / "group.py").write_text(textwrap.dedent(command), encoding="utf-8")
        (self.build / "CTestTestfile.cmake").write_text(
            f'add_test("a group" "{sys.executable}" "{self.build}/group.py")\n'
            f'set_tests_properties("a group" PROPERTIES TIMEOUT {time_limit_s})\n', encoding="utf-8")
        subprocess.run(["ctest", "--test-dir", str(self.build), "--output-junit", "test-results/ctest.xml"],
                       capture_output=True, check=False)
        passed, failed, texts = count(self.build)
        return (passed, failed), "\n".join(texts)

    def test_counts_passed_and_failed_tests(self):
        self.assertEqual(self.count(a_group__xml=REPORT.format(""))[0], (2, 0))
        counts, text = self.count("raise SystemExit(1)", a_group__xml=REPORT.format(FAILED))
        self.assertEqual(counts, (1, 1))
        self.assertRegex(text, r"FAILED  runner second \(a group\)\n +1 == 2\n +at line 7")

    def test_a_test_passes_if_it_passes_on_all_ranks(self):
        counts, _ = self.count(a_group__xml=REPORT.format(""), a_group__xml__1=REPORT.format(FAILED))
        self.assertEqual(counts, (1, 1))

    def test_names_skipped_tests_and_counts_them_neither_way(self):
        counts, text = self.count(a_group__xml=REPORT.format('<skipped message="no browser"/>'))
        self.assertEqual(counts, (1, 0))
        self.assertRegex(text, r"SKIPPED  runner second \(a group\)\n +no browser")

    def test_a_group_that_crashes_is_a_failure(self):
        counts, text = self.count("import os; print('rank 0: second', flush=True); os.abort()",
                                  a_group__xml=REPORT.format("")[:60])
        self.assertEqual(counts, (0, 1))
        self.assertRegex(text, "(?s)FAILED  a group as a whole: .*incomplete.*rank 0: second")
        self.assertEqual(self.count("raise SystemExit(3)", a_group__xml=REPORT.format(""))[0], (2, 1))

    def test_a_group_without_a_report_is_a_failure(self):
        counts, text = self.count()
        self.assertEqual(counts, (0, 1))
        self.assertIn("it left no report", text)

    def test_a_group_that_hangs_is_ended_with_its_children(self):
        counts, text = self.count(f"""\
            import subprocess, sys
            child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"], start_new_session=True)
            open({str(self.build / "child")!r}, "w").write(str(child.pid))
            print("rank 0: second", flush=True)
            child.wait()
            """, time_limit_s=3)
        self.assertEqual(counts, (0, 1))
        self.assertIn("rank 0: second", text)
        state = Path("/proc", (self.build / "child").read_text(encoding="utf-8"), "stat")
        # CTest kills the child and does not wait for its end, which takes a moment on a busy machine.
        deadline_s = time.monotonic() + 30
        while running(state) and time.monotonic() < deadline_s:
            time.sleep(0.05)
        self.assertFalse(running(state))


def running(state):
    """Whether the process of this /proc/PID/stat exists and is not a zombie."""
    try:
        return state.read_text(encoding="utf-8").split()[2] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


if __name__ == "__main__":
    unittest.main()
