# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a vibrometer in the files of laboratories: directions and the order of indices."""
import shutil
import subprocess
from dataclasses import replace

import h5py
import numpy as np
from scans import KINDS, ScanTest, some_scan

from shearwake.laboratory.measure_scan import Alignment
from shearwake.laboratory.scan_files import read_scan, write_scan


class Direction(ScanTest):
    """Velocities point into the skin, whatever the file counts as positive."""

    def test_a_negative_direction_negates_the_velocities_in_every_format(self):
        scan = some_scan()
        against = replace(scan, velocity_m_s=-scan.velocity_m_s, direction=(-0.1, -0.2, -0.97))
        for kind in KINDS:
            with self.subTest(kind=kind):
                path = self.folder / f"against{KINDS[kind]}"
                write_scan(path, against, kind)
                read = read_scan(path)
                np.testing.assert_allclose(read.velocity_m_s, scan.velocity_m_s, rtol=1e-12)
                self.assertEqual(tuple(read.direction), scan.direction)

    def test_z_out_of_the_skin_negates_z_only(self):
        scan = some_scan().along_z(z_outwards=True)
        np.testing.assert_array_equal(scan.velocity_m_s, -some_scan().velocity_m_s)
        self.assertEqual(scan.direction, (-0.1, -0.2, 0.97))

    def test_the_job_gives_the_line_of_sight_and_the_file_the_sign(self):
        scan = some_scan()
        scan.states_direction = True
        job = {"vibrometer": {"trigger_delay_s": 1.3e-3, "offset_m": [0.0, 0.0], "direction": [0.0, 0.0, 1.0]}}
        self.assertIn("is used instead of that of the file", "; ".join(Alignment(scan, job).notes))
        job["vibrometer"]["direction"] = [value / np.linalg.norm(scan.direction) for value in scan.direction]
        self.assertNotIn("instead", "; ".join(Alignment(scan, job).notes))
        scan.states_direction = False
        self.assertIn("into the skin, since the file states no direction", "; ".join(Alignment(scan, job).notes))
        self.assertAlmostEqual(np.linalg.norm(Alignment(scan, {}).direction), 1.0)

    def test_the_notes_state_defaults_of_the_job_and_how_to_use_what_the_file_states(self):
        scan = replace(some_scan(), states_direction=True)
        job = {"vibrometer": {"trigger_delay_s": 0.0, "offset_m": [0.0, 0.0], "direction": [0.0, 0.0, 1.0]}}
        notes = "; ".join(Alignment(scan, job).notes)
        self.assertIn("0 ms (the default if the job states none), is used instead of that of the file, 1.3 ms", notes)
        self.assertIn("set vibrometer.trigger_delay_ms = 1.3", notes)
        tilt, azimuth = np.degrees([np.arctan2(np.hypot(0.1, 0.2), 0.97), np.arctan2(0.2, 0.1)])
        self.assertIn(f"set vibrometer.tilt_deg = {tilt:.4g} and azimuth_deg = {azimuth:.4g}", notes)
        job["vibrometer"].update(trigger_delay_s=1e-3, direction=[0.6, 0.0, 0.8])
        self.assertNotIn("default", "; ".join(Alignment(scan, job).notes))

    def test_the_line_of_sight_is_not_attributed_to_a_file_that_states_its_negative(self):
        path = self.folder / "against.csv"
        write_scan(path, replace(some_scan(), direction=(0.0, 0.0, -1.0)), "csv")
        notes = "; ".join(Alignment(read_scan(path), {}).notes)
        self.assertIn("(direction_z = -1); they and the line of sight are negated", notes)
        self.assertIn("line of sight: (0, 0, 1), z into the skin", notes)

    def test_implausible_velocities_are_noted_with_the_units(self):
        scan = some_scan()  # velocities of about 1e-4 m/s
        scan.velocity_m_s[2] = 1e6  # a point without signal
        for factor, noted in ((1e3, False), (1e5, True)):
            notes = "; ".join(Alignment(replace(scan, velocity_m_s=factor * scan.velocity_m_s), {}).notes)
            self.assertEqual("m/s is implausible for skin: values are read in m, s and m/s" in notes, noted)


