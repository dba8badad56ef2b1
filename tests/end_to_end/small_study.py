# SPDX-License-Identifier: BSD-3-Clause
"""A small study of k-Wave and the import of its files."""
import numpy
import scipy.io

from kwave import import_kwave
from program import ProgramTest

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
        "sensor": {"mask": numpy.array([[3.0, 4, 2, 5, 4, 2]]).T, "record": ["p", "u"]},
        "options": {"PMLInside": True, "PMLSize": numpy.array([[2.0, 2, 2]])},
    }


def cell(words):
    cells = numpy.empty((1, len(words)), dtype=object)
    cells[0, :] = words
    return cells


class FilesTest(ProgramTest):
    def imported(self, name, expect=0):
        code, output = import_kwave(self.folder, name, "--out", "study")
        self.assertEqual(code, expect, output)
        return output

    def refused(self, name, *words, expect=3):
        self.contains(self.imported(name, expect=expect), *words)

    def changed(self, variables=(), **parts):
        """Writes study.mat with changed fields and other variables, without those that are None, and returns the path of the import."""
        structures = study()
        structures["sensor"]["record"] = cell(["p", "u"])
        for name, fields in parts.items():
            structures[name] = {field: value for field, value in {**structures[name], **fields}.items() if value is not None}
        structures.update(variables)
        scipy.io.savemat(self.folder / "study.mat", {name: value for name, value in structures.items() if value is not None})
        return self.folder / "study.h5"
