# SPDX-License-Identifier: BSD-3-Clause
"""The engines give the same levels of sensation."""
import pytest

from program import ProgramTest, gaussian, job_text

TISSUE = {"density_kg_m3": 1000.0, "c_p_m_s": 50.0, "c_s_m_s": 5.0, "viscosity_Pa_s": 1.0}
LEVELS = {"load": {"peak_Pa": 125.0, "footprint": gaussian(9.0), "modulation": {"kind": "AM", "am_frequency_Hz": 200.0}},
          "domain": {"extent_mm": [72.0, 72.0], "spacing_mm": 3.0}, "time": {"duration_ms": 26.0, "output_interval_us": 250.0},
          "measure": {"at_ms": 25.0, "settled_after_ms": 10.0, "sensation": True}}
MEDIA = {"half-space": TISSUE, "rigid": {**TISSUE, "thickness_mm": 12.0}}


class EnginesAgree(ProgramTest):
    def largest_difference_dB(self, base, engines):
        """Of felt_peak_dB and felt_path_dB of the engines from the first one."""
        self.write_job(job_text(medium={"base": base, "layer": [MEDIA[base]]}, sweep={"solver.engine": engines}, **LEVELS))
        exact, *others = self.reduced(base, ranks=2)
        return max(abs(float(other[name]) - float(exact[name])) for other in others for name in ("felt_peak_dB", "felt_path_dB"))

    @pytest.mark.long
    def test_the_level_of_sensation_of_spectral_is_that_of_layered(self):
        for base in ("half-space", "rigid"):
            with self.subTest(base):
                # The accuracy of the step, 0.1 % of the field, is 0.009 dB.
                self.assertLess(self.largest_difference_dB(base, ["layered", "spectral"]), 0.009)

    @pytest.mark.long
    def test_the_level_of_sensation_of_pstd_differs_by_the_error_of_its_surface(self):
        # docs/explanation/engine-pstd.md: 0.44 dB at 3 points per FWHM
        self.assertLess(self.largest_difference_dB("half-space", ["layered", "pstd"]), 0.5)
