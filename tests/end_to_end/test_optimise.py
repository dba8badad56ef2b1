# SPDX-License-Identifier: BSD-3-Clause
"""shearwake optimise: the optimum is reproduced by its case, the bound by NumPy alone, and the study is resumed."""
import fcntl
import json
import os
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
import shearwake
from program import AM, ROOT, ProgramTest, alive, changed_job, descendants, gaussian, job_text, read_csv
from scipy.interpolate import RegularGridInterpolator
from shearwake.checksum import read_json, sealed

STEADY = job_text(
    "best", medium={"base": "half-space", "layer": [{"density_kg_m3": 1000.0, "c_p_m_s": 50.0, "c_s_m_s": 5.0, "viscosity_Pa_s": 1.0}]},
    load={"peak_Pa": 100.0, "footprint": gaussian(6.0),
          "modulation": {"kind": "STM", "path": {"shape": "circle", "radius_mm": 8.0}, "draw_frequency_Hz": 140.0}},
    domain={"extent_mm": [48.0, 48.0], "spacing_mm": 2.0, "edges": "open"}, time={"regime": "periodic", "output_interval_us": 250.0},
    solver={"engine": "layered"}, measure={"region_mm": [40.0, 40.0]},
    optimise={"knot_us": 500.0, "strength_at_least": [0.7, 0.9], "starts": 4, "update_rate_Hz": 2800.0, "bits": 6})
PLAIN = {"optimise.update_rate_Hz": None, "optimise.bits": None, "optimise.sm_frequency_Hz": [140.0], "optimise.sm_deviation_m_s": [2.0]}
TRANSIENT = {
    "load.modulation": {"kind": "STM", "path": {"shape": "line", "from_mm": [-20.0, 0.0], "to_mm": [20.0, 0.0]}, "speed_m_s": 7.0},
    "domain": {"extent_mm": [96.0, 64.0], "spacing_mm": 2.0}, "time": {"duration_ms": 5.0, "output_interval_us": 250.0},
    "measure": {"settled_after_ms": 1.0}, **PLAIN, "optimise.sm_frequency_Hz": [250.0]}
ONE = {"optimise.strength_at_least": [0.8]}
# Eight rows of jobs/speed-fwhm-modulation.toml, on its own domain.
SPEED_SWEEP = {
    "medium": {"base": "half-space", "layer": [{"density_kg_m3": 1000.0, "c_p_m_s": 1500.0, "c_s_m_s": 5.0, "viscosity_Pa_s": 1.0}]},
    "domain": {"extent_mm": [300.0, 162.0], "spacing_mm": 2.5}, "time": {"duration_ms": 14.0, "output_interval_us": 100.0},
    "solver": {"engine": "layered"}, "measure": {"at_ms": 14.0, "settled_after_ms": 4.0}}
SM = {"kind": "SM-STM", "speed_deviation_m_s": 2.0, "sm_frequency_Hz": 200.0}


def speed_sweep(modulation, sweep, **tables):
    path = {"shape": "line", "from_mm": [-75.0, 0.0], "to_mm": [85.0, 0.0]}
    load = {"peak_Pa": 100.0, "footprint": gaussian(10.0), "modulation": {"path": path, "speed_m_s": 7.0, **modulation}}
    return job_text("rows", **SPEED_SWEEP, load=load, sweep={"load.modulation.speed_m_s": [4.0, 7.0], **sweep}, **tables)


FROZEN = json.loads((ROOT / "tests" / "data" / "studies" / "optimise.json").read_text(encoding="utf-8"))["studies"]
# Columns that are determined by cases which do not depend on the search.
DETERMINED = ("eta_unmodulated_1", "eta_sm_1", "strength_sm_1", "sm_frequency_Hz", "sm_deviation_m_s", "sm_phase_deg", "uniformity_unmodulated_1",
              "uniformity_sm_1")


