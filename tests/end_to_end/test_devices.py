# SPDX-License-Identifier: BSD-3-Clause
"""Files of devices, read as loads and written by `export --to`. The files that are read are made here, byte by byte."""
import collections
import json
import math
import re
import struct

import jsonschema
import numpy as np
import pytest

from program import ROOT, SWEEP, ProgramTest, case_files, changed

PAGE = (ROOT / "docs/explanation/modulations.md").read_text(encoding="utf-8")
MODULATIONS = {name: block for block, name in re.findall(
    r"```toml\n# part of a job\n\[load.modulation\]\n(kind = \"([\w-]+)\"[^`]*)```", PAGE)}
SCHEMA = json.loads((ROOT / "docs/reference/json-output.schema.json").read_text(encoding="utf-8"))
JOB = """schema = 1
[job]
name = "device"
title = "device"
[medium]
preset = "thesis-tissue"
[load]
peak_Pa = 100.0
footprint = {footprint}
[load.modulation]
{modulation}
[domain]
extent_mm = [120.0, 60.0]
spacing_mm = 3.0
[time]
duration_ms = {ms}
output_interval_us = 100.0
[measure]
at_ms = {ms}
"""
GAUSSIAN = "{ shape = \"gaussian\", fwhm_mm = 9.0 }"
ARRAY = "{ shape = \"array\", preset = \"array-16x16\", distance_mm = 150.0, update_rate_kHz = 2.0 }"
HJIF = {"version": "2023", "profile": "Main", "level": 1, "date": "2025-01-01", "description": "", "timescale": 1000, "avatars": [],
        "syncs": [], "perceptions": [{
            "id": 0, "avatar_id": 0, "description": "", "perception_modality": "Vibrotactile", "effect_library": [], "channels": [{
                "id": 0, "description": "", "gain": 1.0, "mixing_coefficient": 1.0, "body_part_mask": 0, "bands": [{
                    "band_type": "VectorialWave", "lower_frequency_limit": 0, "upper_frequency_limit": 500, "effects": [{
                        "id": 1, "effect_type": "Basis", "position": 0, "phase": 0.0, "base_signal": "Sine", "keyframes": [
                            {"relative_position": 0, "amplitude_modulation": 0.5, "frequency_modulation": 100},
                            {"relative_position": 20, "amplitude_modulation": 0.5, "frequency_modulation": 100}]}]}]}]}]}


def wav_bytes(samples, rate=8000, channels=1, data_B=None):
    """A RIFF file of 16-bit samples; `data_B`: the size that its data chunk states."""
    data = struct.pack(f"<{len(samples)}h", *samples)
    form = struct.pack("<4sIHHIIHH", b"fmt ", 16, 1, channels, rate, 2 * rate * channels, 2 * channels, 16)
    chunk = struct.pack("<4sI", b"data", len(data) if data_B is None else data_B) + data
    return b"RIFF" + struct.pack("<I", 4 + len(form) + len(chunk)) + b"WAVE" + form + chunk


