# SPDX-License-Identifier: BSD-3-Clause
"""File operations of a case that takes milliseconds: with ten thousand of them, metadata limit a parallel file system."""
import re
import shutil
import subprocess
import unittest

import program
from program import NO_FRAMES, ProgramTest, case_files, swept, without_reference

# All calls of strace's class %file, such as openat, stat, unlink, rename and statfs.
MOST_PER_CASE = 30


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class MetadataOperations(ProgramTest):
    def operations(self, cases):
        self.write_job(without_reference(swept(*(100 + 10 * n for n in range(cases))), NO_FRAMES))
        out, trace = self.folder / f"out of {cases}", self.folder / "trace"
        done = subprocess.run(["strace", "-f", "-o", trace, "-e", "trace=%file", program.PROGRAM, "run", "job.toml", "--out", out],
                              capture_output=True, text=True, cwd=self.folder, env=program.environment())
        if "PTRACE" in done.stderr or "ptrace" in done.stderr:
            self.skipTest("this machine forbids to trace processes")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(case_files(out)), cases)
        return len(re.findall(r"^\d+ +\w+\(", trace.read_text(encoding="utf-8", errors="replace"), re.M))

    def test_a_case_needs_few_metadata_operations(self):
        few, many = 4, 14
        per_case = (self.operations(many) - self.operations(few)) / (many - few)
        self.assertLessEqual(per_case, MOST_PER_CASE)
        self.assertGreater(per_case, 5)  # it does write files


if __name__ == "__main__":
    unittest.main()