class Optimise(ProgramTest):
    def job(self, *changes):
        self.write_job(changed_job(STEADY, *changes))

    def rows(self, out="out/best.optimise"):
        rows = read_csv(self.folder / out / "optimise" / "table.csv")
        names = list(rows[0])
        numbers = names[names.index("strength_at_least_1"):names.index("valid")]
        return [{k: float(v) if v and k in numbers else v for k, v in row.items()} for row in rows]

    def verify(self, out="out/best.optimise"):
        return self.call(sys.executable, ROOT / "scripts" / "verify_certificate.py", self.folder / out, expect=None, env=None)

    def check_rows(self, rows):
        for row in rows:
            # The case of the optimum is computed by itself. Its envelope has kinks at other knots than the basis of the
            # forms, hence other quadrature nodes in time, whose errors are below 2e-5 of the field (observed: 2e-6).
            self.assertLess(abs(row["eta_computed_1"] / row["eta_optimum_1"] - 1.0), 1e-5)
            self.assertGreaterEqual(row["strength_optimum_1"], row["strength_at_least_1"] * (1.0 - 1e-12))
            self.assertLessEqual(row["eta_optimum_1"], row["eta_ceiling_1"])
            self.assertGreaterEqual(row["eta_optimum_1"], row["eta_am_1"])
            self.assertGreaterEqual(row["eta_optimum_1"], row["eta_unmodulated_1"])
            # The relaxation is not exact, but excludes most of what the envelope cannot reach.
            self.assertLess(row["eta_ceiling_1"], 1.2 * row["eta_optimum_1"])

    def check_jobs(self, *rows, kind="", column="eta_computed_1", out="out/best.optimise"):
        """The written job of each optimum reproduces it."""
        for n, row in enumerate(rows):
            job = self.folder / out / "optimise" / f"{row['case']}.strength-{row['strength_at_least_1']:g}.{kind}job.toml"
            [again] = self.reduced(f"job-{kind}{n}", job=job)
            # Both are the same case but for the rounding of units.
            self.assertLess(abs(float(again["eta_period_1"]) / row[column] - 1.0), 1e-6)

    def test_a_steady_optimum_is_reproduced_exported_and_below_a_verified_bound(self):
        self.job()
        output = self.shearwake("optimise", "job.toml", ranks=2).output
        self.contains(output, "[1/4] comparison with SM-STM", "[4/4] cases of the results", "best AM-STM | best SM-STM | optimum | upper bound", "optima: ")
        rows = self.rows()
        self.check_rows(rows)
        self.assertEqual([row["strength_at_least_1"] for row in rows], [0.7, 0.9])
        self.check_jobs(rows[0])
        # The envelope exceeds the best SM-STM at a strength of 0.9, or the bound proves that no envelope does.
        self.assertGreater(rows[1]["eta_sm_1"], 0.0)
        self.assertTrue(rows[1]["eta_optimum_1"] > rows[1]["eta_sm_1"] or rows[1]["eta_ceiling_1"] < rows[1]["eta_sm_1"])
        found = self.verify()
        self.assertEqual((found.returncode, found.stdout.count("verified")), (0, 2), found.stdout + found.stderr)
        self.check_waveform(rows[0])
        self.check_report()
        # A changed bound is refused, whether it is smaller or greater than the certificate's own.
        [path, _] = sorted((self.folder / "out/best.optimise/optimise").glob("*.strength-*.json"))
        text = path.read_text(encoding="utf-8")
        optimum = json.loads(text)
        bound = optimum["ceiling"]["eta"]
        for factor, reason in ((0.98, "which is not less than"), (1.01, "its certificate proves a smaller one")):
            optimum["ceiling"]["eta"] = bound * factor
            path.write_text(json.dumps(optimum), encoding="utf-8")
            refused = self.verify()
            self.assertEqual(refused.returncode, 1)
            self.contains(refused.stdout, reason, "table.csv has")
        path.write_text(text, encoding="utf-8")

    def check_report(self):
        self.shearwake("report", "out/best.optimise")
        report = self.folder / "out/best.optimise/report"
        page = (report / "index.html").read_text(encoding="utf-8")
        order = [page.index(f'<h2 id="{name}">') for name in ("optimise_mean", "player", "optimise_front")]
        self.assertEqual(order, sorted(order))  # what is drawn comes first
        figures = {path.name for path in report.rglob("*.png")}
        self.assertLessEqual({"optimise_front.png", "optimise_envelopes.png", "optimise_energy.png", "optimise_surfaces_1.png",
                              "optimise_mean.png", "optimise_path.png"}, figures)
        self.contains(page, "upper bound", "verify_certificate.py", "<h3>Uniformity along the path</h3>")

    def drawn(self, out, name):
        """The uniformity of each case of an output folder, from the time mean of u^2 of its file: {case: uniformity}."""
        found = {}
        for case in shearwake.Sweep(self.folder / out).cases:
            mean = case.arrays("mean")
            at = np.column_stack([mean["drawn_x"], mean["drawn_y"]])
            rms = np.sqrt(RegularGridInterpolator((mean["x"], mean["y"]), mean["u_z_squared"])(at))
            found[case.settings.get(name)] = rms.min() / rms.mean()
        return found

    @pytest.mark.long
    def test_a_required_uniformity_keeps_the_circle_closed(self):
        least = 0.9
        self.job(ONE)
        self.shearwake("optimise", "job.toml", "--quiet", "--out", "free", ranks=2)
        self.job(ONE, {"optimise.uniformity": least})
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        [free], [row] = self.rows("free"), self.rows()
        self.check_rows([row])
        self.assertEqual(self.verify().returncode, 0)  # the bound holds with the constraint as well
        # The constraint binds. The case is computed with other quadrature nodes than the forms, see check_rows().
        self.assertLess(free["uniformity_optimum_1"], 0.9 * least)
        self.assertLess(abs(row["uniformity_optimum_1"] / least - 1.0), 1e-4)
        self.assertGreater(row["uniformity_unmodulated_1"], 0.99)  # a circle looks the same everywhere but for the grid
        self.assertGreaterEqual(row["uniformity_am_1"], least * (1.0 - 1e-4))
        self.assertLess(row["eta_optimum_1"], free["eta_optimum_1"])
        self.assertGreater(row["eta_optimum_1"], row["eta_unmodulated_1"])
        # The columns are those of the files, and the jobs of the optimum and of the exported waveform reproduce them.
        drawn = self.drawn("out/best.optimise", "optimise.modulation")
        for name, kind in (("optimum", "optimum"), ("unmodulated", "unmodulated"), ("am", "AM-STM"), ("exported", "exported")):
            self.assertAlmostEqual(drawn[kind], row[f"uniformity_{name}_1"], delta=1e-8)  # nine digits in the table
        self.check_jobs(row)
        self.check_jobs(row, kind="exported.", column="eta_exported_1")
        self.assertAlmostEqual(self.drawn("job-0", "")[None], row["uniformity_optimum_1"], delta=1e-6)
        self.assertAlmostEqual(self.drawn("job-exported.0", "")[None], row["uniformity_exported_1"], delta=1e-6)

    def test_a_uniformity_that_no_envelope_reaches_is_rejected(self):
        # The rms falls at the ends of a line.
        self.job(TRANSIENT, ONE, {"optimise.uniformity": 1.0})
        self.contains(self.shearwake("optimise", "job.toml", expect=3).output, "no envelope was found", "optimise.uniformity = 1",
                      "the unmodulated load has a uniformity of 0.")

    def check_waveform(self, row):
        """The waveform has the levels of the optimum, and its TOML gives the eta of the exported case."""
        stem = self.folder / "out/best.optimise/optimise" / f"{row['case']}.strength-0.7"
        updates = read_csv(f"{stem}.csv")
        levels = [int(u["level"]) for u in updates]
        self.assertTrue(0 <= min(levels) and max(levels) == 63)
        self.assertEqual(len(updates), 2800 // 140)
        optimum = json.loads(Path(f"{stem}.json").read_text(encoding="utf-8"))["found"]["values"]
        t = np.array([float(u["t_us"]) for u in updates]) * 1e-6
        knots = np.arange(len(optimum) + 1) / len(optimum) / 140
        exact = np.interp(t, knots, [*optimum, optimum[0]])
        np.testing.assert_allclose(t, np.arange(len(updates)) / 2800, atol=1e-12)  # nine digits of us
        x, y = (np.array([float(u[name]) for u in updates]) for name in ("x_mm", "y_mm"))
        np.testing.assert_allclose(np.hypot(x, y), 8.0, rtol=1e-8)  # nine digits
        # Half a level of the sound pressure.
        self.assertLess(np.abs(np.array(levels) / 63 - np.sqrt(exact)).max(), 0.5 / 63 + 1e-9)
        self.check_jobs(row, kind="exported.", column="eta_exported_1")
        # The table in another job.
        envelope = Path(f"{stem}.toml").read_text(encoding="utf-8")
        self.write_job(STEADY + envelope)
        [again] = self.reduced("again")
        self.assertAlmostEqual(float(again["eta_period_1"]), row["eta_exported_1"], delta=1e-9)

    @pytest.mark.extended
    def test_a_transient_optimum_is_reproduced_and_a_study_is_resumed(self):
        self.job(TRANSIENT)
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        rows = self.rows()
        self.check_rows(rows)
        self.assertEqual(self.verify().returncode, 0)
        out = self.folder / "out/best.optimise"
        # The fields of the knots are no longer needed, and nothing is computed again.
        self.assertEqual(len(list(out.glob("optimise/*.forms.json"))), 1)
        output = self.shearwake("optimise", "job.toml").output
        self.contains(output, "0 computed now")
        self.assertEqual(self.rows(), rows)
        # Without one optimum, only this one is searched again; the result is the same.
        next(out.glob("optimise/*.strength-0.9.json")).unlink()
        self.shearwake("optimise", "job.toml", "--quiet")
        self.assertEqual(self.rows(), rows)
        self.contains(self.shearwake("optimise", "job.toml", "-S", "optimise.starts=2", expect=2).output,
                      "contains the optima of another job")
        self.check_damage(out)

    def check_damage(self, out):
        """Files of the study whose bytes have changed are refused by name, and so are optima that the cases do not have."""
        for path in (next(out.glob("optimise/*.forms.json")), next(out.glob("optimise/*.strength-0.9.json"))):
            text = path.read_text(encoding="utf-8")
            place = text.index("0.") + 2
            path.write_text(text[:place] + str((int(text[place]) + 1) % 10) + text[place + 1:], encoding="utf-8")
            self.contains(self.shearwake("optimise", "job.toml", "--quiet", expect=6).output, f"{path.name} is damaged", "remove it")
            path.write_text(text, encoding="utf-8")
        # Forms with a valid checksum that are not those of the cases.
        [path], table = out.glob("optimise/*.forms.json"), (out / "optimise/table.csv").read_text(encoding="utf-8")
        forms = read_json(path.read_text(encoding="utf-8"))
        path.write_text(sealed({**forms, "numerator": (1.1 * np.array(forms["numerator"])).tolist()}), encoding="utf-8")
        for optimum in out.glob("optimise/*.strength-*.json"):
            optimum.unlink()
        self.contains(self.shearwake("optimise", "job.toml", "--quiet", expect=6).output, "by its quadratic forms", "no table is written")
        self.assertEqual((out / "optimise/table.csv").read_text(encoding="utf-8"), table)

    @pytest.mark.extended
    def test_a_second_study_in_the_same_folder_is_refused_while_the_first_is_active(self):
        self.job(TRANSIENT, ONE)
        self.shearwake("optimise", "job.toml", "--quiet")
        with open(self.folder / "out/best.optimise/optimise/locks/folder", "a", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            second = self.shearwake("optimise", "job.toml", expect=2).output
        self.contains(second, "another optimise is active in out/best.optimise")
        self.assertEqual(len(second.strip().splitlines()), 1)
        self.shearwake("optimise", "job.toml", "--quiet")

    @pytest.mark.extended
    def test_an_interrupt_ends_the_search_and_its_processes(self):
        self.job(PLAIN, {"optimise.starts": 10000})
        process = self.start("optimise", "job.toml")
        output = ""
        while "[3/4]" not in output:
            line = process.stdout.readline()
            self.assertTrue(line, output)
            output += line
        self.wait_for(lambda: len(descendants(process.pid)) >= 2, "the module and its worker")
        pids = descendants(process.pid)
        os.killpg(process.pid, signal.SIGINT)
        self.contains(self.output_of(process, 75), "the search was stopped", "shearwake optimise job.toml")
        self.wait_for(lambda: not any(map(alive, pids)), "the module to end")

    @pytest.mark.extended
    def test_an_optimum_is_not_valid_if_its_waves_return(self):
        for extent_mm, valid in (([96.0, 64.0], "yes"), ([56.0, 36.0], "no")):
            self.job(TRANSIENT, ONE, {"optimise.starts": 1, "domain.extent_mm": extent_mm})
            self.shearwake("optimise", "job.toml", "--out", valid, "--quiet")
            self.assertEqual([row["valid"] for row in self.rows(valid)], [valid])

    @pytest.mark.long
    def test_a_killed_study_is_resumed_with_the_same_result(self):
        self.job(TRANSIENT)
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        self.kill(self.start_and_stop("optimise", "job.toml", "--quiet", "--out", "killed", ranks=2,
                                      faults={"PATH": "killed/*.h5", "CALL": "rename", "STOP_AT": 2}))
        self.assertFalse((self.folder / "killed/optimise/table.csv").exists())
        self.shearwake("optimise", "job.toml", "--quiet", "--out", "killed", ranks=2)
        self.assertEqual(self.rows("killed"), self.rows())

    def check_one(self, *changes, column="eta_period_1"):
        """The optimum of the changed job is reproduced; returns its row."""
        self.job(PLAIN, ONE, {"optimise.maximise": column}, *changes)
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        rows = self.rows()
        self.check_rows(rows)
        verified = self.verify()
        self.assertEqual(verified.returncode, 0, verified.stdout)
        return rows[0]

    @pytest.mark.extended
    def test_two_foci_are_modulated_together(self):
        self.check_one({"load.modulation.foci_mm": [[-4.0, 0.0], [4.0, 0.0]]})

    @pytest.mark.long
    def test_the_focus_of_an_array_is_modulated(self):
        array = {"shape": "array", "preset": "array-16x16", "distance_mm": 150.0, "pressure_Pa_m": 3.4}
        self.check_one({"load.footprint": array, "load.peak_Pa": None})

    @pytest.mark.extended
    def test_the_sharpness_of_a_shape_is_maximised(self):
        self.check_one(column="sharpness_1")

    @pytest.mark.extended
    def test_the_share_of_a_band_at_the_depth_of_a_receptor_is_maximised(self):
        row = self.check_one({"measure.bands_Hz": [[200, 500]], "measure.depths_mm": [2.0], "record.traces_mm": [[8.0, 0.0]]},
                             column="share_200_500_1")
        self.assertGreater(row["eta_optimum_1"], 1.2 * row["eta_unmodulated_1"])

    @pytest.mark.long
    def test_speed_profile_speed_and_size_are_optimised_with_the_envelope(self):
        self.job(PLAIN, ONE)
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        envelope = self.rows()[0]["eta_optimum_1"]
        self.job(PLAIN, ONE, {"optimise.starts": 2, "optimise.over": ["envelope", "speed-profile", "speed", "size"],
                              "optimise.rounds": 1, "optimise.factor_at_most": 1.2})
        self.shearwake("optimise", "job.toml", "--quiet", "--out", "moved", ranks=2)
        [row] = self.rows("moved")
        self.check_rows([row])
        self.assertGreater(row["eta_optimum_1"], envelope)
        self.assertGreater(row["eta_optimum_1"], row["eta_sm_1"])
        self.check_jobs(row, out="moved")
        self.assertEqual(self.verify("moved").returncode, 0)
        self.assertTrue(1 / 1.2 - 1e-9 <= row["optimum_size_1"] <= 1.2 + 1e-9)

    @pytest.mark.long
    def test_an_optimum_is_computed_in_other_tissues(self):
        self.job(PLAIN, ONE, {"optimise.robust_to": 0.2})
        self.shearwake("optimise", "job.toml", "--quiet", ranks=2)
        rows = read_csv(self.folder / "out/best.optimise/optimise/robustness.csv")
        self.assertEqual(len(rows), 10)
        self.assertEqual({row["difference"] for row in rows if "," not in row["difference"]},
                         {f"{what} {sign}20 %" for what in ("c_s", "viscosity", "speed") for sign in "+-"})
        # The tissue with a higher c_s is that of a job with this c_s.
        optimum = json.loads(next((self.folder / "out/best.optimise/optimise").glob("*.strength-*.json")).read_text())
        knots = json.loads(next((self.folder / "out/best.optimise/optimise").glob("*.forms.json")).read_text())["knots"]
        samples = {"shape": "samples", "interval_us": 1e6 * knots["interval_s"], "repeat": True, "values": optimum["found"]["values"]}
        self.job(PLAIN, {"medium.layer[1].c_s_m_s": 6.0, "load.modulation.envelope": [samples]})
        [stiffer] = self.reduced("stiffer")
        [row] = [row for row in rows if row["difference"] == "c_s +20 %"]
        self.assertAlmostEqual(float(row["eta_found_1"]), float(stiffer["eta_period_1"]), delta=1e-9)

    @pytest.mark.long
    def test_no_modulation_of_a_sweep_exceeds_the_bound_of_its_path_and_strength(self):
        together = {f"load.modulation.{kind}_frequency_Hz": [100, 400] for kind in ("am", "sm")}
        self.write_job(speed_sweep({**SM, "am_frequency_Hz": 200.0}, {"load.modulation.kind": ["SM-STM", "AM-STM"], "zip": [together]},
                                   table={"x": "load.modulation.speed_m_s", "reference": {"kind": "STM"}}))
        self.reduced("rows", ranks=2)
        # For AM-STM the path is that of plain STM; the envelope of SM-STM is constant on its own path.
        self.write_job(speed_sweep({"kind": "STM"}, {}, optimise={"strength_at_least": [0.5, 0.6, 0.7, 1.0], "starts": 2, "knot_us": 500.0}))
        self.shearwake("optimise", "job.toml", "--quiet", "--out", "plain", ranks=2)
        self.write_job(speed_sweep(SM, {"load.modulation.sm_frequency_Hz": [100, 400]},
                                   optimise={"strength_at_least": [1.0], "starts": 2, "knot_us": 1000.0}))
        self.shearwake("optimise", "job.toml", "--quiet", "--out", "sm", ranks=2)
        compared = self.call(sys.executable, ROOT / "scripts" / "compare_with_bounds.py", "rows/tables/rows.csv", "plain", "sm", env=None)
        self.contains(compared.stdout, "10 rows: 0 exceed")

    @pytest.mark.extended
    def test_bounds_are_those_of_the_stored_table_and_optima_are_not_lower(self):
        self.check_frozen("bounds-sm")

    @pytest.mark.long
    def test_bounds_are_those_of_all_stored_tables_and_optima_are_not_lower(self):
        for name in FROZEN:
            with self.subTest(job=name):
                self.check_frozen(name)

    def check_frozen(self, name):
        study = FROZEN[name]
        overrides = [word for text in study["overrides"] for word in ("-S", text)]
        self.shearwake("optimise", ROOT / "jobs" / f"{name}.toml", *overrides, "--quiet", "--out", name, ranks=2)
        rows = self.rows(name)
        self.assertEqual(self.verify(name).returncode, 0)
        self.assertEqual([list(row) for row in rows], [list(row) for row in study["rows"]])
        for row, stored in zip(rows, study["rows"]):
            self.assertEqual((row["case"], row["valid"]), (stored["case"], stored["valid"]))
            for column in DETERMINED:  # nine digits in the table
                self.assertEqual(row[column] == "", stored[column] == "", column)
                self.assertAlmostEqual(row[column] or 0.0, stored[column] or 0.0, delta=2e-9 * abs(stored[column] or 0.0))
            # The largest eta of a grid; the stored table has none where the unmodulated load missed a strength of 1 by rounding.
            self.assertGreaterEqual(row["eta_am_1"], stored["eta_am_1"] * (1.0 - 2e-9))
            # Another local search may end elsewhere, but not lower: 1e-5 is far below the distance from the bound.
            self.assertGreaterEqual(row["eta_optimum_1"], stored["eta_optimum_1"] - 1e-5)
            if name not in ("best-motion", "best-circle"):  # the motion of the job, not that of a search
                self.assertAlmostEqual(row["eta_ceiling_1"] / stored["eta_ceiling_1"], 1.0, delta=1e-4)  # of the bisection

    def test_jobs_that_cannot_be_optimised_are_rejected(self):
        self.job({"optimise": None})
        self.contains(self.shearwake("optimise", "job.toml", expect=3).output, "has no table [optimise]")
        self.shearwake("check", "job.toml")
        for changes, *says in (
                ({"load.modulation.kind": "AM-STM", AM: 280.0}, "has an envelope, which would be replaced"),
                ({"optimise.maximise": "share_40_400_1"}, 'must be "eta_period_1" or "sharpness_1"', "bands_Hz"),
                ({"optimise.maximise": "felt_path_dB"}, 'must be "eta_period_1" or "sharpness_1", but is "felt_path_dB"'),
                ({"optimise.am_frequency_Hz": [100.0]}, "optimise.am_frequency_Hz: 100 Hz has no whole number of periods"),
                ({"optimise.sm_frequency_Hz": [100.0]}, "optimise.sm_frequency_Hz: 100 Hz has no whole number of periods"),
                ({"optimise.update_rate_Hz": 2801.0}, "optimise.update_rate_Hz = 2801 results in"),
                ({"load.modulation": {"kind": "LM", "lm_frequency_Hz": 140.0, "lm_amplitude_mm": 4.0},
                  "optimise.over": ["envelope", "size"]}, 'over has more than "envelope"')):
            with self.subTest(changes=changes):
                self.job(changes)
                for command in ("optimise", "check"):  # the same error
                    self.contains(self.shearwake(command, "job.toml", expect=3).output, *says)
        self.job({"optimise.over": ["speed"]})
        self.contains(self.shearwake("check", "job.toml", expect=3).output, 'must contain "envelope"')
        self.job({"optimise.knot_us": None, "optimise.knots_us": 500.0})
        self.contains(self.shearwake("check", "job.toml", expect=3).output, "knot_us")
