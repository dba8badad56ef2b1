"""A few kills over a small sweep of both engines; long_form.py does a hundred over forty cases."""
import unittest

from faults import FaultTest, both_engines


class Kills(FaultTest):
    def test_the_table_is_the_same_after_any_kills(self):
        self.write_job(both_engines(3))
        reference = self.undisturbed(1)
        kills = self.survive(seed=2, ranks_per_case=1, kills=4, reference=reference, longest_s=0.8)
        self.assertTrue(kills, "it was too fast to be killed")


if __name__ == "__main__":
    unittest.main()
