# SPDX-License-Identifier: BSD-3-Clause
"""Damaged files of scans."""

import numpy as np
from scans import ScanTest, some_scan

from shearwake.laboratory.scan import BadScan
from shearwake.laboratory.scan_files import read_scan, write_scan


class Damaged(ScanTest):
    def test_truncated_files_are_refused(self):
        for kind in ("uff", "uffb"):
            content = self.written(kind).read_bytes()
            for share in (0.3, 0.6, 0.9, 0.99):
                with self.subTest(kind=kind, share=share):
                    self.refused(content[:int(share * len(content))], "truncated")

    def test_data_sets_without_a_start_are_refused(self):
        for kind in ("uff", "uffb"):
            parts = self.written(kind).read_bytes().split(b"    -1\n")
            for n in range(1, len(parts)):
                with self.subTest(kind=kind, n=n):
                    content = b"    -1\n".join(parts[:n]) + b"    -5\n" + b"    -1\n".join(parts[n:])
                    with self.assertRaises(BadScan):
                        read_scan(self.file(content, ".uff"))

    def test_messages_contain_no_control_characters(self):
        good = self.written("csv").read_text()
        with self.assertRaises(BadScan) as caught:
            read_scan(self.file(good.replace("0.2", "\x1b[31m", 1).encode(), ".csv"))
        self.assertIn("?[31m", str(caught.exception))

    def test_a_claimed_size_of_10_GB_is_refused(self):
        content = self.written("uffb").read_bytes()
        size = f"{30 * 8:12d}".encode()
        self.assertIn(size, content)
        self.refused(content.replace(size, f"{10 ** 10:12d}".encode()), "claims 10000000000 bytes")
        import h5py

        path = self.folder / "large.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("time", shape=(1_250_000_000,), dtype="f8", chunks=(1024,))
            for name in ("x", "y", "velocity"):
                file[name] = np.zeros(1)
        with self.assertRaisesRegex(BadScan, "time has 1250000000 values"):
            read_scan(path)

    def test_links_to_other_files_are_named_and_not_followed(self):
        import h5py

        scan, path = some_scan(), self.folder / "links.h5"
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["v"] = file["g/velocity"] = scan.velocity_m_s
        (self.folder / "raw").write_bytes(scan.velocity_m_s.tobytes())

        def virtual(file):
            layout = h5py.VirtualLayout(scan.velocity_m_s.shape, "f8")
            layout[...] = h5py.VirtualSource("other.h5", "v", scan.velocity_m_s.shape)
            file.create_virtual_dataset("velocity", layout)

        def soft(file):
            file["away"], file["velocity"] = h5py.ExternalLink("other.h5", "/g"), h5py.SoftLink("/away/velocity")

        for make, words in (
                (lambda file: file.__setitem__("velocity", h5py.ExternalLink("other.h5", "/v")),
                 "the link /velocity leads to another file, other.h5"),
                (soft, "the link /away leads to another file, other.h5"),
                (lambda file: file.__setitem__("vibrometer", h5py.ExternalLink("other.h5", "/g")),
                 "the link /vibrometer leads to another file, other.h5"),
                (lambda file: file.create_dataset("velocity", scan.velocity_m_s.shape, "f8",
                                                  external=[("raw", 0, scan.velocity_m_s.nbytes)]),
                 "the dataset /velocity stores its values in another file"),
                (virtual, "the dataset /velocity stores its values in another file")):
            with h5py.File(path, "w") as file:
                for name, values in (("time", scan.time_s), ("x", scan.x_m), ("y", scan.y_m)):
                    file[name] = values
                make(file)
            with self.subTest(words=words), self.assertRaises(BadScan) as caught:
                read_scan(path)
            self.assertIn(words, str(caught.exception))

    def test_matlab_and_hdf5_files_with_wrong_contents_are_refused(self):
        import h5py
        import scipy.io

        scan = some_scan()
        good = {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s}
        cases = (({"velocity": scan.velocity_m_s[:3]}, "5 points and 30 times, but velocities of the shape (3, 30)"),
                 ({"velocity": np.zeros((5, 30, 2))}, "velocities of the shape"),
                 ({"velocity": 1e3 * np.ones((5, 30)) + 1.0}, "must be in m/s"),
                 ({"y": scan.y_m[:4]}, "different numbers of points"),
                 ({"time": np.full(30, np.nan)}, "time contains a value that is not a finite number"),
                 ({"x": np.full(5, np.inf)}, "x contains a value that is not a finite number"),
                 ({"velocity": np.ones((5, 30)) * 1j}, "not an array of real numbers"),
                 ({"trigger_delay": np.nan}, "trigger_delay must be one finite number"),
                 ({"time": None}, "it has no time"))
        for change, words in cases:
            arrays = {name: values for name, values in {**good, **change}.items() if values is not None}
            five, seven = self.folder / "five.mat", self.folder / "seven.h5"
            scipy.io.savemat(five, arrays)
            with h5py.File(seven, "w") as file:
                for name, values in arrays.items():
                    file[name] = values
            for path in (five, seven):
                with self.subTest(words=words, path=path.name), self.assertRaises(BadScan) as caught:
                    read_scan(path)
                self.assertIn(words, str(caught.exception))
        content = five.read_bytes()
        for share in (0.3, 0.6, 0.9):
            with self.subTest(share=share):
                self.refused(content[:int(share * len(content))], "cannot be read as a MATLAB file", ".mat")
        size = (30 * 8).to_bytes(4, "little")
        scipy.io.savemat(five, good)
        claimed = five.read_bytes().replace(size, (4 * 10 ** 9).to_bytes(4, "little"))
        self.refused(claimed, "cannot be read as a MATLAB file", ".mat")

    def test_csv_with_wrong_fields_is_refused(self):
        good = self.written("csv").read_text()
        for text, words in ((good.replace("x_m", "x_mm", 1), "the first line must begin with"),
                            (good.rstrip() + ",1\n", "every line must have 33 fields"),
                            (good.replace("0.2", "zero", 1), "not a number"), (good.rstrip() + "1_0\n", "not a number"),
                            (good.replace(",0.0,", ",nan,", 1), "time contains a value that is not a finite number"),
                            ("", "the first line must begin with")):
            with self.subTest(words=words):
                self.refused(text, words, ".csv")

    def test_values_that_cannot_be_velocities_are_refused(self):
        scan = some_scan()
        for change, words in ((lambda s: s.velocity_m_s.__setitem__((0, 0), np.inf), "infinite"),
                              (lambda s: s.velocity_m_s.__setitem__((0, 0), 1e5), "must be in m/s"),
                              (lambda s: s.x_m.__setitem__(0, 300.0), "must be in metres"),
                              (lambda s: s.time_s.__setitem__(3, s.time_s[2]), "uniformly spaced")):
            scan = some_scan()
            change(scan)
            path = self.folder / "changed.mat"
            write_scan(path, scan, "mat")
            with self.subTest(words=words), self.assertRaisesRegex(BadScan, words):
                read_scan(path)
