# SPDX-License-Identifier: BSD-3-Clause
"""One case through all commands that compute cases gives the same arrays, bit by bit."""
import h5py
import numpy

from program import ProgramTest
from serving import Server, one
from shearwake import Engine

JOB = one({"afferents": {"where": "grid", "extent_mm": [16.0, 8.0], "pitch_mm": 8.0}})


class Compute(ProgramTest):
    def stored(self, command):
        """All arrays of the case that a command stores, by their paths."""
        out = self.folder / command
        self.shearwake(command, self.write_job(JOB), "--out", out)
        arrays = {}
        with h5py.File(next(out.rglob("cases/*.h5"))) as file:
            file.visititems(lambda name, item: arrays.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        return arrays

    def assert_identical(self, found, expected):
        self.assertEqual(found.dtype.kind, expected.dtype.kind)
        self.assertTrue(numpy.array_equal(found, expected, equal_nan=expected.dtype.kind == "f"))

    def test_run_evaluate_serve_and_the_engine_of_python_compute_the_same_arrays(self):
        run = self.stored("run")
        self.assertGreater(len(run), 60)
        evaluated = self.stored("evaluate")
        self.assertEqual(set(evaluated), set(run))
        with Server() as server:
            message, served = server.compute(JOB)
        with Engine() as engine:
            solved = engine.evaluate(JOB)
        for name, values in run.items():
            with self.subTest(array=name):
                self.assert_identical(evaluated[name], values)
                if name == "surface/u_z":  # sent in single precision
                    self.assert_identical(served["u_z"], values[:, 0].astype(numpy.float32))
                elif name.startswith("surface/"):  # coordinates, which are not sent
                    continue
                elif values.shape:
                    self.assert_identical(served[name], values)
                    self.assert_identical(solved.arrays[name], values)
                elif numpy.isfinite(values):
                    self.assertEqual(message["columns"][name]["value"], values)
                    self.assertEqual(solved.value(name), values)
