# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a vibrometer: written and read again, files of other programs, and hostile files."""
import os
import random
import shutil
import signal
import subprocess
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np

from shearwake.laboratory.measure_scan import Alignment
from shearwake.laboratory.scan import BadScan, Scan, half_unit, plain_step_s
from shearwake.laboratory.child import in_child
from shearwake.laboratory.scan_files import read_scan, write_scan
from shearwake.laboratory.units import check_unit
from shearwake.laboratory.scan_motion import one_period

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


class Names(ScanTest):
    """Settings and units that a file states are used, or refused."""

    def arrays(self):
        scan = some_scan()
        return {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s}

    def test_a_delay_is_read_in_its_unit_and_a_misspelt_one_is_refused(self):
        lines = [line for line in self.written("csv").read_text().splitlines(True) if "delay" not in line]
        for remark, delay_s in (("trigger_delay_s: 0.005", 5e-3), ("trigger_delay_ms = 5", 5e-3), ("trigger_delay_us = +250", 2.5e-4),
                                ("measured in 2024: gel", 0.0), ("temperature_C = 21", 0.0)):
            with self.subTest(remark=remark):
                scan = read_scan(self.file(f"# {remark}\n" + "".join(lines), ".csv"))
                self.assertAlmostEqual(scan.trigger_delay_s, delay_s, places=12)
                self.assertEqual(any("without effect" in note for note in scan.notes), delay_s == 0.0)
        for remark in ("triger_delay_s = 0.005", "trigger_delay_min = 5", "delay_ms = 5", "direction = -1", "directionz: -1",
                       "trigger_delay_s = 5 ms", "trigger_delay_s = 1\n# trigger_delay_ms = 2", "trigger_delay_ms 5", "direction_z\t-1"):
            with self.subTest(remark=remark):
                self.refused(f"# {remark}\n" + "".join(lines), "trigger_delay" if "delay" in remark else "direction_z", ".csv")

    def test_a_byte_order_mark_is_passed_over(self):
        for kind in ("csv", "uff"):
            with self.subTest(kind=kind):
                scan = read_scan(self.file(b"\xef\xbb\xbf" + self.written(kind).read_bytes(), KINDS[kind]))
                np.testing.assert_allclose(scan.x_m, some_scan().x_m, rtol=1e-12)
                self.assertFalse(any("assumed" in note for note in scan.notes), scan.notes)  # data set 164 comes first

    def test_names_and_units_in_matlab_and_hdf5_files(self):
        import h5py
        import scipy.io

        five, seven = self.folder / "five.mat", self.folder / "seven.h5"
        for name, words in (("trigger_delay_ms", ""), ("triggerdelay", "did you mean trigger_delay"), ("direction", "direction_z")):
            scipy.io.savemat(five, {**self.arrays(), name: 5.0})
            with h5py.File(seven, "w") as file:
                for key, values in {**self.arrays(), name: 5.0}.items():
                    file[key] = values
            for path in (five, seven):
                with self.subTest(name=name, path=path.name):
                    if words:
                        with self.assertRaisesRegex(BadScan, words):
                            read_scan(path)
                    else:
                        self.assertAlmostEqual(read_scan(path).trigger_delay_s, 5e-3)
        for scale, length, speed, time in ((1e3, "mm", "mm/s", "ms"), (1e6, "\u00b5m", "um/s", "us"), (1.0, "metres", "SI", "s")):
            with h5py.File(seven, "w") as file:
                for (key, values), unit in zip(self.arrays().items(), (time, length, length, speed)):
                    file[key] = scale * values
                    file[key].attrs["units"] = unit
            read = read_scan(seven)
            with self.subTest(length=length):
                np.testing.assert_allclose(read.velocity_m_s, some_scan().velocity_m_s, rtol=1e-12)
                np.testing.assert_allclose(read.x_m, some_scan().x_m, rtol=1e-12)
                np.testing.assert_allclose(read.rate_Hz, 51200.0, rtol=1e-12)

    def test_spellings_of_units_are_read_and_other_units_are_refused(self):
        import h5py

        def scan(unit, name="velocity", attribute="units"):
            with h5py.File(self.folder / "units.h5", "w") as file:
                for key, values in {**self.arrays(), "trigger_delay_ms": 5.0}.items():
                    file[key] = values
                file[name].attrs[attribute] = unit
            return read_scan(self.folder / "units.h5")

        for unit, factor in (("mm s-1", 1e-3), ("mm s^-1", 1e-3), ("mm\u00b7s\u207b\u00b9", 1e-3), ("Millimetres per second", 1e-3),
                             ("micrometer/sec", 1e-6), ("microns/s", 1e-6), ("[m/s]", 1.0), ("meters/second", 1.0), ("", 1.0)):
            for attribute in ("units", "Unit"):
                with self.subTest(unit=unit, attribute=attribute):
                    np.testing.assert_allclose(scan(unit, attribute=attribute).velocity_m_s, factor * some_scan().velocity_m_s, rtol=1e-12)
        for name, unit in (("velocity", "in/s"), ("velocity", "V"), ("velocity", "mm"), ("x", "inch"), ("time", "min"),
                           ("trigger_delay_ms", "s")):
            with self.subTest(name=name, unit=unit), self.assertRaisesRegex(BadScan, f"the unit of {name} is \"{unit}\""):
                scan(unit, name)
        self.assertAlmostEqual(scan("ms", "trigger_delay_ms").trigger_delay_s, 5e-3)
        self.assertAlmostEqual(scan("milliseconds", "time").rate_Hz, 51.2e6, places=3)

    def test_variables_without_effect_are_noted(self):
        import scipy.io

        path = self.folder / "more.mat"
        scipy.io.savemat(path, {**self.arrays(), "velocity_unit": "m/s", "dir_z": -1.0})
        self.assertIn("without effect: velocity_unit, dir_z", read_scan(path).notes)

    def test_stated_units_are_those_of_si_or_refused(self):
        for text in ("m, s, m/s", "SI (m, m/s, s)", "PSV-400/A", "Metres per second", "velocity in m/s", b"m s^-1", 1.0):
            check_unit("units", text)
        for text in ("inch", "in", "in/s", "km", "ft", "mm, s, mm/s", "m, ms", "millimetres per second", b"\xc2\xb5m/s"):
            with self.subTest(text=text), self.assertRaises(BadScan):
                check_unit("x_units", text)
        check_unit("without", "mm")  # not a unit

    def test_a_unit_that_would_be_ignored_is_refused(self):
        import h5py
        import scipy.io

        for name, unit in (("velocity_unit", "mm/s"), ("Units", "mm"), ("unit", "\u00b5m/s")):
            with self.subTest(name=name):
                path = self.folder / "units.mat"
                scipy.io.savemat(path, {**self.arrays(), name: unit})
                with self.assertRaisesRegex(BadScan, f"{name} is \"{unit}\", but values are read in m, s and m/s"):
                    read_scan(path)
                with h5py.File(self.folder / "units.h5", "w") as file:
                    for key, value in {**self.arrays(), name: unit}.items():
                        file[key] = value
                with self.assertRaisesRegex(BadScan, "but values are read in m, s and m/s"):
                    read_scan(self.folder / "units.h5")
        lines = self.written("csv").read_text()
        for remark in ("velocity unit: mm/s", "units = cm", "velocity_units mm/s"):
            self.refused(f"# {remark}\n{lines}", "values are read in m, s and m/s", ".csv")
        for remark in ("velocity unit: m/s", "community gel, 60 mm", "unit 5 of the laboratory", "range: 100 mm/s"):
            self.assertTrue(any("without effect" in note for note in read_scan(self.file(f"# {remark}\n{lines}", ".csv")).notes))

    def test_coordinates_in_mm_times_in_ms_and_velocities_along_the_surface_are_refused(self):
        scan = some_scan()
        for changes, reason in (({"x_m": 1e3 * scan.x_m}, "coordinates must be in metres"),
                                ({"time_s": 1e3 * scan.time_s}, "times must be in seconds"),
                                ({"direction": (1.0, 0.0, 0.0)}, "nearly parallel to the surface")):
            with self.subTest(reason=reason):
                path = self.folder / "wrong.csv"
                write_scan(path, replace(scan, **changes), "csv")
                with self.assertRaisesRegex(BadScan, reason):
                    read_scan(path)


