# SPDX-License-Identifier: BSD-3-Clause
"""shearwake compare: tables, cases and sweeps of different ranks, grids, engines and pressures, and its exit codes."""
import json

import h5py
import pytest

from program import NO_FRAMES, ProgramTest, case_files, command, plan_ids, small_job, swept, without_reference

JOB = without_reference(NO_FRAMES, {"record.snapshots_ms": [2.0, 4.0]}, swept(500, 1000))


class Compare(ProgramTest):
    def compare(self, *arguments, expect=1):
        return json.loads(self.shearwake("compare", *arguments, "--json", expect=expect).stdout)

    def setUp(self):
        super().setUp()
        self.write_job(JOB)
        self.shearwake("run", "job.toml", "--quiet")

    def test_a_stronger_load_scales_fields_traces_and_columns(self):
        self.shearwake("run", "job.toml", "-S", "load.peak_Pa=101", "--out", "other", "--quiet")
        found = self.compare("other", self.out)
        self.assertEqual(found["schema"], 2)
        self.assertEqual(len(found["pairs"]), 2)  # matched by the swept key
        for pair in found["pairs"]:
            self.assertEqual([f["time_ms"] for f in pair["fields"]], [2.0, 4.0])
            self.assertEqual(len(pair["traces"]), 2)
            for entry in pair["fields"] + pair["traces"]:
                self.assertAlmostEqual(entry["relative_l2"], 0.01, delta=1e-7)  # fields are stored as float32
            columns = {c["column"]: c["change"] for c in pair["columns"]}
            self.assertAlmostEqual(columns["peak_um"], 0.01, delta=1e-9)
            self.assertAlmostEqual(columns["eta_at_1"], 0.0, delta=1e-9)
            self.assertIn("participation_at_1", columns)  # the same grid
            # The field and so its change is largest near the focus, which ends at 14 mm.
            self.assertLess(abs(pair["fields"][1]["at_mm"][0] - 12.0), 5.0)
            self.assertEqual(pair["fields"][1]["at_mm"][1], 0.0)
        self.assertEqual(found["not_compared"], ["wall_s", "note"])
        moved = [column["column"] for column in found["moved"]]
        self.contains(moved, "peak_um", "surface", "traces")
        self.assertNotIn("eta_period_1", moved)  # a ratio, in which the strength of the load cancels
        self.assertTrue(self.compare("other", self.out, "--tolerance", "*=0.011", expect=0)["equal"])
        (self.folder / "t.toml").write_text('[tolerance]\ntraces = inf\n"*" = 0.011\nsurface = 1e-3\n', encoding="utf-8")
        output = self.shearwake("diff", "other", self.out, "--tolerance", "t.toml", expect=1, ranks=2).output
        self.contains(output, "surface  1 % of its largest value", "2 of 2 cases differ", "not compared: wall_s, note, traces",
                      "1 column changed", "2 cases with different ids")
        self.shearwake("compare", "other", self.out, "--tolerance", "t.toml", "--tolerance", "surface=0.011")

    @pytest.mark.extended
    def test_grids_are_compared_at_their_common_points(self):
        self.shearwake("run", "job.toml", "-S", "domain.spacing_mm=1.0", "--out", "fine", "--quiet")
        found = self.compare(self.out, "fine")
        [first, *_] = found["pairs"]
        self.assertEqual([g["spacing_mm"] for g in first["grids"]], [1.5, 1.0])
        self.assertEqual(set(found["not_compared"]), {"wall_s", "note", *(f"{m}_{w}_1" for m in ("ipr", "ipr_abs", "participation")
                                                                      for w in ("at", "period"))})
        for field in first["fields"]:
            self.assertLess(field["relative_l2"], 0.05)  # three points per FWHM
            self.assertGreater(field["relative_l2"], 1e-6)
        output = self.shearwake("compare", self.out, "fine", "--page", "page.html", expect=1).output
        self.contains(output, "the pair whose surfaces differ most", "largest difference")
        page = (self.folder / "page.html").read_text(encoding="utf-8")
        self.contains(page, "data:image/png;base64,iVBOR", "peak_um")
        self.assertEqual(page.count("\nfirst:  "), 2)  # both pairs

    @pytest.mark.extended
    def test_labels_and_stored_warnings_of_both_sides_are_printed(self):
        self.shearwake("run", "job.toml", "-S", "time.duration_ms=20", "--out", "long", "--quiet")
        output = self.shearwake("compare", "long", self.out, expect=1).output
        self.contains(output, "not valid, first: waves of", "first:  ", "second: ", "(AM frequency 500\u00a0Hz)")
        warnings = self.compare("long", self.out)["pairs"][0]["warnings"]
        returning = [[w["key"] for w in of_side if w["message"].startswith("waves of")] for of_side in warnings]
        self.assertEqual(returning, [["domain.extent_mm"], []])

    @pytest.mark.extended
    def test_files_that_are_not_case_files_are_named(self):
        path = case_files(self.out)[0]
        (self.folder / "text.h5").write_text("not HDF5")
        with h5py.File(self.folder / "map.h5", "w") as file:
            file["c_s_m_s"] = 5.0
        for name, words in (("text.h5", "text.h5 is not a case file of shearwake"),
                            ("map.h5", "map.h5 is not a case file of shearwake"),
                            ("none.h5", "none.h5 is neither a case file, a table (CSV) nor"), ("out/none", "output folder; run the job first")):
            output = self.shearwake("compare", name, path, expect=6).output
            self.contains(output, words)
            self.assertNotIn("Traceback", output)

    @pytest.mark.extended
    def test_single_cases_of_two_engines(self):
        self.shearwake("run", "job.toml", "-S", "solver.engine=spectral", "--out", "other", "--quiet")
        pairs = self.compare(case_files(self.out)[0], case_files(self.out)[1])["pairs"]
        self.assertGreater(pairs[0]["fields"][1]["relative_l2"], 0.1)  # another frequency
        sweeps = self.compare("other", self.out)["pairs"]
        self.assertEqual(sweeps[0]["engines"], ["spectral", "layered"])
        # Required: the accuracy of spectral is 1e-3 of the whole run, and a single surface may differ by a few times that.
        for pair in sweeps:
            self.assertLess(pair["fields"][1]["relative_l2"], 5e-3)

    @pytest.mark.extended
    def test_a_case_equals_itself(self):
        path = case_files(self.out)[0]
        [pair] = self.compare(path, path, expect=0)["pairs"]
        self.assertEqual([f["relative_l2"] for f in pair["fields"]], [0.0, 0.0])
        self.assertTrue(all(c["change"] == 0.0 for c in pair["columns"]))
        self.contains(self.shearwake("compare", path, path).output, "2 surfaces: equal", "no difference")

    @pytest.mark.long
    def test_many_frames_are_summarised(self):
        self.shearwake("run", "job.toml", "-S", "record.frames=true", "--out", "a", "--quiet")
        self.shearwake("run", "job.toml", "-S", "record.frames=true", "-S", "load.peak_Pa=101", "--out", "b", "--quiet")
        found = self.compare("a", "b")["pairs"][0]["fields"]
        self.assertEqual(len(found), 40)
        largest = max(found, key=lambda f: f["largest_um"])
        case_a, case_b = (case_files(self.folder / name)[0] for name in "ab")
        output = self.shearwake("compare", case_a, case_b, "--page", "page.html", expect=1).output
        lines = [line for line in output.splitlines() if line.startswith("  surface at")]
        self.assertEqual(len(lines), 5)
        self.contains(output, f"40 surfaces: relative L2 up to 0.99 %, largest difference {largest['largest_um']:.3g} um",
                      f"surface at {largest['time_ms']:.6g} ms", "--page lists each")
        self.assertEqual((self.folder / "page.html").read_text(encoding="utf-8").count("surface at"), 40)

    @pytest.mark.extended
    def test_a_reader_that_closes_the_pipe_ends_the_comparison_quietly(self):
        done = self.call("bash", "-c", 'set -o pipefail; "$@" | true', "bash", *command("compare", self.out, self.out, "--json"))
        self.assertEqual(done.output, "")

    @pytest.mark.extended
    def test_records_at_other_times_and_depths_are_differences(self):
        self.shearwake("run", "job.toml", "-S", "record.snapshots_ms=[3.0]", "-S", "measure.at_ms=3", "--out", "other", "--quiet")
        done = self.shearwake("compare", "other", self.out, "--page", "page.html", "--tolerance", "*=1e9", expect=1)
        self.contains(done.output, "surface: no common time", "surface  recorded at 1 and 2 times, of which 0 are common")
        self.contains((self.folder / "page.html").read_text(encoding="utf-8"), "No picture")
        self.shearwake("run", "job.toml", "-S", "measure.depths_mm=[0.5]", "--out", "deep", "--quiet")
        self.assertRegex(self.shearwake("compare", "deep", self.out, expect=1).output, "measured depths +other: 0 mm -> 0.5 mm")
        self.assertNotIn("depths", self.shearwake("compare", self.out, self.out).output)

    @pytest.mark.extended
    def test_tables_of_other_ranks_are_equal(self):
        self.shearwake("run", "job.toml", "--out", "two", "--quiet", ranks=2)
        self.contains(self.shearwake("compare", "two", self.out).output, "2 cases", "no difference", "not compared: wall_s, note")
        self.shearwake("diff", "two/tables/small.csv", self.out, ranks=2)  # the table of the folder alone

    @pytest.mark.extended
    def test_missing_and_extra_cases_are_differences(self):
        self.shearwake("run", "job.toml", "-S", 'sweep."load.modulation.am_frequency_Hz"=[500]', "--out", "fewer", "--quiet")
        self.contains(self.shearwake("compare", "fewer", self.out, expect=1).output, "missing case: load.modulation.am_frequency_Hz=1000")
        self.contains(self.shearwake("compare", self.out, "fewer", expect=1).output, "extra case: load.modulation.am_frequency_Hz=1000")
        (self.out / "cases" / f"{plan_ids(self.out)[0]}.h5").unlink()  # it has a row, and a corresponding status
        self.contains(self.shearwake("compare", self.out, "fewer", expect=1).output, "complete -> missing")

    @pytest.mark.extended
    def test_sweeps_without_common_cases_differ(self):
        self.write_job(small_job(swept(50, 60, key="load.peak_Pa"), {"table": None}), name="b.toml")
        self.shearwake("run", "b.toml", "--out", "other", "--quiet")
        self.contains(self.shearwake("compare", self.out, "other", expect=1).output, "missing case: load.peak_Pa=50",
                      "extra case: load.modulation.am_frequency_Hz=500", "missing column: load.peak_Pa", "0 cases")


