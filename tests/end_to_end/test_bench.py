# SPDX-License-Identifier: BSD-3-Clause
"""The output of `bench`, and the rates that `plan` and `run` measure."""
import json
import math
import os
from unittest import mock

import pytest

from program import AM, ProgramTest, read_by, swept, without_reference


def brief_job(*engines):
    return without_reference(read_by(0.4, settled_ms=0.0), {"sweep": {AM: [400], "solver.engine": list(engines)}})


class Bench(ProgramTest):
    def planned(self, *words):
        return json.loads(self.shearwake("plan", *words, "--json").stdout)

    def measured(self, *arguments, ranks=1):
        """The document of a benchmark. Speeds are not asserted, since they depend on the machine."""
        return json.loads(self.shearwake("bench", *arguments, "--json", ranks=ranks).stdout)

    @pytest.mark.extended
    def test_each_engine_is_measured_next_to_its_ffts(self):
        for ranks, engine, grid, names in ((2, "spectral", "32x24x9", ["no body", "contrast 4", "contrast 16", "contrast 1000", "rigid cylinder"]),
                                           (1, "pstd", "16x12x10", ["lossless, double", "lossless, single", "lossy, double", "lossy, single"])):
            with self.subTest(engine):
                found = self.measured(engine, "--grid", grid, ranks=ranks)
                self.assertEqual((found["name"], found["ranks"]), (engine, ranks))
                self.assertEqual([m["name"].partition("s, ")[2] for m in found["measurements"]], names)
                for m in found["measurements"]:
                    points = math.prod(map(int, grid.split("x")))
                    self.assertAlmostEqual(m["points_per_s"] * m["time_s"], points, delta=1e-6 * points)
                    if "rigid" not in m["name"]:
                        self.assertEqual(m["fft_s"] > 0.0, "no body" not in m["name"])
                self.assertGreater(found["copies_B_per_s"], 0.0)
        self.contains(self.shearwake("bench", "pstd", "--grid", "16x12x10").stdout, "engine pstd, 1 rank, kernels", "s per step",
                      "16 x 12 x 10 points, lossy, single")

    @pytest.mark.long
    def test_layered_is_measured_with_periodic_and_open_edges_and_in_the_periodic_regime(self):
        found = self.measured("layered")["measurements"]
        self.assertEqual([m["name"] for m in found], ["256 x 192 x 280 frames, periodic edges", "256 x 192 x 280 frames, open edges",
                                                      "256 x 192 x 128 frames, periodic regime"])
        self.assertGreater(min(m["fft_s"] for m in found), 0.0)

    @pytest.mark.extended
    def test_grids_are_rounded_up_to_lengths_with_fast_ffts(self):
        found = self.measured("spectral", "--grid", "33x22x16")["measurements"]
        self.assertEqual(found[0]["name"], "36 x 24 x 17 levels, no body")
        for grid in ("32x24", "32x24x9x1", "0x24x9", "many"):
            with self.subTest(grid):
                self.contains(self.shearwake("bench", "spectral", "--grid", grid, expect=2).output, "--grid")

    def test_a_run_records_one_rate_per_engine_with_which_plan_estimates_its_time(self):
        self.write_job(brief_job("layered", "pstd", "spectral"))
        cache = self.folder / "cache"
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            before = self.shearwake("plan", "job.toml")
            self.assertEqual(before.output.count("time: not known on this machine yet"), 1)
            self.assertNotIn("core hours", before.output)
            unknown = self.planned("job.toml")
            self.assertEqual({unknown[name] for name in ("wall_s", "core_hours", "longest_case_s")}, {None})
            self.assertEqual({case["seconds"] for case in unknown["cases"]}, {None})
            self.shearwake("run", "job.toml", "--quiet", "--only", unknown["cases"][0]["id"])
            partly = self.planned("job.toml")  # one of three engines
            self.assertIsNone(partly["wall_s"])
            self.assertEqual([case["seconds"] is None for case in partly["cases"]], [False, True, True])
            self.shearwake("run", "job.toml", "--quiet", ranks=2)
            (file,) = cache.glob("rates-*.json")
            self.assertEqual(set(json.loads(file.read_text(encoding="utf-8"))["rates"]), {"layered", "pstd", "spectral"})
            known = self.planned("job.toml")
            self.assertGreater(known["wall_s"], sum(case["seconds"] for case in known["cases"]))  # by the start of the program
            output = self.shearwake("plan", "job.toml").output
            self.contains(output, "core hours", "longest case")
            self.assertNotIn("not known", output)
            on_two = self.planned("job.toml", "-n", 2, "--ranks-per-case", 2)
            for case, other in zip(known["cases"], on_two["cases"], strict=True):
                self.assertAlmostEqual(case["seconds"], 2 * other["seconds"])
            file.write_text(file.read_text(encoding="utf-8")[:100], encoding="utf-8")
            self.assertIn("time: not known on this machine yet", self.shearwake("plan", "job.toml").output)

    @pytest.mark.extended
    def test_the_size_of_the_teams_does_not_depend_on_recorded_rates(self):
        self.write_job()
        cache = self.folder / "cache"
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            names = ("teams", "ranks_per_case")
            before = [self.planned("job.toml", "-n", ranks) for ranks in (3, 4, 8)]
            self.shearwake("run", "job.toml", "--quiet")
            (file,) = cache.glob("rates-*.json")
            slow = json.loads(file.read_text(encoding="utf-8"))
            slow["rates"] = {engine: 1e6 * rate for engine, rate in slow["rates"].items()}
            file.write_text(json.dumps(slow), encoding="utf-8")
            after = [self.planned("job.toml", "-n", ranks) for ranks in (3, 4, 8)]
        self.assertGreater(after[0]["wall_s"], 1e4)
        self.assertEqual(*([[plan[name] for name in names] for plan in plans] for plans in (before, after)))

    @pytest.mark.long
    def test_fftw_plans_are_measured_once_regardless_of_earlier_engines(self):
        cache = self.folder / "cache"

        def plans():
            return {file.name: file.read_bytes() for file in cache.glob("fftw-*-staggered-*")}
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            self.write_job(brief_job("pstd"))
            self.shearwake("run", "job.toml", "--quiet", "--out", "pstd")
            first = plans()
            self.assertTrue(first)
            # The layered case uses the MPI part of FFTW, which takes part in the search for plans from then on.
            self.write_job(brief_job("layered", "pstd"))
            self.shearwake("run", "job.toml", "--quiet", "--out", "both")
        self.assertEqual({name: text for name, text in plans().items() if name in first}, first)

    @pytest.mark.extended
    def test_a_plan_has_no_more_teams_than_cases(self):
        self.write_job(without_reference(swept(400)))
        output = self.shearwake("plan", "job.toml", "-n", 4096).output
        self.assertRegex(output, r"1 case on 4096 ranks \(1 team of \d+, \d+ ranks stay idle\)")
