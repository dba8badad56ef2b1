# SPDX-License-Identifier: BSD-3-Clause
"""Jobs with random changes: check and plan accept them or report errors, in limited time and memory."""
import json
import random
import re
import shutil
import zlib

import pytest

from shearwake import Job

from limits import accepted_or_refused, grey_header, png, times
from mutations import mutated
from program import AM, ONE_CASE, PSTD, ROOT, SPECTRAL, ProgramTest, changed, changed_job, command


def stored_job(name, *changes):
    """A job of the repository with changed keys."""
    return changed_job(ROOT / "jobs" / f"{name}.toml", *changes)


def linspace(*arguments):
    return {"linspace": list(arguments)}


class MutatedJobs(ProgramTest):
    def accepted_or_refused(self, verb, name=""):
        return accepted_or_refused(self, command(verb, "job.toml", "--elsewhere"), (0, 3), f"{verb} {name}")

    def test_mutated_jobs_are_accepted_or_refused_at_once(self):
        jobs = sorted((ROOT / "jobs").glob("*.toml"))
        for file in (ROOT / "jobs").glob("*.csv"):
            shutil.copy(file, self.folder)
        rng = random.Random(1)
        found = {0: 0, 3: 0}
        for number in range(times(20, 500)):
            job = rng.choice(jobs)
            text = mutated(job.read_text(encoding="utf-8"), rng)
            self.write_job(text)
            for verb in ("check", "plan"):
                with self.subTest(number=number, job=job.name, verb=verb):
                    found[self.accepted_or_refused(verb, f"{job.name} number {number}\n{text}")[1]] += 1
        self.assertGreater(min(found.values()), times(20, 500) // 10, found)

    @pytest.mark.extended
    def test_plans_of_many_cases_with_chosen_steps_end_at_once(self):
        for file in (ROOT / "jobs").glob("*.csv"):
            shutil.copy(file, self.folder)
        for name, change in (("fig2.2", SPECTRAL), ("foci", SPECTRAL), ("gaussian-or-array", SPECTRAL),
                             ("am-on-force-or-pressure", {"time.output_interval_us": 0.0317})):
            self.write_job(stored_job(name, change))
            with self.subTest(name=name):
                output, code = self.accepted_or_refused("plan", name)
                self.assertEqual(code, 0, output)

    @pytest.mark.extended
    def test_the_step_of_a_fine_mesh_is_left_to_the_run(self):
        """Trial runs of thousands of elements take seconds."""
        self.write_job(stored_job("bone-under-palm", {"solver.spectral.longest_element_mm": 0.005}))
        output, code = self.accepted_or_refused("plan")
        self.assertEqual(code, 0, output)
        self.contains(output, "choosing time steps takes more than a second and is left to `run`")
        self.contains(output, "time: not known on this machine yet")

    @pytest.mark.extended
    def test_a_huge_grid_of_pstd_is_planned_at_once(self):
        """A body that crosses the domain, among millions of rows of nodes."""
        self.write_job(stored_job("bone-under-palm", {
            "solver": {"engine": "pstd"}, "domain": {"extent_mm": [1280.0, 800.0], "spacing_mm": 0.2}}))
        for verb in ("check", "plan"):
            output, code = self.accepted_or_refused(verb)
            self.assertEqual(code, 0, output)
        self.contains(output, "left to `run`")

    @pytest.mark.extended
    def test_many_bodies_are_compared_at_once(self):
        """The overlaps of all pairs, also beyond the periodic edges, and the steps of pstd around each of them."""
        rng = random.Random(2)
        places = [[rng.uniform(-64, 64), rng.uniform(-40, 40), rng.uniform(6, 14)] for _ in range(120)]
        shape = {"shape": "ellipsoid", "semi_axes_mm": [6.0, 5.0, 4.0], "azimuth_deg": 30.0}
        bone, = Job(ROOT / "jobs" / "bone-under-palm.toml").tables["medium"]["body"]
        for engine, stiffness in (("spectral", {"rigid": True}), ("spectral", {"c_s_m_s": 900.0}), ("pstd", {"c_s_m_s": 12.0})):
            bodies = [bone, *({**shape, "center_mm": at, **stiffness} for at in places)]
            self.write_job(stored_job("bone-under-palm", ONE_CASE, {"solver.engine": engine, "medium.body": bodies}))
            with self.subTest(engine=engine, stiffness=stiffness):
                self.accepted_or_refused("check")
                if engine == "pstd":
                    self.accepted_or_refused("plan")

    @pytest.mark.extended
    def test_check_counts_the_files_of_all_cases(self):
        """Some TB."""
        every_frame = [round(0.05 * i, 2) for i in range(1, 281)]
        self.write_job(stored_job("quickstart", {"domain.extent_mm": [960.0, 640.0], "record.snapshots_ms": every_frame, "table": None,
                                                 "sweep": {"load.peak_Pa": linspace(10.0, 100.0, 3000)}}))
        output = {}
        for verb in ("check", "plan"):
            output[verb], _ = accepted_or_refused(self, command(verb, "job.toml"), (3,), verb)
        self.assertEqual(*(re.search(r"the files of the cases need \d+ MB", text).group() for text in output.values()))

    @pytest.mark.extended
    def test_a_sweep_of_the_depth_of_a_body_is_planned_at_once(self):
        text = (ROOT / "jobs" / "bone-under-palm.toml").read_text(encoding="utf-8")
        self.write_job(changed(('"medium.body[1].depth_mm" = [5.0, 6.0, 8.0, 10.0, 14.0]',
                                '"medium.body[1].depth_mm" = { linspace = [5.0, 14.0, 20] }'), text=text))
        output, code = self.accepted_or_refused("plan")
        self.assertEqual(code, 0, output)
        self.contains(output, "40 cases")

    @pytest.mark.extended
    def test_a_large_sweep_with_an_array_is_validated_at_once(self):
        """The pattern of an array takes more time than all else that validates a case."""
        array = {"shape": "array", "preset": "array-16x16", "distance_mm": 200.0}
        for peaks, distances, code, words in ((1500, 0, 0, "1500 cases"), (1500, 6, 0, "9000 cases"),
                                              (2, 2000, 3, "has 2000 different arrays, but at most")):
            axes = {"load.peak_Pa": linspace(10.0, 100.0, peaks)}
            if distances:
                axes["load.footprint.distance_mm"] = linspace(150.0, 250.0, distances)
            self.write_job(stored_job("foci", {"load.footprint": array, "sweep": axes, "table": None}))
            with self.subTest(distances=distances):
                output, ended = self.accepted_or_refused("check")
                self.assertEqual(ended, code, output)
                self.contains(output, words)

    @pytest.mark.extended
    def test_the_resources_of_a_large_plan_are_those_of_cases_spread_over_it(self):
        """The files of a case grow linearly with its duration, so their mean is that of the shortest and the longest case."""
        mean_B = {}
        for count in (2, 2501):
            self.write_job(stored_job("foci", {"time.output_interval_us": 10.0, "table": None,
                                               "sweep": {"time.duration_ms": linspace(60.0, 160.0, count)}}))
            output, code = self.accepted_or_refused("plan")
            self.assertEqual(code, 0, output)
            document = json.loads(self.shearwake("plan", "job.toml", "--elsewhere", "--json").stdout)
            mean_B[count], estimated = document["disk_B"] / count, document["estimated_cases"]
        self.assertLess(estimated, 2501)
        self.contains(output, "of 2501 cases, the largest and others that are spread evenly")
        # Gaps between the computed cases are at most 2.7 times their mean (multiples of the golden ratio).
        self.assertAlmostEqual(mean_B[2501] / mean_B[2], 1.0, delta=2.7 / estimated)

    @pytest.mark.extended
    def test_steady_states_with_hardly_any_loss_are_computed_or_errors_of_the_job(self):
        for exponent, code in ((0.27, 0), (1e-7, 0), (1e-300, 3)):
            self.write_job(stored_job("reardon-square", {"medium.layer[1].loss.exponent": exponent}))
            for verb in ("check", "plan"):
                with self.subTest(exponent=exponent, verb=verb):
                    output, ended = self.accepted_or_refused(verb)
                    self.assertEqual(ended, code, output)
        self.contains(output, "the loss factor of layer", "at 8.333 Hz", "increase its loss")

    @pytest.mark.extended
    def test_pictures_are_decoded_once(self):
        self.write_job(stored_job("lens-letter", {"load.footprint.target_polygon_mm": None, "load.footprint.target_png": "grey.png",
                                                  "load.footprint.target_width_mm": 40.0, "sweep": {AM: linspace(75, 300, 200)}}))
        side = 4096
        (self.folder / "grey.png").write_bytes(png(grey_header(side), zlib.compress((b"\0" + side * b"\xff") * side, 9)))
        output, ended = self.accepted_or_refused("check", "pictures")
        self.assertEqual(ended, 0, output)
        self.contains(output, "200 cases")

    @pytest.mark.extended
    def test_work_without_bounds_is_refused_with_the_number_and_the_limit(self):
        array = {"shape": "array", "elements": [16, 16], "pitch_mm": 10.0, "radius_mm": 4.5, "distance_mm": 200.0}
        transient = {"time.regime": None, "time.duration_ms": 1e5, "time.output_interval_us": 1000.0}
        letter = [[-20, 30], [-6, 30], [-6, -16], [900, -16], [24, -30], [-20, -30]]
        (self.folder / "scan.csv").write_text("x_mm,y_mm\n" + "".join(f"{i % 199 - 99},{i % 79 - 39}\n" for i in range(19_900)),
                                              encoding="utf-8")
        for name, job, changes, words in (
                ("rigid body", "bone-under-palm", {**ONE_CASE, "domain.spacing_mm": 0.05, "medium.body[1].axis": "z", "medium.body[1].rigid": True,
                                                   "medium.body[1].length_mm": 12.0}, "squares of the grid"),
                ("references", "quickstart", {
                    "load.modulation": {"kind": "AM", "am_frequency_Hz": 200.0}, "sweep": {"load.footprint.fwhm_mm": linspace(3, 5, 9990)},
                    "table": {"reference": {"am_frequency_Hz": 100.0}}}, "more than 10000 cases with the references"),
                ("long lists", "quickstart", {
                    "vibrometer.file": "scan.csv", "sweep": {"load.footprint.fwhm_mm": linspace(3, 5, 5000)}, "table": None},
                 "each case has lists of 39800 numbers"),
                ("elements", "steady-circle", {"load.footprint": {**array, "elements": [100, 100], "pitch_mm": 1.0, "radius_mm": 0.5}},
                 "products of samples and elements"),
                ("reach of a lens", "lens-letter", {"load.footprint.reach_mm": 500.0}, "at most 800 x 800"),
                ("grid of pstd", "quickstart", {**ONE_CASE, **PSTD, "domain": {"extent_mm": [1000.0, 1000.0], "spacing_mm": 0.05}}, "MB per rank"),
                ("cases", "foci", {"sweep": {"load.peak_Pa": linspace(10.0, 100.0, 9000), "load.footprint.fwhm_mm": linspace(8, 12, 8)},
                                   "table": None}, "sweep results in 72000 cases; at most 10000 are supported"),
                ("target far outside", "lens-letter", {"load.footprint.target_polygon_mm": letter, "load.footprint.pixel_mm": 0.5},
                 "6075 x 6075 points, but at most 800 x 800"),
                ("iterations", "lens-letter", {"load.footprint.iterations": 10000}, "points times iterations"),
                ("ramp", "steady-circle", {"load.modulation.ramp_ms": 1e-9, "time.regime": None, "time.duration_ms": 100.0},
                 "at most 1e+06 are supported"),
                ("duration", "steady-circle", {**transient, "time.duration_ms": 1e6}, "at most"),
                ("samples", "steady-circle", {**transient, "solver.layered.time_step_us": 0.01}, "samples of the load in time"),
                ("common period", "steady-circle", {
                    "sweep": {"load.modulation.draw_frequency_Hz": [25.00000001], "load.modulation.am_depth": [1.0]},
                    "time.longest_period_ms": 1e7, AM: 1e5}, "no common period"),
                ("array", "steady-circle", {"load.footprint": {**array, "reach_mm": 500.0, "frequency_kHz": 200.0}},
                 "samples of the pattern, but at most")):
            self.write_job(stored_job(job, {"afferents": None}, changes))
            for verb in ("check", "plan"):
                with self.subTest(name=name, verb=verb):
                    output, code = accepted_or_refused(self, command(verb, "job.toml"), (3,), f"{verb} {name}")
                    self.contains(output, words)
