# SPDX-License-Identifier: BSD-3-Clause
"""The output of `bench`. Speeds are not asserted, since they depend on the machine."""
import json
import os
import re
import signal
import unittest
from unittest import mock

import pytest

from program import PATIENCE_s, SWEEP, ProgramTest, case_files, changed, without_reference

SMALL = ("bench", "spectral", "--grid", "32x24x9", "--steps", 2)
BRIEF = (("duration_ms = 4.0", "duration_ms = 0.4"), ("at_ms = 4.0", "at_ms = 0.4"), ("settled_after_ms = 1.0", "settled_after_ms = 0.0"))
PHASES = ["FFTs", "solves over depth", "strain/force transfer", "stresses, iteration", "sponge", "other"]


class Bench(ProgramTest):
    def row(self, said, name):
        """The numbers after a name: share, seconds, MB, GB/s."""
        found = re.search(rf"^    {re.escape(name)} +([0-9. ]+)$", said, re.MULTILINE)
        self.assertIsNotNone(found, f"no {name} in\n{said}")
        return [float(word) for word in found.group(1).split()]

    def number(self, said, name, field):
        line = next(line for line in said.splitlines() if line.strip().startswith(name))
        return float(re.findall(r"[0-9]+\.[0-9]+", line)[field])

    def planned(self, *words):
        return json.loads(self.shearwake("plan", *words, "--json").stdout)

    def rates(self, cache, ranks=1):
        """What was measured on this number of ranks."""
        (file,) = cache.glob(f"rates-*-{ranks}.json")
        return json.loads(file.read_text(encoding="utf-8"))["rates"]

    @pytest.mark.long
    def test_spectral_prints_the_share_of_each_phase(self):
        for ranks, contrast in ((1, 16), (3, 4)):
            with self.subTest(ranks=ranks, contrast=contrast):
                said = self.shearwake(*SMALL, "--contrast", contrast, ranks=ranks).stdout
                self.assertIn(f"engine spectral, {ranks} rank", said)
                self.assertIn("32 x 24 points x 9 levels, 2 steps", said)
                shares = [self.row(said, name)[0] for name in PHASES]
                self.assertAlmostEqual(sum(shares), 1.0, delta=0.003)  # six shares, each rounded to 0.0005
                for name in PHASES[:4]:
                    self.assertGreater(self.row(said, name)[2], 0.0)  # MB moved
                self.assertIn("lower bound: FFTs of planes", said)
                self.assertIn("lower bound: FFTs of rows", said)
                self.assertGreater(self.number(said, "peak memory per rank", 0), 0.0)

    def test_contrast_requires_iterations(self):
        counts = [self.number(self.shearwake(*SMALL, "--contrast", contrast).stdout, "iterations per step", 0)
                  for contrast in (1, 100)]
        self.assertEqual(counts[0], 0.0)
        self.assertGreater(counts[1], 0.0)

    def test_a_sponge_has_a_share_of_the_time(self):
        said = self.shearwake("bench", "spectral", "--grid", "32x24x9", "--steps", 12, "--contrast", 1, "--sponge", 4).stdout
        self.assertIn("sponge of 4 mm", said)
        self.assertGreater(self.row(said, "sponge")[1], 0.0)
        self.assertEqual(self.row(self.shearwake(*SMALL, "--contrast", 1).stdout, "sponge")[1], 0.0)

    def test_without_a_body_nothing_is_transformed(self):
        said = self.shearwake(*SMALL, "--contrast", 1).stdout
        self.assertEqual(self.row(said, "FFTs")[2], 0.0)
        self.assertIn("none", said)

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

    def test_invalid_grids_are_rejected(self):
        for grid in ("32x24", "33x24x9", "32x24x10", "32x24x9x1", "0x24x9", "many"):
            with self.subTest(grid):
                said = self.shearwake("bench", "spectral", "--grid", grid, expect=2).said
                self.assertIn("256x192x25", said)


if __name__ == "__main__":
    unittest.main()