class Order(ScanTest):
    """The indices of point and time, also in scans with as many points as times."""

    def square(self):
        return some_scan(points=30)

    def test_a_square_scan_is_read_again_from_every_format(self):
        scan = self.square()
        for kind in KINDS:
            with self.subTest(kind=kind):
                path = self.folder / f"square{KINDS[kind]}"
                write_scan(path, scan, kind)
                np.testing.assert_allclose(read_scan(path).velocity_m_s, scan.velocity_m_s, rtol=1e-12)

    def test_a_matlab_file_has_the_order_that_matlab_shows(self):
        import h5py
        import scipy.io

        for scan in (self.square(), some_scan()):
            arrays = {"time": scan.time_s[None, :], "x": scan.x_m[:, None], "y": scan.y_m[:, None], "velocity": scan.velocity_m_s}
            five, seven = self.folder / "five.mat", self.folder / "seven.mat"
            scipy.io.savemat(five, arrays)
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
        import h5py

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
        import h5py

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
        import scipy.io

        scan = some_scan(points=6)
        path = self.folder / "grid.mat"
        grids = {name: getattr(scan, f"{name}_m").reshape(3, 2) for name in "xy"}
        velocity = scan.velocity_m_s.reshape(3, 2, -1).transpose(1, 0, 2).reshape(6, -1)
        scipy.io.savemat(path, {"time": scan.time_s, **grids, "velocity": velocity})
        read = read_scan(path)
        order = np.argsort(read.x_m)
        np.testing.assert_array_equal(read.velocity_m_s[order], scan.velocity_m_s[np.argsort(scan.x_m)])
        self.assertIn("first index first", "; ".join(read.notes))


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
        scipy.io.savemat(path, {**arrays, "velocity": scan.velocity_m_s.T})  # one column per point
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
        self.assertEqual((int(rows), int(columns), int(times)), (5, 30, 30))  # Octave has one row per point
        self.assertEqual(float(value), scan.velocity_m_s[1, 0])
        np.testing.assert_array_equal(read_scan(again).velocity_m_s, scan.velocity_m_s)


