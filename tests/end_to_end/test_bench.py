# SPDX-License-Identifier: BSD-3-Clause
"""The output of `bench`, and the rates that `plan` and `run` measure."""
import json
import math
import os
import signal
import unittest
from unittest import mock

import pytest

from program import PATIENCE_s, SWEEP, ProgramTest, case_files, changed, without_reference

BRIEF = (("duration_ms = 4.0", "duration_ms = 0.4"), ("at_ms = 4.0", "at_ms = 0.4"), ("settled_after_ms = 1.0", "settled_after_ms = 0.0"))


class Bench(ProgramTest):
    def planned(self, *words):
        return json.loads(self.shearwake("plan", *words, "--json").stdout)

    def rates(self, cache, ranks=1):
        """What was measured on this number of ranks."""
        (file,) = cache.glob(f"rates-*-{ranks}.json")
        return json.loads(file.read_text(encoding="utf-8"))["rates"]

    def measured(self, *arguments, ranks=1):
        """The document of a benchmark. Speeds are not asserted, since they depend on the machine."""
        return json.loads(self.shearwake("bench", *arguments, "--json", ranks=ranks).stdout)

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
        self.says(self.shearwake("bench", "pstd", "--grid", "16x12x10").stdout, "engine pstd, 1 rank, kernels", "s per step",
                  "16 x 12 x 10 points, lossy, single")

    @pytest.mark.long
    def test_layered_is_measured_with_periodic_and_open_edges_and_in_the_periodic_regime(self):
        found = self.measured("layered")["measurements"]
        self.assertEqual([m["name"] for m in found], ["256 x 192 x 280 frames, periodic edges", "256 x 192 x 280 frames, open edges",
                                                      "256 x 192 x 128 frames, periodic regime"])
        self.assertGreater(min(m["fft_s"] for m in found), 0.0)

    def test_grids_are_rounded_up_to_lengths_with_fast_ffts(self):
        found = self.measured("spectral", "--grid", "33x22x16")["measurements"]
        self.assertEqual(found[0]["name"], "36 x 24 x 17 levels, no body")
        for grid in ("32x24", "32x24x9x1", "0x24x9", "many"):
            with self.subTest(grid):
                self.says(self.shearwake("bench", "spectral", "--grid", grid, expect=2).said, "--grid")

    def test_a_run_measures_missing_rates_and_records_those_of_its_cases(self):
        self.write_job()
        cache = self.folder / "cache"
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            before = self.shearwake("plan", "job.toml").said
            self.assertIn("time: unknown: run `plan --probe`", before)
            self.assertNotIn("core hours", before)
            self.assertEqual(self.planned("job.toml")["wall_s"], None)
            probed = self.shearwake("plan", "job.toml", "--probe").said
            self.assertIn("measuring the speed of 1 kind of case (layered), for at most 2 s each after its setup", probed)
            self.assertIn("time: probed on this machine", probed)
            self.assertNotIn("measuring", self.shearwake("plan", "job.toml", "--probe").said)
            self.assertEqual([rate["is_probed"] for rate in self.rates(cache) if rate["kind"] == "files"], [True])
            first = self.shearwake("run", "job.toml").said
            self.assertNotIn("measuring", first)
            measured = self.shearwake("plan", "job.toml").said
            self.assertIn("time: measured on this machine", measured)
            self.assertIn("core hours", measured)
            (file,) = cache.glob("rates-*-1.json")
            rates = self.rates(cache)
            self.assertLess({"layered frames", "files"}, {rate["kind"] for rate in rates if not rate["is_probed"]})
            self.assertFalse([rate for rate in rates if rate["kind"].startswith(("spectral", "pstd"))], rates)
            file.write_text(file.read_text(encoding="utf-8")[:100], encoding="utf-8")
            self.assertIn("measuring", self.shearwake("run", "job.toml", "--out", "again").said)

    def test_every_engine_is_probed_and_measured(self):
        body = ("[load]", '[[medium.body]]\nname = "b"\nshape = "ellipsoid"\nsemi_axes_mm = [6.0, 6.0, 2.0]\n'
                'center_mm = [0.0, 0.0]\ndepth_mm = 4.0\nc_s_m_s = 9.0\n\n[load]')
        for engine, changes in (("spectral", (body,)), ("pstd", ())):
            with self.subTest(engine):
                self.write_job(without_reference((SWEEP, '"load.modulation.am_frequency_Hz" = [400]'), *changes))
                words = ("job.toml", "-S", f"solver.engine={engine}")
                with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / engine)}):
                    probed = self.planned(*words, "--probe")
                    self.assertEqual(probed["time_origin"], "probed")
                    self.assertGreater(probed["wall_s"], probed["longest_case_s"])  # by the start of the program
                    self.shearwake("run", *words, "--quiet", "--out", engine + "-out")
                    self.assertEqual(self.planned(*words)["time_origin"], "measured")

    def test_the_rates_of_all_cases_of_a_short_run_are_recorded(self):
        self.write_job(without_reference((SWEEP, '"load.modulation.am_frequency_Hz" = [400]\n'
                                                  '"solver.engine" = ["layered", "pstd", "spectral"]'), *BRIEF))
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / "cache")}):
            self.shearwake("run", "job.toml", "--quiet", ranks=2)
            self.assertEqual({case["time_origin"] for case in self.planned("job.toml", "-n", 2)["cases"]}, {"measured"})

    def test_a_signal_ends_the_probes_of_a_run(self):
        # Far more steps than are computed before the signal arrives.
        self.write_job(changed(("frames = true", ""), ("duration_ms = 4.0", "duration_ms = 4000.0")))
        cache = self.folder / "cache"
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            process = self.start("run", "job.toml", "-S", "solver.engine=pstd", "--force")
            for line in process.stdout:
                if "measuring the speed" in line:
                    break
            process.send_signal(signal.SIGTERM)
            said = process.communicate(timeout=PATIENCE_s)[0]
        self.assertEqual(process.returncode, 75, said)
        self.assertEqual(case_files(self.out), [])

    @pytest.mark.long
    def test_fftw_plans_are_measured_once_regardless_of_earlier_engines(self):
        cache = self.folder / "cache"

        def write(engines):
            self.write_job(without_reference(
                (SWEEP, f'"load.modulation.am_frequency_Hz" = [400]\n"solver.engine" = {engines}'), *BRIEF))

        def plans():
            return {file.name: file.read_bytes() for file in cache.glob("fftw-*-staggered-*")}
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(cache)}):
            write('["pstd"]')
            self.shearwake("run", "job.toml", "--quiet", "--out", "pstd")
            first = plans()
            self.assertTrue(first)
            # The layered case uses the MPI part of FFTW, which takes part in the search for plans from then on.
            write('["layered", "pstd"]')
            self.shearwake("run", "job.toml", "--quiet", "--out", "both")
        self.assertEqual({name: text for name, text in plans().items() if name in first}, first)

    def test_a_plan_for_other_ranks_uses_the_rates_of_this_processor(self):
        self.write_job()
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / "cache")}):
            self.shearwake("run", "job.toml", "--quiet")
            said = self.shearwake("plan", "job.toml", "-n", 2).said
        self.says(said, "core hours", "time: measured on this machine")

    @pytest.mark.long
    def test_without_a_cache_no_rates_are_saved(self):
        self.write_job()
        for place in ("off", "/proc/nowhere"):
            with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": place}):
                for _ in range(2):
                    self.assertIn("measuring", self.shearwake("plan", "job.toml", "--probe").said)

    def test_a_plan_has_no_more_teams_than_cases(self):
        self.write_job(without_reference((SWEEP, '"load.modulation.am_frequency_Hz" = [400]')))
        said = self.shearwake("plan", "job.toml", "-n", 4096).said
        self.assertRegex(said, r"1 case on 4096 ranks \(1 team of \d+, \d+ ranks stay idle\)")


if __name__ == "__main__":
    unittest.main()
