# SPDX-License-Identifier: BSD-3-Clause
"""The quantities and verdicts of scripts/user_studies.py, the skin without waves, and the sentence that README.md quotes."""
import csv
import importlib.util
import math
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("SHEARWAKE", ROOT / "build" / "shearwake"))
SPEC = importlib.util.spec_from_file_location("user_studies", ROOT / "scripts/user_studies.py")
user_studies = importlib.util.module_from_spec(SPEC)
sys.modules["user_studies"] = user_studies
SPEC.loader.exec_module(user_studies)
STUDIES = tomllib.loads((ROOT / "jobs/studies/studies.toml").read_text(encoding="utf-8"))["study"]


class Quantities(unittest.TestCase):
    def test_a_gap_is_interpolated_and_infinite_beyond_the_largest_distance(self):
        def rows(*gaps):
            return [{"load.modulation.foci_mm": f"[[-{d}, 0], [{d}, 0]]", "felt_gap_dB": gap} for d, gap in zip((5, 10, 15), gaps)]
        self.assertAlmostEqual(user_studies.gap_distance(rows(0.0, 1.3, 3.3)), 25.0)
        self.assertEqual(user_studies.gap_distance(rows(0.0, 0.0, 0.0)), math.inf)

    def test_a_maximum_lies_between_the_values_of_the_axis(self):
        x = np.array([2.0, 5.0, 1.0, 7.0])  # unsorted and not uniform
        self.assertAlmostEqual(user_studies.find_maximum(x, -(x - 4.3) ** 2), 4.3)  # exact for a parabola
        self.assertEqual(user_studies.find_maximum(x, x), 7.0)  # still rises at the end

    def test_the_exponent_of_a_power_is_recovered(self):
        rows = [{"load.modulation.draw_frequency_Hz": f, "felt_path_dB": 7.0 + 20 * 3.1 * math.log10(f)} for f in (5.0, 9.0, 17.0)]
        self.assertAlmostEqual(user_studies.growth_exponent(rows), 3.1)

    def test_lm_is_compared_with_am_of_the_same_frequency(self):
        rows = [{"load.modulation.kind": kind, "load.modulation.am_frequency_Hz": f, "felt_peak_dB": level}
                for kind, f, level in (("AM", 10.0, 1.0), ("STM", 20.0, 9.0), ("AM", 20.0, 5.0), ("STM", 10.0, 4.0))]
        self.assertEqual(user_studies.lm_minus_am_least(rows), 3.0)

    def test_the_force_of_27_mN_does_not_depend_on_the_peak_of_the_job(self):
        def level(peak_Pa):
            return user_studies.level_of_slow_lm([{"load.modulation.kind": "LM", "load.modulation.am_frequency_Hz": 10.0,
                                                   "load.peak_Pa": peak_Pa, "felt_peak_dB": 20 * math.log10(peak_Pa)}])
        self.assertAlmostEqual(level(60.0), level(300.0))
        sigma_m = 10.2e-3 / math.sqrt(8 * math.log(2))  # force of a Gaussian: 2 pi sigma^2 times its peak
        self.assertAlmostEqual(10 ** (level(60.0) / 20) * 2 * math.pi * sigma_m**2, 27e-3)


class Verdicts(unittest.TestCase):
    def result(self, values, springs=None, reported=(2.0, 4.0)):
        return user_studies.Result({"name": "n", "kind": "number", "reported": reported}, np.array(values), springs)

    def test_a_result_is_met_by_the_median_and_not_by_one_extreme_skin(self):
        self.assertTrue(self.result([1.0, 3.0, 9.0]).met)
        self.assertFalse(self.result([3.9, 5.0, 9.0]).met)
        self.assertTrue(self.result([3.0, 3.0, math.inf], reported=(2.3, math.inf)).met)

    def test_the_share_of_skins_has_a_standard_error_that_is_never_zero(self):
        share, error = self.result([3.0] * 16 + [9.0] * 48).share()
        self.assertEqual(share, 0.25)
        self.assertAlmostEqual(error, math.sqrt(0.25 * 0.75 / 64), delta=0.003)  # (k + 1) / (n + 2) is .258 and not .25
        self.assertGreater(self.result([3.0] * 64).share()[1], 0.01)

    def test_springs_meet_a_result_only_if_they_have_a_value_in_the_interval(self):
        self.assertTrue(self.result([3.0], springs=2.5).springs_met)
        self.assertFalse(self.result([3.0], springs=4.5).springs_met)
        self.assertFalse(self.result([3.0], springs=None).springs_met)

    def test_the_shift_is_that_of_the_median_without_every_other_value_of_the_axis(self):
        rows = [{"load.modulation.am_frequency_Hz": f, "felt_peak_dB": -abs(f - 200.0)} for f in (100.0, 200.0, 300.0, 400.0, 500.0)]
        study = {"name": "n", "quantity": "most_sensitive_tested_frequency", "axis": "load.modulation.am_frequency_Hz",
                 "reported": [0.0, 1000.0]}
        # 200 Hz on the complete axis, 100 Hz (as near as 300 Hz, and first) with 100, 300 and 500 Hz
        self.assertAlmostEqual(user_studies.evaluate(study, [rows], None).shift, 0.1)

    def test_the_summary_counts_numbers_and_orders_apart(self):
        def result(kind, value, springs):
            return user_studies.Result({"name": f"{kind} {value}", "kind": kind, "reported": [2.0, 4.0]}, np.array([value]), springs)
        text = user_studies.summarise([result("number", 3.0, 3.0), result("number", 9.0, 3.0), result("order", 3.0, None),
                                       result("order", 9.0, 3.0)])
        self.assertEqual(text, "Of 2 results with a number, 1 are met by the median of 1 sampled skins, 1 of these also by a skin without "
                               "waves; of 2 orders, 1 are met, 0 of these also by a skin without waves. Orders that are predicted "
                               "wrongly: order 9.0.")


