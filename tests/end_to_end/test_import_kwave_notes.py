# SPDX-License-Identifier: BSD-3-Clause
"""import-kwave reads options in all usual forms, prints what it assumes, and warns of what is probably not intended."""
import types

import h5py
import numpy
import pytest

from kwave import import_kwave, save
from small_study import FilesTest, cell, study
from test_import_kwave_files import as_in_python

from shearwake.kwave import checks

pytestmark = pytest.mark.extended


class Notes(FilesTest):
    def saved(self, changes, **variables):
        """A study with changed fields, {structure: {field: value}}, and other variables."""
        self.changed(variables, **changes)
        return "study.mat"

    def test_options_may_be_a_cell_array_of_names_and_values(self):
        pairs = cell(["PMLInside", False, "PMLSize", numpy.array([2.0, 3, 1]), "PlotSim", False, "DataCast", "single"])
        for name in ("options", "input_args"):
            output = self.imported(self.saved({}, **{"options": None, name: pairs}))
            self.contains(output, "PMLSize 2, 3, 1, outside the grid, PMLAlpha 2", "options.PlotSim: ignored, does not change the physics",
                          "options.DataCast: ignored")
            with h5py.File(self.folder / "study.h5") as file:
                self.assertEqual([file[f"pml_{axis}_size"][0, 0, 0] for axis in "xyz"], [2, 3, 1])
                self.assertEqual([file[f"N{axis}"][0, 0, 0] for axis in "xyz"], [14, 15, 10])
        self.contains(output, "note: the variable input_args is read as options")
        save(self.folder / "study.mat", {**{name: value for name, value in study().items() if name != "options"}})
        with h5py.File(self.folder / "study.mat", "r+") as file:  # the cell array of MATLAB 7.3
            words = [numpy.array([[ord(letter)] for letter in "PMLSize"], dtype="u2"), numpy.array([[3.0]])]
            cells = file.create_dataset("options", (2, 1), dtype=h5py.ref_dtype)
            for number, word in enumerate(words):
                file[f"#refs#/options.{number}"] = word
                cells[number, 0] = file[f"#refs#/options.{number}"].ref
        self.contains(self.imported("study.mat"), "PMLSize 3, inside the grid")

    def test_options_of_other_kinds_are_rejected(self):
        for value, words in ((cell(["PMLSize", 3.0, "PMLInside"]), "a cell array of 3 elements; it must contain pairs"),
                             (cell([3.0, "PMLSize"]), "element 1 of options is numbers"),
                             ("PMLSize", 'options is the text "PMLSize"; it must be a struct'),
                             (numpy.array([1.0, 2.0]), "options is numbers"),
                             ({"PMLsize": 3.0}, "(did you mean PMLSize?)"),
                             (cell(["PMLsize", 3.0]), "options.PMLsize is not a field that pstdElastic3D uses")):
            with self.subTest(words=words):
                self.refused(self.saved({}, options=value), words)

    def test_misspelt_variables_are_reported(self):
        for right, wrong in (("options", "Options"), ("options", "opts"), ("sensor", "sensors"), ("source", "Source")):
            with self.subTest(wrong=wrong):
                self.refused(self.saved({}, **{right: None, wrong: study()[right]}), f"has a variable {wrong} but none named {right}",
                             f"Rename it with {right} = {wrong}")
        self.contains(self.imported(self.saved({}, sensors=1.0, sensor_data=2.0)), "note: not read: sensor_data, sensors")

    def test_the_layer_the_size_and_the_supported_frequency_are_printed(self):
        output = self.imported(self.saved({"medium": {"sound_speed_shear": 4.0}}, options={"PMLSize": 2.0}))
        self.contains(output, "size: 10 x 9 x 16 mm, spacing 1, 1, 2 mm",
                      "absorbing layer (PML): PMLSize 2, inside the grid, PMLAlpha 2, MultiAxialPMLRatio 0.1",
                      "maximum supported frequency: 1000 Hz")  # 4 m/s over twice the largest spacing
        self.contains(self.imported(self.saved({}, options={"PMLSize": 2.0, "PMLAlpha": 0.0})), "absorbing layer (PML): none")
        self.refused(self.saved({}, options=None), "options.PMLSize is 10 along x: two such layers do not fit")

    def test_implausible_units_are_warned_of(self):
        for group, fields, words in (
                ("medium", {"density": 1.0}, ("warning: medium.density is 1 kg/m3; k-Wave expects kg/m3",)),
                ("medium", {"density": 1e6}, ("warning: medium.density is 1e+06 kg/m3",))):
            with self.subTest(words=words):
                self.contains(self.imported(self.saved({group: fields})), *words)
        self.refused(self.saved({"kgrid": {"dx": 1.0, "dy": 1.0, "dz": 2.0}}), "kgrid.dx is 1 m, so that the grid would be ",
                     "k-Wave expects metres", "in mm, save them divided by 1000: kgrid.dx = 0.001")
        self.assertNotIn("expects", self.imported(self.saved({})))
        large = types.SimpleNamespace(spacing_m=numpy.array([0.05, 0.01, 0.01]), points=numpy.array([32, 32, 32]), warnings=[],
                                      medium={"density_kg_m3": numpy.array(1000.0)}, first=numpy.zeros(3, dtype=int))
        checks.check_plausible(large)
        self.assertEqual(large.warnings, ["kgrid.Nx * kgrid.dx is 1.6 m, more than a body; k-Wave expects metres"])

    def test_a_variable_that_is_not_a_structure_is_described(self):
        for name, value, words in (("source", numpy.ones((4, 4)), ("source is not a structure but numbers", "struct('u_mask'")),
                                   ("medium", "water", ('medium is not a structure but the text "water"',
                                                        "struct('sound_speed_compression'"))):
            with self.subTest(name):
                self.refused(self.saved({}, **{name: value}), *words)

    def test_nodes_inside_the_layer_are_warned_of(self):
        self.contains(self.imported(self.saved({}, options={"PMLSize": 3.0})),
                      "warning: source.uz: 3 of 3 nodes lie inside the absorbing layer",
                      "warning: sensor.mask: 3 of 3 nodes lie inside the absorbing layer")
        for options in ({"PMLSize": 3.0, "PMLAlpha": 0.0}, {"PMLSize": 3.0, "PMLInside": False}):
            self.assertNotIn("inside the absorbing", self.imported(self.saved({}, options=options)))

    def test_a_source_above_the_supported_frequency_is_warned_of(self):
        time_s = 1e-5 * numpy.arange(400)
        changes = {"kgrid": {"Nt": 400}, "medium": {"sound_speed_shear": 5.0}}  # supports 1250 Hz
        for frequency_Hz, expected in ((200.0, False), (3000.0, True)):
            series = numpy.sin(2 * numpy.pi * frequency_Hz * time_s)[None, :]
            output = self.imported(self.saved({**changes, "source": {"uz": series}}))
            self.assertEqual("above 1250 Hz, the maximum supported frequency" in output, expected, output)

    def test_samples_that_do_not_match_the_steps_are_reported(self):
        for samples, words in ((30, "later samples are not used"), (12, "the source does not act after step 12")):
            self.contains(self.imported(self.saved({"source": {"uz": numpy.ones((1, samples))}})),
                          f"source.uz has {samples} samples, but kgrid.Nt is 20", words)

    def test_results_of_the_import_are_not_imported(self):
        self.imported(self.saved({}))
        self.refused("study.h5", "study.h5 is an elastic input file of k-Wave: run it with shearwake kwave -i study.h5")
        (self.folder / "study.toml").write_text("schema = 1\n", encoding="utf-8")
        self.refused("study.toml", "study.toml is a job, not a k-Wave simulation")

    def test_the_extension_of_the_output_is_not_repeated(self):
        self.saved({})
        for name in ("a", "a.h5"):
            code, output = import_kwave(self.folder, "study.mat", "--out", name)
            self.assertEqual(code, 0, output)
            self.contains(output, "next: shearwake kwave -i a.h5 -o a-output.h5")
        self.assertEqual([path.name for path in self.folder.glob("a*")], ["a.h5"])

    def test_without_a_mask_values_of_the_entire_grid_are_recorded(self):
        for record, flags in ((["p", "u"], "--p_final"), (["p", "u_max_all"], "--u_max_all")):
            output = self.imported(self.saved({}, sensor={"record": cell(record)}))
            self.contains(output, "note: sensor.mask is missing: only values of the entire grid are recorded", f"{flags} -s 1")
        self.shearwake("kwave", "-i", "study.h5", "-o", "out.h5", "--u_max_all")
        self.contains(self.shearwake("kwave", "-i", "study.h5", "-o", "out.h5", "-p", expect=1).output, "the sensor has no points")

    def test_the_input_is_not_replaced(self):
        with h5py.File(self.folder / "study.h5", "w") as file:
            for group, fields in study().items():
                for name, value in fields.items():
                    file[f"{group}/{name}"] = [numpy.bytes_(word) for word in value] if isinstance(value, list) else as_in_python(value)
        before = (self.folder / "study.h5").read_bytes()
        self.refused("study.h5", "study.h5 would replace the input file")
        self.assertEqual((self.folder / "study.h5").read_bytes(), before)
