# SPDX-License-Identifier: BSD-3-Clause
"""import-kwave reads the same study from files of MATLAB, Octave, SciPy and h5py, and explains other files."""
import shutil
import subprocess
import unittest

import h5py
import numpy
import scipy.io

from kwave import save
from program import ROOT, ProgramTest, environment

POINTS = (10, 9, 8)


def study():
    mask = numpy.zeros(POINTS)
    mask[3:5, 4, 2], mask[6, 4, 2] = 1.0, 1.0
    c_s = 5.0 + numpy.arange(10.0)[:, None, None] * numpy.ones(POINTS)
    return {
        "kgrid": {**{f"N{axis}": n for axis, n in zip("xyz", POINTS)}, "dx": 1e-3, "dy": 1e-3, "dz": 2e-3,
                  "dt": 1e-5, "Nt": 20},
        "medium": {"sound_speed_compression": 20.0, "sound_speed_shear": c_s, "density": 1000.0,
                   "sound_speed_ref": "mean"},
        "source": {"u_mask": mask, "uz": numpy.arange(60.0).reshape(3, 20), "u_mode": "dirichlet"},
        "sensor": {"mask": numpy.array([[3.0, 4, 2, 5, 4, 2]]).T, "record": ["p", "uz"]},
        "options": {"PMLInside": True, "PMLSize": numpy.array([[2.0, 2, 2]])},
    }


def cell(words):
    cells = numpy.empty((1, len(words)), dtype=object)
    cells[0, :] = words
    return cells


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


class FilesTest(ProgramTest):
    def imported(self, name, expect=0):
        done = subprocess.run([ROOT / "scripts" / "import-kwave", name, "--out", "study"], cwd=self.folder,
                              env=environment(), capture_output=True, encoding="utf-8", check=False)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stdout + done.stderr)
        return done.stdout + done.stderr


class Files(FilesTest):
    def assert_reads(self, name):
        self.imported(name)
        with h5py.File(self.folder / "study.h5") as file:
            numpy.testing.assert_array_equal(file["grid/points"][()], POINTS)
            self.assertEqual((file["grid"].attrs["time_step_s"], file["grid"].attrs["steps"]), (1e-5, 20))
            numpy.testing.assert_array_equal(file["layer/points"][()], [2, 2, 2])
            numpy.testing.assert_array_equal(file["medium/c_s_m_s"][()], study()["medium"]["sound_speed_shear"])
            source = file["source_0"]
            self.assertEqual((source.attrs["field"], source.attrs["mode"]), (b"uz", b"dirichlet"))
            numpy.testing.assert_array_equal(source["nodes"][()], [[3, 4, 2], [4, 4, 2], [6, 4, 2]])
            numpy.testing.assert_array_equal(source["series"][()], numpy.arange(60.0).reshape(3, 20))
            numpy.testing.assert_array_equal(file["sensor/nodes"][()], [[2, 3, 1], [3, 3, 1], [4, 3, 1]])
            self.assertEqual(file["sensor"].attrs["fields"], b"uz sxx syy szz")
            self.assertEqual(file["layer"].attrs["speed_m_s"], 20.0)

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
        structures = study()
        structures["sensor"]["record"] = cell(["p", "uz"])
        for record in (cell(["p", "uz"]), ["p ", "uz"]):  # a cell array, and rows of characters
            structures["sensor"]["record"] = record
            scipy.io.savemat(self.folder / "study.mat", structures)
            self.assert_reads("study.mat")

    def test_scipy_savemat_with_arrays_of_scipys_usual_types(self):
        structures = study()
        structures["source"]["u_mask"] = structures["source"]["u_mask"].astype(bool)
        structures["sensor"].update(record=cell(["p", "uz"]), mask=structures["sensor"]["mask"].astype("i4"))
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
        structures["sensor"]["record"] = cell(["p", "uz"])
        scipy.io.savemat(self.folder / "given.mat", structures)
        for form, name in (("-v7", "study.mat"), ("-v6", "study6.mat"), ("-hdf5", "study.hdf")):
            subprocess.run(["octave-cli", "--quiet", "--eval",
                            f"load given.mat; options.PMLInside = true; kgrid.t_array = 0:1e-5:19e-5; save {form} {name} "
                            "kgrid medium source sensor options"], cwd=self.folder, check=True, capture_output=True)
            with self.subTest(form=form):
                self.assert_reads(name)


class Errors(FilesTest):
    def refused(self, name, *words, expect=3):
        self.says(self.imported(name, expect=expect), *words)

    def test_files_that_are_no_studies_are_explained(self):
        (self.folder / "text.mat").write_text("no study", encoding="utf-8")
        self.refused("text.mat", "is neither an HDF5 file nor a .mat file")
        self.refused("nowhere.mat", "No such file", expect=6)
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
                structures = study()
                structures["sensor"]["record"] = cell(["p", "uz"])
                structures[group][field] = value
                scipy.io.savemat(self.folder / "study.mat", structures)
                if words == "wrote":  # an empty value is as good as none
                    self.imported("study.mat")
                else:
                    self.refused("study.mat", words)

    def test_objects_of_matlab_are_explained(self):
        save(self.folder / "study.mat", study())
        with h5py.File(self.folder / "study.mat", "r+") as file:
            del file["kgrid"]
            file["kgrid"] = numpy.zeros((1, 6), dtype="u4")
            file["kgrid"].attrs["MATLAB_class"] = numpy.bytes_("kWaveGrid")
        self.refused("study.mat", "kgrid is not a structure", "struct('Nx', kgrid.Nx")
        save(self.folder / "study.mat", study())
        with h5py.File(self.folder / "study.mat", "r+") as file:
            del file["source/u_mode"]
            file["source/u_mode"] = numpy.zeros((1, 6), dtype="u4")
            file["source/u_mode"].attrs["MATLAB_class"] = numpy.bytes_("string")
        self.refused("study.mat", "source.u_mode", "save a struct or a character array instead")


if __name__ == "__main__":
    unittest.main()