class Definitions(unittest.TestCase):
    def test_every_study_has_its_job_its_quantity_and_an_interval(self):
        for study in STUDIES:
            with self.subTest(study["name"]):
                job = tomllib.loads((ROOT / f"jobs/studies/{study['job']}.toml").read_text(encoding="utf-8"))
                self.assertGreaterEqual(job["uncertain"]["samples"], 64)
                self.assertTrue(callable(getattr(user_studies, study["quantity"])))
                self.assertLess(*study["reported"])
                self.assertIn(study["kind"], ("number", "order"))
                self.assertIn(study["chosen"], ("study", "us"))
                self.assertTrue(study["link"].startswith("https://"))
                self.assertIn(study.get("axis", next(iter(job["sweep"]))), job["sweep"])
                if study["kind"] == "number":
                    self.assertTrue(all(map(math.isfinite, study["reported"])))

    def test_page_and_readme_state_the_same_summary(self):
        def words(path):
            return " ".join(re.sub(r"\]\([^)]*\)|\[", "", (ROOT / path).read_text(encoding="utf-8")).split())
        page = words("docs/explanation/user-studies.md")
        summary = re.match(r"# User studies (Of \d+ results with a number, .*?(?:wrongly: .*?|waves)\.) ", page)
        self.assertIsNotNone(summary)
        self.assertIn(summary[1][1:], words("README.md"))  # the first letter may be small
        counts = [sum(study["kind"] == kind for study in STUDIES) for kind in ("number", "order")]
        self.assertEqual([int(n) for n in re.findall(r"[oO]f (\d+) (?:results|orders)", summary[1])], counts)
        self.assertEqual(page.count("| met |") + page.count("| not met |"), len(STUDIES))


class Springs(unittest.TestCase):
    def test_the_skin_without_waves_moves_in_proportion_to_the_pressure(self):
        layer = re.search(r"^springs='(.*)'", (ROOT / "scripts/user-studies").read_text(encoding="utf-8"), re.M)[1]
        compliance_m_Pa, peak_Pa, f_Hz, a0_m_s2 = 100e-9, 125.0, 200.0, 0.029  # a0: threshold at 200 Hz
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "run", ROOT / "jobs/studies/wilson-localisation.toml", "--out", folder, "--quiet", "-S",
                            f"medium.layer={layer}", "-S", "uncertain={}"], check=True, capture_output=True)
            subprocess.run([PROGRAM, "reduce", folder], check=True, capture_output=True)
            with (Path(folder) / "tables/study-wilson-localisation.csv").open(encoding="utf-8", newline="") as table:
                row = next(csv.DictReader(table))
            with h5py.File(Path(folder) / "cases" / f"{row['id']}.h5") as file:
                surface = file["surface"]
                u_m, x_m, y_m = (surface[name][:] for name in ("u_z", "x", "y"))
        u_m = u_m.reshape(-1, *u_m.shape[-2:])[-1]
        shape = np.exp(-4 * math.log(2) * ((x_m[:, None]**2 + y_m**2) / 10.2e-3**2))
        if u_m.shape != shape.shape:
            shape = shape.T
        scale = float((u_m * shape).sum() / (shape**2).sum())
        # The spectrum of the focus ends below k = 1/mm, where the layer of .02 mm is softer by (k h)^2 < 0.1 %.
        self.assertLess(np.abs(u_m - scale * shape).max(), 0.01 * abs(scale))
        expected_dB = 20 * math.log10((2 * math.pi * f_Hz)**2 * compliance_m_Pa * peak_Pa / 2 / math.sqrt(2) / a0_m_s2)
        self.assertAlmostEqual(float(row["felt_peak_dB"]), expected_dB, delta=0.01)  # 0.1 % of the amplitude

    def test_the_tangential_closed_form_agrees_with_that_of_a_half_space(self):
        k, omega, c_s, viscosity = np.array([20.0, 100.0, 400.0]), 2 * math.pi * 150.0, 5.0, 2.0
        module = user_studies.lateral_modulation
        w, _ = module.respond(k, omega, c_s, viscosity, 2.0)  # 2 m: waves of 150 Hz have decayed
        mu = 1000.0 * c_s**2 + 1j * omega * viscosity
        k_s2 = 1000.0 * omega**2 / mu
        alpha, beta = np.sqrt(k**2 - 1000.0 * omega**2 / (1000.0 * 1500.0**2 + 2j * omega * viscosity)), np.sqrt(k**2 - k_s2)
        rayleigh = (2 * k**2 - k_s2)**2 - 4 * k**2 * alpha * beta
        np.testing.assert_allclose(w, -alpha * k_s2 / (mu * rayleigh), rtol=1e-6)  # rounding where alpha is close to beta
