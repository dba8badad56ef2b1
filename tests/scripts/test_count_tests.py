# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/count_tests.py makes of groups that pass, fail, crash or hang under CTest."""
import subprocess
import sys
import textwrap

from count_tests import count
from program import PATIENCE_s, ProgramTest, alive

REPORT = """\
<testsuites><testsuite name="group">
<testcase classname="runner" name="first"/><testcase classname="runner" name="second">{}</testcase>
</testsuite></testsuites>"""
FAILED = '<failure message="1 == 2" type="CHECK">at line 7</failure>'


class Groups(ProgramTest):
    def setUp(self):
        super().setUp()
        self.build = self.folder
        self.results = self.build / "test-results"
        self.results.mkdir()

    def count(self, command="", time_limit_s=PATIENCE_s, **reports):
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
        for time_limit_s in (3, 30, 300):  # a busy machine needs longer to start the child
            counts, text = self.count(f"""\
                import subprocess, sys
                print("rank 0: second", flush=True)
                child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1e6)"], start_new_session=True)
                open({str(self.build / "child")!r}, "w").write(f"{{child.pid}}\\n")
                child.wait()
                """, time_limit_s=time_limit_s)
            self.assertEqual(counts, (0, 1))
            child = (self.build / "child").read_text(encoding="utf-8") if (self.build / "child").exists() else ""
            if child.endswith("\n"):
                break
        self.assertIn("rank 0: second", text)
        # CTest kills the child and does not wait for its end.
        self.wait_for(lambda: not alive(int(child)), "the end of the child")
