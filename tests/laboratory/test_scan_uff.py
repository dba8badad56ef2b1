# SPDX-License-Identifier: BSD-3-Clause
"""Scans in the Universal File Format as other programs write it, and rounded times."""

import numpy as np
from scans import ScanTest, some_scan

from shearwake.laboratory.scan import BadScan
from shearwake.laboratory.scan_files import read_scan
from shearwake.laboratory.scan_motion import one_period


class UffTest(ScanTest):
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


class OtherPrograms(UffTest):
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


class Rounding(UffTest):
    """Times with six digits have a rate with whole periods if their rounding allows it."""

    def test_a_scan_of_whole_periods_is_accepted(self):
        rate_Hz, count = 51200.0, 1024
        tone = "".join(f"{np.sin(2 * np.pi * 200 * n / rate_Hz):13.5E}" + ("\n" if n % 6 == 5 else "") for n in range(count)) + "\n"
        text = self.text(count=count, values=tone).replace(f"{1e-4:13.5E}", f"{1.0 / rate_Hz:13.5E}")
        scan = read_scan(self.file(text))
        self.assertAlmostEqual(scan.with_rate_of(5e-3).rate_Hz / rate_Hz, 1.0, places=12)
        period, periods = one_period(scan.with_rate_of(5e-3), 5e-3)  # 256 samples
        self.assertEqual((period.shape, periods), ((1, 256), 4))
        with self.assertRaisesRegex(BadScan, "is not a whole number of samples"):
            one_period(scan.with_rate_of(5.001e-3), 5.001e-3)

    def test_printed_times_of_csv_are_rounded_alike(self):
        rate_Hz, points, samples = 51200.0, 3, 2048
        rows = ["x_m,y_m,quality," + ",".join(f"{n / rate_Hz:.6g}" for n in range(samples))]
        rows += [f"{0.001 * p},0,1," + ",".join(["0.5"] * samples) for p in range(points)]
        scan = read_scan(self.file("\n".join(rows), ".csv"))
        self.assertAlmostEqual(scan.with_rate_of(5e-3).rate_Hz / rate_Hz, 1.0, places=12)
        rows[0] = rows[0].replace(f",{100 / rate_Hz:.6g},", f",{100.5 / rate_Hz:.6g},")
        self.refused("\n".join(rows), "not uniformly spaced", ".csv")
