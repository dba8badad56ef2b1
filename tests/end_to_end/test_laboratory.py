# SPDX-License-Identifier: BSD-3-Clause
"""A virtual experiment is exported, measured, fitted and compared; damaged data are refused with a reason."""
import csv
import fcntl
import json
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from program import PATIENCE_s, ROOT, SPECTRAL, ProgramTest, changed_job, command, environment, gaussian, job_text

from shearwake.laboratory.dispersion import curves, line_coordinates
from shearwake.laboratory.scan import Scan
from shearwake.laboratory.scan_files import read_scan, write_scan
from shearwake.studies import fit

C_S, VISCOSITY = 2.5, 0.3

GEL = {"medium": {"base": "rigid", "layer": [{"thickness_mm": 12.0, "density_kg_m3": 1000.0, "c_p_m_s": 1500.0, "c_s_m_s": C_S,
                                              "viscosity_Pa_s": VISCOSITY}]},
       "load": {"peak_Pa": 100.0, "footprint": gaussian(9.0), "modulation": {"kind": "AM", "am_frequency_Hz": 120.0}},
       "domain": {"extent_mm": [80.0, 80.0], "spacing_mm": 2.0}, "time": {"duration_ms": 20.0, "output_interval_us": 250.0},
       "solver": {"engine": "layered"}, "measure": {"settled_after_ms": 5.0}}
FULL = job_text("gel", **GEL, vibrometer={"grid_mm": [78.0, 78.0], "spacing_mm": 2.0, "center_mm": [-1.0, -1.0]})
LINE = job_text("gel", **GEL, vibrometer={"line_mm": [[-29.5, 0.0], [29.5, 0.0]], "spacing_mm": 1.0, "sampling_rate_kHz": 8.0})
LAYER = "medium.layer[1]"
SPEED = {f"{LAYER}.c_s_m_s": {"distribution": "uniform", "min": 1.5, "max": 4.0}}
LOAD = {"load.peak_Pa": {"distribution": "uniform", "min": 20.0, "max": 400.0},
        "vibrometer.trigger_delay_ms": {"distribution": "normal", "mean": 0.0, "sd": 1.0}}


def uncertain(keys):
    return {"uncertain": {"samples": 2, **keys}}


def fractional(tau_us, exponent):
    return {f"{LAYER}.viscosity_Pa_s": None, f"{LAYER}.loss": {"law": "fractional", "tau_us": tau_us, "exponent": exponent}}


FIT = changed_job(LINE, uncertain({**SPEED, f"{LAYER}.viscosity_Pa_s": {"distribution": "lognormal", "median": 0.5, "geometric_sd": 3.0}, **LOAD}))
FIT_OF_LOAD = changed_job(LINE, uncertain(LOAD))
LAYERS = ((8e-3, 1000.0, 1500.0, 2.2), (10e-3, 1000.0, 1500.0, 4.4))  # of jobs/gel-dispersion.toml


class LaboratoryTest(ProgramTest):
    def scanned(self, job, *more):
        """The case file of a job with a vibrometer."""
        path = self.write_job(job)
        out = self.folder / "out"
        self.shearwake("run", path, "--out", out, *more)
        return path, next((out / "cases").glob("*.h5"))

    def fails(self, *arguments):
        """A command that ends with the exit code of a usage error or of a bad job."""
        done = self.shearwake(*arguments, expect=None)
        self.assertIn(done.returncode, (2, 3), done.output)
        return done

    def with_noise(self, case, dB, missing=0.0, seed=1, name="noisy.mat"):
        scan = read_scan(case)
        rng = np.random.default_rng(seed)
        rms = np.sqrt(np.mean(scan.velocity_m_s ** 2))
        noisy = scan.velocity_m_s + 10.0 ** (-dB / 20.0) * rms * rng.normal(size=scan.velocity_m_s.shape)
        noisy[rng.random(len(noisy)) < missing] = np.nan
        path = self.folder / name
        write_scan(path, Scan(scan.time_s, scan.x_m, scan.y_m, noisy, None, scan.trigger_delay_s, scan.direction), "mat")
        return path


