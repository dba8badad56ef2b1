# SPDX-License-Identifier: BSD-3-Clause
"""Names, settings, units and plausibility of scans in the files of laboratories."""
from dataclasses import replace
from unittest import mock

import h5py
import numpy as np
from scans import KINDS, ScanTest, some_scan

from shearwake.laboratory.scan import BadScan
from shearwake.laboratory.scan_files import read_scan, write_scan
from shearwake.laboratory.units import check_unit


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

    def test_a_byte_order_mark_is_skipped(self):
        for kind in ("csv", "uff"):
            with self.subTest(kind=kind):
                scan = read_scan(self.file(b"\xef\xbb\xbf" + self.written(kind).read_bytes(), KINDS[kind]))
                np.testing.assert_allclose(scan.x_m, some_scan().x_m, rtol=1e-12)
                self.assertFalse(any("assumed" in note for note in scan.notes), scan.notes)  # data set 164 comes first

    def test_semicolons_and_tabs_separate_fields_and_decimal_commas_are_refused(self):
        text = self.written("csv").read_text()
        padded = "".join(line.rstrip() + 30 * "," + "\n" for line in text.splitlines())  # all lines are of one length in a spreadsheet
        for converted in (text.replace(",", ";"), "\ufeff" + text.replace(",", ";").replace("\n", "\r\n"), text.replace(",", "\t"),
                          padded.replace(",", ";"), padded + 60 * "," + "\n", "sep=;\n" + text.replace(",", ";"),
                          '"# x, y and velocities"\n' + text):
            scan = read_scan(self.file(converted, ".csv"))
            self.assertEqual(scan.trigger_delay_s, some_scan().trigger_delay_s)
            np.testing.assert_array_equal(scan.velocity_m_s, read_scan(self.written("csv")).velocity_m_s)
        lines = text[text.index("x_m"):]
        for comma in (lines.replace(",", ";").replace(".", ","), lines.replace(".", ","), lines.replace(",", "\t").replace(".", ","),
                      "# trigger_delay_ms = 0,5;;\n" + lines.replace(",", ";")):
            self.refused(comma, "write decimal numbers with a point", ".csv")

    def test_names_and_units_in_matlab_and_hdf5_files(self):
        for name, words in (("trigger_delay_ms", ""), ("triggerdelay", "did you mean trigger_delay"), ("direction", "direction_z")):
            arrays = {**self.arrays(), name: 5.0}
            for path in (self.mat_file(arrays), self.hdf5_file(arrays)):
                with self.subTest(name=name, path=path.name):
                    if words:
                        self.unread(path, words)
                    else:
                        self.assertAlmostEqual(read_scan(path).trigger_delay_s, 5e-3)
        for scale, length, speed, time in ((1e3, "mm", "mm/s", "ms"), (1e6, "\u00b5m", "um/s", "us"), (1.0, "metres", "SI", "s")):
            units = dict(zip(self.arrays(), (time, length, length, speed)))
            with mock.patch.object(self, "arrays", return_value={key: scale * values for key, values in self.arrays().items()}):
                read = read_scan(self.hdf5({(key, "units"): unit for key, unit in units.items()}))
            with self.subTest(length=length):
                np.testing.assert_allclose(read.velocity_m_s, some_scan().velocity_m_s, rtol=1e-12)
                np.testing.assert_allclose(read.x_m, some_scan().x_m, rtol=1e-12)
                np.testing.assert_allclose(read.rate_Hz, 51200.0, rtol=1e-12)

    def test_spellings_of_units_are_read_and_other_units_are_refused(self):
        def scan(unit, name="velocity", attribute="units"):
            stored = [unit] if attribute == "Unit" else unit  # MATLAB stores an array of one text
            return read_scan(self.hdf5({(name, attribute): stored}, trigger_delay_ms=5.0))

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
        path = self.mat_file({**self.arrays(), "velocity_unit": "m/s", "dir_z": -1.0})
        self.assertEqual(read_scan(path).notes, ["without effect: dir_z"])  # the unit agrees

    def test_stated_units_are_those_of_si_or_refused(self):
        for text in ("m, s, m/s", "SI (m, m/s, s)", "PSV-400/A", "Metres per second", "velocity in m/s", b"m s^-1", 1.0):
            check_unit("units", text)
        for text in ("inch", "in", "in/s", "km", "ft", "mm, s, mm/s", "m, ms", "millimetres per second", b"\xc2\xb5m/s"):
            with self.subTest(text=text), self.assertRaises(BadScan):
                check_unit("x_units", text)
        check_unit("without", "mm")  # not a unit

    def test_a_unit_that_would_be_ignored_is_refused(self):
        for name, unit in (("velocity_unit", "mm/s"), ("Units", "mm"), ("unit", "\u00b5m/s")):
            with self.subTest(name=name):
                arrays = {**self.arrays(), name: unit}
                self.unread(self.mat_file(arrays), f"{name} is \"{unit}\", but values are read in m, s and m/s")
                self.unread(self.hdf5_file(arrays), "but values are read in m, s and m/s")
        lines = self.written("csv").read_text()
        for remark in ("velocity unit: mm/s", "units = cm", "velocity_units mm/s"):
            self.refused(f"# {remark}\n{lines}", "values are read in m, s and m/s", ".csv")
        for remark in ("velocity unit: m/s", "community gel, 60 mm", "unit 5 of the laboratory", "range: 100 mm/s"):
            self.assertTrue(any("without effect" in note for note in read_scan(self.file(f"# {remark}\n{lines}", ".csv")).notes))

    def hdf5(self, attributes, group="/", **more):
        """The scan in an HDF5 file with attributes {(dataset or "/", name): value}, in a group; `more` is at the top."""
        path = self.folder / "attributes.h5"
        with h5py.File(path, "w") as file:
            place = file.require_group(group)
            for key, value in self.arrays().items():
                place[key] = value
            for key, value in more.items():
                file[key] = value
            for (where, name), value in attributes.items():
                file[where].attrs[name] = value
        return path

    def test_attributes_of_hdf5_files_are_settings_or_refused(self):
        for group in ("/", "/vibrometer"):
            for where in {"/", group}:
                with self.subTest(group=group, where=where):
                    read = read_scan(self.hdf5({(where, "direction_z"): -1.0, (where, "trigger_delay_ms"): 2.0, (where, "title"): "gel",
                                                (where, "velocity_unit"): "m/s"}, group))
                    np.testing.assert_array_equal(read.velocity_m_s, -some_scan().velocity_m_s)
                    self.assertEqual((read.trigger_delay_s, read.states_direction), (2e-3, True))
                    for name, value in (("units", "mm/s"), ("velocityUnit", "mm/s"), ("triggerDelay", 2.0), ("velocity_scale", 1e-3),
                                        ("sign", -1.0), ("polarity", "negative")):
                        self.unread(self.hdf5({(where, name): value}, group), name)
        for name, value in (("dimension", "mm/s"), ("scale_factor", 1e-3), ("add_offset", 0.1), ("direction", "-Z"), ("direction_z", -1.0),
                            ("_FillValue", float(some_scan().velocity_m_s[0, 3]))):
            with self.subTest(name=name), self.assertRaisesRegex(BadScan, name):
                read_scan(self.hdf5({("velocity", name): value}))
        for name, value in (("scale_factor", 1.0), ("add_offset", 0.0), ("_FillValue", np.nan), ("_FillValue", -9999.0), ("long_name", "v")):
            with self.subTest(name=name, value=value):
                np.testing.assert_array_equal(read_scan(self.hdf5({("velocity", name): value})).velocity_m_s, some_scan().velocity_m_s)

    def stated_everywhere(self, name, value):
        """Scans of which one states a name as a remark, a variable of MATLAB, or an attribute of an HDF5 file or of its velocities."""
        lines = "".join(line for line in self.written("csv").read_text().splitlines(True) if not line.startswith("#"))
        yield self.file(f"# {name} = {value}\n" + lines.replace(",nan", ",0"), ".csv")
        yield self.mat_file({**self.arrays(), name: value}, "stated.mat")
        for where in ("/", "velocity"):
            yield self.hdf5({(where, name): value})

    def test_names_that_change_nothing_are_read(self):
        """Names of other quantities, and statements of what is assumed."""
        for name, value in (("directory", "/data"), ("trigger_date", 20240312), ("delta", 0.5), ("decay", 2.5), ("delay", 0.0),
                            ("velocity_units", "m/s"), ("scale", 1.0), ("offset", 0.0), ("sign", 1), ("sign", "+"), ("polarity", "positive"),
                            ("positive", "down"), ("direction", "z"), ("direction", "out-of-plane"), ("fill_level_mm", 30.0),
                            ("quality_factor", 30.0), ("crest_factor", 3.0), ("scan_direction", "-x"), ("sign_convention", "into the skin"),
                            ("dimensions", "60 x 60 mm"), ("scaling", "none"), ("time_scale", "UTC"), ("pressure_unit", "mm"),
                            ("laser_spot_unit", "mm"), ("focal_length_unit", "mm"), ("display_units", "mm/s")):
            for path in self.stated_everywhere(name, value):
                with self.subTest(name=name, value=value, path=path.name):
                    read = read_scan(path)
                    np.testing.assert_array_equal(np.nan_to_num(read.velocity_m_s), np.nan_to_num(some_scan().velocity_m_s))
                    self.assertEqual((read.trigger_delay_s, read.direction), (0.0, (0.0, 0.0, 1.0)))

    def test_names_that_contradict_what_is_read_are_refused(self):
        for name, value in (("scale", 1e-3), ("velocity_scale", "0.001"), ("scale_factor", 2), ("add_offset", 0.1), ("x_offset", 0.01),
                            ("sign", -1), ("sign_of_velocity", -1), ("polarity", "inverted"), ("positive", "up"), ("direction", "-Z"),
                            ("direction", "x"), ("delay", 0.01), ("delay", "5 ms"), ("delay_ms", 5.0), ("velocity_units", "mm/s"),
                            ("coordinateUnit", "mm"), ("length_unit", "cm")):
            for path in self.stated_everywhere(name, value):
                with self.subTest(name=name, value=value, path=path.name), self.assertRaisesRegex(BadScan, name):
                    read_scan(path)

    def test_members_without_values_change_nothing(self):
        for name in ("scale", "offset", "units", "direction"):
            for member in ("group", "link", "empty"):
                path = self.hdf5({})
                with h5py.File(path, "r+") as file:
                    if member == "group":
                        file.create_group(name)
                    elif member == "link":
                        file[name] = h5py.SoftLink("/nowhere")
                    else:  # [] of MATLAB is stored as its numbers of rows and columns
                        file[name] = np.array([0, 1], dtype=np.uint64)
                        file[name].attrs["MATLAB_empty"] = np.uint8(1)
                with self.subTest(name=name, member=member):
                    np.testing.assert_array_equal(read_scan(path).velocity_m_s, some_scan().velocity_m_s)

    def test_dimensions_without_variables_in_netcdf_files_are_no_times_and_state_the_order(self):
        scan = some_scan(points=30)
        for dimension in ("t", "sample"):
            for dims in (("point", dimension), (dimension, "point")):
                with h5py.File(self.folder / "bare.nc", "w") as file:
                    for name in ("point", dimension):
                        file[name] = np.zeros(30, ">f4")
                        file[name].make_scale("This is a netCDF dimension but not a netCDF variable.        30")
                    for name, values, of in (("time", scan.time_s, (dimension,)), ("x", scan.x_m, ("point",)), ("y", scan.y_m, ("point",)),
                                             ("velocity", scan.velocity_m_s if dims[0] == "point" else scan.velocity_m_s.T, dims)):
                        file[name] = values
                        for at, one in enumerate(of):
                            file[name].dims[at].attach_scale(file[one])
                with self.subTest(dims=dims):
                    read = read_scan(self.folder / "bare.nc")
                    np.testing.assert_array_equal(read.velocity_m_s, scan.velocity_m_s)
                    self.assertEqual([note for note in read.notes if "index" in note], [])

    def test_equal_statements_agree_in_any_type(self):
        for one, other in ((np.bytes_(b"m/s"), "m/s"), (b"m/s", "m/s"), (np.float32(0.1), 0.1), (np.array([0.1]), 0.1)):
            with self.subTest(one=one, other=other):
                name = "velocity_unit" if other == "m/s" else "trigger_delay_ms"
                read = read_scan(self.hdf5({("/vibrometer", name): one, ("/", name): other}, "/vibrometer"))
                self.assertAlmostEqual(read.trigger_delay_s, 0.0 if other == "m/s" else 1e-4, places=11)

    def test_a_fill_value_is_that_of_points_without_signal(self):
        arrays = {**self.arrays(), "x": np.arange(5.0) / 100.0}
        with mock.patch.object(self, "arrays", return_value=arrays):
            read = read_scan(self.hdf5({(name, "_FillValue"): 0.0 for name in ("time", "x", "y")}))
        np.testing.assert_array_equal(read.x_m, arrays["x"])
        self.assertEqual(read.time_s[0], 0.0)

    def test_settings_next_to_the_struct_are_read_and_contradictions_refused(self):
        for inner, outer, delay_s in (({}, {"trigger_delay_ms": 2.0}, 2e-3), ({"trigger_delay_ms": 2.0}, {"trigger_delay_ms": 2.0}, 2e-3),
                                      ({"trigger_delay_ms": 2.0}, {"trigger_delay_ms": 3.0}, None),
                                      ({"trigger_delay_ms": 2.0}, {"trigger_delay_s": 2e-3}, None), ({}, {"velocity_unit": "mm/s"}, None)):
            five_and_seven = (self.mat_file({"vibrometer": {**self.arrays(), **inner}, **outer, "comment": 5.0}), self.hdf5({("/vibrometer", name): value for name, value in inner.items()}, "/vibrometer", **outer))
            for one in five_and_seven:
                with self.subTest(path=one.name, inner=inner, outer=outer):
                    if delay_s is None:
                        self.unread(one, next(iter(outer)))
                    else:
                        self.assertAlmostEqual(read_scan(one).trigger_delay_s, delay_s, places=12)

    def test_two_names_of_one_quantity_are_refused(self):
        for name, other in (("v", "velocity"), ("t", "time")):
            for path in (self.mat_file({**self.arrays(), name: self.arrays()[other]}), self.hdf5({}, **{name: self.arrays()[other]})):
                with self.subTest(path=path.name), self.assertRaisesRegex(BadScan, f"both {other} and {name}"):
                    read_scan(path)

    def test_units_in_structs_in_any_order_of_words_and_in_remarks_are_refused(self):
        for more in ({"units": {"velocity": "mm/s", "x": "m"}}, {"unit_velocity": "mm/s"}, {"velocityUnits": "mm/s"}):
            with self.subTest(more=more):
                self.unread(self.mat_file({**self.arrays(), **more}), "is \"mm/s\", but values are read in")
        self.unread(self.hdf5({}, **{"units/velocity": "mm/s"}), "units/velocity is \"mm/s\"")
        lines = self.written("csv").read_text()
        for remark in ("velocity in mm/s", "Velocities: \u00b5m/s", "all x in mm, y in mm", "scale = 0.001"):
            self.refused(f"# {remark}\n{lines}", "remove it", ".csv")
        for remark in ("velocity in m/s", "time: 14 h", "x: 60 mm of gel", "scale: full"):
            self.assertTrue(any("without effect" in note for note in read_scan(self.file(f"# {remark}\n{lines}", ".csv")).notes), remark)

    def test_times_in_single_precision_have_the_rate_that_their_rounding_allows(self):
        time = np.arange(51200) / 51200.0  # the last ones differ by 0.3 % of a step after rounding to single precision
        arrays = {**self.arrays(), "velocity": np.zeros((5, len(time)))}
        for factor, unit in ((1.0, "s"), (1e3, "ms")):
            arrays["time"] = (factor * time).astype(np.float32)
            with self.subTest(unit=unit), mock.patch.object(self, "arrays", return_value=arrays):
                self.assertAlmostEqual(read_scan(self.hdf5({("time", "units"): unit})).with_rate_of(5e-3).rate_Hz, 51200.0, places=7)
                if unit == "s":
                    self.assertAlmostEqual(read_scan(self.mat_file(arrays)).with_rate_of(5e-3).rate_Hz, 51200.0, places=7)
        arrays["time"] = time.astype(np.float32)
        arrays["time"][25000:] += np.float32(4e-5)  # two samples are missing
        with mock.patch.object(self, "arrays", return_value=arrays), self.assertRaisesRegex(BadScan, "not uniformly spaced"):
            read_scan(self.hdf5({}))

    def test_a_quality_in_per_cent_is_refused(self):
        for largest, words in ((100.0, "divide per cent by 100"), (1.0, ""), (1.0 + 1e-7, "")):
            path = self.folder / "quality.csv"
            write_scan(path, replace(some_scan(), quality=np.array([0.0, np.nan, 0.5, 1.0, largest])), "csv")
            if words:
                self.unread(path, words)
            else:
                self.assertEqual(np.nanmax(read_scan(path).quality), largest)

    def test_coordinates_in_mm_times_in_ms_and_velocities_along_the_surface_are_refused(self):
        scan = some_scan()
        for changes, reason in (({"x_m": 1e3 * scan.x_m}, "coordinates must be in metres"),
                                ({"time_s": 1e3 * scan.time_s}, "times must be in seconds"),
                                ({"direction": (1.0, 0.0, 0.0)}, "nearly parallel to the surface")):
            with self.subTest(reason=reason):
                path = self.folder / "wrong.csv"
                write_scan(path, replace(scan, **changes), "csv")
                self.unread(path, reason)