class Order(ScanTest):
    """The indices of point and time, also in scans with as many points as times."""

    def square(self):
        return some_scan(points=30)

    def test_a_matlab_file_has_the_order_that_matlab_shows(self):
        for scan in (self.square(), some_scan()):
            arrays = {"time": scan.time_s[None, :], "x": scan.x_m[:, None], "y": scan.y_m[:, None], "velocity": scan.velocity_m_s}
            five, seven = self.mat_file(arrays), self.folder / "seven.mat"
            with h5py.File(seven, "w", userblock_size=512) as file:
                for name, values in arrays.items():
                    file[name] = values.T  # as save -v7.3 of MATLAB does
                    file[name].attrs["MATLAB_class"] = np.bytes_("double")
            with open(seven, "r+b") as file:
                file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
            for path in (five, seven):
                with self.subTest(path=path.name, points=len(scan.x_m)):
                    read = read_scan(path)
                    np.testing.assert_array_equal(read.velocity_m_s, scan.velocity_m_s)
                    self.assertEqual(any("first index of velocity" in note for note in read.notes), len(scan.x_m) == 30)

    def test_vectors_as_matrices_are_those_of_h5write(self):
        scan, path = self.square(), self.folder / "h5write.h5"
        for shape, transposed in (((1, -1), True), ((-1, 1), True), ((-1,), False)):
            with h5py.File(path, "w") as file:
                for name, values in (("time", scan.time_s), ("x", scan.x_m), ("y", scan.y_m)):
                    file[name] = values.reshape(shape)
                file["velocity"] = scan.velocity_m_s.T if transposed else scan.velocity_m_s
            with self.subTest(shape=shape):
                read = read_scan(path)
                np.testing.assert_array_equal(read.velocity_m_s, scan.velocity_m_s)
                self.assertIn("as MATLAB counts" if transposed else "as h5py and h5dump count", "; ".join(read.notes))

    def test_dimension_scales_state_the_order(self):
        scan = self.square()
        path = self.folder / "scales.h5"
        for order in (("point", "time"), ("time", "point")):
            with h5py.File(path, "w") as file:
                for name, values in {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "point": np.arange(30.0)}.items():
                    file[name] = values
                file["velocity"] = scan.velocity_m_s if order[0] == "point" else scan.velocity_m_s.T
                for name, dimension in zip(order, file["velocity"].dims):
                    file[name].make_scale(name)
                    dimension.attach_scale(file[name])
            with self.subTest(order=order):
                read = read_scan(path)
                np.testing.assert_array_equal(read.velocity_m_s, scan.velocity_m_s)
                self.assertEqual(read.notes, [])

    def test_the_points_of_matrices_are_counted_as_by_matlab(self):
        scan = some_scan(points=6)
        grids = {name: getattr(scan, f"{name}_m").reshape(3, 2) for name in "xy"}
        velocity = scan.velocity_m_s.reshape(3, 2, -1).transpose(1, 0, 2).reshape(6, -1)
        read = read_scan(self.mat_file({"time": scan.time_s, **grids, "velocity": velocity}))
        order = np.argsort(read.x_m)
        np.testing.assert_array_equal(read.velocity_m_s[order], scan.velocity_m_s[np.argsort(scan.x_m)])
        self.assertIn("first index first", "; ".join(read.notes))


class RoundTrip(ScanTest):
    def test_a_written_scan_is_read_again_to_1e_12(self):
        for scan, kind in ((scan, kind) for scan in (some_scan(), some_scan(points=30)) for kind in KINDS):  # also a square one
            with self.subTest(kind=kind, points=len(scan.x_m)):
                path = self.folder / f"written{KINDS[kind]}"
                write_scan(path, scan, kind)
                read = read_scan(path)
                for name in ("time_s", "x_m", "y_m", "velocity_m_s", "quality"):
                    # ASCII type 58 has 13 digits.
                    np.testing.assert_allclose(getattr(read, name), getattr(scan, name), rtol=1e-12, atol=0.0)
                self.assertEqual(read.trigger_delay_s, scan.trigger_delay_s)
                self.assertEqual(tuple(read.direction), scan.direction)

    def test_matlab_files_of_version_5_are_read(self):
        scan = some_scan()
        arrays = {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s}
        for stored in (arrays, {"vibrometer": arrays}, {**arrays, "velocity": scan.velocity_m_s.T}):  # the last: a column per point
            np.testing.assert_array_equal(read_scan(self.mat_file(stored)).velocity_m_s, scan.velocity_m_s)

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
        self.assertEqual((int(rows), int(columns), int(times)), (5, 30, 30))  # Octave has one row per point
        self.assertEqual(float(value), scan.velocity_m_s[1, 0])
        np.testing.assert_array_equal(read_scan(again).velocity_m_s, scan.velocity_m_s)
