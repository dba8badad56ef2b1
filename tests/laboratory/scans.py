# SPDX-License-Identifier: BSD-3-Clause
"""Scans for the tests of their files."""
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import scipy.io

from shearwake.laboratory.scan import BadScan, Scan
from shearwake.laboratory.scan_files import read_scan, write_scan

KINDS = {"uff": ".uff", "uffb": ".uff", "csv": ".csv", "mat": ".mat"}


def some_scan(points=5, samples=30):
    rng = np.random.default_rng(7)
    velocity = rng.normal(size=(points, samples)) * 1e-4
    velocity[2] = np.nan
    quality = np.linspace(0.2, 1.0, points)
    quality[2] = 0.0
    return Scan(np.arange(samples) / 51200.0, rng.normal(size=points) * 1e-2, rng.normal(size=points) * 1e-2, velocity,
                quality, 1.3e-3, (0.1, 0.2, 0.97))


class ScanTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def file(self, content, suffix=".uff"):
        path = self.folder / f"scan{suffix}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def hdf5_file(self, arrays, name="seven.h5"):
        with h5py.File(self.folder / name, "w") as file:
            for key, values in arrays.items():
                file[key] = values
        return self.folder / name

    def mat_file(self, arrays, name="five.mat"):
        scipy.io.savemat(self.folder / name, arrays)
        return self.folder / name

    def written(self, kind):
        path = self.folder / f"written{KINDS[kind]}"
        write_scan(path, some_scan(), kind)
        return path

    def unread(self, path, words):
        with self.assertRaisesRegex(BadScan, words):
            read_scan(path)

    def refused(self, content, words, suffix=".uff"):
        with self.assertRaises(BadScan) as caught:
            read_scan(self.file(content, suffix))
        self.assertIn(words, str(caught.exception))
