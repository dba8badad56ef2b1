# SPDX-License-Identifier: BSD-3-Clause
"""The jobs of this repository are valid and state their purpose."""
import re

from program import ROOT, ProgramTest

JOBS = sorted((ROOT / "jobs").glob("*.toml"))


class JobsTest(ProgramTest):
    def test_every_job_is_valid_and_starts_with_its_purpose(self):
        self.assertGreater(len(JOBS), 10)
        for job in JOBS:
            with self.subTest(job=job.name):
                self.assertIn("no errors", self.shearwake("check", str(job)).stdout)
                text = job.read_text(encoding="utf-8")
                self.assertTrue(text.startswith("# "), "a comment comes first")
                self.assertIn(f'name = "{job.stem}"', text)

    def test_the_map_of_modulations_has_500_cases(self):
        plan = self.shearwake("plan", str(ROOT / "jobs" / "speed-fwhm-modulation.toml")).stdout
        self.assertGreaterEqual(int(re.search(r"^(\d+) cases on 1 rank", plan, re.MULTILINE)[1]), 500)
