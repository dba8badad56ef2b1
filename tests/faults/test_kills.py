# SPDX-License-Identifier: BSD-3-Clause
"""A few kills during a small sweep of both engines; long_form.py has a hundred kills and forty cases."""
import unittest

from faults import FaultTest, both_engines


class Kills(FaultTest):
    def test_kills_do_not_change_the_table(self):
        self.write_job(both_engines(3))
        reference = self.undisturbed(1)
        kills = self.survive(seed=2, ranks_per_case=1, kills=4, reference=reference, longest_s=0.8)
        self.assertTrue(kills, "it was too fast to be killed")


if __name__ == "__main__":
    unittest.main()
