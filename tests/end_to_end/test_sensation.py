# SPDX-License-Identifier: BSD-3-Clause
"""Levels of sensation of short runs, and their search with adaptive axes."""

import pytest
from program import AM, ProgramTest, changed_job, gaussian, job_text, swept

AT_REST = {"medium": {"base": "rigid", "layer": [{"preset": "palm"}]},
           "load": {"peak_Pa": 125.0, "footprint": gaussian(8.5), "modulation": {"kind": "AM", "am_frequency_Hz": 200.0}},
           "domain": {"extent_mm": [96.0, 96.0], "spacing_mm": 2.0, "edges": "open"}}
PERIODIC = job_text(**AT_REST, time={"regime": "periodic", "output_interval_us": 250.0})
SHORT = job_text(**AT_REST, time={"duration_ms": 14.0, "output_interval_us": 50.0}, measure={"sensation": True})


def felt(row):
    return {name: text for name, text in row.items() if name.startswith("felt_")}


class Levels(ProgramTest):
    def rows(self, job, out):
        self.write_job(job)
        return self.reduced(out, ranks=2)

    def test_a_window_of_whole_periods_has_the_level_of_the_steady_state(self):
        steady, short = (self.rows(changed_job(job, swept(100, 200, 400)), out) for job, out in ((PERIODIC, "steady"), (SHORT, "short")))
        for exact, window in zip(steady, short, strict=True):
            self.assertEqual(window["felt_band_Hz"], exact["felt_band_Hz"])
            # The skin has settled for 3.5 ms only: what is left of the beginning is up to a fifth of the amplitude.
            self.assertAlmostEqual(float(window["felt_peak_dB"]), float(exact["felt_peak_dB"]), delta=1.5)

    def test_a_window_that_is_too_short_has_no_level_and_check_warns(self):
        job = self.write_job(changed_job(SHORT, swept(50, 60)))
        self.contains(self.shearwake("check", "job.toml").output, "measure.sensation: the columns felt_* will be empty: AM at 50 Hz needs 20 ms")
        for row, frequency_Hz in zip(self.reduced("short", job=job, ranks=2), (50, 60), strict=True):
            self.assertEqual(len(felt(row)), 13)
            self.assertEqual(set(felt(row).values()), {""})
            self.assertIn(f"AM at {frequency_Hz} Hz needs", row["note"])

    def test_the_table_of_lm_and_am_states_where_the_model_fails(self):
        keys = {"load.modulation.lm_frequency_Hz": 200.0, "load.modulation.lm_amplitude_mm": 3.0}
        for kinds, states in ((["AM", "LM"], True), (["LM"], False)):
            self.rows(changed_job(PERIODIC, keys, swept(*kinds, key="load.modulation.kind")), f"{states}")
            text = next((self.folder / f"{states}" / "tables").glob("*.md")).read_text(encoding="utf-8")
            self.assertEqual("the model fails" in text.lower() and "user-studies" in text, states, text)

    @pytest.mark.extended
    def test_the_most_sensitive_frequency_is_found_between_the_centres_of_bands(self):
        search = {"find": "maximum", "in": [120, 350], "column": "felt_peak_dB", "tolerance": 1.0}
        best, found = (max(self.rows(changed_job(PERIODIC, {"sweep": {AM: axis}}), out), key=lambda row: float(row["felt_peak_dB"]))
                       for axis, out in (({"linspace": [120, 350, 116]}, "fine"), (search, "found")))
        # The spacing of the fine scan, and the tolerance of the search.
        self.assertAlmostEqual(float(found[AM]), float(best[AM]), delta=2.0 + 1.0)
        self.assertGreaterEqual(float(found["felt_peak_dB"]), float(best["felt_peak_dB"]) - 0.01)
