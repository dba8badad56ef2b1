"""What `bench` prints; never how fast: that is the machine's."""
import json
import os
import re
import unittest
from unittest import mock

from program import SWEEP, ProgramTest, without_reference

SMALL = ("bench", "spectral", "--grid", "32x24x9", "--steps", 2)
PHASES = ["FFTs", "solves over depth", "strain/force transfer", "stresses, iteration", "sponge", "other"]


class Bench(ProgramTest):
    def row(self, said, name):
        """The numbers behind a name: share, seconds, MB, GB/s."""
        found = re.search(rf"^    {re.escape(name)} +([0-9. ]+)$", said, re.MULTILINE)
        self.assertIsNotNone(found, f"no {name} in\n{said}")
        return [float(word) for word in found.group(1).split()]

    def number(self, said, name, field):
        line = next(line for line in said.splitlines() if line.strip().startswith(name))
        return float(re.findall(r"[0-9]+\.[0-9]+", line)[field])

    def test_where_a_step_goes(self):
        for ranks, contrast in ((1, 16), (3, 4)):
            with self.subTest(ranks=ranks, contrast=contrast):
                said = self.shearwake(*SMALL, "--contrast", contrast, ranks=ranks).stdout
                self.assertIn(f"engine spectral, {ranks} rank", said)
                self.assertIn("32 x 24 points x 9 levels, 2 steps", said)
                shares = [self.row(said, name)[0] for name in PHASES]
                self.assertAlmostEqual(sum(shares), 1.0, delta=0.003)  # of six, each to 0.0005
                for name in PHASES[:4]:
                    self.assertGreater(self.row(said, name)[2], 0.0)  # has moved something
                self.assertIn("floor: bare FFTs", said)
                self.assertIn("floor: their rows", said)
                self.assertGreater(self.number(said, "memory of a rank", 0), 0.0)

    def test_contrast_costs_iterations(self):
        counts = [self.number(self.shearwake(*SMALL, "--contrast", contrast).stdout, "iterations a step", 0)
                  for contrast in (1, 100)]
        self.assertEqual(counts[0], 0.0)
        self.assertGreater(counts[1], 0.0)

    def test_a_sponge_takes_a_share(self):
        said = self.shearwake("bench", "spectral", "--grid", "32x24x9", "--steps", 12, "--contrast", 1, "--sponge", 4).stdout
        self.assertIn("4 mm of sponge", said)
        self.assertGreater(self.row(said, "sponge")[1], 0.0)
        self.assertEqual(self.row(self.shearwake(*SMALL, "--contrast", 1).stdout, "sponge")[1], 0.0)

    def test_without_a_body_nothing_is_transformed(self):
        said = self.shearwake(*SMALL, "--contrast", 1).stdout
        self.assertEqual(self.row(said, "FFTs")[2], 0.0)
        self.assertIn("none", said)

    def test_what_cases_cost_beside_their_solves(self):
        for ranks in (1, 2):
            said = self.shearwake("bench", "sweep", "--cases", 6, ranks=ranks).said
            self.says(said, "6 computed now", "32 computed now")
            self.assertRegex(said, r" 6 tiny cases +[0-9.]+ s +[0-9.]+ ms a case and team beside its solve")
            idle = re.search(r"32 mixed cases +[0-9.]+ s +([0-9.]+) % of the teams' time idle", said)
            self.assertTrue(0.0 <= float(idle.group(1)) < 100.0, said)
        self.assertEqual(list(self.folder.iterdir()), [], "it has left something")

    def test_what_plan_believes_of_a_machine(self):
        self.write_job()
        cache = {"SHEARWAKE_CACHE": str(self.folder / "cache")}
        with mock.patch.dict(os.environ, cache):
            assumed = self.shearwake("plan", "job.toml", "-n", 4096).said
            self.shearwake("bench", "machine", ranks=2)
            measured = self.shearwake("plan", "job.toml", "-n", 4096).said
        self.assertNotEqual(assumed, measured)
        self.assertIn("2 ranks", measured)  # where and when it was measured
        machine = json.loads((self.folder / "cache" / "machine.json").read_text(encoding="utf-8"))
        for name in ("layered_factor", "spectral_factor", "message_s", "transposed_B_s", "file_s", "written_B_s"):
            self.assertGreater(machine[name], 0.0, name)

    def test_a_plan_has_no_more_teams_than_cases(self):
        self.write_job(without_reference((SWEEP, '"load.modulation.am_frequency_Hz" = [400]')))
        said = self.shearwake("plan", "job.toml", "-n", 4096).said
        self.assertRegex(said, r"on 4096 ranks: 1 team of \d+ \(\d+ ranks have nothing to do\)")
        self.assertIn("teams work 100 % of the time", said)

    def test_grids_it_does_not_take(self):
        for grid in ("32x24", "33x24x9", "32x24x10", "32x24x9x1", "0x24x9", "many"):
            with self.subTest(grid):
                said = self.shearwake("bench", "spectral", "--grid", grid, expect=2).said
                self.assertIn("256x192x25", said)


if __name__ == "__main__":
    unittest.main()
