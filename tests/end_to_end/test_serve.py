# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake serve` gives the results of `run`, cancels, and survives hostile requests."""
import json
import math
import threading

import h5py
import numpy
import pytest

from program import SPECTRAL, ProgramTest, case_files
from serving import Server, extent, one

LARGE = one(extent(1200.0, 1200.0))  # 640 000 points
STEERED = {"load.footprint": {"shape": "array", "preset": "array-16x16", "distance_mm": 200.0}}


def columns(message):
    return {name: column["value"] for name, column in message["columns"].items()}


class Serve(ProgramTest):
    def stored(self, job):
        """The columns and the frames of the case that `run` computes."""
        out = self.folder / "run"
        self.shearwake("run", self.write_job(job), "--out", out, "--quiet")
        with h5py.File(case_files(out)[0]) as file:
            scalars = {name: float(item[()]) for name, item in file.items()
                       if isinstance(item, h5py.Dataset) and item.shape == ()}
            spikes = file["afferents/spike_time"][()] if "afferents" in file else None
            return scalars, file["surface/u_z"][:, 0], spikes, case_files(out)[0].stem

    def assert_equal_to_run(self, message, arrays, job):
        scalars, frames, spikes, case = self.stored(job)
        self.assertEqual(message["type"], "result")
        self.assertEqual(message["case"], case)
        found = columns(message)
        self.assertEqual(set(found), set(scalars))
        for name, value in scalars.items():
            if not numpy.isfinite(value):
                self.assertIsNone(found[name], name)
            else:  # the same arithmetic; only the order of sums over ranks may differ
                # At the instant of the reading the waves have left: IPR is 1e-7 of its value in the period, and rounding
                # errors of transforms, 1e-16 of that value, are 1.3e-9 of it.
                limit = 1e-8 if name.startswith("ipr_at") else 1e-9
                self.assertLessEqual(abs(found[name] - value), limit * max(abs(value), 1e-30), name)
        # Frames have single precision, whose relative error is 6e-8.
        self.assertLessEqual(numpy.abs(arrays["u_z"] - frames).max(), 1e-7 * numpy.abs(frames).max())
        if spikes is not None:
            numpy.testing.assert_allclose(arrays["afferents/spike_time"], spikes, rtol=1e-9)

    def test_a_result_equals_the_case_that_run_computes(self):
        job = one({"afferents": {"where": "grid", "extent_mm": [16.0, 8.0], "pitch_mm": 8.0, "classes": ["RA"]}})
        with Server() as server:
            self.assertEqual((server.hello["type"], server.hello["protocol"], server.hello["ranks"]), ("hello", 1, 1))
            server.compute(one(peak=70.0))  # leaves transfer functions and buffers
            self.assert_equal_to_run(*server.compute(job), job)
            self.assertEqual(server.end(), 0)

    def test_two_ranks_give_the_result_of_run(self):
        job = one(peak=50.0)
        with Server(ranks=2) as server:
            self.assertEqual(server.hello["ranks"], 2)
            server.compute(one(extent(96.0, 48.0)))
            self.assert_equal_to_run(*server.compute(job), job)
            self.assertEqual(server.compute("schema = 2")[0]["code"], "bad_job")
            self.assertEqual(server.end(), 0)

    @pytest.mark.extended
    def test_the_scan_of_a_tilted_vibrometer_contains_all_components(self):
        job = one({"vibrometer": {"points_mm": [[-6.0, 3.0], [3.0, 1.5], [6.0, -6.0]], "tilt_deg": 30.0, "azimuth_deg": 40.0}})
        with Server() as server:
            message, arrays = server.compute(job)
        self.assertEqual(message["case"], self.stored(job)[3])
        with h5py.File(case_files(self.folder / "run")[0]) as file:
            scan = file["vibrometer/velocity"][()]
        self.assertGreater(numpy.abs(scan).max(), 0.0)
        numpy.testing.assert_allclose(arrays["vibrometer/velocity"], scan, rtol=0.0, atol=1e-9 * numpy.abs(scan).max())

    def test_a_newer_request_a_message_and_the_end_of_the_input_cancel(self):
        with Server() as server:
            first = server.send(LARGE)
            second = server.send(one())
            message, _ = server.receive()
            self.assertEqual((message["type"], message["id"]), ("cancelled", first))
            self.assertIn("newer", message["reason"])
            self.assertEqual(server.receive()[0]["id"], second)
            third = server.send(LARGE)
            server.send_text('{"type": "cancel"}\n')
            message, _ = server.receive()
            self.assertEqual((message["type"], message["id"]), ("cancelled", third))
            server.send(LARGE)
            self.assertEqual(server.end(), 0)

    @pytest.mark.extended
    def test_the_sweep_of_a_job_is_ignored(self):
        with Server() as server:
            plain, _ = server.compute(one())
            swept, _ = server.compute(one({"sweep": {"load.peak_Pa": {"linspace": [1, 100, 10000]}}}))
            self.assertEqual(swept["case"], plain["case"])

    def test_overrides_and_a_choice_of_arrays_belong_to_a_request(self):
        scan = {"vibrometer.points_mm": [[-6.0, 3.0]]}
        job = one(scan)
        with Server() as server:
            expected, _ = server.compute(one(scan, peak=70.0))
            found, arrays = server.receive_until(server.send(job, overrides=[["load.peak_Pa", "70"]], arrays=["vibrometer/velocity"]))
            self.assertEqual((found["case"], columns(found)), (expected["case"], columns(expected)))
            self.assertEqual([(name, array.shape) for name, array in arrays.items()], [("vibrometer/velocity", (1, 41))])
            wrong, _ = server.receive_until(server.send(job, overrides=["load.peak_Pa=70"]))
            self.assertEqual((wrong["code"], "list of pairs" in wrong["message"]), ("bad_request", True))

    def test_a_job_is_described_with_its_vibrometer_and_its_distributions(self):
        described = {"vibrometer": {"file": "points.csv", "tilt_deg": 30.0, "trigger_delay_ms": 2.0}, "uncertain": {
            "samples": 2, "load.peak_Pa": {"distribution": "normal", "mean": 100.0, "sd": 10.0},
            "load.modulation.speed_m_s": {"distribution": "uniform", "min": 2.0, "max": 4.0}}}
        job = one(described)
        (self.folder / "points.csv").write_text("x_mm,y_mm\n1,2\n3,4\n")
        with Server() as server:
            self.assertEqual(server.receive_until(server.send(job, type="describe"))[0]["code"], "bad_job")  # names a file
        with Server("--files", self.folder) as server:
            found, _ = server.receive_until(server.send(job, type="describe", overrides=[["load.peak_Pa", "3"]]))
            case = server.compute(one(described, peak=3.0))[0]["case"]
        self.assertEqual((found["type"], found["case"], found["engine"], found["periodic"]), ("description", case, "layered", False))
        self.assertAlmostEqual(found["duration_s"], 4e-3, delta=1e-15)
        self.assertAlmostEqual(found["vibrometer"]["trigger_delay_s"], 2e-3, delta=1e-15)
        numpy.testing.assert_allclose(found["vibrometer"]["direction"], [0.5, 0.0, 0.75 ** 0.5], atol=1e-15)
        peak, speed = found["uncertain"]
        self.assertEqual((peak["key"], peak["median"], speed["prior"]), ("load.peak_Pa", 100.0, None))
        self.assertAlmostEqual(peak["prior"]["sd"], 10.0, delta=1e-4)  # quantiles with six digits
        self.assertAlmostEqual(speed["low"], 2.0, delta=1e-8)
        self.assertIn("load.peak_Pa is uncertain", found["diagnostics"][0]["message"])

    @pytest.mark.extended
    def test_a_request_ends_after_the_time_limit(self):
        with Server("--time-limit", "0.05") as server:
            message, _ = server.compute(LARGE)
            self.assertEqual((message["type"], message["code"]), ("error", "time_limit"))

    @pytest.mark.extended
    def test_a_request_ends_while_it_is_prepared(self):
        with Server("--time-limit", "0.5") as server:
            message, _ = server.compute(one(STEERED, {"load.modulation.path.from_mm": [-12.0, 0.0], "time.output_interval_us": 5.0}))
            self.assertEqual((message["type"], message["code"]), ("error", "time_limit"))
            self.assertEqual(server.compute("schema = 2")[0]["code"], "bad_job")  # the process continues

    @pytest.mark.long
    def test_the_kept_pattern_of_an_array_changes_no_result(self):
        steered, softer, other = (one(STEERED, {"time.duration_ms": 1.0, **change}) for change in (
            {}, {"medium.preset": "forearm"}, {"load.footprint.distance_mm": 180.0}))
        with Server() as server:
            kept = [server.compute(job)[1]["u_z"] for job in (steered, softer, other, one(), steered)]
        for job, frames in zip((steered, softer, other), kept):
            with Server() as server:
                numpy.testing.assert_array_equal(server.compute(job)[1]["u_z"], frames)
        numpy.testing.assert_array_equal(kept[0], kept[4])

    @pytest.mark.extended
    def test_the_sizes_that_run_rejects_are_rejected(self):
        layer = {"thickness_mm": 0.01, "density_kg_m3": 1000.0, "c_p_m_s": 1500.0, "c_s_m_s": 5.0, "viscosity_Pa_s": 1.0}
        job = one({"medium": {"base": "rigid", "layer": [{**layer, "name": str(n)} for n in range(3000)]}})
        with Server() as server:
            message, _ = server.compute(job)
        self.assertEqual((message["type"], message["code"]), ("error", "bad_job"))
        for output in (message["message"], self.shearwake("run", self.write_job(job), expect=3).output):
            self.assertIn("case files can store at most 60 kB", output)

    def test_hostile_requests_have_clear_errors_and_the_process_survives(self):
        def requested(**members):
            return json.dumps(members) + "\n"

        unusable = [
            ("{\n", "not a JSON object"), ("[1, 2]\n", "not a JSON object"), ("null\n", "not a JSON object"),
            (b"\xff\xfe\x00\x01\n", "not a JSON object"), ("[" * 500_000 + "\n", "not a JSON object"),
            ('{"a":' * 100_000 + "\n", "not a JSON object"), ("x" * 1_500_000 + "\n", "more than 1000000 bytes"),
            (requested(type="compute", job=one()), 'needs an "id"'), (requested(type="compute", id=-1, job="a"), 'needs an "id"'),
            (requested(type="compute", id="1", job="a"), 'needs an "id"'), (requested(type="compute", id=10**30, job="a"), 'needs an "id"'),
            (requested(type="compute", id=1), 'needs a "job"'), (requested(type="compute", id=1, job=[1]), 'needs a "job"'),
            (requested(type="delete", id=1, job="a"), 'must be "compute"'), ("{}\n", 'must be "compute"'),
        ]
        jobs = [
            (one(peak=math.nan), "load.peak_Pa"), (one(peak=-math.inf), "load.peak_Pa"), ("schema = 1", "job is missing"),
            ("\x00\x01", "not valid TOML"), ("a = [[[[" * 1000, "TOML"), (one(SPECTRAL), "layered"),
            (one({"domain.spacing_mm": 1e-5}), "at most"), (one(extent(1e9, 48.0)), "domain.extent_mm"), (one(extent(9000.0, 9000.0)), "at most"),
            (one({"time.duration_ms": 1e9}), "time.duration_ms"), (one({"time.output_interval_us": 1e-5}), "at most"),
            (one({"afferents": {"where": "csv", "file": "/etc/passwd"}}), "file"), (one({"medium.map": "/dev/zero"}), "map"),
            (one({"afferents": {"where": "grid", "extent_mm": [10000.0, 10000.0], "pitch_mm": 0.001}}), "afferents"),
        ]
        with Server() as server:
            for text, expected in unusable:
                server.send_text(text)
                message, _ = server.receive()
                self.assertEqual((message["type"], message["code"]), ("error", "bad_request"), text[:60])
                self.assertIn(expected, message["message"], text[:60])
            for job, expected in jobs:
                message, _ = server.compute(job)
                self.assertEqual(message["type"], "error", job)
                self.assertIn(expected, message["message"], job)
            self.assertEqual(server.compute(one())[0]["type"], "result")
            self.assertEqual(server.end(), 0)

    @pytest.mark.extended
    def test_a_thousand_rapid_changes_do_not_let_the_memory_grow(self):
        def changes(server, first):
            """Sends a thousand requests without waiting for answers, and returns the last answer."""
            answers = []
            reader = threading.Thread(target=lambda: answers.append(server.receive_until(server_last)))
            server_last = server.number + 1000
            reader.start()
            for n in range(first, first + 1000):
                server.send(one(peak=50.0 + 0.01 * n))
            reader.join()
            return answers[0][0]

        with Server() as server:
            for _ in range(3):
                server.compute(one())
            self.assertEqual(changes(server, 0)["type"], "result")
            before = server.resident_kB()
            self.assertEqual(changes(server, 1000)["type"], "result")
            # A leak of one result per request would be 200 MB; the allocator may keep some pages.
            self.assertLess(server.resident_kB() - before, 8000)

    @pytest.mark.extended
    def test_a_reader_that_ends_ends_the_process(self):
        with Server() as server:
            server.process.stdout.close()
            server.send(one())
            server.process.wait(60)
