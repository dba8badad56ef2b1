# SPDX-License-Identifier: BSD-3-Clause
"""The trends in the figures of the thesis, computed with coarse versions of their jobs."""
import pytest

from program import ROOT, ProgramTest, changed, changed_job, swept, table

# Headings of figure 2.2 in docs/explanation/thesis.md: FWHM in mm, and the first of three rows.
BLOCKS = [(width, f"| FWHM {width} mm: dominant frequency of du_z/dt (Hz) |") for width in "26"]


def printed(first_row):
    """Five numbers of each of three rows: dominant frequency, shares of du_z/dt and of u_z."""
    lines = (ROOT / "docs" / "explanation" / "thesis.md").read_text(encoding="utf-8").splitlines()
    at = next(n for n, line in enumerate(lines) if line.startswith(first_row))
    return [[float(cell) for cell in line.split("|")[2:7]] for line in lines[at:at + 3]]


class ThesisTrends(ProgramTest):
    def frequency_sweep(self, job, key, frequencies):
        """The columns of a job on a coarser grid and with fewer cases."""
        key = f"load.modulation.{key}"
        self.write_job(changed_job(ROOT / "jobs" / job, swept(*frequencies, key=key), {"domain.spacing_mm": 1.2, "time.output_interval_us": 100.0}))
        rows = self.reduced("out", ranks=2)
        cases = {float(row[key]): row for row in rows if row["reference"] != "yes"}
        self.assertEqual(sorted(cases), frequencies)

        def column(name):
            return [float(cases[f][name]) for f in frequencies]
        return column("eta_period_over_reference_1"), column("focal_rms_over_reference_1")

    # All time windows are 10 ms long. The compared differences are 1 to 7 % on the fine grid, and this grid is in
    # error by 0.5 %.
    @pytest.mark.extended
    def test_speed_modulation_falls_monotonically_toward_plain_scanning(self):
        eta, strength = self.frequency_sweep("fig2.4.toml", "sm_frequency_Hz", [100, 200, 300, 400, 500, 600])
        self.assertEqual(eta, sorted(eta, reverse=True))
        self.assertGreater(eta[0], 1.15)
        self.assertAlmostEqual(eta[-1], 1.0, delta=0.01)
        for value in strength:  # the strength is preserved
            self.assertTrue(0.98 < value < 1.11, value)

    @pytest.mark.extended
    def test_amplitude_modulation_rises_and_falls_toward_plain_scanning(self):
        eta, strength = self.frequency_sweep("fig2.3.toml", "am_frequency_Hz", [100, 200, 300, 400, 500, 600, 800])
        self.assertEqual(eta[2:], sorted(eta[2:], reverse=True))  # from 300 Hz on
        self.assertLess(eta[0], eta[1])  # slow modulation resembles plain scanning
        self.assertGreater(eta[-1], 1.0)
        self.assertEqual(strength, sorted(strength, reverse=True))
        for value in strength:  # half the mean force preserves at most half of the strength
            self.assertTrue(0.5 < value < 0.62, value)

    # The grid is coarse: 2 points per FWHM of 2 mm, 3 per FWHM of 6 mm. Since the spectrum of a Gaussian decreases
    # rapidly, it reproduces the printed digits. The tolerance of 2 % is the rounding to 1 Hz of values from 34 Hz on.
    def test_what_the_manual_says_of_speed_and_size_comes_out(self):
        text = (ROOT / "jobs" / "fig2.2.toml").read_text(encoding="utf-8")
        self.write_job(changed(('"domain.spacing_mm" = [0.6, 1.5]', '"domain.spacing_mm" = [1.0, 2.0]'), text=text))
        self.reduced("out", ranks=2)
        found = {(row["load.footprint.fwhm_mm"], row["load.modulation.speed_m_s"]): row for row in table(self.folder / "out")}
        self.assertEqual(len(found), 10)
        for (width, first_row), band in zip(BLOCKS, ("100_1000", "100_500")):
            frequency, velocity, displacement = printed(first_row)
            rows = [found[width, speed] for speed in ("1", "3", "5", "7", "9")]
            peaks = [float(row["velocity_peak_frequency_Hz"]) for row in rows]
            self.assertEqual(peaks, sorted(peaks))  # increases with the speed
            for n, row in enumerate(rows):
                with self.subTest(fwhm_mm=width, speed_m_s=row["load.modulation.speed_m_s"]):
                    self.assertAlmostEqual(peaks[n], frequency[n], delta=0.02 * frequency[n])
                    for share, name in ((velocity[n], f"velocity_share_{band}_1"), (displacement[n], f"share_{band}_1")):
                        self.assertAlmostEqual(float(row[name]), share, delta=0.02, msg=name)
