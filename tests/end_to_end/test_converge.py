# SPDX-License-Identifier: BSD-3-Clause
"""shearwake converge: estimated errors compared with much finer runs, resuming, error columns."""
import csv
import json
import unittest

from program import SWEEP, ProgramTest, case_files, started, without_reference

# Coarse in space and small in extent, so that all errors are large enough to be measured.
COARSE = without_reference(
    ("spacing_mm = 1.5", "spacing_mm = 2.0"), ("extent_mm = [64.0, 48.0]", "extent_mm = [56.0, 40.0]"),
    ("frames = true", ""), (SWEEP, SWEEP.replace("400, 500, 1000", "500, 1000")))
SPECTRAL = ('engine = "layered"', 'engine = "spectral"\nspectral = { time_step_us = 100.0 }')
COLUMNS = ("eta_period_1", "focal_rms_um", "eta_at_1")


def rows(folder, name="small"):
    with open(folder / "tables" / f"{name}.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Converge(ProgramTest):
    def studied(self):
        return json.loads((self.out / "converge" / "converge.json").read_text(encoding="utf-8"))["cases"]

    def test_the_estimates_cover_the_difference_from_a_much_finer_run(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml")
        said = self.shearwake("converge", "job.toml", "--cases", "1", ranks=2).said
        self.says(said, "half the spacing, 1 mm", "twice the domain", "estimated error")
        [case] = self.studied()
        self.assertTrue(case["complete"])
        self.assertEqual([r["name"] for r in case["refinements"]], ["spacing", "time", "domain"])
        self.shearwake("run", "job.toml", "--out", "fine", "-S", "domain.spacing_mm=0.5",
                       "-S", "domain.extent_mm=[168.0, 120.0]", "-S", "time.output_interval_us=25",
                       "-S", 'sweep."load.modulation.am_frequency_Hz"=[500]')
        self.shearwake("reduce", "fine")
        [finest] = rows(self.folder / "fine")
        for column in COLUMNS:
            with self.subTest(column=column):
                entry = case["columns"][column]
                error = abs(entry["value"] - float(finest[column]))
                # The sum of three magnitudes is an upper estimate, since changes may cancel; what remains after
                # the refinement is at most half of the change. 10 times would be of no use.
                self.assertLess(error, 1.5 * entry["error"])
                self.assertGreater(error, 0.1 * entry["error"])
        self.assertNotIn("ipr_at_1", case["columns"])  # counts samples

    def test_richardson_predicts_the_error_of_the_time_step(self):
        self.write_job(without_reference(SPECTRAL, ("frames = true", ""),
                                         (SWEEP, SWEEP.replace("400, 500, 1000", "400"))))
        self.shearwake("converge", "job.toml", "--quiet")
        [case] = self.studied()
        time = case["refinements"][1]
        self.assertEqual((time["name"], time["order"], time["ratio"]), ("time", 2.0, 2.0))
        # The same frames with a sixteenth of the step: its error is below 1 % of that of the base.
        self.shearwake("run", "job.toml", "--out", "fine", "-S", "solver.spectral.time_step_us=6.25",
                       "-S", "time.output_interval_us=50")
        self.shearwake("reduce", "fine")
        [finest] = rows(self.folder / "fine")
        for column in ("focal_rms_um", "eta_at_1"):
            with self.subTest(column=column):
                entry = case["columns"][column]
                estimate = abs(entry["changes"]["time"]) * 4 / 3
                error = abs(entry["value"] - float(finest[column]))
                # Terms of fourth order: a quarter of the estimate at this large step.
                self.assertAlmostEqual(error / estimate, 1.0, delta=0.25)

    def test_it_reuses_the_cases_of_the_sweep_and_of_an_earlier_study(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml", "--quiet")
        self.shearwake("converge", "job.toml", "--cases", "1", "--quiet")
        study = self.out / "converge"
        self.assertEqual(len(case_files(study)), 4)
        self.assertEqual(len(started(study)), 3)  # the unrefined case was copied
        self.says(self.shearwake("converge", "job.toml", "--cases", "1").said, "0 computed now, 4 already complete")
        case_files(study)[0].unlink()
        self.says(self.shearwake("converge", "job.toml", "--cases", "1").said, "4 cases: ", "3 already complete")
        # Another selection adds cases.
        self.shearwake("converge", "job.toml", "--cases", "2", "--quiet")
        self.assertEqual(len(case_files(study)), 8)
        self.assertEqual(len(self.studied()), 2)
        # `run` accepts the folder with its study.
        self.says(self.shearwake("run", "job.toml").said, "2 already complete")

    def test_reduce_adds_error_columns_on_request(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml", "--quiet")
        self.says(self.shearwake("reduce", "--errors", self.out, expect=2).said,
                  "has no estimates of the numerical error: run shearwake converge")
        said = self.shearwake("converge", "job.toml", "--cases", "1").said
        self.assertRegex(said, r"columns without an estimate, which are empty or count samples: .*ipr_at_1")
        self.shearwake("reduce", self.out)
        self.assertNotIn("eta_at_1_error", rows(self.out)[0])
        self.shearwake("reduce", "--errors", self.out)
        first, second = rows(self.out)
        [case] = self.studied()
        self.assertAlmostEqual(float(first["eta_at_1_error"]), case["columns"]["eta_at_1"]["error"], delta=1e-8)
        self.assertEqual(second["eta_at_1_error"], "")
        self.assertNotIn("ipr_at_1_error", first)
        # Other commands that rewrite the table keep its columns; `reduce` without the option removes them.
        self.shearwake("compare", self.out, self.out)
        self.assertEqual(rows(self.out), [first, second])
        table = json.loads((self.out / "tables" / "small.json").read_text(encoding="utf-8"))
        self.assertIn("estimated numerical error of eta_at_1", [c["meaning"] for c in table["columns"]])

    def test_unknown_cases_are_rejected(self):
        self.write_job(COARSE)
        self.says(self.shearwake("converge", "job.toml", "--only", "abc", expect=2).said, "--only abc: no such case")


if __name__ == "__main__":
    unittest.main()