class Tables(ProgramTest):
    @pytest.mark.extended
    def test_invalid_tables_and_tolerances_are_errors(self):
        for name, text in (("bad", "id,a\n1\n"), ("good", "id,eta_1\nx,1\n"), ("empty", "id,eta_1\n"), ("same", "id,wall_s\nx,1\n")):
            (self.folder / f"{name}.csv").write_text(text, encoding="utf-8")
        (self.folder / "t.toml").write_text("[tolerance]\neta_1 = -1\n", encoding="utf-8")
        for words, code, expected in (
                (["bad.csv", "good.csv"], 6, "bad.csv:2: this is not a valid table"), (["none.csv", "good.csv"], 6, "none.csv is neither"),
                ([self.folder, "good.csv"], 6, "is not an output folder"), (["good.csv"], 2, "B is required"),
                (["good.csv", "empty.csv"], 2, "empty.csv has no cases"), (["same.csv", "same.csv"], 2, "no column in common"),
                (["good.csv", "good.csv", "--tolerance", "eta_2=1"], 2, "eta_2; did you mean eta_1?"),
                (["good.csv", "good.csv", "--tolerance", "eta_1"], 2, "COLUMN=RELATIVE"),
                (["good.csv", "good.csv", "--tolerance", "t.toml"], 2, "t.toml: eta_1 must be a number of at least 0"),
                (["good.csv", "good.csv", "--tolerance", "none.toml"], 6, "none.toml does not exist")):
            with self.subTest(words):
                self.contains(self.shearwake("compare", *words, expect=code).output, expected)
