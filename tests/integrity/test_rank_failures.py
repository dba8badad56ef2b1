# SPDX-License-Identifier: BSD-3-Clause
"""Memory refused to one rank at many places of a case. The test itself is tests/mpi/test_rank_failures.cpp, which
`scripts/test` runs in a short form; this file runs it with more places."""
import re
import subprocess
import unittest

from attacks import LEDGER, LONG_FORM
from program import PROGRAM, environment

RUNNER = PROGRAM.parent / "tests" / "mpi_tests"
PLACES = 60  # per rank and kind of case


@unittest.skipUnless(LONG_FORM, "runs as a part of mpi_tests")
class RankFailures(unittest.TestCase):
    def test_memory_refused_to_one_rank_fails_its_case_only(self):
        for ranks in (2, 3):
            with self.subTest(ranks=ranks):
                env = {**environment(), "SHEARWAKE_REFUSALS": str(PLACES)}
                done = subprocess.run(
                    ["mpirun", "-n", str(ranks), RUNNER, "memory refused*"], env=env, capture_output=True, encoding="utf-8",
                    errors="replace", check=False, timeout=3600)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                outcomes = re.findall(r"(\d+) cases failed, (\d+) continued", done.stdout)
                self.assertTrue(outcomes, done.stdout)
                attack = f"memory refused to one of {ranks} ranks, layered, spectral and pstd"
                for failed, continued in outcomes:
                    LEDGER.add(attack, "only this case failed", int(failed))
                    LEDGER.add(attack, "case continued without a checkpoint", int(continued))


if __name__ == "__main__":
    unittest.main()
