# SPDX-License-Identifier: BSD-3-Clause
"""import-kwave reads the same study from files of MATLAB, Octave, SciPy and h5py, and explains other files."""
import shutil

import h5py
import numpy
import pytest
import scipy.io
import scipy.sparse

from kwave import nodes_of, save
from program import ROOT
from small_study import POINTS, FilesTest, cell, study

pytestmark = pytest.mark.extended

def as_in_python(value):
    """A value as Python scripts store it with h5py: arrays with reversed indices, texts as strings."""
    return value if isinstance(value, (str, list, bool, int, float)) else numpy.asarray(value).T


def octave_value(group, name, value):
    """Stores a value in the format of Octave's save -hdf5."""
    item = group.create_group(name)
    item.attrs["OCTAVE_NEW_FORMAT"] = numpy.uint8(1)
    if isinstance(value, (dict, list)):
        item["type"] = numpy.bytes_("scalar struct" if isinstance(value, dict) else "cell")
        inner = item.create_group("value")
        if isinstance(value, list):
            inner["dims"] = numpy.array([1, len(value)])
            value = {f"_{n}": one for n, one in enumerate(value)}
        for field, one in value.items():
            octave_value(inner, field, one)
    elif isinstance(value, str):
        item["type"] = numpy.bytes_("string")
        item["value"] = numpy.array([[ord(letter)] for letter in value], dtype="i1")
    else:
        value = numpy.asarray(value, dtype=float)
        item["type"] = numpy.bytes_("matrix" if value.ndim else "scalar")
        item["value"] = value.T


class Files(FilesTest):
    def assert_reads(self, name):
        self.contains(self.imported(name), "--p_raw --u_raw -s 1")
        with h5py.File(self.folder / "study.h5") as file:
            self.assertEqual([file[f"N{axis}"][0, 0, 0] for axis in "xyz"], list(POINTS))
            self.assertEqual((file["dt"][0, 0, 0], file["Nt"][0, 0, 0]), (1e-5, 20))
            self.assertEqual([file[f"pml_{axis}_size"][0, 0, 0] for axis in "xyz"], [2, 2, 2])
            numpy.testing.assert_array_equal(file["mu"][()].T, 1000.0 * study()["medium"]["sound_speed_shear"] ** 2)
            self.assertEqual([file[name][0, 0, 0] for name in ("ux_source_flag", "uz_source_flag", "u_source_mode")], [0, 20, 0])
            numpy.testing.assert_array_equal(nodes_of(file, "u_source_index"), [[3, 4, 2], [4, 4, 2], [6, 4, 2]])
            numpy.testing.assert_array_equal(file["uz_source_input"][0].T, numpy.arange(60.0).reshape(3, 20))
            numpy.testing.assert_array_equal(file["sensor_mask_corners"][0], [[3, 4, 2, 5, 4, 2]])
            self.assertEqual(file["c_ref"][0, 0, 0], 20.0)

    def test_matlab_7_3(self):
        save(self.folder / "study.mat", study())
        with h5py.File(self.folder / "study.mat", "r+") as file:  # the attributes that MATLAB adds
            for group in ("kgrid", "medium", "source", "sensor", "options"):
                file[group].attrs["MATLAB_class"] = numpy.bytes_("struct")
            file["source/u_mode"].attrs["MATLAB_class"] = numpy.bytes_("char")
            file["sensor/record"].attrs["MATLAB_class"] = numpy.bytes_("cell")
            file["options/PMLInside"].attrs["MATLAB_class"] = numpy.bytes_("logical")
            empty = file["source"].create_dataset("p0", data=numpy.zeros(2, dtype="u8"))
            empty.attrs["MATLAB_empty"] = numpy.uint8(1)
        self.assert_reads("study.mat")

    def test_scipy_savemat(self):
        for record in (cell(["p", "u"]), ["p ", "u "]):  # a cell array, and rows of characters
            self.changed(sensor={"record": record})
            self.assert_reads("study.mat")

    def test_scipy_savemat_with_arrays_of_scipys_usual_types(self):
        structures = study()
        structures["source"]["u_mask"] = structures["source"]["u_mask"].astype(bool)
        structures["sensor"].update(record=cell(["p", "u"]), mask=structures["sensor"]["mask"].astype("i4"))
        structures["kgrid"]["dt"] = numpy.float32(1e-5).astype(float).round(8)
        scipy.io.savemat(self.folder / "study.mat", structures, do_compression=True, oned_as="column")
        self.assert_reads("study.mat")

    def test_h5py_with_strings_scalars_attributes_and_bytes(self):
        for text in (str, numpy.bytes_):
            with h5py.File(self.folder / "study.h5py", "w") as file:
                for group, fields in study().items():
                    for name, value in fields.items():
                        if isinstance(value, list):
                            file[f"{group}/{name}"] = [numpy.bytes_(word) for word in value]
                        elif isinstance(value, str):
                            file[f"{group}/{name}"] = text(value)
                        else:
                            file[f"{group}/{name}"] = as_in_python(value)
                del file["kgrid/Nx"]
                file["kgrid"].attrs["Nx"] = POINTS[0]
            self.assert_reads("study.h5py")

    def test_octave_hdf5(self):
        with h5py.File(self.folder / "study.h5o", "w") as file:
            for name, fields in study().items():
                octave_value(file, name, {field: float(value) if isinstance(value, bool) else value
                                          for field, value in fields.items()})
        self.assert_reads("study.h5o")

    def test_octave_itself(self):
        if not shutil.which("octave-cli"):
            self.skipTest("octave-cli is not installed")
        structures = study()
        structures["sensor"]["record"] = cell(["p", "u"])
        scipy.io.savemat(self.folder / "given.mat", structures)
        for form, name in (("-v7", "study.mat"), ("-v6", "study6.mat"), ("-hdf5", "study.hdf")):
            self.call("octave-cli", "--quiet", "--eval", "load given.mat; options.PMLInside = true; kgrid.t_array = 0:1e-5:19e-5; "
                      f"save {form} {name} kgrid medium source sensor options")
            with self.subTest(form=form):
                self.assert_reads(name)


