# SPDX-License-Identifier: BSD-3-Clause
"""Jobs with random changes: check and plan accept them or report errors, in limited time and memory."""
import json
import random
import re
import shutil
import zlib

import pytest

from limits import accepted_or_refused, grey_header, png, times
from mutations import mutated
from program import ROOT, ProgramTest, changed, command



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
        spectral = ('engine = "layered"', 'engine = "spectral"')
        for name, change in (("fig2.2", spectral), ("foci", spectral), ("gaussian-or-array", spectral),
                             ("am-on-force-or-pressure", ("output_interval_us = 50.0", "output_interval_us = 0.0317"))):
            text = (ROOT / "jobs" / f"{name}.toml").read_text(encoding="utf-8")
            self.write_job(changed(change, text=text))
            with self.subTest(name=name):
                output, code = self.accepted_or_refused("plan", name)
                self.assertEqual(code, 0, output)

    @pytest.mark.extended
    def test_the_step_of_a_fine_mesh_is_left_to_the_run(self):
        """Trial runs of thousands of elements take seconds."""
        text = (ROOT / "jobs" / "bone-under-palm.toml").read_text(encoding="utf-8")
        self.write_job(text.replace("longest_element_mm = 2.0", "longest_element_mm = 0.005"))
        output, code = self.accepted_or_refused("plan")
        self.assertEqual(code, 0, output)
        self.contains(output, "choosing time steps takes more than a second and is left to `run`")
        self.contains(output, "time: not known on this machine yet")

    @pytest.mark.extended
    def test_a_huge_grid_of_pstd_is_planned_at_once(self):
        """A body that crosses the domain, among millions of rows of nodes."""
        text = (ROOT / "jobs" / "bone-under-palm.toml").read_text(encoding="utf-8")
        text = changed(('"spectral"', '"pstd"'), ("extent_mm = [128.0, 80.0]", "extent_mm = [1280.0, 800.0]"),
                       ("spacing_mm = 1.0", "spacing_mm = 0.2"), text=text)
        self.write_job(text.replace("[solver.spectral]\naccuracy = 5e-3\nlongest_element_mm = 2.0", ""))
        for verb in ("check", "plan"):
            output, code = self.accepted_or_refused(verb)
            self.assertEqual(code, 0, output)
        self.contains(output, "left to `run`")

    @pytest.mark.extended
    def test_many_bodies_are_compared_at_once(self):
        """The overlaps of all pairs, also beyond the periodic edges, and the steps of pstd around each of them."""
        text = (ROOT / "jobs" / "bone-under-palm.toml").read_text(encoding="utf-8")
        text = text[:text.index("[sweep]")]
        rng = random.Random(2)
        places = [[rng.uniform(-64, 64), rng.uniform(-40, 40), rng.uniform(6, 14)] for _ in range(120)]
        for engine, rigid in (("spectral", "rigid = true"), ("spectral", "c_s_m_s = 900.0"), ("pstd", "c_s_m_s = 12.0")):
            bodies = "".join(f'[[medium.body]]\nshape = "ellipsoid"\ncenter_mm = {at}\nsemi_axes_mm = [6.0, 5.0, 4.0]\n'
                             f'azimuth_deg = 30.0\n{rigid}\n' for at in places)
            self.write_job(text.replace('"spectral"', f'"{engine}"').replace("[load]", bodies + "[load]", 1))
            with self.subTest(engine=engine, rigid=rigid):
                self.accepted_or_refused("check")
                if engine == "pstd":
                    self.accepted_or_refused("plan")

    @pytest.mark.extended
    def test_check_counts_the_files_of_all_cases(self):
        """Some TB."""
        text = (ROOT / "jobs" / "quickstart.toml").read_text(encoding="utf-8")
        every_frame = ", ".join(f"{0.05 * i:.2f}" for i in range(1, 281))
        snapshots = re.search(r"(?<=snapshots_ms = )\[[^]]*\]", text).group()
        text = changed(("[240.0, 162.0]", "[960.0, 640.0]"), (snapshots, f"[{every_frame}]"), text=text[:text.index("[sweep]")])
        self.write_job(text + '[sweep]\n"load.peak_Pa" = { linspace = [10.0, 100.0, 3000] }\n')
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
        text = (ROOT / "jobs" / "foci.toml").read_text(encoding="utf-8")
        text = text[:text.index("[sweep]")] + '[sweep]\n"load.peak_Pa" = { linspace = [10.0, 100.0, 1500] }\n'
        text = changed(('shape = "gaussian", fwhm_mm = 10.2', 'shape = "array", preset = "array-16x16", distance_mm = 200.0'), text=text)
        distances = '"load.footprint.distance_mm" = {{ linspace = [150.0, 250.0, {}] }}'
        for more, code, words in (("", 0, "1500 cases"), (distances.format(6), 0, "9000 cases"),
                                  (distances.format(2000), 3, "has 2000 different arrays, but at most")):
            swept = text.replace("1500] }", "2] }" if code else "1500] }") + more + "\n"
            self.write_job(swept)
            with self.subTest(more=more):
                output, ended = self.accepted_or_refused("check")
                self.assertEqual(ended, code, output)
                self.contains(output, words)

    @pytest.mark.extended
    def test_the_resources_of_a_large_plan_are_those_of_cases_spread_over_it(self):
        """The files of a case grow linearly with its duration, so their mean is that of the shortest and the longest case."""
        text = (ROOT / "jobs" / "foci.toml").read_text(encoding="utf-8")
        text = changed(("output_interval_us = 250.0", "output_interval_us = 10.0"), text=text[:text.index("[sweep]")])
        mean_B = {}
        for count in (2, 2501):
            self.write_job(text + f'[sweep]\n"time.duration_ms" = {{ linspace = [60.0, 160.0, {count}] }}\n')
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
        text = (ROOT / "jobs" / "reardon-square.toml").read_text(encoding="utf-8")
        for exponent, code in (("0.27", 0), ("1e-7", 0), ("1e-300", 3)):
            self.write_job(changed(("exponent = 0.27", f"exponent = {exponent}"), text=text))
            for verb in ("check", "plan"):
                with self.subTest(exponent=exponent, verb=verb):
                    output, ended = self.accepted_or_refused(verb)
                    self.assertEqual(ended, code, output)
        self.contains(output, "the loss factor of layer", "at 8.333 Hz", "increase its loss")

    @pytest.mark.extended
    def test_pictures_are_decoded_once(self):
        lens = (ROOT / "jobs" / "lens-letter.toml").read_text(encoding="utf-8")
        polygon = next(line for line in lens.splitlines() if line.startswith("target_polygon_mm"))
        text = changed((polygon, 'target_png = "grey.png"\ntarget_width_mm = 40.0'), ("[75, 150, 300]", "{ linspace = [75, 300, 200] }"), text=lens)
        self.write_job(text)
        side = 4096
        (self.folder / "grey.png").write_bytes(png(grey_header(side), zlib.compress((b"\0" + side * b"\xff") * side, 9)))
        output, ended = self.accepted_or_refused("check", "pictures")
        self.assertEqual(ended, 0, output)
        self.contains(output, "200 cases")

    def test_work_without_bounds_is_refused_with_the_number_and_the_limit(self):
        lens = (ROOT / "jobs" / "lens-letter.toml").read_text(encoding="utf-8")
        steady = (ROOT / "jobs" / "steady-circle.toml").read_text(encoding="utf-8")
        steady = changed(("[afferents]\nwhere = \"csv\"\nfile = \"circle-afferents.csv\"\ninput = \"stress\"\nperiods = 12\n", ""),
                         text=steady)
        gaussian = 'footprint = { shape = "gaussian", fwhm_mm = 8.5 }'
        array = 'footprint = { shape = "array", elements = [16, 16], pitch_mm = 10.0, radius_mm = 4.5, distance_mm = 200.0'
        foci = (ROOT / "jobs" / "foci.toml").read_text(encoding="utf-8")
        bone = (ROOT / "jobs" / "bone-under-palm.toml").read_text(encoding="utf-8")
        bone = bone[:bone.index("[sweep]")]
        quickstart = (ROOT / "jobs" / "quickstart.toml").read_text(encoding="utf-8")
        quickstart = quickstart[:quickstart.index("[sweep]")]
        at_rest = changed(("AM-STM", "AM"), ("speed_m_s = 7.0\n", ""), text="\n".join(
            line for line in quickstart.splitlines() if not line.startswith("path =")) + "\n")
        (self.folder / "scan.csv").write_text("x_mm,y_mm\n" + "".join(f"{i % 199 - 99},{i % 79 - 39}\n" for i in range(19_900)),
                                              encoding="utf-8")
        for name, text, words in (
                ("rigid body", changed(("spacing_mm = 1.0", "spacing_mm = 0.05"), ('axis = "y"', 'axis = "z"\nrigid = true'),
                                       text=bone.replace("center_mm", "length_mm = 12.0\ncenter_mm")), "squares of the grid"),
                ("references", at_rest + '[sweep]\n"load.footprint.fwhm_mm" = { linspace = [3, 5, 9990] }\n'
                 '[table]\nreference = { am_frequency_Hz = 100.0 }\n', "more than 10000 cases with the references"),
                ("long lists", quickstart + '[vibrometer]\nfile = "scan.csv"\n[sweep]\n"load.footprint.fwhm_mm" = '
                 '{ linspace = [3, 5, 5000] }\n', "each case has lists of 39800 numbers"),
                ("elements", changed((gaussian, f"{array.replace('[16, 16]', '[100, 100]').replace('10.0', '1.0').replace('4.5', '0.5')} }}"),
                                     text=steady), "products of samples and elements"),
                ("reach of a lens", changed(("pixel_mm = 4.0", "pixel_mm = 4.0\nreach_mm = 500.0"), text=lens), "at most 800 x 800"),
                ("grid of pstd", changed(('engine = "layered"', 'engine = "pstd"'), ("[240.0, 162.0]", "[1000.0, 1000.0]"),
                                         ("spacing_mm = 0.75", "spacing_mm = 0.05"), text=quickstart), "MB per rank"),
                ("cases", changed(("[sweep]", '[sweep]\n"load.peak_Pa" = { linspace = [10.0, 100.0, 9000] }'), text=foci),
                 "sweep results in 72000 cases; at most 10000 are supported"),
                ("target far outside", changed(("[24, -16]", "[900, -16]"), ("pixel_mm = 4.0", "pixel_mm = 0.5"), text=lens),
                 "6075 x 6075 points, but at most 800 x 800"),
                ("iterations", changed(("pixel_mm = 4.0", "pixel_mm = 4.0\niterations = 10000"), text=lens),
                 "points times iterations"),
                ("ramp", changed(('am_frequency_Hz = 200.0', 'am_frequency_Hz = 200.0\nramp_ms = 1e-9'),
                                 ('regime = "periodic"', 'duration_ms = 100.0'), text=steady),
                 "at most 1e+06 are supported"),
                ("duration", changed(('regime = "periodic"', 'duration_ms = 1e6\n'), ("output_interval_us = 250.0",
                                     "output_interval_us = 1000.0"), text=steady), "at most"),
                ("samples", changed(('engine = "layered"', 'engine = "layered"\n[solver.layered]\ntime_step_us = 0.01'),
                                    ('regime = "periodic"', 'duration_ms = 1e5'),
                                    ("output_interval_us = 250.0", "output_interval_us = 1000.0"), text=steady),
                 "samples of the load in time"),
                ("common period", changed(("[25, 50, 75, 100, 125, 150]", "[25.00000001]"),
                                          ('regime = "periodic"', 'regime = "periodic"\nlongest_period_ms = 1e7'),
                                          ("am_frequency_Hz = 200.0", "am_frequency_Hz = 1e5"), ("[0.0, 1.0]", "[1.0]"),
                                          text=steady), "no common period"),
                ("array", changed((gaussian, f"{array}, reach_mm = 500.0, frequency_kHz = 200.0 }}"), text=steady),
                 "samples of the pattern, but at most")):
            self.write_job(text)
            for verb in ("check", "plan"):
                with self.subTest(name=name, verb=verb):
                    output, code = accepted_or_refused(self, command(verb, "job.toml"), (3,), f"{verb} {name}")
                    self.contains(output, words)
