# SPDX-License-Identifier: BSD-3-Clause
"""The verdicts of scripts/user_studies.py and the quantities that it derives from tables."""
import importlib.util
import math
import sys
import tomllib
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("user_studies", ROOT / "scripts/user_studies.py")
user_studies = importlib.util.module_from_spec(SPEC)
sys.modules["user_studies"] = user_studies
SPEC.loader.exec_module(user_studies)


class UserStudies(unittest.TestCase):
    def verdict(self, values, **study):
        return user_studies.verdict({"reported": [2.0, 4.0], "unit": "mm", **study}, np.array(values))

    def test_verdicts_follow_their_definition(self):
        self.assertEqual(self.verdict([1.0, 3.0, 9.0]), "inside")
        self.assertEqual(self.verdict([3.9, 5.0, 9.0]), "same order")  # the intervals overlap
        self.assertEqual(self.verdict([5.0, 6.0, 7.0]), "outside")
        self.assertEqual(self.verdict([5.0, 6.0, 7.0], factor=2.0), "same order")
        self.assertEqual(self.verdict([8.1, 8.2, 8.3], factor=2.0), "outside")
        self.assertEqual(self.verdict([0.5, 1.0, 1.5], unit="dB"), "same order")  # the right sign
        self.assertEqual(self.verdict([-0.5, -1.0, 1.5], unit="dB"), "outside")

    def test_a_gap_is_interpolated_and_infinite_beyond_the_largest_distance(self):
        def rows(*gaps):
            return [{"load.modulation.foci_mm": f"[[-{d}, 0], [{d}, 0]]", "felt_gap_dB": gap} for d, gap in zip((5, 10, 15), gaps)]
        self.assertAlmostEqual(user_studies.gap_distance(rows(0.0, 1.3, 3.3)), 25.0)
        self.assertEqual(user_studies.gap_distance(rows(0.0, 0.0, 0.0)), math.inf)  # which stops the comparison

    def test_every_study_has_its_job_and_its_quantity(self):
        for study in tomllib.loads((ROOT / "jobs/studies/studies.toml").read_text(encoding="utf-8"))["study"]:
            with self.subTest(study["name"]):
                self.assertTrue((ROOT / f"jobs/studies/{study['job']}.toml").exists())
                self.assertTrue(callable(getattr(user_studies, study["quantity"])))
                self.assertLess(*study["reported"])
                self.assertTrue(study["link"].startswith("https://"))


if __name__ == "__main__":
    unittest.main()
