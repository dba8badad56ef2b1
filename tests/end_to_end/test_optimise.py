# SPDX-License-Identifier: BSD-3-Clause
"""shearwake optimise: the optimum is reproduced by its case, the bound by NumPy alone, and the study is resumed."""
import csv
import json
import subprocess
import sys
import unittest

import numpy as np
from program import ROOT, ProgramTest, changed

STEADY = """
schema = 1
[job]
name = "best"
[medium]
base = "half-space"
[[medium.layer]]
density_kg_m3 = 1000.0
c_p_m_s = 50.0
c_s_m_s = 5.0
viscosity_Pa_s = 1.0
[load]
peak_Pa = 100.0
footprint = { shape = "gaussian", fwhm_mm = 6.0 }
[load.modulation]
kind = "STM"
path = { shape = "circle", radius_mm = 8.0 }
draw_frequency_Hz = 140.0
[domain]
extent_mm = [48.0, 48.0]
spacing_mm = 2.0
edges = "open"
[time]
regime = "periodic"
output_interval_us = 250.0
[solver]
engine = "layered"
[measure]
region_mm = [40.0, 40.0]
[optimise]
knot_us = 500.0
strength_at_least = [0.7, 0.9]
starts = 4
update_rate_Hz = 3000.0
bits = 6
"""
CIRCLE = 'path = { shape = "circle", radius_mm = 8.0 }\ndraw_frequency_Hz = 140.0'
TRANSIENT = (
    (CIRCLE, 'path = { shape = "line", from_mm = [-20.0, 0.0], to_mm = [20.0, 0.0] }\nspeed_m_s = 7.0'),
    ('edges = "open"', ""), ("extent_mm = [48.0, 48.0]", "extent_mm = [96.0, 64.0]"),
    ('regime = "periodic"', "duration_ms = 5.0"), ("region_mm = [40.0, 40.0]", "settled_after_ms = 1.0"),
    ("update_rate_Hz = 3000.0\nbits = 6\n", ""))


class Optimise(ProgramTest):
    def job(self, *changes):
        self.write_job(changed(*changes, text=STEADY))

    def rows(self, out="out/best.optimise"):
        with open(self.folder / out / "optimise" / "table.csv", encoding="utf-8") as file:
            return [{k: float(v) if v and k != "case" else v for k, v in row.items()} for row in csv.DictReader(file)]

    def verify(self, out="out/best.optimise"):
        return subprocess.run([sys.executable, ROOT / "scripts" / "verify_certificate.py", self.folder / out],
                              capture_output=True, text=True, check=False)

    def check_rows(self, rows):
        for row in rows:
            # The case of the optimum is computed by itself; the forms are exact but for rounding.
            self.assertLess(abs(row["eta_computed_1"] / row["eta_optimum_1"] - 1.0), 1e-6)
            self.assertGreaterEqual(row["strength_optimum_1"], row["strength_at_least_1"] * (1.0 - 1e-12))
            self.assertLessEqual(row["eta_optimum_1"], row["eta_ceiling_1"])
            self.assertGreaterEqual(row["eta_optimum_1"], row["eta_am_1"])
            self.assertGreaterEqual(row["eta_optimum_1"], row["eta_unmodulated_1"])

    def test_a_steady_optimum_is_reproduced_by_its_case_and_below_a_verified_bound(self):
        self.job()
        said = self.shearwake("optimise", "job.toml", ranks=2).said
        self.says(said, "eta_optimum_1", "eta_ceiling_1", "optima: ")
        rows = self.rows()
        self.check_rows(rows)
        self.assertEqual([row["strength_at_least_1"] for row in rows], [0.7, 0.9])
        found = self.verify()
        self.assertEqual((found.returncode, found.stdout.count("verified")), (0, 2), found.stdout + found.stderr)
        # The bound of a changed certificate is refused.
        [path, _] = sorted((self.folder / "out/best.optimise/optimise").glob("*.strength-*.json"))
        optimum = json.loads(path.read_text(encoding="utf-8"))
        optimum["ceiling"]["eta"] *= 0.98
        path.write_text(json.dumps(optimum), encoding="utf-8")
        self.assertEqual(self.verify().returncode, 1)

    def test_an_exported_waveform_reproduces_the_exported_case(self):
        self.job()
        self.shearwake("optimise", "job.toml", "--quiet")
        row = self.rows()[0]
        stem = self.folder / "out/best.optimise/optimise" / f"{row['case']}.strength-0.7"
        with open(f"{stem}.csv", encoding="utf-8") as file:
            updates = list(csv.DictReader(file))
        levels = [int(u["level"]) for u in updates]
        self.assertTrue(0 <= min(levels) and max(levels) == 63)
        self.assertEqual(len(updates), round(3000 / 140))
        optimum = json.loads(open(f"{stem}.json", encoding="utf-8").read())["found"]["values"]
        t = np.array([float(u["t_us"]) for u in updates]) * 1e-6
        knots = np.arange(len(optimum) + 1) / len(optimum) / 140
        exact = np.interp(t, knots, [*optimum, optimum[0]])
        # Half a level of the sound pressure.
        self.assertLess(np.abs(np.array(levels) / 63 - np.sqrt(exact)).max(), 0.5 / 63 + 1e-9)
        # The TOML table in a job of its own gives the eta of the exported case.
        envelope = open(f"{stem}.toml", encoding="utf-8").read()
        self.job(("[domain]", envelope + "[domain]"))
        self.shearwake("run", "job.toml", "--out", "again")
        self.shearwake("reduce", "again")
        with open(self.folder / "again/tables/best.csv", encoding="utf-8") as file:
            [again] = list(csv.DictReader(file))
        self.assertAlmostEqual(float(again["eta_period_1"]), row["eta_exported_1"], delta=1e-9)

    def test_a_transient_optimum_is_reproduced_and_a_study_is_resumed(self):
        self.job(*TRANSIENT)
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        rows = self.rows()
        self.check_rows(rows)
        self.assertEqual(self.verify().returncode, 0)
        out = self.folder / "out/best.optimise"
        # The fields of the knots are no longer needed, and nothing is computed again.
        self.assertEqual(len(list(out.glob("optimise/*.forms.json"))), 1)
        said = self.shearwake("optimise", "job.toml").said
        self.says(said, "0 computed now")
        self.assertEqual(self.rows(), rows)
        # Without one optimum, only this one is searched again; the result is the same.
        next(out.glob("optimise/*.strength-0.9.json")).unlink()
        self.shearwake("optimise", "job.toml", "--quiet")
        self.assertEqual(self.rows(), rows)
        self.says(self.shearwake("optimise", "job.toml", "-S", "optimise.starts=2", expect=2).said,
                  "contains the optima of another job")

    def test_jobs_that_cannot_be_optimised_are_rejected(self):
        self.job((STEADY[STEADY.index("[optimise]"):], ""))
        self.says(self.shearwake("optimise", "job.toml", expect=3).said, "has no table [optimise]")
        self.job(('kind = "STM"', 'kind = "AM-STM"\nam_frequency_Hz = 280.0'))
        self.says(self.shearwake("optimise", "job.toml", expect=3).said, "has an envelope, which would be replaced")
        self.job(("knot_us = 500.0", "knots_us = 500.0"))
        self.says(self.shearwake("check", "job.toml", expect=3).said, "knot_us")


if __name__ == "__main__":
    unittest.main()
