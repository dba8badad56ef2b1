# SPDX-License-Identifier: BSD-3-Clause
"""shearwake converge: estimated errors compared with much finer runs, resuming, error columns."""
import fcntl
import json

import pytest

from program import (HALF_SPACE, NO_FRAMES, NO_REFERENCE, ONE_CASE, OPEN, PERIODIC, ROOT, SPECTRAL, ProgramTest, case_files,
                     changed_job, read_csv, small_job, started, swept, without_reference)

from shearwake.studies import converge

# Coarse in space and small in extent, so that all errors are large enough to be measured.
SMALL = {"domain.extent_mm": [56.0, 40.0]}
WITH_REFERENCE = small_job(SMALL, {"domain.spacing_mm": 2.0}, NO_FRAMES, swept(500, 1000))
COARSE = changed_job(WITH_REFERENCE, NO_REFERENCE)
LONG_STEPS = without_reference(SPECTRAL, {"solver.spectral.time_step_us": 100.0}, NO_FRAMES, swept(400))
# Small jobs whose spacing of 1.5 mm is a third of the FWHM.
ONE = small_job(ONE_CASE, NO_FRAMES)
CIRCLE = changed_job(ONE, PERIODIC, OPEN, {"domain.extent_mm": [80.0, 80.0], "load.modulation": {
    "kind": "STM", "path": {"shape": "circle", "radius_mm": 6.0}, "draw_frequency_Hz": 100.0}})
ENDLESS = changed_job(ONE, HALF_SPACE, OPEN, {"domain.extent_mm": [72.0, 48.0]})
AROUND_PATH = changed_job(ONE, {"measure.region_mm": "path", "domain.extent_mm": [96.0, 72.0]})
BRACKETED = ("eta_period_1", "eta_at_1", "focal_rms_um", "participation_period_mm2", "ipr_abs_period_mm2", "sharpness_1")
COLUMNS = ("eta_period_1", "focal_rms_um", "eta_at_1")


def rows(folder, name="small"):
    return read_csv(folder / "tables" / f"{name}.csv")


# Of the earlier implementation in C++.
FROZEN = {"coarse": (COARSE, "1"), "half": (ENDLESS, "1"), "spectral": (LONG_STEPS, "1"), "reference": (WITH_REFERENCE, "2")}


