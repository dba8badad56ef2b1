"""What the thesis' figures show, by coarse versions of the jobs that draw them."""
import re
import unittest

from program import ROOT, ProgramTest, table

# Where docs/thesis.md prints figure 2.2: FWHM in mm, and the first of three rows.
BLOCKS = [(width, f"| FWHM {width} mm: dominant frequency of du_z/dt (Hz) |") for width in "26"]
SWEEP = re.compile(r"\[sweep\]\n.*?\n\n", re.DOTALL)


def printed(first_row):
    """Five numbers of each of three rows: dominant frequency, shares of du_z/dt and of u_z."""
    lines = (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8").splitlines()
    at = next(n for n, line in enumerate(lines) if line.startswith(first_row))
    return [[float(cell) for cell in line.split("|")[2:7]] for line in lines[at:at + 3]]


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

    # A coarse grid: 2 points across a focus of 2 mm, 3 across one of 6. The spectrum of a Gaussian
    # ends early: what the manual prints comes out to its last digit. 2 %: whole Hz, from 34 up.
    def test_what_the_manual_says_of_speed_and_size_comes_out(self):
        text = (ROOT / "jobs" / "fig2.2.toml").read_text(encoding="utf-8")
        fine = '"domain.spacing_mm" = [0.6, 1.5]'
        self.assertIn(fine, text)
        self.write_job(text.replace(fine, '"domain.spacing_mm" = [1.0, 2.0]'))
        self.shearwake("run", "job.toml", "--out", "out", ranks=2)
        self.shearwake("reduce", "out")
        found = {(row["load.footprint.fwhm_mm"], row["load.modulation.speed_m_s"]): row
                 for row in table(self.folder / "out")}
        self.assertEqual(len(found), 10)
        for (width, first_row), band in zip(BLOCKS, ("100_1000", "100_500")):
            frequency, velocity, displacement = printed(first_row)
            rows = [found[width, speed] for speed in ("1", "3", "5", "7", "9")]
            peaks = [float(row["velocity_peak_frequency_Hz"]) for row in rows]
            self.assertEqual(peaks, sorted(peaks))  # it rises with the speed
            for n, row in enumerate(rows):
                with self.subTest(fwhm_mm=width, speed_m_s=row["load.modulation.speed_m_s"]):
                    self.assertAlmostEqual(peaks[n], frequency[n], delta=0.02 * frequency[n])
                    for share, name in ((velocity[n], f"velocity_share_{band}_1"),
                                        (displacement[n], f"share_{band}_1")):
                        self.assertAlmostEqual(float(row[name]), share, delta=0.02, msg=name)


if __name__ == "__main__":
    unittest.main()
