# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a vibrometer: written and read again, files of other programs, and hostile files."""
import os
import random
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from shearwake.laboratory.scan import BadScan, Scan
from shearwake.laboratory.scan_files import in_child, read_scan, write_scan

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

    def written(self, kind):
        path = self.folder / f"written{KINDS[kind]}"
        write_scan(path, some_scan(), kind)
        return path

    def refused(self, content, words, suffix=".uff"):
        with self.assertRaises(BadScan) as caught:
            read_scan(self.file(content, suffix))
        self.assertIn(words, str(caught.exception))


class RoundTrip(ScanTest):
    def test_a_written_scan_is_read_again_to_1e_12(self):
        scan = some_scan()
        for kind in KINDS:
            with self.subTest(kind=kind):
                read = read_scan(self.written(kind))
                for name in ("time_s", "x_m", "y_m", "velocity_m_s", "quality"):
                    # ASCII type 58 has 13 digits.
                    np.testing.assert_allclose(getattr(read, name), getattr(scan, name), rtol=1e-12, atol=0.0)
                self.assertEqual(read.trigger_delay_s, scan.trigger_delay_s)
                self.assertEqual(tuple(read.direction), scan.direction)

    def test_matlab_files_of_version_5_are_read(self):
        import scipy.io

        scan = some_scan()
        path = self.folder / "five.mat"
        arrays = {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s}
        scipy.io.savemat(path, arrays)
        np.testing.assert_array_equal(read_scan(path).velocity_m_s, scan.velocity_m_s)
        scipy.io.savemat(path, {"vibrometer": arrays})
        np.testing.assert_array_equal(read_scan(path).velocity_m_s, scan.velocity_m_s)
        scipy.io.savemat(path, {**arrays, "velocity": scan.velocity_m_s.T})  # one column per point, as MATLAB loads ours
        np.testing.assert_array_equal(read_scan(path).velocity_m_s, scan.velocity_m_s)

    def test_octave_reads_the_hdf5_file_and_its_own_is_read(self):
        if not shutil.which("octave-cli"):
            self.skipTest("octave-cli is not installed")
        scan, path = some_scan(), self.written("mat")
        again = self.folder / "again.mat"
        script = (f"load('{path}'); printf('%d %d %d %.17g\\n', size(velocity), numel(time), velocity(2, 1)); "
                  f"save('-v7', '{again}', 'time', 'x', 'y', 'velocity')")
        done = subprocess.run(["octave-cli", "--quiet", "--no-init-file", "--eval", script], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows, columns, times, value = done.stdout.split()
        self.assertEqual((int(rows), int(columns), int(times)), (30, 5, 30))  # Octave has one column per point
        self.assertEqual(float(value), scan.velocity_m_s[0, 1])
        np.testing.assert_array_equal(read_scan(again).velocity_m_s, scan.velocity_m_s)


class OtherPrograms(ScanTest):
    """Files as the documentation of the format describes them, without the additions of this program."""

    def text(self, unit="m/s", quantity=11, data=2, count=4, spacing=1, values=None, kind=1):
        values = values if values is not None else "".join(f"{v:13.5E}" for v in (0.0, 1e-3, -2e-3, 5e-4)) + "\n"
        head = "".join((
            "NONE\nNONE\n01-JAN-20 12:00:00\nNONE\nNONE\n",
            f"{kind:5d}{1:10d}{0:5d}{0:10d} {'NONE':<10s}{9:10d}{3:4d} {'NONE':<10s}{0:10d}{0:4d}\n",
            f"{data:10d}{count:10d}{spacing:10d}{0:13.5E}{1e-4:13.5E}{0:13.5E}\n",
            f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':<20s} {'s':<20s}\n",
            f"{quantity:10d}{0:5d}{0:5d}{0:5d} {'Velocity':<20s} {unit:<20s}\n",
            f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'NONE':<20s}\n" * 2))
        nodes = f"    -1\n    15\n{9:10d}{0:10d}{0:10d}{0:10d}{0.01:13.5E}{-0.02:13.5E}{0:13.5E}\n    -1\n"
        return nodes + "    -1\n    58\n" + head + values + "    -1\n"

    def test_single_precision_and_nodes_of_type_15_are_read(self):
        scan = read_scan(self.file(self.text()))
        np.testing.assert_allclose(scan.velocity_m_s, [[0.0, 1e-3, -2e-3, 5e-4]], rtol=1e-6)
        self.assertEqual((scan.x_m[0], scan.y_m[0]), (0.01, -0.02))
        self.assertAlmostEqual(scan.rate_Hz, 1e4, places=6)
        self.assertEqual(scan.quality[0], 1.0)

    def binary(self, order, single):
        """The same data set in binary form. `order`: 1 for little and 2 for big endian."""
        text = self.text(data=2 if single else 4, values="")
        nodes, head = text.split("    58\n")
        data = np.array((0.0, 1e-3, -2e-3, 5e-4), {1: "<", 2: ">"}[order] + ("f4" if single else "f8")).tobytes()
        first = f"    58b{order:6d}{2:6d}{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n"
        return (nodes + first + head[:-len("    -1\n")]).encode() + data + b"\n    -1\n"

    def test_binary_data_of_both_byte_orders_and_precisions_are_read(self):
        for order in (1, 2):
            for single in (False, True):
                with self.subTest(order=order, single=single):
                    scan = read_scan(self.file(self.binary(order, single)))
                    np.testing.assert_allclose(scan.velocity_m_s, [[0.0, 1e-3, -2e-3, 5e-4]], rtol=1e-7 if single else 0.0)
        good = self.binary(2, False)
        for text, words in ((good.replace(f"{2:6d}{2:6d}".encode(), f"{2:6d}{1:6d}".encode(), 1), "not in IEEE format"),
                            (good.replace(f"{32:12d}".encode(), f"{24:12d}".encode(), 1), "a data set claims 4 values"),
                            (good.replace(f"{11:12d}".encode(), f"{12:12d}".encode(), 1), "12 text records"),
                            (self.binary(2, False).replace(b"\n    -1\n", b"", 2)[:-7], "truncated")):
            with self.subTest(words=words):
                self.refused(text, words)

    def test_millimetres_per_second_are_converted(self):
        np.testing.assert_allclose(read_scan(self.file(self.text(unit="mm/s"))).velocity_m_s[0, 1], 1e-6)

    def test_other_contents_are_refused_with_the_reason(self):
        for text, words in ((self.text(unit="in/s"), "the unit of the velocity is \"in/s\""),
                            (self.text(quantity=8), "the ordinate is a displacement"),
                            (self.text(quantity=12), "the ordinate is an acceleration"),
                            (self.text(kind=4), "functions of type 4"),
                            (self.text(data=5), "data are of type 5"),
                            (self.text(spacing=0), "not uniformly spaced"),
                            (self.text(count=5), "claims 5 values, but contains 4"),
                            (self.text(count=3), "claims 3 values, but contains more"),
                            (self.text(count=1_250_000_000), "claims 1250000000 values"),
                            (self.text(count=400_000_000), "claims 400000000 values"),
                            (self.text(values="          NaN\n" * 4), "not a finite number"),
                            (self.text(values="    what\n"), "a value is not a number"),
                            (self.text().replace("    15\n", "    16\n"), "node 9 has no coordinates")):
            with self.subTest(words=words):
                self.refused(text, words)


class Hostile(ScanTest):
    def test_truncated_files_are_refused(self):
        for kind in ("uff", "uffb"):
            content = self.written(kind).read_bytes()
            for share in (0.3, 0.6, 0.9, 0.99):
                with self.subTest(kind=kind, share=share):
                    self.refused(content[:int(share * len(content))], "truncated")

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

    def test_a_file_that_crashes_its_library_is_refused(self):
        def crash(_):
            os.kill(os.getpid(), signal.SIGSEGV)

        def exhaust(_):
            raise MemoryError

        for read in (crash, exhaust):
            with self.subTest(read=read.__name__), self.assertRaisesRegex(BadScan, "the file is damaged"):
                in_child(read, self.folder)

    def test_csv_with_wrong_fields_is_refused(self):
        good = self.written("csv").read_text()
        for text, words in ((good.replace("x_m", "x_mm", 1), "the first line must begin with"),
                            (good.rstrip() + ",1\n", "every line must have 33 fields"),
                            (good.replace("0.2", "zero", 1), "not a number"),
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

    def test_changed_bytes_give_a_scan_or_a_reason(self):
        rng = random.Random(3)
        for kind, suffix in KINDS.items():
            content = self.written(kind).read_bytes()
            for n in range(150):
                changed = bytearray(content)
                for _ in range(rng.choice((1, 3, 20))):
                    at = rng.randrange(len(changed))
                    what = rng.random()
                    if what < 0.5:
                        changed[at] = rng.randrange(256)
                    elif what < 0.75:
                        del changed[at:at + rng.randrange(1, 40)]
                    else:
                        changed[at:at] = changed[:rng.randrange(1, 40)]
                with self.subTest(kind=kind, n=n):
                    try:
                        read_scan(self.file(bytes(changed), suffix))
                    except BadScan as error:
                        self.assertTrue(str(error))


if __name__ == "__main__":
    unittest.main()
