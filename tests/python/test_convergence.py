# SPDX-License-Identifier: BSD-3-Clause
"""Estimates of numerical errors from the changes by refinements (shearwake.studies.convergence)."""
import math
import unittest

from shearwake.plan import Column, Table
from shearwake.studies.convergence import Refinement, document_of, markdown_of, studied_cases

REFINEMENTS = [{"name": name, "change": "", "id": name, "ratio": 2.0, "order": order}
               for name, order in (("spacing", 2.0), ("time", 2.0), ("domain", None))]
CASES = [{"id": "case", "settings": {"load.peak_Pa": 100.0}, "is_reference": False, "base": "base", "refinements": REFINEMENTS}]


def table(rows, not_valid=()):
    """A table of complete cases with these values."""
    names = sorted({name for values in rows.values() for name in values})
    return Table([Column(name, "1", "", counts_samples=name.startswith("ipr")) for name in names],
                 {id: {"status": "complete", "valid": "no" if id in not_valid else "yes", "values": values} for id, values in rows.items()})


class Convergence(unittest.TestCase):
    def test_richardsons_estimate_is_exact_for_a_power_of_the_step(self):
        # value(h) = 3 + 0.7 h^p, evaluated at h = 1 and h = 1/r.
        for p in (1.0, 2.0, 4.0):
            for r in (2.0, 3.0):
                self.assertAlmostEqual(Refinement("", "", "", r, p).error(0.7 * (1.0 / r)**p - 0.7), 0.7, delta=1e-13)
        self.assertEqual(Refinement("", "", "", 2.0, None).error(-0.3), 0.3)

    def test_columns_that_count_samples_are_omitted_and_missing_values_stay_unknown(self):
        rows = {"base": {"eta_at_1": 0.5, "ipr_at_1": 9.0, "focal_rms_um": 2.0, "peak_um": 3.0, "empty_1": math.nan},
                "spacing": {"eta_at_1": 0.52, "ipr_at_1": 36.0, "focal_rms_um": 2.0, "peak_um": 3.0},
                "time": {"eta_at_1": 0.5, "ipr_at_1": 9.0},
                "domain": {"eta_at_1": 0.49, "ipr_at_1": 9.0, "focal_rms_um": 2.0, "peak_um": 3.0}}
        [case] = studied_cases(CASES, table(rows))
        self.assertTrue(case.is_complete and case.is_valid)
        self.assertEqual(list(case.columns), ["eta_at_1", "focal_rms_um"])
        self.assertAlmostEqual(case.columns["eta_at_1"].error, 0.055, delta=1e-13)  # 1.5 (4/3 0.02 + 0 + 0.01)
        written = document_of("job", [case])["cases"][0]
        self.assertIsNone(written["columns"]["focal_rms_um"]["error"])
        self.assertIsNone(written["columns"]["focal_rms_um"]["changes"]["time"])
        self.assertAlmostEqual(written["columns"]["eta_at_1"]["changes"]["domain"], -0.01, delta=1e-13)
        self.assertTrue(written["valid"])
        self.assertIn("## case: load.peak_Pa = 100\n", markdown_of([case], [], []))
        [case] = studied_cases(CASES, table(rows, ["base"]))
        self.assertFalse(document_of("", [case])["cases"][0]["valid"])
        self.assertIn("## case, not valid: ", markdown_of([case], [], []))
        del rows["domain"]
        self.assertFalse(studied_cases(CASES, table(rows))[0].is_complete)

    def test_errors_in_dB_are_relative_to_the_amplitude_and_largest_levels_have_none(self):
        rows = {id: {"felt_path_dB": 0.0, "felt_peak_dB": 3.0} for id in ("base", "spacing", "time")}
        rows["domain"] = {"felt_path_dB": 4.0137333}  # no order: 1.5 times this is 6.0206 dB
        cases = studied_cases(CASES, table(rows))
        self.assertEqual(list(cases[0].columns), ["felt_path_dB"])
        text = markdown_of(cases, ["felt_path_dB"], ["felt_path_dB", "felt_peak_dB"])
        self.assertIn("| 6 | 1e+02 % |", text)  # twice the amplitude
        self.assertTrue(text.endswith("largest of all samples: felt_peak_dB\n"))