class OtherPrograms(ScanTest):
    """Files as the documentation of the format describes them, without the additions of this program."""

    def text(self, unit="m/s", quantity=11, data=2, count=4, spacing=1, values=None, kind=1, direction=3, exponents=(0, 0, 0),
             time_unit="s", divisor=0, units=""):
        values = values if values is not None else "".join(f"{v:13.5E}" for v in (0.0, 1e-3, -2e-3, 5e-4)) + "\n"
        head = "".join((
            "NONE\nNONE\n01-JAN-20 12:00:00\nNONE\nNONE\n",
            f"{kind:5d}{1:10d}{0:5d}{0:10d} {'NONE':<10s}{9:10d}{direction:4d} {'NONE':<10s}{0:10d}{0:4d}\n",
            f"{data:10d}{count:10d}{spacing:10d}{0:13.5E}{1e-4:13.5E}{0:13.5E}\n",
            f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':<20s} {time_unit:<20s}\n",
            f"{quantity:10d}" + "".join(f"{n:5d}" for n in exponents) + f" {'Velocity':<20s} {unit:<20s}\n",
            f"{divisor:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'NONE':<20s}\n",
            f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'NONE':<20s}\n"))
        nodes = f"    -1\n    15\n{9:10d}{0:10d}{0:10d}{0:10d}{0.01:13.5E}{-0.02:13.5E}{0:13.5E}\n    -1\n"
        return units + nodes + "    -1\n    58\n" + head + values + "    -1\n"

    def system(self, code, per_metre=None):
        """Data set 164, with or without its record of factors."""
        factors = "" if per_metre is None else f"{per_metre:25.17E}{1.0:25.17E}{1.0:25.17E}\n{273.15:25.17E}\n".replace("E", "D")
        return f"    -1\n   164\n{code:10d}{'units':<20s}{2:10d}\n{factors}    -1\n"

    def test_the_response_direction_gives_the_sign(self):
        values = np.array([0.0, 1e-3, -2e-3, 5e-4])
        for direction, sign, note in ((3, 1.0, "response direction +z"), (-3, -1.0, "response direction -z"), (0, 1.0, "")):
            with self.subTest(direction=direction):
                scan = read_scan(self.file(self.text(direction=direction)))
                np.testing.assert_allclose(scan.velocity_m_s[0], sign * values, rtol=1e-6)
                self.assertEqual((tuple(scan.direction), scan.states_direction), ((0.0, 0.0, 1.0), direction != 0))
                self.assertIn(note, "; ".join(scan.notes))
        for direction, words in ((1, "velocities along x"), (-2, "velocities along y"), (4, "rotations"), (-6, "rotations"), (7, "unknown")):
            with self.subTest(direction=direction):
                self.refused(self.text(direction=direction), words)

    def test_a_sign_in_record_6_applies_also_to_files_of_this_program(self):
        content = self.written("uff").read_text()
        changed = content.replace(f"{3:4d} {'NONE':<10s}{0:10d}{0:4d}", f"{-3:4d} {'NONE':<10s}{0:10d}{0:4d}")
        self.assertNotEqual(changed, content)
        scan = read_scan(self.file(changed))
        np.testing.assert_allclose(scan.velocity_m_s, -some_scan().velocity_m_s, rtol=1e-12)
        self.assertIn("contradicts the direction", "; ".join(scan.notes))

    def test_velocities_without_a_unit_are_in_that_of_data_set_164(self):
        values = np.array([0.0, 1e-3, -2e-3, 5e-4])
        for unit, units, factor, note in (("", "", 1.0, "velocities in m/s (assumed"),
                                          ("NONE", self.system(5, 1e3), 1e-3, "velocities in mm/s (data set 164)"),
                                          ("", self.system(5), 1e-3, "velocities in mm/s (data set 164)"),
                                          ("", self.system(9, 1e6), 1e-6, "velocities in um/s (data set 164)"),
                                          ("m/s", self.system(5, 1e3), 1.0, "velocities in m/s (label of record 9, unlike data set 164"),
                                          ("MM/SEC", self.system(1, 1.0), 1e-3, "velocities in mm/s (label of record 9, unlike"),
                                          ("\u00b5m/s", "", 1e-6, "velocities in um/s")):
            with self.subTest(unit=unit, note=note):
                scan = read_scan(self.file(self.text(unit=unit, units=units)))
                np.testing.assert_allclose(scan.velocity_m_s[0], factor * values, rtol=1e-6)
                self.assertIn(note, "; ".join(scan.notes))
        scan = read_scan(self.file(self.text(units=self.system(8))))
        self.assertAlmostEqual(scan.x_m[0], 1e-5)  # .01 mm
        self.refused(self.text(units=self.system(9)), "contains no factor of the unit of length")
        self.refused(self.text(units=self.system(5, 1.0)), "its code 5 means lengths in mm, its factor 1 lengths in m")
        self.refused(self.text(units=self.system(1, 1.0) + self.system(5, 1e3)), "different units of length, m and mm")

    def test_exponents_denominators_and_units_of_the_time_are_read(self):
        self.refused(self.text(unit="", exponents=(-2, 1, 0)), "the dimension length^-2 force^1 temperature^0")
        self.refused(self.text(quantity=0, unit="", exponents=(0, 1, 0)), "a velocity has length^1")
        self.assertIn("contradicts the dimension", "; ".join(read_scan(self.file(self.text(exponents=(2, 0, 0)))).notes))
        self.refused(self.text(divisor=13), "divided by another quantity")
        self.refused(self.text(time_unit="min"), "the unit of the time is \"min\"")
        for unit, rate_Hz in (("ms", 1e7), ("SEC", 1e4), ("NONE", 1e4), ("us", 1e10)):
            with self.subTest(unit=unit):
                self.assertAlmostEqual(read_scan(self.file(self.text(time_unit=unit))).rate_Hz / rate_Hz, 1.0, places=9)
        read_scan(self.file(self.text(exponents=(1, 0, 0), unit="")))
        read_scan(self.file(self.text(quantity=1)))  # a general quantity in m/s
        self.refused(self.text(quantity=1, unit=""), "the ordinate is of type 1")

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


class Rounding(OtherPrograms):
    """Times with six digits have the sampling rate from which they are rounded."""

    def test_the_plain_rate_is_found(self):
        for rate_Hz, found_Hz in ((51200.0, 51200.0), (44100.0, 44100.0), (96e3, 96e3), (32768.0, 32768.0), (1e8 / 2048, 1e8 / 2048),
                                  (1234.56789, 1234.57)):
            printed = f"{1.0 / rate_Hz:13.5E}"
            with self.subTest(rate_Hz=rate_Hz):
                # Rounding of 1 / (1 / f); six digits of an arbitrary rate remain six digits.
                self.assertAlmostEqual(plain_step_s(float(printed), half_unit(printed)) * found_Hz, 1.0,
                                       places=14 if found_Hz == rate_Hz else 5)

    def test_a_scan_of_whole_periods_is_accepted(self):
        rate_Hz, count = 51200.0, 1024
        tone = "".join(f"{np.sin(2 * np.pi * 200 * n / rate_Hz):13.5E}" + ("\n" if n % 6 == 5 else "") for n in range(count)) + "\n"
        text = self.text(count=count, values=tone).replace(f"{1e-4:13.5E}", f"{1.0 / rate_Hz:13.5E}")
        scan = read_scan(self.file(text))
        self.assertAlmostEqual(scan.rate_Hz / rate_Hz, 1.0, places=12)
        self.assertIn("agrees with the rounded time step", "; ".join(scan.notes))
        period, periods = one_period(scan, 5e-3)  # 256 samples
        self.assertEqual((period.shape, periods), ((1, 256), 4))
        # A period of 300 samples at a rate without a plain value.
        other = read_scan(self.file(text.replace(f"{1.0 / rate_Hz:13.5E}", f"{1.0 / 51987.6543:13.5E}")))
        period_s = 300 / 51987.6543
        one_period(other.with_rate_of(period_s), period_s)
        with self.assertRaisesRegex(BadScan, "is not a whole number of samples"):
            one_period(scan.with_rate_of(5.001e-3), 5.001e-3)

    def test_printed_times_of_csv_are_rounded_alike(self):
        rate_Hz, points, samples = 51200.0, 3, 2048
        rows = ["x_m,y_m,quality," + ",".join(f"{n / rate_Hz:.6g}" for n in range(samples))]
        rows += [f"{0.001 * p},0,1," + ",".join(["0.5"] * samples) for p in range(points)]
        scan = read_scan(self.file("\n".join(rows), ".csv"))
        self.assertAlmostEqual(scan.rate_Hz / rate_Hz, 1.0, places=12)
        self.assertIn("agrees with the rounded times", "; ".join(scan.notes))
        rows[0] = rows[0].replace(f",{100 / rate_Hz:.6g},", f",{100.5 / rate_Hz:.6g},")
        self.refused("\n".join(rows), "not uniformly spaced", ".csv")


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

    def test_files_that_grow_by_decompression_are_refused(self):
        import h5py
        import scipy.io

        n = 10_000_000
        path = self.folder / "bomb.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("time", (n,), "f8", chunks=(1000,), compression="gzip")
            file.create_dataset("velocity", data=np.zeros((1, n)), chunks=(1, n // 10), compression="gzip")
            file["x"] = file["y"] = np.zeros(1)
        with self.assertRaisesRegex(BadScan, "10000000 values .80 MB. but stores 0 kB; at most 64 MB, or 100 times"):
            read_scan(path)
        path = self.folder / "bomb.mat"
        scipy.io.savemat(path, {"time": np.zeros(4 * n), "velocity": np.zeros((1, 1))}, do_compression=True)
        self.assertLess(path.stat().st_size, 1_000_000)
        with self.assertRaisesRegex(BadScan, "needs more memory than the limit"):
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
