# SPDX-License-Identifier: BSD-3-Clause
"""Responses of afferents: [afferents] of a job, and the command respond."""

import h5py
import numpy as np
import pytest
import xarray

from program import ProgramTest, without_reference


def with_afferents(changes=(), **keys):
    """The small job with keys of [afferents] and other changes."""
    return without_reference({"load.peak_Pa": 5000.0, "afferents": {
        "where": "palm", "classes": ["RA", "PC"], "pin_line": {"from_mm": [-12.0, 0.0], "to_mm": [12.0, 0.0], "count": 7}, **keys}}, dict(changes))


class Afferents(ProgramTest):
    def cases(self, folder):
        return {p.stem: p for p in (self.folder / folder / "cases").glob("*.h5")}

    def test_xarray_reads_the_spikes_and_the_table_has_their_columns(self):
        self.write_job(with_afferents(noise=True))
        self.reduced(self.out)
        path = next(iter(self.cases("out/small").values()))
        data = xarray.open_dataset(path, group="afferents")
        self.assertEqual(data.sizes["spike"], int(data.spike_count.sum()))
        self.assertEqual(data.spike_time.attrs["units"], "s")
        self.assertLessEqual(float(data.spike_time.max()), 4e-3 + 1e-9)
        header = (self.out / "tables" / "small.csv").read_text().splitlines()[0].split(",")
        for column in ("spikes_1", "active_1", "rate_Hz", "spread_mm", "vector_strength_1", "locking_1", "first_spike_ms"):
            self.assertIn(f"PC_{column}", header)
            self.assertIn(f"RA_{column}", header)

    def test_respond_reproduces_the_spikes_of_a_case_from_its_pins(self):
        self.write_job(with_afferents(noise=False))
        self.shearwake("run", "job.toml")
        path = next(iter(self.cases("out/small").values()))
        self.shearwake("respond", path, "--group", "pins", "--options", "job.toml", "--out", "a.h5")
        with h5py.File(path) as case, h5py.File(self.folder / "a.h5") as alone:
            for name in ("hand_x", "spike_count", "spike_time"):
                np.testing.assert_allclose(alone["afferents"][name][()], case["afferents"][name][()], rtol=0, atol=1e-12)

    def test_fibres_respond_to_the_stress_of_each_engine(self):
        counts = {}
        for engine in ("layered", "spectral"):
            self.write_job(with_afferents({"solver.engine": engine}, input="stress"))
            self.shearwake("run", "job.toml", "--out", engine, ranks=2)
            counts[engine] = []
            for path in self.cases(engine).values():
                with h5py.File(path) as file:
                    counts[engine].append(float(file["PC_spikes_1"][()]))
        self.assertGreater(min(counts["layered"]), 20)
        # The fields differ by 0.1 %, which could change the spikes of a neuron at its threshold, but does not.
        np.testing.assert_allclose(sorted(counts["spectral"]), sorted(counts["layered"]), rtol=0.01)

    def test_receptors_must_lie_above_the_rigid_base(self):
        self.write_job(with_afferents({"medium.layer[1].thickness_mm": 1.8}, input="stress"))
        output = self.shearwake("check", "job.toml", expect=3).output
        self.contains(output, "afferents.input is \"stress\"", "receptors at a depth of 2 mm", "the rigid base at 1.8 mm")

    def test_receptors_beyond_the_domain_are_counted(self):
        self.write_job(with_afferents(input="stress"))
        self.contains(self.shearwake("check", "job.toml").output, "warning", "of 3553 receptors are outside the domain")

    def test_errors_are_reported_before_the_run(self):
        for keys, words in (
                ({"pin_radius_mm": -1}, "afferents.pin_radius_mm must be between 1e-09 and 10000"),
                ({"patch_mm": [400, 0]}, "all 7 pins are outside of the skin"),
                ({"input": "carrier", "carrier": {"amplitude_um": 50, "sampling_kHz": 80}}, "2 samples per cycle of 40 kHz")):
            self.write_job(with_afferents(**keys))
            self.contains(self.shearwake("check", "job.toml", ranks=2, expect=3).output, "error", words)
        self.write_job(with_afferents(pin_radius_mm=3))
        self.contains(self.shearwake("check", "job.toml").output, "warning", "2 mm, half of their smallest distance, is used instead")


