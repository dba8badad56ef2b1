# SPDX-License-Identifier: BSD-3-Clause
"""Engine pstd in the program: comparison with layered, invalid jobs, interrupted and resumed runs."""

import h5py
import numpy
import pytest
import xarray

from program import SWEEP, ProgramTest, case_files, table, without_reference
from test_checkpoint import SavedCase

PSTD = ('engine = "layered"', 'engine = "pstd"')
BOTH = without_reference(
    ('base = "rigid"', 'base = "half-space"'), ("thickness_mm = 20.0\n", ""),
    ("fwhm_mm = 4.5", "fwhm_mm = 6.0"),
    (SWEEP, SWEEP.replace("400, 500, ", "")
     + '\nzip = [ { "solver.engine" = ["layered", "pstd"], "medium.layer[1].c_p_m_s" = [50, 1500] } ]'))
SAVED = without_reference(
    (SWEEP, '"load.modulation.am_frequency_Hz" = [1250, 2500]'), PSTD,
    ("extent_mm = [64.0, 48.0]", "extent_mm = [36.0, 24.0]"),
    ("from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0]", "from_mm = [-8.0, 0.0], to_mm = [14.0, 0.0]"),
    ("traces_mm = [[0.0, 0.0], [3.2, 1.1]]", "traces_mm = [[0.0, 0.0]]"),
    ("duration_ms = 4.0", "duration_ms = 2.0"), ("frames = true", "frames = true\nvolumes_ms = [0.1, 1.5]"),
    ("at_ms = 4.0", "at_ms = 1.0"), ("settled_after_ms = 1.0", "settled_after_ms = 0.2"))


class Pstd(ProgramTest):
    @pytest.mark.long
    def test_a_sweep_compares_it_with_engine_layered(self):
        self.write_job(BOTH)
        said = self.shearwake("plan", "job.toml").said
        self.says(said, 'c_p of layer "tissue" is capped at 50 m/s, 10 times c_s',
                  "error of the surface field: 3.2 % for a focus",
                  "pstd uses steps of")
        self.shearwake("run", "job.toml", ranks=2)
        self.shearwake("reduce", self.out)
        exact, stepped = table(self.out)
        self.assertEqual([exact["solver.engine"], stepped["solver.engine"]], ["layered", "pstd"])
        for name in ("eta_period_1", "eta_at_1", "focal_rms_um", "peak_um"):
            with self.subTest(column=name):  # with 4 points per FWHM, the field is in error by 2 to 3 %
                self.assertLess(abs(float(stepped[name]) / float(exact[name]) - 1.0), 0.04)
        notes = []
        for path in case_files(self.out):
            with xarray.open_dataset(path, decode_timedelta=False) as case:
                notes.append(case.attrs.get("solver_notes", ""))
        self.assertEqual(sum("is capped at 50 m/s" in note for note in notes), 1, notes)

    def test_a_prescribed_displacement_is_reached(self):
        moved = PSTD[0], PSTD[1] + '\npstd = { load = "displacement", displacement_um = 4.0, top = "continued" }'
        self.write_job(without_reference(moved, (SWEEP, SWEEP.replace("400, 500, ", "")),
                                         ("duration_ms = 4.0", "duration_ms = 1.5"), ("at_ms = 4.0", "at_ms = 1.5"),
                                         ("settled_after_ms = 1.0", "settled_after_ms = 0.2")))
        self.shearwake("run", "job.toml")
        with h5py.File(case_files(self.out)[0]) as file:
            surface_m = file["surface/u_z"][()]
        # The AM of 1 kHz has its minimum at 1 ms and its maxima at 0.5 and 1.5 ms.
        self.assertAlmostEqual(surface_m[14].max(), 4e-6, delta=0.05 * 4e-6)  # 0.5 mm from a point
        self.assertLess(numpy.abs(surface_m).max(), 4.0001e-6)

    def test_unsupported_jobs_are_rejected(self):
        unstable = PSTD[0], PSTD[1] + "\npstd = { time_step_us = 50.0 }"
        self.write_job(without_reference(unstable, (SWEEP, SWEEP.replace("400, 500, ", ""))))
        for name in ("check", "run"):
            self.says(self.shearwake(name, "job.toml", expect=3).said,
                      "solver.pstd.time_step_us = 50 is unstable on this grid: steps above", "reduce the step or omit the key")


class PstdGoesOn(SavedCase):
    JOB = SAVED

    def test_a_case_killed_on_one_rank_is_resumed_bit_for_bit(self):
        self.kill_in_the_middle(ranks=1, saves=5)
        self.resume()
        self.assert_resumed(100)
        self.assertEqual(self.largest_difference(), 0.0)  # the same program on the same ranks

    @pytest.mark.long
    def test_a_case_killed_on_two_ranks_is_resumed_on_three(self):
        self.kill_in_the_middle(ranks=2, saves=5)
        self.resume(ranks=3)
        self.assert_resumed(100)
        self.assertLess(self.largest_difference(), 1e-12)  # sums over the ranks
