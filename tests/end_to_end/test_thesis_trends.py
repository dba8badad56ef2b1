"""What the thesis' figures show, by coarse versions of the jobs that draw them."""
import re
import unittest

from program import ROOT, ProgramTest, table

SWEEP = re.compile(r"\[sweep\]\n.*?\n\n", re.DOTALL)


def coarse(job, sweep):
    """The job's text on a coarser grid and with fewer cases."""
    text = (ROOT / "jobs" / job).read_text(encoding="utf-8")
    text, swept = SWEEP.subn(f"[sweep]\n{sweep}\n\n", text)
    text = text.replace("spacing_mm = 0.75", "spacing_mm = 1.2")
    text = text.replace("output_interval_us = 50.0", "output_interval_us = 100.0")
    assert swept == 1 and "spacing_mm = 1.2" in text and "us = 100.0" in text
    return text


class ThesisTrends(ProgramTest):
    def rows(self, job, sweep):
        self.write_job(coarse(job, sweep))
        self.shearwake("run", "job.toml", "--out", "out", ranks=2)
        self.shearwake("reduce", "out")
        return table(self.folder / "out")

    def frequency_sweep(self, job, key, frequencies):
        key = f"load.modulation.{key}"
        rows = self.rows(job, f'"{key}" = {frequencies}')
        cases = {float(row[key]): row for row in rows if row["reference"] != "yes"}
        self.assertEqual(sorted(cases), frequencies)

        def column(name):
            return [float(cases[f][name]) for f in frequencies]
        return column("eta_period_over_reference_1"), column("focal_rms_over_reference_1")

    # All windows are the same 10 ms. The steps that are compared are 1 to 7 % on the fine grid,
    # which this one follows to 0.5 %.
    def test_speed_modulation_falls_monotonically_toward_plain_scanning(self):
        eta, strength = self.frequency_sweep("fig2.4.toml", "sm_frequency_Hz",
                                             [100, 200, 300, 400, 500, 600])
        self.assertEqual(eta, sorted(eta, reverse=True))
        self.assertGreater(eta[0], 1.15)
        self.assertAlmostEqual(eta[-1], 1.0, delta=0.01)
        for value in strength:  # it keeps its strength
            self.assertTrue(0.98 < value < 1.11, value)

    def test_amplitude_modulation_rises_and_falls_toward_plain_scanning(self):
        eta, strength = self.frequency_sweep("fig2.3.toml", "am_frequency_Hz",
                                             [100, 200, 300, 400, 500, 600, 800])
        self.assertEqual(eta[2:], sorted(eta[2:], reverse=True))  # from 300 Hz up
        self.assertLess(eta[0], eta[1])  # a slow one is plain scanning at every instant
        self.assertGreater(eta[-1], 1.0)
        self.assertEqual(strength, sorted(strength, reverse=True))
        for value in strength:  # half of it at most is left of a force of half the mean
            self.assertTrue(0.5 < value < 0.62, value)

    def test_the_dominant_frequency_rises_with_the_speed(self):
        text = (ROOT / "jobs" / "fig2.2.toml").read_text(encoding="utf-8")
        small = '"load.footprint.fwhm_mm" = [2.0, 6.0], "domain.spacing_mm" = [0.6, 1.5]'
        self.assertIn(small, text)
        self.write_job(text.replace(
            small, '"load.footprint.fwhm_mm" = [6.0], "domain.spacing_mm" = [2.0]'))
        self.shearwake("run", "job.toml", "--out", "out", ranks=2)
        self.shearwake("reduce", "out")
        found = {float(row["load.modulation.speed_m_s"]): float(row["velocity_peak_frequency_Hz"])
                 for row in table(self.folder / "out")}
        by_speed = [found[speed] for speed in sorted(found)]
        self.assertEqual(len(by_speed), 5)
        self.assertEqual(by_speed, sorted(by_speed))


if __name__ == "__main__":
    unittest.main()
