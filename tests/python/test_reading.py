# SPDX-License-Identifier: BSD-3-Clause
"""The package opens sweeps as tables and datasets, and reads only what is needed."""
import json
import shutil
import sys
import warnings
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
import pandas as pd
import pytest

from study import AM, FWHM, InFolder, job, program, shearwake

from shearwake.checksum import sealed  # noqa: E402

OPENED = []
sys.addaudithook(lambda event, arguments: OPENED.append(str(arguments[0])) if event in ("open", "os.scandir") else None)


class Counting:
    """Counts the case files that are opened, and the other files of an output folder."""

    def __enter__(self):
        self.cases, real = [], h5py.File
        self.patch = mock.patch("h5py.File", lambda path, *rest, **more: self.cases.append(str(path)) or real(path, *rest, **more))
        self.patch.start()
        OPENED.clear()
        return self

    def __exit__(self, *_):
        self.patch.stop()
        self.others = [path for path in OPENED if "/out/" in path or path.startswith("out/")]


class Reading(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep = job().run()
        cls.paths = {case.settings.get(AM): case.path for case in cls.sweep.cases}

    def opened(self):
        return shearwake.open("out/small")

    def stored(self, frequency, name):
        with h5py.File(self.paths[frequency]) as file:
            return file[name][()]

    def test_three_lines_give_a_dataset_with_the_swept_key_as_dimension(self):
        sweep = shearwake.open("out/small")
        data = sweep.dataset("eta_t", "traces", "eta_period_1")
        self.assertEqual(data["eta_t"].dims, ("am_frequency_Hz", "depth", "time"))
        self.assertEqual(data["traces"].dims, ("am_frequency_Hz", "trace", "time"))
        self.assertEqual(data["am_frequency_Hz"].values.tolist(), [400.0, 500.0, 1000.0])
        self.assertEqual(data["am_frequency_Hz"].attrs, {"key": AM, "long_name": "AM frequency", "units": "Hz"})
        self.assertEqual(data["traces"].attrs["units"], "m")
        for frequency in (400.0, 500.0, 1000.0):
            one = data.sel(am_frequency_Hz=frequency)
            np.testing.assert_array_equal(one["eta_t"], self.stored(frequency, "eta"))
            np.testing.assert_array_equal(one["traces"], self.stored(frequency, "traces/u_z"))
            self.assertEqual(float(one["eta_period_1"]), self.stored(frequency, "eta_period_1"))

    def test_opening_reads_only_the_plan(self):
        with Counting() as count:
            sweep = self.opened()
            self.assertEqual([case.settings[AM] for case in sweep.cases], [400.0, 500.0, 1000.0])
        self.assertEqual(count.cases, [])
        self.assertEqual({Path(path).name for path in count.others}, {"plan.json", "job.toml"})

    def test_a_selection_of_a_dataset_reads_one_file(self):
        data = self.opened().dataset("eta_t", "surface")
        with Counting() as count:
            repr(data)
            chosen = data["surface"].sel(am_frequency_Hz=500.0).isel(surface_time=[3, 7], depth=0)
        self.assertEqual(count.cases, [])
        with Counting() as count:
            values = chosen.values
        self.assertEqual(count.cases, [str(Path("out/small") / self.paths[500.0].relative_to(self.sweep.folder))])
        np.testing.assert_array_equal(values, self.stored(500.0, "surface/u_z")[[3, 7], 0])

    def test_ten_thousand_cases_are_listed_without_opening_one(self):
        folder = Path("out/many")
        (folder / "cases").mkdir(parents=True)
        entries = [{"id": f"{n:016x}", "settings": {AM: float(n % 100), FWHM: 1.0 + n // 100}, "is_reference": False,
                    "reference_id": "", "case": "[domain]\nnx = 48\n"} for n in range(10000)]
        (folder / "plan.json").write_text(sealed({
            "schema": 2, "name": "many", "title": "many", "swept_keys": [AM, FWHM], "table": {"x": AM, "series": []},
            "cases": entries}))
        for entry in entries:
            (folder / "cases" / (entry["id"] + ".h5")).touch()
        tables = folder / "tables"
        tables.mkdir()
        (tables / "many.json").write_text(json.dumps({
            "columns": [{"name": "peak_um", "unit": "um", "meaning": "peak"}],
            "cases": [{"id": e["id"], "status": "complete", "note": "", "wall_s": 1.0, "values": {"peak_um": float(n)},
                       "notes": {}, "warnings": []} for n, e in enumerate(entries)]}))
        with Counting() as count:
            sweep = shearwake.open(folder)
            listed = [(case.id, case.status, case.settings[FWHM]) for case in sweep.cases]
            peaks = sweep.dataset("peak_um")["peak_um"]
            table = sweep.table
        self.assertEqual(count.cases, [])
        self.assertEqual(sorted(Path(path).name for path in count.others), ["cases", "many.json", "plan.json"])
        self.assertEqual(listed[123], (entries[123]["id"], "complete", 2.0))
        self.assertEqual(peaks.shape, (100, 100))
        self.assertEqual(float(peaks.sel(am_frequency_Hz=23, fwhm_mm=2)), 123.0)
        self.assertEqual(table["peak_um"].iloc[123], 123.0)

    def test_the_table_has_units_and_equals_the_csv_file(self):
        table = self.opened().table
        expected = pd.read_csv("out/small/tables/small.csv").set_index("id")
        self.assertEqual(list(table.index), list(expected.index))
        self.assertEqual(table.attrs["units"]["ipr_period_mm2"], "mm2")
        self.assertEqual(table.attrs["units"][AM], "Hz")
        for column in ("eta_period_1", "peak_um", "eta_period_over_reference_1"):
            # The CSV file has nine digits.
            np.testing.assert_allclose(table[column], expected[column], rtol=1e-8)

    def test_without_a_table_the_numbers_come_from_the_case_files(self):
        shutil.copytree("out/small/cases", "out/alone/cases")
        alone, whole = shearwake.open("out/alone"), self.opened()
        self.assertEqual([case.id for case in alone.cases], [case.id for case in whole.cases])
        self.assertEqual(alone.table["peak_um"].tolist(), whole.table["peak_um"].tolist())
        self.assertEqual(alone.dataset("eta").sizes, whole.dataset("eta").sizes)

    def test_references_are_on_the_same_grid(self):
        data = self.opened().dataset("eta_period_1", "force", references=True)
        reference = self.sweep.references[0]
        self.assertEqual(data["eta_period_1"].values.tolist(), [reference.value("eta_period_1")] * 3)
        np.testing.assert_array_equal(data["force"].values, [reference.array("force")] * 3)

    def test_a_missing_case_is_nan(self):
        shutil.copytree("out/small", "out/part")
        (Path("out/part/cases") / self.paths[500.0].name).unlink()
        sweep = shearwake.open("out/part")
        self.assertEqual([case.status == "complete" for case in sweep.cases], [True, False, True])
        self.assertEqual(np.isnan(sweep.dataset("force")["force"].values).all(axis=1).tolist(), [False, True, False])
        with self.assertRaisesRegex(shearwake.NotRecorded, "has no file"):
            sweep.cases[1].surface

    def test_cases_of_different_grids_are_united(self):
        sweep = job(program.swept(1.0, 2.0, key="domain.spacing_mm"), {
            "job.name": "grids", "measure.depths_mm": [0.0, 3.0], "table.x": "domain.spacing_mm"}).run()
        with self.assertWarnsRegex(shearwake.GridsDiffer, "surface/x|/x"):
            surface = sweep.dataset("surface")["surface"]
        fine, coarse = (surface.sel(spacing_mm=s).isel(surface_time=-1, depth=0) for s in (1.0, 2.0))
        self.assertFalse(np.isnan(fine.values).any())
        self.assertEqual(surface["depth"].values.tolist(), [0.0, 3e-3])
        kept = coarse.dropna("x", how="all").dropna("y", how="all")
        np.testing.assert_array_equal(kept.values, sweep.cases[1].snapshot()[3])

    def test_readings_that_are_not_valid_are_marked_and_warned_of(self):
        # Waves of 5 m/s return to the focus from the edges of the smaller domain, not from those of the larger one.
        text = job(program.swept([36.0, 24.0], [120.0, 120.0], key="domain.extent_mm"), {
            "job": {"name": "judged"}, "domain.extent_mm": [64.0, 120.0], "table.x": "domain.extent_mm"})
        with pytest.warns(shearwake.NotValid, match="of judged are not valid: "):
            sweep = text.run()
        expected = {"36": False, "120": True}
        for case in sweep.every_case:
            self.assertEqual(case.is_valid, expected[str(round(1e3 * case.setting("domain", "nx")
                                                               * case.setting("domain", "spacing_m")))], case.warnings)
        self.assertEqual(sweep.table["valid"].tolist(), [case.is_valid for case in sweep.every_case])
        csv = pd.read_csv("out/judged/tables/judged.csv").set_index("id")
        self.assertEqual((csv["valid"] == "yes").tolist(), sweep.table["valid"].tolist())
        self.assertEqual(Path("out/judged/tables/judged.md").read_text(encoding="utf-8").splitlines()[0], "# judged")
        with pytest.warns(shearwake.NotValid, match="of 2 cases of judged are not valid"):
            data = sweep.dataset("peak_um")
        np.testing.assert_array_equal(data["valid"].values, [case.is_valid for case in sweep.cases])
        self.assertEqual(int(data["peak_um"].where(data["valid"] == 1).count()), 1)
        shutil.copytree("out/judged/cases", "out/judged-alone/cases")
        with pytest.warns(shearwake.NotValid):
            alone = shearwake.open("out/judged-alone").dataset("peak_um")
        self.assertEqual(sorted(alone["valid"].values.tolist()), [0.0, 1.0])
        invalid = next(case for case in sweep.cases if not case.is_valid)
        self.assertTrue(invalid.plot.surface().axes[0].get_title(loc="left").endswith("(not valid)"))
        for opened in (lambda: invalid.surface, lambda: invalid.series):
            with pytest.warns(shearwake.NotValid, match="not valid: "):
                opened()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual([case.dataset().attrs for case in sweep.cases if case.is_valid],
                             [{"case": case.id, "valid": 1} for case in sweep.cases if case.is_valid])
        self.assertEqual([repr(case).endswith(", not valid>") for case in sweep.cases], [not case.is_valid for case in sweep.cases])

    def test_a_ratio_is_valid_if_the_case_and_its_reference_are(self):
        shutil.copytree("out/small", "out/wrong-reference")
        path = Path("out/wrong-reference/tables/small.json")
        table = json.loads(path.read_text())
        reference = self.sweep.references[0].id
        table["warnings"].append({"severity": "error", "key": "domain.extent_mm", "message": "waves return"})
        for row in table["cases"]:
            if row["id"] == reference:
                row["warnings"] = [len(table["warnings"])]
        path.write_text(json.dumps(table))
        sweep = shearwake.open("out/wrong-reference")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual(sweep.dataset("eta_period_1")["valid"].values.tolist(), [1.0] * 3)
        with pytest.warns(shearwake.NotValid, match="1 of 4 cases of small are not valid: waves return"):
            data = sweep.dataset("eta_period_1", "eta_period_over_reference_1")
        self.assertEqual(data["valid"].values.tolist(), [0.0] * 3)
        self.assertEqual(data["valid_case"].values.tolist(), [1.0] * 3)
        table = sweep.table[~sweep.table["is_reference"]]
        self.assertEqual((table["valid"].tolist(), table["valid_ratios"].tolist()), ([True] * 3, [False] * 3))

    def test_the_dimensions_of_several_keys_and_of_keys_that_vary_together(self):
        sweep = job({"job.name": "two"}).sweep(
            {AM: [400.0, 500.0]}, zip=[{FWHM: [4.5, 6.0], "load.peak_Pa": [100.0, 50.0]}],
            exclude=[{AM: 500.0, FWHM: 6.0}]).run()
        data = sweep.dataset("peak_um", "eta")
        self.assertEqual(dict(data["peak_um"].sizes), {"am_frequency_Hz": 2, "fwhm_mm": 2})
        self.assertEqual(data["peak_Pa"].dims, ("fwhm_mm",))
        self.assertEqual(np.isnan(data["peak_um"].values).tolist(), [[False, False], [False, True]])
        self.assertEqual(float(data["peak_um"].sel(am_frequency_Hz=400, fwhm_mm=6.0)),
                         sweep.case(am_frequency_Hz=400.0, fwhm_mm=6.0).value("peak_um"))

    def test_a_case_that_does_not_exist_is_refused_with_the_nearest_value(self):
        sweep = self.opened()
        with self.assertRaisesRegex(KeyError, "no case has load.modulation.am_frequency_Hz = 410; the nearest value is 400"):
            sweep.case(am_frequency_Hz=410)
        with self.assertRaisesRegex(TypeError, r"7 is not a mapping .* sweep.cases\[0\]"):
            sweep.case(7)

    def test_a_case_offers_its_contents(self):
        case = self.opened().case(am_frequency_Hz=400.0)
        self.assertEqual(case.surface.dims, ("time", "depth", "x", "y"))
        self.assertEqual(case.surface.attrs["units"], "m")
        self.assertEqual(case.traces["x"].values.tolist(), [0.0, 0.0032])
        self.assertEqual(case.setting("load", "peak_Pa"), 100.0)
        self.assertEqual(case.reference.settings, {})
        self.assertTrue(case.is_valid)
        case.verify()
        with self.assertRaisesRegex(shearwake.NotRecorded, "record.volumes_ms"):
            case.volume
        with self.assertRaisesRegex(shearwake.NotRecorded, r"\[afferents\]"):
            case.spikes()

    def test_misspelt_columns_and_parameters_are_errors(self):
        case = self.opened().cases[1]
        lone = shearwake.open_case(case.path)
        for one in (case, lone):
            with self.assertRaisesRegex(KeyError, "focal_rms_mm is not a column; did you mean focal_rms_um"):
                one.value("focal_rms_mm")
            with self.assertRaisesRegex(KeyError, "no measure.focal_radius_mm; did you mean focal_radius_m"):
                one.setting("measure", "focal_radius_mm")
            with self.assertRaisesRegex(KeyError, "no domain.spacing_m.x"):
                one.setting("domain", "spacing_m", "x")
            self.assertEqual((one.setting("load", "nothing", default=3.5), one.value("focal_rms_mm", -1.0)), (3.5, -1.0))
            self.assertEqual(one.value("focal_rms_um", -1.0), one.value("focal_rms_um"))
        self.assertTrue(np.isnan(case.reference.value("eta_period_over_reference_1")))
        shutil.copytree("out/small", "out/unfinished")
        for path in Path("out/unfinished/cases").glob("*.h5"):
            path.unlink()
        (Path("out/unfinished/tables") / "small.json").unlink()
        with self.assertRaisesRegex(shearwake.NotRecorded, "has no file"):
            shearwake.open("out/unfinished").cases[0].value("peak_um")

    def test_errors_about_a_damaged_file_name_it(self):
        shutil.copytree("out/small", "out/cut")
        sweep = shearwake.open("out/cut")
        case = sweep.cases[2]
        case.path.write_bytes(case.path.read_bytes()[:2900])
        for read in (lambda: case.arrays(), lambda: case.surface, lambda: case.attributes, case.verify,
                     lambda: sweep.dataset("traces")["traces"].values):
            with self.assertRaises(shearwake.Damaged) as raised:
                read()
            self.assertIn(str(case.path), str(raised.exception))
        with self.assertRaisesRegex(shearwake.NotRecorded, "not a valid case file"):
            shearwake.open_case(case.path)

    def test_damage_names_programs_that_opened_a_file_for_writing(self):
        shutil.copytree("out/small", "out/written")
        sweep = shearwake.open("out/written")
        for case, change in zip(sweep.cases, ("nothing", "value", "attribute")):
            with h5py.File(case.path, "r+") as file:
                if change == "value":
                    file["eta_at_1"][()] *= 1.01
                elif change == "attribute":
                    file.attrs["remark"] = "x" * 5000
            if change == "nothing":
                case.verify()
                continue
            with self.assertRaisesRegex(shearwake.Damaged, "another program has opened it for writing and changed it"):
                case.verify()
        case.path.write_bytes(case.path.read_bytes()[:1000])
        with self.assertRaisesRegex(shearwake.Damaged, "covers .* bytes: it is truncated"):
            case.verify()

    def test_a_case_that_was_found_to_be_damaged_has_no_values(self):
        shutil.copytree("out/small", "out/flipped")
        sweep = shearwake.open("out/flipped")
        case, other = sweep.cases[0], sweep.cases[1]
        sound = case.path.read_bytes()
        case.path.write_bytes(sound[:1000] + bytes([sound[1000] ^ 1]) + sound[1001:])
        self.assertEqual(case.status, "complete")  # not read yet
        damage = sweep.verify()
        self.assertEqual((case.status, case.is_complete, case.values), ("damaged", False, {}))
        self.assertIn("its bytes do not match its checksum", case.reason)
        self.assertEqual(damage, {case.id: case.reason})
        with self.assertRaises(shearwake.Damaged):
            case.verify()
        self.assertEqual(sweep.table.loc[case.id, "status"], "damaged")
        self.assertTrue(np.isnan(sweep.dataset("peak_um")["peak_um"].sel(am_frequency_Hz=case.settings[AM]).min()))
        self.assertEqual((other.status, other.damage), ("complete", ""))
        case.path.write_bytes(other.path.read_bytes())
        with self.assertRaisesRegex(shearwake.Damaged, "it contains another case"):
            case.verify()
        case.path.write_bytes(sound)
        case.verify()
        self.assertEqual((case.status, sweep.verify()), ("complete", {}))

    def test_the_tables_beside_the_table_of_cases_are_frames(self):
        shutil.copytree("out/small", "tables-of-all-kinds")
        folder = Path("tables-of-all-kinds")
        (folder / "tables" / "small.statistics.csv").write_text(
            "column,statistic,value,low_95,high_95,samples,without_value,note\n"
            "eta_at_1,q50,0.25,0.2,0.3,40,2,\neta_at_1,q95,,,,0,42,too few samples\n", encoding="utf-8")
        (folder / "optimise").mkdir()
        (folder / "optimise" / "table.csv").write_text("case,load.speed_m_s,strength_at_least_1,eta_am_1\n"
                                                       "ab,7,0.9,\n", encoding="utf-8")
        sweep = shearwake.open(folder)
        self.assertEqual(sweep.statistics.loc[0, "value"], 0.25)
        self.assertTrue(np.isnan(sweep.statistics.loc[1, "value"]))
        self.assertEqual(sweep.statistics["note"].tolist(), ["", "too few samples"])
        self.assertEqual(sweep.optima.loc[0, "strength_at_least_1"], 0.9)
        self.assertTrue(np.isnan(sweep.optima.loc[0, "eta_am_1"]))
        self.assertTrue(sweep.sensitivity.empty and sweep.adaptive.empty)
        (folder / "tables" / "small.sensitivity.csv").write_text("column,value\neta_at_1,x\n", encoding="utf-8")
        with self.assertRaisesRegex(shearwake.NotAnOutputFolder, "sensitivity is damaged"):
            self.assertTrue(sweep.sensitivity.empty)

    def test_other_folders_and_names_are_rejected_with_a_reason(self):
        with self.assertRaisesRegex(shearwake.NotAnOutputFolder, "no such output folder"):
            shearwake.open("out/none")
        with self.assertRaisesRegex(KeyError, "peak_qm is not a column.*did you mean peak_um"):
            self.opened().dataset("peak_qm")
        with self.assertRaisesRegex(KeyError, "am_frequency_Hz"):
            self.opened().select(speed=3)
        Path("no.h5").write_text("no case")
        with self.assertRaisesRegex(shearwake.NotRecorded, "not a valid case file"):
            shearwake.open_case("no.h5")

    def test_pictures_show_the_snapshot_nearest_to_the_time(self):
        case = self.opened().cases[0]
        axes = case.plot.surface(0.00204).axes[0]
        self.assertEqual(axes.get_title(loc="left"), "t = 2 ms")
        np.testing.assert_array_equal(axes.images[0].get_array(), 1e6 * self.stored(400.0, "surface/u_z")[19, 0].T)
        axes = case.plot.wake().axes[0]
        self.assertGreaterEqual(len(axes.lines), 5)  # path, focal disc, focus, and two Mach lines
        self.assertLess(axes.images[0].get_clim()[1], case.value("peak_um"))

    @pytest.mark.long
    def test_an_animation_shows_every_frame(self):
        movie = self.opened().cases[0].animate(end_um=2.0)
        movie.save("a.gif", writer="pillow", dpi=30)
        self.assertGreater(Path("a.gif").stat().st_size, 1000)
        self.assertEqual(len(list(movie.new_frame_seq())), 40)
        shown = movie._repr_html_()  # a player without icons of another site that begins with the wake
        for other in ("<link", "https://", "fa fa-"):
            self.assertNotIn(other, shown)
        self.assertEqual(shown.count("set_frame(frames.length >> 1);"), 1)
        self.assertIn(">\u25b6</button>", shown.replace("\n", "").replace("  ", ""))


class Receptors(InFolder):
    def test_afferents_and_spikes_agree_with_the_table(self):
        for name in ("circle.toml", "circle-afferents.csv"):
            shutil.copy(program.ROOT / "jobs" / name, name)
        small = shearwake.Job("circle.toml", time={"duration_ms": 50.0, "output_interval_us": 500.0},
                              measure={"settled_after_ms": 10.0}, record={"snapshots_ms": [50.0]},
                              table={"reference": {}}, domain={"spacing_mm": 4.0})
        tables = small.tables
        del tables["table"]["reference"]
        made = shearwake.Job(tables).sweep({"load.modulation.draw_frequency_Hz": [100.0]}).run()
        case = made.cases[0]
        afferents, spikes = case.afferents, case.spikes()
        self.assertEqual(len(afferents), 104)
        self.assertEqual(set(afferents["class"]), {"RA", "PC"})
        self.assertEqual(len(spikes), afferents["spike_count"].sum())
        for kind in ("RA", "PC"):
            self.assertEqual((spikes["class"] == kind).sum(), case.value(f"{kind}_spikes_1"))
        self.assertTrue(((spikes["time_s"] > 0) & (spikes["time_s"] <= 0.05)).all())
        counts = spikes.groupby("afferent").size()
        np.testing.assert_array_equal(afferents["spike_count"][counts.index], counts)