class Respond(ProgramTest):
    def test_respond_prints_the_response_to_a_motion_from_csv(self):
        rows = [f"{0.2 * k:.1f},{30 * (1 - np.cos(0.08 * np.pi * k)):.6f}" for k in range(500)]
        (self.folder / "m.csv").write_text("t_ms,u_um\n" + "\n".join(rows) + "\n")
        output = self.shearwake("respond", "m.csv", "-S", "afferents.noise=true", "--out", "a.h5", ranks=2).output
        self.contains(output, "motion: 500 samples at 5000 Hz for each of 1 pin(s), 0 to 59.76 um", "SA1", "RA", "PC", "spikes: a.h5")
        data = xarray.open_dataset(self.folder / "a.h5", group="afferents")
        self.assertGreater(data.sizes["spike"], 100)

    def test_respond_accepts_the_stress_at_receptors(self):
        (self.folder / "r.csv").write_text("x_mm,y_mm,class,row\n0,0,PC,1\n0,0,SA1,0\n")
        rows = [f"{0.2 * k:.1f},{p},{p}" for k in range(500) for p in [2000 * (1 - np.cos(0.08 * np.pi * k))]]
        (self.folder / "s.csv").write_text("t_ms,p_Pa,p_Pa\n" + "\n".join(rows) + "\n")
        stress = ("-S", "afferents.input=stress", "-S", "afferents.where=csv")
        self.shearwake("respond", "s.csv", *stress, "-S", 'afferents.file="r.csv"', "--out", "a.h5", ranks=2)
        data = xarray.open_dataset(self.folder / "a.h5", group="afferents")
        self.assertGreater(float(data.spike_count[0]), 10)  # 200 Hz for 0.1 s
        output = self.shearwake("respond", "s.csv", "-S", "afferents.input=stress", ranks=2, expect=2).output
        self.contains(output, "one per receptor, but found 2")

    @pytest.mark.extended
    def test_motions_in_implausible_units_are_warned_of(self):
        for header, times, peak, words in (
                ("t_ms,u_mm", "{:.1f}", 30.0, "warning: the largest displacement is 3e+04 um;"),  # um below u_mm
                ("t_ms,u_um", "{:.1f}", 6e-5, "warning: the largest displacement is 6e-05 um;"),  # m below u_um
                ("t_us,u_um", "{:.1f}", 60.0, "warning: the motion lasts 0.02 ms, less than"),  # ms below t_us
                ("t_ms,u_um", "{:.1f}", 60.0, "")):
            rows = [f"{times.format(0.2 * k)},{peak * (k == 50)}" for k in range(100)]
            (self.folder / "m.csv").write_text(header + "\n" + "\n".join(rows) + "\n")
            output = self.shearwake("respond", "m.csv", "-S", 'afferents.classes=["PC"]').output
            with self.subTest(words=words):
                self.assertIn(words, output)
                self.assertEqual("check the unit" in output, bool(words))

    def test_invalid_motions_are_rejected_with_their_position(self):
        for text, words in [("t_ms,u_um\n0,0\n1,nan\n", "pin 0, sample 1"),
                            ("t_ms,u_mm\n0,0\n1,600\n", "a displacement is 600 mm"),
                            ("t_ms,u_m\n0,0\n1,-0.06\n", "a displacement is -60 mm")]:
            (self.folder / "m.csv").write_text(text)
            self.contains(self.shearwake("respond", "m.csv", ranks=2, expect=2).output, words)
        self.contains(self.shearwake("respond", "none.h5", expect=2).output, "none.h5 does not exist")
        (self.folder / "m.csv").write_text("t_ms,u_um\n0,0\n1,0\n")
        output = self.shearwake("respond", "m.csv", "--out", "none/a.h5", ranks=2, expect=6).output
        self.contains(output, "the folder none does not exist")
        self.contains(self.shearwake("respond", expect=2).output, "needs a MOTION")