class Converge(ProgramTest):
    def studied(self):
        return json.loads((self.out / "converge" / "converge.json").read_text(encoding="utf-8"))["cases"]

    @pytest.mark.extended
    def test_the_documents_equal_the_frozen_ones(self):
        frozen = json.loads((ROOT / "tests" / "data" / "studies" / "converge.json").read_text(encoding="utf-8"))
        for name, (job, cases) in FROZEN.items():
            self.write_job(job)
            self.shearwake("converge", "job.toml", "--out", name, "--cases", cases, "--quiet")
            found = json.loads((self.folder / name / "converge" / "converge.json").read_text(encoding="utf-8"))["cases"]
            for case, expected in zip(found, frozen[name], strict=True):
                columns = case.pop("columns")
                self.assertEqual(list(columns), list(expected["columns"]))
                for column, entry in expected.pop("columns").items():
                    with self.subTest(job=name, case=case["id"], column=column):
                        # Kernels of other processors add in another order.
                        delta = 1e-9 * max(abs(entry["value"]), 1.0)
                        self.assertAlmostEqual(columns[column]["value"], entry["value"], delta=delta)
                        self.assertEqual(list(columns[column]["changes"]), list(entry["changes"]))
                        for refinement, change in entry["changes"].items():
                            self.assertAlmostEqual(columns[column]["changes"][refinement], change, delta=delta)
                        self.assertAlmostEqual(columns[column]["error"], entry["error"], delta=5.0 * delta)
                self.assertEqual(case, expected)

    def test_the_function_returns_the_estimates_and_reports_progress(self):
        path, reports = self.write_job(COARSE), []
        [case] = converge(path, out=self.folder / "out", cases=1, progress=reports.append)
        self.assertEqual([refinement.name for refinement in case.refinements], ["spacing", "time", "domain"])
        self.assertEqual((reports[-1].done, reports[-1].total), (4, 4))
        document = json.loads((self.folder / "out" / "converge" / "converge.json").read_text(encoding="utf-8"))
        self.assertEqual(document["cases"][0]["columns"]["eta_at_1"]["error"], case.columns["eta_at_1"].error)

    @pytest.mark.extended
    def test_the_estimates_cover_the_difference_from_a_much_finer_run(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml")
        output = self.shearwake("converge", "job.toml", "--cases", "1", ranks=2).output
        self.contains(output, "half the spacing, 1 mm", "twice the domain", "estimated error")
        [case] = self.studied()
        self.assertTrue(case["complete"])
        self.assertEqual([r["name"] for r in case["refinements"]], ["spacing", "time", "domain"])
        [finest] = self.reduced("fine", "-S", "domain.spacing_mm=0.5", "-S", "domain.extent_mm=[168.0, 120.0]",
                                "-S", "time.output_interval_us=25", "-S", 'sweep."load.modulation.am_frequency_Hz"=[500]')
        for column in COLUMNS:
            with self.subTest(column=column):
                entry = case["columns"][column]
                error = abs(entry["value"] - float(finest[column]))
                # An upper estimate with a factor of safety, since changes may cancel; 10 times would be of no use.
                self.assertLess(error, entry["error"])
                self.assertGreater(error, 0.1 * entry["error"])
        self.assertNotIn("ipr_at_1", case["columns"])  # counts samples

    def check_brackets(self, job, extent_mm, *region):
        """The stated errors of a coarse job are at least the differences from fine runs, and at most three times the sum
        of their magnitudes when spacing, frames and domain are refined one at a time. Refined runs have a quarter of the
        spacing and of the frame interval, and `extent_mm`, twice the base, with `region`."""
        self.write_job(job)
        self.shearwake("converge", "job.toml", "--cases", "1", "--quiet")
        [case] = self.studied()
        fine = {"spacing": ("-S", "domain.spacing_mm=0.375"), "time": ("-S", "time.output_interval_us=25"),
                "domain": ("-S", f"domain.extent_mm={extent_mm}", *region)}
        fine["all"] = tuple(option for options in fine.values() for option in options)
        found = {}
        for name, options in fine.items():
            [found[name]] = self.reduced(name, *options)
        for column in BRACKETED:
            with self.subTest(column=column):
                entry = case["columns"][column]
                true = {name: abs(float(row[column]) - entry["value"]) for name, row in found.items()}
                self.assertGreaterEqual(entry["error"], true["all"])
                self.assertLessEqual(entry["error"], 3.0 * (true["spacing"] + true["time"] + true["domain"]))
        return case

    @pytest.mark.long
    def test_errors_bracket_the_true_ones_of_a_circle_with_open_edges(self):
        case = self.check_brackets(CIRCLE, "[160.0, 160.0]")
        # The measured area is the same, so that the infinite plane does not depend on the domain. What is left is the
        # tolerance with which its transfer function is interpolated, 1e-6 of the maximum.
        for column in BRACKETED:
            entry = case["columns"][column]
            self.assertLess(abs(entry["changes"]["domain"]), 1e-5 * entry["value"])

    @pytest.mark.extended
    def test_errors_bracket_the_true_ones_of_a_half_space(self):
        # The region of the base consists of the cells of its samples.
        case = self.check_brackets(ENDLESS, "[144.0, 96.0]", "-S", "measure.region_mm=[72.0, 48.0]",
                                   "-S", "measure.region_center_mm=[-0.75, -0.75]")
        self.assertLess(abs(case["columns"]["ipr_abs_period_mm2"]["changes"]["domain"]), 1e-5 * 600.0)

    @pytest.mark.long
    def test_errors_bracket_the_true_ones_of_a_region_on_a_periodic_domain(self):
        self.check_brackets(AROUND_PATH, "[192.0, 144.0]")

    @pytest.mark.long
    def test_errors_of_engine_spectral_bracket_the_difference_from_layered(self):
        for base, changes in (("rigid", {}), ("half-space", HALF_SPACE)):
            self.write_job(changed_job(ONE, SPECTRAL, SMALL, changes))
            self.shearwake("converge", "job.toml", "--cases", "1", "--quiet", "--out", base)
            text = (self.folder / base / "converge" / "converge.json").read_text(encoding="utf-8")
            [case] = json.loads(text)["cases"]
            [finest] = self.reduced(f"fine-{base}", "--quiet", "-S", 'solver.engine="layered"', "-S", "domain.spacing_mm=0.75",
                                    "-S", "time.output_interval_us=25", "-S", "domain.extent_mm=[112.0, 80.0]")
            for column in BRACKETED:
                with self.subTest(base=base, column=column):
                    entry = case["columns"][column]
                    error = abs(float(finest[column]) - entry["value"])
                    self.assertGreaterEqual(entry["error"], error)
                    # In the others changes of opposite signs cancel: up to 11 times.
                    if column in COLUMNS:
                        self.assertLessEqual(entry["error"], 5.0 * error)

    @pytest.mark.extended
    def test_richardson_predicts_the_error_of_the_time_step(self):
        self.write_job(LONG_STEPS)
        self.shearwake("converge", "job.toml", "--quiet")
        [case] = self.studied()
        time = case["refinements"][1]
        self.assertEqual((time["name"], time["order"], time["ratio"]), ("time", 2.0, 2.0))
        # The same frames with a sixteenth of the step: its error is below 1 % of that of the base.
        [finest] = self.reduced("fine", "-S", "solver.spectral.time_step_us=6.25", "-S", "time.output_interval_us=50")
        for column in ("focal_rms_um", "eta_at_1"):
            with self.subTest(column=column):
                entry = case["columns"][column]
                estimate = abs(entry["changes"]["time"]) * 4 / 3
                error = abs(entry["value"] - float(finest[column]))
                # Terms of fourth order: a quarter of the estimate at this large step.
                self.assertAlmostEqual(error / estimate, 1.0, delta=0.25)

    @pytest.mark.extended
    def test_it_reuses_the_cases_of_the_sweep_and_of_an_earlier_study(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml", "--quiet")
        self.shearwake("converge", "job.toml", "--cases", "1", "--quiet")
        study = self.out / "converge"
        self.assertEqual(len(case_files(study)), 4)
        self.assertEqual(len(started(study)), 3)  # the unrefined case was copied
        self.contains(self.shearwake("converge", "job.toml", "--cases", "1").output, "0 computed now, 4 already complete")
        case_files(study)[0].unlink()
        self.contains(self.shearwake("converge", "job.toml", "--cases", "1").output, "4 cases: ", "3 already complete")
        # Another selection adds cases.
        self.shearwake("converge", "job.toml", "--cases", "2", "--quiet")
        self.assertEqual(len(case_files(study)), 8)
        self.assertEqual(len(self.studied()), 2)
        # `run` accepts the folder with its study.
        self.contains(self.shearwake("run", "job.toml").output, "2 already complete")

    def test_reduce_adds_error_columns_on_request(self):
        self.write_job(COARSE)
        self.shearwake("run", "job.toml", "--quiet")
        self.contains(self.shearwake("reduce", "--errors", self.out, expect=2).output,
                      "has no estimates of the numerical error: run shearwake converge")
        output = self.shearwake("converge", "job.toml", "--cases", "1").output
        self.assertRegex(output, r"columns without an estimate, which are empty, count samples or .*: .*ipr_at_1.*peak_um")
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
        errors = self.out / "converge" / "converge.json"
        errors.write_text(errors.read_text().replace("0.0", "0.1", 1))
        self.contains(self.shearwake("reduce", "--errors", self.out, expect=6).output, "does not match its checksum")

    @pytest.mark.extended
    def test_a_second_study_in_the_folder_is_rejected(self):
        self.write_job(COARSE)
        locks = self.out / "converge" / "locks"
        locks.mkdir(parents=True)
        with open(locks / "study", "w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.contains(self.shearwake("converge", "job.toml", "--cases", "1", expect=2).output, "being used by another shearwake converge")
        self.assertEqual([path.name for path in locks.parent.iterdir()], ["locks"])

    def test_unknown_cases_are_rejected(self):
        self.write_job(COARSE)
        self.contains(self.shearwake("converge", "job.toml", "--only", "abc", expect=2).output, "--only abc: no such case")