class Devices(ProgramTest):
    def write(self, modulation, name="job.toml", footprint=GAUSSIAN, ms=20.0):
        (self.folder / name).write_text(JOB.format(modulation=modulation, footprint=footprint, ms=ms), encoding="utf-8")

    def load_at(self, rate_Hz, name="job.toml"):
        """x and y in mm and the gain on the force, as the program computes them."""
        document = json.loads(self.shearwake("show", "--modulation", name, "--json", "--rate", rate_Hz).stdout)
        jsonschema.Draft202012Validator(SCHEMA).validate(document)
        run = document["run"]
        return np.array(run["x_m"]) * 1e3, np.array(run["y_m"]) * 1e3, np.array(run["gain"])

    def test_a_list_is_played_with_rests(self):
        (self.folder / "list.csv").write_text("t_ms,intensity_1,x_cm,y_cm,z_cm\n0,1,0,0,15\n5,0.25,0.1,0,15\n10,0,0.1,0.2,15\n", encoding="utf-8")
        self.write('kind = "file"\nfile = "list.csv"')
        x, y, gain = self.load_at(1000)
        self.assertEqual([x[2], x[7], x[12], x[17]], [0, 1, 1, 0])  # repeated after 15 ms
        self.assertEqual([y[2], y[7], y[12], y[17]], [0, 0, 2, 0])
        self.assertEqual([gain[2], gain[7], gain[12], gain[17]], [1, 0.25, 0, 1])

    def test_a_wav_file_is_an_envelope_of_the_pressure(self):
        (self.folder / "a.wav").write_bytes(wav_bytes([0, 16384, -32768, 32767] * 40))
        self.write('kind = "file"\nfile = "a.wav"\nposition_mm = [3.0, 0.0]')
        x, _, gain = self.load_at(8000)
        self.assertEqual(set(x), {3.0})
        expected = [((s + 32768) / 65535) ** 2 for s in (0, 16384, -32768, 32767)]
        np.testing.assert_allclose(gain[:8], expected * 2, atol=1e-9)  # rounding of the text between the programs

    @pytest.mark.extended
    def test_an_envelope_of_40000_samples_is_played(self):
        """A pressure |sin(pi f t)|, whose force is that of AM with the frequency f, for 5 s with 251 periods."""
        pressure = np.abs(np.sin(np.pi * 50.2 * np.arange(40_000) / 8000))
        (self.folder / "long.wav").write_bytes(wav_bytes([round(65_533 * p) - 32_767 for p in pressure]))
        self.write('kind = "file"\nfile = "long.wav"', ms=5000.0)
        gain = self.load_at(8000)[2]
        np.testing.assert_allclose(gain, np.sin(np.pi * 50.2 * np.arange(40_001) / 8000) ** 2, atol=1e-4)  # 16 bits: 4e-5 of the force
        peaks_um = []
        for modulation in ('kind = "file"\nfile = "long.wav"', 'kind = "AM"\nam_frequency_Hz = 50.2'):
            self.write(modulation, ms=30.0)
            peaks_um.append(json.loads(self.shearwake("evaluate", "job.toml", "--json", "--out", "out").stdout)["values"]["peak_um"])
        self.assertAlmostEqual(peaks_um[0] / peaks_um[1], 1.0, delta=1e-3)  # lines between samples: (2 pi 50.2 / 8000)^2 / 8 = 2e-4

    def test_an_hjif_file_is_an_envelope_of_the_pressure(self):
        (self.folder / "a.hjif").write_text(json.dumps(HJIF), encoding="utf-8")
        self.write('kind = "file"\nfile = "a.hjif"')
        gain = self.load_at(8000)[2][:160]
        wave = 0.5 * np.sin(2 * np.pi * 100 * np.arange(160) / 8000)
        np.testing.assert_allclose(gain, ((1 + wave) / 2) ** 2, atol=1e-9)

    def test_transients_of_an_hjif_file_are_two_periods_of_a_sine(self):
        """Of 22 ms each, as in the reference software."""
        document = json.loads(json.dumps(HJIF))
        band = document["perceptions"][0]["channels"][0]["bands"][0]
        band["band_type"] = "Transient"
        band["effects"][0]["keyframes"] = [{"relative_position": 0, "amplitude_modulation": 0.5}, {"relative_position": 40, "amplitude_modulation": 0.25}]
        (self.folder / "a.hjif").write_text(json.dumps(document), encoding="utf-8")
        self.write('kind = "file"\nfile = "a.hjif"', ms=70.0)
        t_ms = np.arange(496) / 8  # until 62 ms
        wave = (0.5 * np.sin(4 * np.pi * t_ms / 22) * (t_ms < 22) + 0.25 * np.sin(4 * np.pi * (t_ms - 40) / 22) * (t_ms >= 40))
        np.testing.assert_allclose(self.load_at(8000)[2][:496], ((1 + wave) / 2) ** 2, atol=1e-9)

    def test_phases_of_an_array_are_played(self):
        """Phases that focus on a place, computed here: the load is there, frame by frame. The order is that of board_X.pat of OpenMPD: x
        from the smallest, and for each of them y from the largest."""
        place = {"x": [0.0, 12.0], "y": [-9.0, 0.0]}
        at = (np.arange(16) - 7.5) * 10.47
        rows = []
        for x, y in zip(place["x"], place["y"]):
            rows.append(",".join(f"{-2 * math.pi * 40 / 346.1 * math.hypot(x - px, y - py, 150.0):.9f}" for px in at for py in at[::-1]))
        (self.folder / "p.csv").write_text("2,256\n" + "\n".join(rows) + "\n", encoding="utf-8")
        self.write('kind = "file"\nfile = "p.csv"', footprint=ARRAY)
        x, y, gain = self.load_at(4000)
        for n in range(2):  # frames last 0.5 ms; the place is that of the nearest sample of the pattern, 1.3 mm apart, and of the peak
            self.assertLess(math.hypot(x[2 * n] - place["x"][n], y[2 * n] - place["y"][n]), 1.5)
        self.assertEqual(set(gain), {1.0})
        values = json.loads(self.shearwake("evaluate", "job.toml", "--json", "--out", "out").stdout)["values"]
        self.assertGreater(values["peak_um"], 0.0)
        self.write('kind = "file"\nfile = "p.csv"')
        self.contains(self.shearwake("check", "job.toml", expect=3).output, "shape = \"array\"")

    @pytest.mark.extended
    def test_hostile_files_are_errors_at_their_place(self):
        deep = "[" * 100_000 + "]" * 100_000
        frame = json.loads(json.dumps(HJIF))
        frame["perceptions"][0]["channels"][0]["bands"][0]["effects"][0]["keyframes"][1]["amplitude_modulation"] = 7
        for name, content, *texts in (
                ("a.csv", "t_s,x_mm,y_mm\n0,0,0\n0.001,nan,0\n", "line 3", "finite"),
                ("a.csv", "t_s,x_mm,y_mm\n0,0,0\n-0.001,1,0\n", "line 3", "-0.001"),
                ("a.csv", "t_s,x_mm,y_mm,intensity_1\n0,0,0,1\n0.1,0,0,1.5\n", "line 3", "0 to 1"),
                ("a.csv", "t,x,y,intensity\n0,0,0,1\n1,0,0,1\n", "line 1", "unit"),
                ("a.csv", "t_s,intensity_1\n0,0\n0.001,1\n0.002,1\n0.005,1\n", "line 5", "uniformly spaced"),
                ("a.csv", "2,256\n0.1,0.2\n1,2\n", "line 2", "256"),
                ("a.csv", "", "no row"),
                ("a.csv", b"\xff\xfe", "byte 0"),
                ("a.wav", wav_bytes([0, 1], data_B=2_000_000_000), "1000000000 samples"),
                ("a.wav", wav_bytes([0, 1], channels=2), "2 channels"),
                ("a.wav", b"RIFF", "not a sound file"),
                ("a.hjif", deep, "nested"),
                ("a.hjif", "{\n 1}", "line 2"),
                ("a.hjif", json.dumps(frame), "perceptions[0].channels[0].bands[0].effects[0].keyframes[1].amplitude_modulation", "7"),
                ("a.csv", "t_s;x_mm;y_mm\r\n0;0;0\r\n0,001;1,5;0\r\n", "line 3", "'0,001'"),
                ("a.csv", "t_s,x_mm,y_mm\n0,0,0\n0.1,1_0,0\n", "line 3", "'1_0'"),
                ("a.csv", 't_s,x_mm,y_mm\n0,0,0\n"0.1,1,0\n', "line 3", "unexpected end"),
                ("a.csv", "t_s,x_mm,y_mm\n0,0,0\n0.1,1,0\n0.1,2,0\n", "line 4", "after 0.1 s"),
                ("a.wav", wav_bytes([0, 1], data_B=40), "byte 36", "4 follow"),
                ("a.wav", wav_bytes([0, 1])[:30], "byte 12", "ends in its header"),
                ("a.wav", wav_bytes([0, 1]).replace(struct.pack("<HH", 1, 1), struct.pack("<HH", 6, 1), 1), "chunk fmt", "format 6"),
                ("a.hjif", json.dumps(HJIF).replace('"gain": 1.0', '"gain": 1.0, "gain": 0.2'), "member twice"),
                ("a.hjif", json.dumps(HJIF).replace('"gain": 1.0', '"gain": NaN'), "channels[0].gain"),
                ("a.hjif", json.dumps(HJIF).replace('"gain": 1.0', '"gain": "1.0"'), "channels[0].gain"),
                ("a.hjif", json.dumps(HJIF).replace('"position": 0', f'"position": {"1" * 5000}'), "thousands of digits"),
                ("a.hjif", json.dumps(HJIF).replace("Basis", "Reference"), "effects[0]", "Basis"),
                ("a.mp3", "x", ".wav")):
            with self.subTest(name=name, texts=texts):
                (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
                self.write(f'kind = "file"\nfile = "{name}"')
                self.contains(self.shearwake("check", "job.toml", expect=3).output, "load.modulation.file", name, *texts)
        self.write('kind = "file"\nfile = "missing.csv"\nspeed_m_s = 3.0')
        self.contains(self.shearwake("check", "job.toml", expect=3).output, "missing.csv", "does not apply to kind file")

    def test_gaps_and_clipping_are_warnings(self):
        (self.folder / "gap.csv").write_text("t_ms,x_mm,y_mm\n0,0,0\n1,1,0\n2,2,0\n9,2,1\n10,1,1\n", encoding="utf-8")
        self.write('kind = "file"\nfile = "gap.csv"')
        self.contains(self.shearwake("check", "job.toml").output, "1 gap", "line 4", "7 ms")
        (self.folder / "flat.wav").write_bytes(wav_bytes([0, 20000, 32767, 32767, 32767, 20000]))
        self.write('kind = "file"\nfile = "flat.wav"')
        self.contains(self.shearwake("check", "job.toml").output, "clipping", "0.00025 s")

    @pytest.mark.extended
    def test_every_modulation_returns_from_its_list(self):
        """At the rate of the device, to 1e-4 mm and 1e-4 of the force. Between its samples the focus rests, which export states."""
        self.assertEqual(len(MODULATIONS), 8)
        for name, block in MODULATIONS.items():
            with self.subTest(name):
                self.write(block, ms=100.0)
                asked = self.load_at(8000)
                end = re.search(r'at_end = "(\w+)"', self.shearwake("export", "job.toml", "--to", "csv", "--rate", "4000", "--no-effect",
                                                                    "--out", "back").output)[1]
                self.write(f'kind = "file"\nfile = "back.csv"\nat_end = "{end}"', "back.toml", ms=100.0)
                played = self.load_at(8000, "back.toml")
                for a, b in zip(asked, played):  # in the middle of each rest, whose sample is that of its beginning
                    count = min(len(a), len(b)) // 2 - 1
                    np.testing.assert_allclose(b[1::2][:count], a[::2][:count], atol=1e-4)

    def test_an_envelope_returns_from_wav_and_hjif(self):
        self.write(MODULATIONS["AM"])
        asked = self.load_at(8000)[2]
        for kind in ("wav", "hjif"):
            self.shearwake("export", "job.toml", "--to", kind, "--no-effect", "--out", f"am.{kind}")
            self.write(f'kind = "file"\nfile = "am.{kind}"', "back.toml")
            np.testing.assert_allclose(self.load_at(8000, "back.toml")[2], asked, atol=1e-4)  # 16 bits of the pressure: 4e-5 of the force

    def test_a_device_gets_what_it_can_play_and_the_effect_is_computed(self):
        self.write('kind = "AM-STM"\npath = { shape = "circle", radius_mm = 5.0 }\ndraw_frequency_Hz = 100.0\nam_frequency_Hz = 200.0')
        output = self.shearwake("export", "job.toml", "--to", "autd3").output
        self.contains(output, "effect: eta_", "as played", "8 bits at 4000 Hz", "0.025 mm")
        load = json.loads((self.folder / "job.autd3.json").read_text(encoding="utf-8"))
        self.assertEqual((len(load["points_mm"]), load["sampling_divider"], len(load["modulation"]), load["modulation_divider"]), (400, 1, 40, 10))
        for n in (0, 37, 399):  # on the lattice of 0.025 mm
            angle = 2 * math.pi * n / 400
            np.testing.assert_allclose(load["points_mm"][n][0], [5 * math.cos(angle), 5 * math.sin(angle), 200.0], atol=0.0126)
        expected = [round(255 * abs(math.sin(math.pi * 200 * n / 4000))) for n in range(40)]  # of the pressure
        self.assertEqual(load["modulation"], expected)
        compile((self.folder / "job.autd3.py").read_text(encoding="utf-8"), "job.autd3.py", "exec")
        self.contains(self.shearwake("export", "job.toml", "--to", "autd3", "--rate", "30000", expect=2).output, "40000 Hz / N")

    def test_a_case_file_is_exported_with_its_own_load(self):
        self.write_job(changed((SWEEP, SWEEP.replace("400, 500, 1000", "500"))))
        self.shearwake("run", "job.toml", "--out", "out")
        for case in case_files(self.folder / "out"):
            self.shearwake("export", case, "--to", "csv", "--rate", "40000", "--no-effect", "--out", case.stem)
        gains = [np.loadtxt(self.folder / f"{case.stem}.csv", delimiter=",", skiprows=1)[:, 4] for case in
                 case_files(self.folder / "out")]
        self.assertEqual(sorted(int(gain.min() < 0.5) for gain in gains), [0, 1])  # the reference is not modulated

    def test_cycles_repeat_until_they_end_with_a_sample(self):
        """75 Hz has 533.3 samples of 40 kHz: three cycles are played, so that they do not drift."""
        self.write('kind = "AM"\nam_frequency_Hz = 75.0', ms=80.0)
        self.shearwake("export", "job.toml", "--to", "csv", "--no-effect", "--out", "back")
        self.write('kind = "file"\nfile = "back.csv"', "back.toml", ms=80.0)
        asked, played = self.load_at(80_000)[2], self.load_at(80_000, "back.toml")[2]
        np.testing.assert_allclose(played[1::2], asked[:-1:2], atol=1e-4)

    def test_phases_return_and_their_rounding_has_an_effect(self):
        self.write('kind = "STM"\npath = { shape = "circle", radius_mm = 5.0 }\ndraw_frequency_Hz = 100.0', footprint=ARRAY)
        output = self.shearwake("export", "job.toml", "--to", "phases", "--rate", "2000", "--out", "back").output
        self.contains(output, "128 levels", "update_rate_kHz = 2", "effect: eta_", "as played")
        self.write('kind = "file"\nfile = "back.phases.csv"', "back.toml", footprint=ARRAY)
        asked, played = (np.array(json.loads(self.shearwake("show", "--modulation", name, "--json", "--rate", rate, "--phases").stdout)["phases_rad"])
                         for name, rate in (("job.toml", 2000), ("back.toml", 4000)))
        played = played.reshape(-1, 256)[1::2].reshape(-1)  # in the middle of each frame
        self.assertEqual(len(asked), 20 * 256)
        np.testing.assert_allclose(np.exp(1j * played), np.exp(1j * asked), atol=1e-4)
        self.contains(self.shearwake("export", "job.toml", "--to", "phases", "--rate", "100", expect=2).output, "from 1 to 255")

    @pytest.mark.extended
    def test_the_effect_of_an_envelope_is_that_along_the_motion_of_the_case(self):
        self.write(MODULATIONS["AM-STM"])  # ends after 14 ms
        self.contains(self.shearwake("export", "job.toml", "--to", "wav").output, "not computed, since the case has no reading")
        self.write(MODULATIONS["AM-STM"], ms=12.0)
        for kind in ("wav", "hjif"):
            output = self.shearwake("export", "job.toml", "--to", kind).output
            self.contains(output, "no positions", "along the motion")
            change = float(re.search(r"effect: eta_\S+ .*\(([+-]\S+) %\)", output)[1])
            self.assertLess(abs(change), 1.0)  # straight lines between samples of 8 kHz change sin^2 of 200 Hz by 0.3 %

    def test_a_lens_is_a_closed_solid_in_millimetres(self):
        job = (ROOT / "jobs/lens-letter.toml").read_text(encoding="utf-8")
        (self.folder / "lens.toml").write_text(job, encoding="utf-8")
        self.shearwake("export", "lens.toml", "--to", "stl")
        self.shearwake("lens", "lens.toml", "--out", "map")
        content = (self.folder / "lens.stl").read_bytes()
        count = int.from_bytes(content[80:84], "little")
        self.assertEqual(len(content), 84 + 50 * count)
        facets = np.frombuffer(content[84:], np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")]))
        corners = facets["corners"].astype(float)
        edges = collections.Counter()
        for corner in np.round(corners, 4):
            for n in range(3):
                edges[tuple(corner[n]), tuple(corner[(n + 1) % 3])] += 1
        self.assertTrue(all(edges[b, a] == n for (a, b), n in list(edges.items())))  # each edge is passed in both directions
        volume_mm3 = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        heights_mm = np.loadtxt(self.folder / "map/thickness.csv", delimiter=",", skiprows=1)[:, 2]
        self.assertAlmostEqual(volume_mm3 / (16 * heights_mm.sum()), 1.0, places=6)  # pixels of 4 mm
        range_mm = 1e3 / (40e3 * (1 / 346.1 - 1 / 1000))  # a turn of the phase: 1 / (f |1 / c_air - 1 / c_lens|)
        self.assertGreaterEqual(heights_mm[heights_mm > 0].min(), 1.0)
        self.assertLess(heights_mm.max(), 1.0 + range_mm)
        self.assertGreater(heights_mm.max(), 1.0 + 0.95 * range_mm)

    def test_what_cannot_be_exported_is_refused(self):
        self.write(MODULATIONS["AM"])
        self.contains(self.shearwake("export", "job.toml", "--to", "stl", expect=2).output, "lens")
        self.contains(self.shearwake("export", "job.toml", "--to", "phases", expect=2).output, "array")
        self.contains(self.shearwake("export", "job.toml", "--to", "autd", expect=2).output, "did you mean autd3?")
        self.contains(self.shearwake("export", "job.toml", "--to", "wav", "--rate", "44100", expect=2).output, "8000 and 48000")
        self.shearwake("export", "missing.toml", "--to", "csv", expect=6)
