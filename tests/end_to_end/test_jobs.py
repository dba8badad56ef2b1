# SPDX-License-Identifier: BSD-3-Clause
"""The jobs of this repository are valid, state their purpose, and do not take too long."""
import re
import unittest

from program import ROOT, ProgramTest

JOBS = sorted((ROOT / "jobs").glob("*.toml"))
FIGURES = [f"fig2.{n}.toml" for n in (2, 3, 4, 5)]
LIMIT_s = 300.0  # for all figures together on two cores


class JobsTest(ProgramTest):
    def test_every_job_is_valid_and_starts_with_its_purpose(self):
        self.assertGreater(len(JOBS), 10)
        for job in JOBS:
            with self.subTest(job=job.name):
                self.assertIn("no errors", self.shearwake("check", str(job)).stdout)
                text = job.read_text(encoding="utf-8")
                self.assertTrue(text.startswith("# "), "a comment comes first")
                self.assertIn(f'name = "{job.stem}"', text)

    def test_the_thesis_figures_take_less_than_five_minutes(self):
        seconds = 0.0
        for name in FIGURES:
            plan = self.shearwake("plan", str(ROOT / "jobs" / name), "-n", "2").stdout
            found = re.search(r"about ([\d.]+) (s|min)\b", plan)
            self.assertIsNotNone(found, plan[-200:])
            seconds += float(found[1]) * (60.0 if found[2] == "min" else 1.0)
        self.assertTrue(0.0 < seconds < LIMIT_s, f"{seconds} s")

    def test_the_map_of_modulations_has_500_cases(self):
        plan = self.shearwake("plan", str(ROOT / "jobs" / "speed-fwhm-modulation.toml")).stdout
        self.assertGreaterEqual(int(re.search(r"^(\d+) cases on 1 rank", plan, re.MULTILINE)[1]), 500)


if __name__ == "__main__":
    unittest.main()
