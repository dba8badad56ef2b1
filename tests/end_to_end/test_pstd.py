# SPDX-License-Identifier: BSD-3-Clause
"""Engine pstd in the program: a prescribed displacement, interrupted and resumed runs."""

import h5py
import numpy
import pytest

from program import PSTD, SWEEP, ProgramTest, case_files, changed, read_by, swept, without_reference
from test_checkpoint import SavedCase

SAVED = changed(
    (SWEEP, '"load.modulation.am_frequency_Hz" = [1250, 2500]'), ('reference = { kind = "STM" }\n', ""), ('engine = "layered"', 'engine = "pstd"'),
    ("extent_mm = [64.0, 48.0]", "extent_mm = [36.0, 24.0]"),
    ("from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0]", "from_mm = [-8.0, 0.0], to_mm = [14.0, 0.0]"),
    ("traces_mm = [[0.0, 0.0], [3.2, 1.1]]", "traces_mm = [[0.0, 0.0]]"),
    ("duration_ms = 4.0", "duration_ms = 2.0"), ("frames = true", "frames = true\nvolumes_ms = [0.1, 1.5]"),
    ("at_ms = 4.0", "at_ms = 1.0"), ("settled_after_ms = 1.0", "settled_after_ms = 0.2"))


class Pstd(ProgramTest):
    def test_a_prescribed_displacement_is_reached(self):
        moved = {"solver.pstd": {"load": "displacement", "displacement_um": 4.0, "top": "continued"}}
        self.write_job(without_reference(PSTD, moved, swept(1000), read_by(1.5, settled_ms=0.2)))
        self.shearwake("run", "job.toml")
        with h5py.File(case_files(self.out)[0]) as file:
            surface_m = file["surface/u_z"][()]
        # The AM of 1 kHz has its minimum at 1 ms and its maxima at 0.5 and 1.5 ms.
        self.assertAlmostEqual(surface_m[14].max(), 4e-6, delta=0.05 * 4e-6)  # 0.5 mm from a point
        self.assertLess(numpy.abs(surface_m).max(), 4.0001e-6)


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