class Measure(LaboratoryTest):
    def test_data_at_full_density_have_the_measures_of_the_simulation(self):
        job, case = self.scanned(FULL)
        exported = self.folder / "scan.uff"
        self.shearwake("export", case, "--out", exported)
        text = self.shearwake("measure", exported, "--options", job, "--out", self.folder / "measured", "--no-report",
                              "--repetitions", "3").stdout
        self.assertIn("1600 of 1600 points", text)
        document = json.loads(self.shearwake("compare", self.folder / "measured", self.folder / "out", "--json", expect=1).stdout)
        rows = document["pairs"][0]["columns"]
        self.assertGreater(len(rows), 20)
        for row in rows:
            if row["column"].startswith(("wall_s", "mach")):
                continue
            with self.subTest(column=row["column"]):
                scale = max(abs(row["second"]), 1e-12)
                self.assertLess(abs(row["first"] - row["second"]) / scale, 1e-3)
        with open(self.folder / "measured" / "tables" / "gel.csv", encoding="utf-8") as file:
            names = next(csv.reader(file))
        self.assertTrue(any(name.endswith("_error") for name in names), names)

    @pytest.mark.extended
    def test_a_line_and_depths_are_refused(self):
        job, case = self.scanned(LINE)
        self.assertIn("lie on one line", self.fails("measure", case, "--options", job, "--no-report").stderr)
        failed = self.fails("measure", case, "--options", job, "-S", "measure.depths_mm=[0, 1]", "--no-report")
        self.assertIn("a scan contains the surface only", failed.stderr)

    @pytest.mark.long
    def test_damaged_files_are_refused_with_a_reason(self):
        job, case = self.scanned(LINE)
        exported = self.folder / "scan.uff"
        self.shearwake("export", case, "--out", exported)
        good = exported.read_text()
        velocity = re.search(r"^ {11}0\.0+E\+00| [- ]\d\.\d{12}E[+-]\d\d", good, re.M)[0]
        count = f"{161:10d}"
        self.assertIn(count, good)
        for text, words in ((good[:len(good) // 2], "truncated"),
                            (good.replace(count, f"{170:10d}", 1), "claims 170 values"),
                            (good.replace(count, f"{1250000000:10d}", 1), "claims 1250000000 values"),
                            (good.replace(velocity, "NaN".rjust(len(velocity)), 1), "not a finite number"),
                            (good.replace("m/s ", "ft/s", 1), "the unit of the velocity is"),
                            ("", "it is not a scan")):
            bad = self.folder / ("bad.uff" if text else "bad.csv")
            bad.write_text(text)
            for arguments in (("measure", bad, "--options", job, "--no-report"), ("fit", job, "--data", bad)):
                with self.subTest(words=words, command=arguments[0]):
                    if arguments[0] == "fit":
                        job.write_text(FIT)
                    failed = self.fails(*arguments)
                    self.assertIn(words, failed.stderr)
                    self.assertNotIn("Traceback", failed.stderr)


class Scans(LaboratoryTest):
    def test_every_exported_format_contains_the_scan_of_the_case(self):
        job, case = self.scanned(changed_job(LINE, {
            "vibrometer.tilt_deg": 10, "vibrometer.trigger_delay_ms": 1.25, "vibrometer.missing_percent": 5}))
        scan = read_scan(case)
        self.assertEqual(np.count_nonzero(scan.quality == 0.0), 3)
        for name, options in (("scan.uff", ()), ("binary.uff", ("--format", "uff", "--binary")), ("scan.csv", ("--format", "csv")),
                              ("scan.mat", ("--format", "mat"))):
            with self.subTest(name=name):
                path = self.folder / name
                self.assertIn("60 points", self.shearwake("export", case, "--out", path, *options).stdout)
                read = read_scan(path)
                for field in ("time_s", "x_m", "y_m", "velocity_m_s", "quality", "trigger_delay_s", "direction"):
                    # ASCII type 58 has 13 digits. Positions at 0 have the rounding errors of the line.
                    np.testing.assert_allclose(getattr(read, field), getattr(scan, field), rtol=1e-12, atol=1e-18)
        job.write_text(job_text("gel", **GEL))
        self.shearwake("run", job, "--out", self.folder / "plain")
        plain = next((self.folder / "plain" / "cases").glob("*.h5"))
        self.assertIn("a case has a scan if its job has [vibrometer]", self.fails("export", plain).stderr)

    @pytest.mark.extended
    def test_the_scan_does_not_depend_on_the_number_of_ranks(self):
        job = self.write_job(changed_job(LINE, {"vibrometer.tilt_deg": 30, "vibrometer.azimuth_deg": 20, "vibrometer.spot_um": 500}))
        found = []
        for ranks in (1, 3):
            out = self.folder / f"out{ranks}"
            self.shearwake("run", job, "--out", out, ranks=ranks)
            found.append(read_scan(next((out / "cases").glob("*.h5"))))
        one, three = (scan.velocity_m_s for scan in found)
        self.assertEqual(one.shape, (60, 161))
        # Sums over other parts of the plane differ by rounding.
        self.assertLess(np.max(np.abs(one - three)), 1e-10 * np.max(np.abs(one)))
        # At 30 degrees, what differs between both sides of the focus is twice the tangential motion.
        self.assertGreater(np.max(np.abs(one - one[::-1])), 0.05 * np.max(np.abs(one)))


class Fit(LaboratoryTest):
    def check_frozen(self, name, found, share=0.05):
        """Compares fit.json with the result of the earlier implementation in C++ on Ceres, which ended within 1e-6 of the least cost:
        within 0.1 standard errors of the minimum with 9660 samples, 0.4 with 168000. Estimates differ by at most `share` of a
        standard error."""
        expected = json.loads((ROOT / "tests" / "data" / "studies" / "fit.json").read_text(encoding="utf-8"))[name]
        for key, entry in expected["estimates"].items():
            estimate, delta = found["estimates"][key], share * entry["standard_error"]
            with self.subTest(key=key):
                self.assertAlmostEqual(estimate["value"], entry["value"], delta=delta)
                self.assertAlmostEqual(estimate["standard_error"] / entry["standard_error"], 1.0, delta=0.02)
                for ours, theirs in zip(estimate["interval_95"], entry["interval_95"]):
                    self.assertAlmostEqual(ours, theirs, delta=2.0 * delta)
                np.testing.assert_allclose(estimate["bounds"], entry["bounds"], rtol=1e-12)
        np.testing.assert_allclose(found["correlations"], expected["correlations"], atol=0.02)
        self.assertEqual((found["points"], found["outliers"]), (expected["points"], expected["outliers"]))
        self.assertAlmostEqual(found["noise_m_s"] / expected["noise_m_s"], 1.0, delta=1e-3)
        for ours, theirs in zip(found["simpler_laws"], expected["simpler_laws"], strict=True):
            self.assertEqual((ours["law"], ours["suffices"]), (theirs["law"], theirs["suffices"]))
            self.assertAlmostEqual(ours["bic_change"] / theirs["bic_change"], 1.0, delta=1e-3)

    @pytest.mark.long
    def test_the_virtual_experiment_gives_the_frozen_estimates(self):
        jobs = ROOT / "jobs"
        self.shearwake("run", jobs / "virtual-experiment.toml", "--out", self.folder / "out")
        case = next((self.folder / "out" / "cases").glob("*.h5"))
        self.shearwake("fit", jobs / "read-back.toml", "--data", case, "--out", self.folder / "fit")
        # Ceres ended 0.0033 above the least cost, 0.08 standard errors away.
        self.check_frozen("virtual-experiment", json.loads((self.folder / "fit" / "fit.json").read_text()), share=0.1)

    def test_an_interrupted_fit_resumes_with_its_predictions(self):
        job, case = self.scanned(LINE)
        job.write_text(FIT_OF_LOAD)
        reports = []

        def interrupt(progress):
            reports.append(progress)
            if progress.predictions == 4:
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            fit(job, case, out=self.folder / "fit", progress=interrupt)
        fitted = fit(job, case, out=self.folder / "fit", progress=reports.append)
        self.assertEqual(reports[-1].computed, reports[-1].predictions - 4)
        self.assertAlmostEqual(fitted.estimates["load.peak_Pa"].value, 100.0, delta=0.1)
        # A damaged prediction is computed again.
        path = next((self.folder / "fit" / "evaluations").iterdir())
        content = path.read_bytes()
        path.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
        again = fit(job, case, out=self.folder / "fit", progress=reports.append)
        self.assertEqual((reports[-1].computed, again.document), (1, fitted.document))
        with open(self.folder / "fit" / "lock", "w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.contains(self.shearwake("fit", job, "--data", case, "--out", self.folder / "fit", expect=2).output,
                          "being used by another shearwake fit")

    @pytest.mark.extended
    def test_an_interrupted_command_ends_with_exit_code_75(self):
        job, case = self.scanned(LINE)
        job.write_text(FIT)
        process = subprocess.Popen(command("fit", job, "--data", case, "--out", self.folder / "fit"), env=environment(),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
        deadline = time.monotonic() + PATIENCE_s
        while not list((self.folder / "fit").glob("evaluations/*")) and time.monotonic() < deadline:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, text = process.communicate(timeout=PATIENCE_s)
        self.assertEqual((process.returncode, text), (75, "the fit was interrupted; rerun the command to resume it\n"))

    @pytest.mark.long
    def test_a_noisy_line_gives_the_material_back(self):
        job, case = self.scanned(LINE)
        data = self.with_noise(case, 20.0)
        job.write_text(FIT)
        out = self.folder / "fit"
        text = self.shearwake("fit", job, "--data", data, "--out", out, ranks=2).stdout
        found = json.loads((out / "fit.json").read_text())
        self.check_frozen("line", found)
        estimates = found["estimates"]
        c_s, viscosity = (estimates[f"medium.layer[1].{key}"] for key in ("c_s_m_s", "viscosity_Pa_s"))
        self.assertTrue(found["converged"], text)
        self.assertLess(abs(c_s["value"] - C_S), 0.02 * C_S)
        self.assertLess(abs(viscosity["value"] - VISCOSITY), 0.1 * VISCOSITY)
        for estimate, truth in ((c_s, C_S), (viscosity, VISCOSITY), (estimates["load.peak_Pa"], 100.0),
                                (estimates["vibrometer.trigger_delay_ms"], 0.0)):
            # Five standard errors: this seed is one of many.
            self.assertLess(abs(estimate["value"] - truth), 5.0 * estimate["standard_error"])
        self.assertFalse(found["simpler_laws"][0]["suffices"], "the layer is lossy")
        for name in ("residuals.png", "correlations.png", "dispersion.png", "dispersion.csv", "residuals.csv"):
            self.assertTrue((out / name).is_file(), name)
        self.assertIn("does not suffice", text)
        with h5py.File(out / "fit.h5", "r") as file:
            self.assertEqual(file["measured"].shape, file["predicted"].shape)

    @pytest.mark.long
    def test_a_scan_against_z_gives_the_pressure_and_the_delay_back(self):
        job, case = self.scanned(LINE)
        scan = read_scan(case)
        job.write_text(FIT_OF_LOAD)
        turned = self.folder / "turned.csv"
        write_scan(turned, Scan(scan.time_s, scan.x_m, scan.y_m, -scan.velocity_m_s, None, 0.0, (0.0, 0.0, -1.0)), "csv")
        unstated = self.folder / "unstated.csv"
        unstated.write_text("".join(line for line in turned.read_text().splitlines(True) if not line.startswith("#")))
        for data, options, note in ((turned, (), "positive velocities point out of the skin"),
                                    (unstated, ("--outwards",), "z of the file points out of the skin")):
            with self.subTest(data=data.name):
                out = self.folder / data.stem
                self.assertIn(note, self.shearwake("fit", job, "--data", data, "--out", out, *options).stdout)
                found = json.loads((out / "fit.json").read_text())["estimates"]
                # Without noise: the tolerance of the solver.
                self.assertLess(abs(found["load.peak_Pa"]["value"] - 100.0), 0.1)
                self.assertLess(abs(found["vibrometer.trigger_delay_ms"]["value"]), 1e-3)

    @pytest.mark.long
    def test_a_fractional_layer_and_its_thickness_are_found_and_no_simpler_law_suffices(self):
        truth = {"c_s_m_s": 2.2, "thickness_mm": 9.0, "loss.tau_us": 80.0, "loss.exponent": 0.5}
        job, case = self.scanned(changed_job(LINE, {f"{LAYER}.{key}": value for key, value in truth.items()},
                                             fractional(truth["loss.tau_us"], truth["loss.exponent"])))
        thickness = {"distribution": "normal", "mean": 11.0, "sd": 3.0, "min": 5.0, "max": 20.0}
        found = self.fractional_fit(job, self.with_noise(case, 20.0), {**SPEED, f"{LAYER}.thickness_mm": thickness})
        self.check_frozen("fractional", found)
        for key, value in truth.items():
            estimate = found["estimates"][f"medium.layer[1].{key}"]
            with self.subTest(key=key, **estimate):
                # Five standard errors: this seed is one of many. They must be small enough to mean something.
                self.assertLess(abs(estimate["value"] - value), 5.0 * estimate["standard_error"])
                self.assertLess(estimate["standard_error"], 0.2 * value)
        self.assertEqual([(one["law"], one["suffices"]) for one in found["simpler_laws"]], [("Kelvin-Voigt", False)])

    @pytest.mark.long
    def test_a_fractional_law_is_not_needed_for_a_kelvin_voigt_layer(self):
        job, case = self.scanned(LINE)
        found = self.fractional_fit(job, self.with_noise(case, 20.0), {})
        self.assertEqual([(one["law"], one["suffices"]) for one in found["simpler_laws"]], [("Kelvin-Voigt", True)])

    def fractional_fit(self, job, data, keys):
        job.write_text(changed_job(LINE, fractional(60.0, 0.7), uncertain({
            f"{LAYER}.loss.tau_us": {"distribution": "lognormal", "median": 60.0, "geometric_sd": 3.0},
            f"{LAYER}.loss.exponent": {"distribution": "uniform", "min": 0.1, "max": 0.999}, **keys})))
        out = self.folder / "fit"
        self.shearwake("fit", job, "--data", data, "--out", out, ranks=2)
        return json.loads((out / "fit.json").read_text())

    @pytest.mark.extended
    def test_a_fit_needs_keys_and_the_engine_layered(self):
        job, case = self.scanned(LINE)
        self.assertIn("[uncertain] names no key", self.fails("fit", job, "--data", case).stderr)
        job.write_text(changed_job(FIT, SPECTRAL))
        self.assertIn("fit computes with engine", self.fails("fit", job, "--data", case).stderr)

    @pytest.mark.extended
    def test_overrides_change_the_fit_or_are_warned_of(self):
        job, case = self.scanned(LINE)
        job.write_text(changed_job(LINE, uncertain(SPEED)))
        key = "medium.layer[1].c_s_m_s"
        fit = ("fit", job, "--data", case, "--out", self.folder / "fit")
        output = self.shearwake(*fit, "-S", f"{key}=3.0", "-S", "vibrometer.averages=9", "-S", "vibrometer.spot_um=10.0").stderr
        self.assertIn(f"-S {key}: warning: {key} is uncertain, so this override has no effect", output)
        self.assertIn("-S vibrometer.averages: warning: the scan contains the recorded motion", output)
        self.assertNotIn("spot_um", output)
        self.shearwake(*fit, "-S", f'uncertain."{key}".min=2.6')  # the true speed is 2.5 m/s
        estimate = json.loads((self.folder / "fit" / "fit.json").read_text())["estimates"][key]
        self.assertAlmostEqual(estimate["bounds"][0], 2.6, places=6)  # bounds are quantiles close to the ends
        self.assertGreaterEqual(estimate["value"], 2.6)
        measure = ("measure", case, "--options", job, "--no-report", "--repetitions", "0", "--out", self.folder / "measure")
        self.assertIn("this command uses one case", self.fails(*measure, "-S", 'sweep."load.peak_Pa"=[3.0, 4.0]').stderr)


def secular(k, omega, layers):
    """The determinant of the tractions at the surface over the states without displacement at the base: the displacement-stress
    vector is propagated through the layers by matrix exponentials (Aki and Richards, Quantitative Seismology, eq. 7.28)."""
    states = np.zeros((4, 2))
    states[2, 0] = states[3, 1] = 1.0
    for h, rho, c_p, c_s in reversed(layers):
        mu, lam = rho * c_s ** 2, rho * (c_p ** 2 - 2.0 * c_s ** 2)
        p = lam + 2.0 * mu
        zeta = 4.0 * mu * (lam + mu) / p
        a = np.array([[0.0, k, 1.0 / mu, 0.0], [-k * lam / p, 0.0, 0.0, 1.0 / p],
                      [k * k * zeta - omega ** 2 * rho, 0.0, 0.0, k * lam / p], [0.0, -omega ** 2 * rho, -k, 0.0]])
        states = expm(-a * h) @ states
        states = states / np.abs(states).max(axis=0)
    return np.linalg.det(states[2:])


def secular_speeds(omega, layers, speeds):
    """All phase speeds between neighbours of `speeds` at which the determinant changes its sign."""
    values = [secular(omega / c, omega, layers) for c in speeds]
    return [brentq(lambda c: secular(omega / c, omega, layers), a, b)
            for a, b, u, v in zip(speeds, speeds[1:], values, values[1:]) if u * v < 0.0]


class Dispersion(LaboratoryTest):
    @pytest.mark.long
    def test_guided_waves_of_two_layers_follow_the_secular_equation(self):
        _, case = self.scanned((ROOT / "jobs" / "gel-dispersion.toml").read_text(encoding="utf-8"))
        scan = read_scan(case)
        frequencies, speeds, _ = curves(line_coordinates(scan.x_m, scan.y_m), scan.velocity_m_s, scan.rate_Hz)
        compared = 0
        for f, c in zip(frequencies, speeds):
            if not 100.0 <= f <= 600.0 or np.isnan(c):
                continue
            roots = secular_speeds(2.0 * np.pi * f, LAYERS, np.geomspace(1.0, 30.0, 400))
            with self.subTest(frequency_Hz=f, roots=roots, measured=c):
                self.assertLess(min(abs(c - root) / root for root in roots), 0.02)
            compared += 1
        self.assertGreater(compared, 70)