class Errors(FilesTest):
    def test_sparse_matrices_that_would_be_large_are_refused(self):
        self.changed(source={"u_mask": scipy.sparse.csc_matrix(([1.0], ([0], [0])), shape=(100_000, 100_000))})
        self.refused("study.mat", "a sparse matrix of 100000 x 100000 numbers")

    def test_files_that_are_not_studies_are_explained(self):
        (self.folder / "text.mat").write_text("no study", encoding="utf-8")
        self.refused("text.mat", "text.mat is neither an HDF5 file nor a .mat file")
        self.refused("nowhere.mat", "nowhere.mat: no such file", "the working directory is", expect=6)
        self.refused(".", "Is a directory", expect=6)
        scipy.io.savemat(self.folder / "other.mat", {"x": 1.0})
        self.refused("other.mat", "has no structure kgrid")
        whole = self.folder / "whole.mat"
        save(whole, study())
        for keep in (100, 2000, 9000):
            (self.folder / "cut.mat").write_bytes(whole.read_bytes()[:keep])
            self.refused("cut.mat", "cut.mat")
        scipy.io.savemat(whole, study())
        for keep in (100, 400, 2000):
            (self.folder / "cut.mat").write_bytes(whole.read_bytes()[:keep])
            self.refused("cut.mat", "import-kwave:")

    def test_values_of_wrong_kinds_are_explained(self):
        for group, field, value, words in (
                ("source", "u_mask", "text", "source.u_mask"),
                ("source", "u_mode", 1.5, "source.u_mode does not contain text"),
                ("source", "uz", numpy.array([[1 + 1j, 2]]), "its numbers are complex"),
                ("kgrid", "Nx", numpy.array([1.0, 2]), "kgrid.Nx has the shape"),
                ("kgrid", "Nt", "many", "kgrid.Nt"), ("kgrid", "dx", numpy.nan, "is not finite"),
                ("medium", "density", {"a": 1.0}, "medium.density does not contain numbers"),
                ("medium", "density", cell([1.0, 2.0]), "medium.density does not contain numbers"),
                ("medium", "sound_speed_ref", "middle", "medium.sound_speed_ref must be a number"),
                ("medium", "sound_speed_shear", numpy.ones(POINTS[::-1]), "its indices are in reverse order"),
                ("sensor", "mask", 1.0, "sensor.mask has the shape"), ("sensor", "record", cell([1.5]), "sensor.record"),
                ("options", "PMLSize", "thick", "options.PMLSize"),
                ("options", "PMLAlpha", cell([]), "wrote"), ("sensor", "mask", numpy.zeros((0, 0)), "wrote")):
            with self.subTest(group=group, field=field, words=words):
                self.changed(**{group: {field: value}})
                if words == "wrote":  # an empty value is as good as none
                    self.imported("study.mat")
                else:
                    self.refused("study.mat", words)

    def test_other_types_of_files_are_refused(self):
        numpy.save(self.folder / "study.npy", numpy.ones(3))
        numpy.savez(self.folder / "study.npz", x=numpy.ones(3))
        (self.folder / "empty.mat").write_bytes(b"")
        for name in ("study.npy", "study.npz", "empty.mat"):
            self.refused(name, f"{name} is neither an HDF5 file nor a .mat file")
        self.refused("emty.mat", "did you mean empty.mat?", expect=6)

    def test_a_simulation_without_meaning_names_the_field_to_change(self):
        ones = numpy.ones(POINTS)
        negative = ones.copy()
        negative[2, 3, 4] = -1000.0
        for group, fields, words in (
                ("kgrid", {"Nt": 20.5}, ("kgrid.Nt is 20.5", "whole number")),
                ("kgrid", {"t_array": numpy.array([0.0, 1e-5, 3e-5]), "dt": numpy.zeros((0, 0))}, ("uniformly spaced",)),
                ("medium", {"sound_speed_shear": 25.0}, ("medium.sound_speed_shear exceeds", "sound_speed_compression")),
                ("medium", {"density": negative}, ("medium.density is -1000 at node (3, 4, 5)", "greater than 0")),
                ("medium", {"sound_speed_shear": -5.0}, ("medium.sound_speed_shear is -5",)),
                ("medium", {"alpha_coeff_compression": 1.0, "alpha_coeff_shear": -1.0}, ("medium.alpha_coeff_shear is -1",)),
                ("medium", {"sound_speed_ref": -1.0}, ("medium.sound_speed_ref is -1",)),
                ("medium", {"sound_speed_shear": 5.0 * numpy.ones((9, 10, 8))}, ("its axes are permuted",)),
                ("medium", {"sound_speed_shear": 5.0 * numpy.ones(720)}, ("reshape it to (10, 9, 8)",)),
                ("source", {"uz": numpy.ones((20, 3))}, ("source.uz", "it appears to be transposed")),
                ("sensor", {"mask": numpy.ones((4, 6))}, ("sensor.mask", "it appears to be transposed")),
                ("sensor", {"record_start_index": 21.0}, ("sensor.record_start_index is 21", "kgrid.Nt = 20")),
                ("options", {"PMLSize": 5.0}, ("options.PMLSize is 5 along y", "kgrid.Ny = 9")),
                ("source", {"u_mask": 0.5 * ones}, ("source.u_mask is 0.5 at node (1, 1, 1); a mask contains 0 and 1",)),
                ("medium", {"density": "heavy"}, ('medium.density does not contain numbers but the text "heavy"',)),
                ("medium", {"density": None}, ("medium.density is missing",)),
                ("medium", {"BonA": 6.0}, ("medium.BonA is not a field", "sound_speed_shear")),
                ("medium", {"density": numpy.ones((3, 3, 3))}, ("(3, 3, 3)", "(10, 9, 8)")),
                ("medium", {"alpha_coeff_shear": 1.0}, ("must be specified together",)),
                ("source", {"u_mask": numpy.zeros((2, 2, 2))}, ("source.u_mask", "(2, 2, 2)")),
                ("source", {"u_mask": None}, ("source.u_mask is missing",)),
                ("source", {"uz": numpy.ones((7, 4))}, ("7 rows, but its mask has 3 nodes",)),
                ("source", {"u_mode": "soft"}, ("soft", '"additive" or "dirichlet"')),
                ("source", {"p0": ones, "s_mask": ones, "sxy": numpy.ones((1, 4))}, ("source.sxy cannot be combined with source.p0",)),
                ("kgrid", {"Ny": 1}, ("at least 2",)), ("kgrid", {"dt": None}, ("kgrid.dt is missing",)),
                ("sensor", {"record": "q"}, ("sensor.record 'q' is unknown",))):
            with self.subTest(words=words):
                self.changed(**{group: fields})
                self.refused("study.mat", *words)

    def test_an_unstable_step_is_rejected(self):
        """A run with 0.95 times the limit is stable, 1.15 times the limit is rejected, also without the import."""
        parts = {"medium": {"sound_speed_shear": 5.0}, "source": {"uz": numpy.ones((1, 20)), "u_mode": "additive"}}
        limit_s = float(2.0 / (20.0 * numpy.pi * numpy.sqrt(1e6 + 1e6 * (8 / 9) ** 2 + 0.25e6)))  # 9 points along y
        self.changed(kgrid={"Nt": 2000, "dt": 0.95 * limit_s}, **parts)
        self.imported("study.mat")
        self.shearwake("kwave", "-i", "study.h5", "-o", "out.h5")
        with h5py.File(self.folder / "study.h5", "r+") as file:
            file["dt"][...] = 1.15 * limit_s
        self.contains(self.shearwake("kwave", "-i", "study.h5", "-o", "out.h5", expect=1).output, "unstable in this medium")

    def test_ranges_of_octave_that_are_endless_are_refused(self):
        kind = [("base", "f8"), ("limit", "f8"), ("increment", "f8")]
        for limits in ((0.0, 1e12, 1.0), (0.0, 1.0, 0.0), (0.0, numpy.inf, 1e-5)):
            with h5py.File(self.folder / "range.h5", "w") as file:
                item = file.create_group("kgrid/t_array")
                item.attrs["OCTAVE_NEW_FORMAT"] = numpy.uint8(1)
                item["type"] = numpy.bytes_("range")
                item["value"] = numpy.array(limits, dtype=kind)
                for name in ("medium", "source"):
                    file.create_group(name)
            with self.subTest(limits=limits):
                self.refused("range.h5", "is not one of at most 1e+07 numbers")

    def test_input_of_the_acoustic_code_is_named(self):
        with h5py.File(self.folder / "acoustic.h5", "w") as file:
            for name, value in {"Nx": 8, "Ny": 8, "Nz": 8, "dt": 1e-7, "c0": 1500.0, "rho0": 1000.0, "pml_x_size": 2}.items():
                file[name] = numpy.full((1, 1, 1), value)
        self.refused("acoustic.h5", "input file of the acoustic C++ code of k-Wave (it contains c0, rho0, pml_x_size)")

    def test_help_describes_the_structures(self):
        run = self.call(ROOT / "scripts" / "import-kwave", "--help")
        self.assertEqual(run.stderr, "")
        self.contains(run.stdout, "kgrid", "sound_speed_shear", "MultiAxialPMLRatio", "exit codes", "--out", "shearwake kwave")

    def test_objects_of_matlab_are_explained(self):
        for place, kind, words in (
                ("kgrid", "kWaveGrid", ("kgrid is not a structure", "struct('Nx', kgrid.Nx")),
                ("source/u_mode", "string", ("source.u_mode", "save a struct or a character array instead"))):
            save(self.folder / "study.mat", study())
            with h5py.File(self.folder / "study.mat", "r+") as file:
                del file[place]
                file[place] = numpy.zeros((1, 6), dtype="u4")
                file[place].attrs["MATLAB_class"] = numpy.bytes_(kind)
            self.refused("study.mat", *words)
