# SPDX-License-Identifier: BSD-3-Clause
"""The progress that scripts show during a build."""
import subprocess
import tempfile
import unittest

from program import ROOT

# A clock that advances by 20 s per reading.
CLOCK = 'date() { seconds=$(($(cat clock) + 20)); echo "$seconds" | tee clock; }'


class Progress(unittest.TestCase):
    def test_a_build_whose_first_step_begins_late_shows_the_time_that_remains_after_it(self):
        with tempfile.TemporaryDirectory() as folder:
            script = f'. "{ROOT}/scripts/common.sh"\n{CLOCK}\necho 0 >clock\nprintf "[0/4] a\\n[1/4] b\\n" | show_steps log'
            done = subprocess.run(["sh", "-eu", "-c", script], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True,
                                  encoding="utf-8", check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout, "building [0/4]\nbuilding [1/4], about 3 min left\n")


if __name__ == "__main__":
    unittest.main()
