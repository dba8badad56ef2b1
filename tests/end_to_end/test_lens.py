# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake lens` writes a lens that can be printed and the field that presses on the skin."""
import csv
import io
import re

import numpy as np
import pytest
from PIL import Image, ImageDraw

from program import ONE_CASE, ProgramTest, small_job

# A lens of 60 mm above skin that is pressed 200 times per second.
def lens_job(target):
    footprint = {"shape": "lens", "aperture_mm": 60.0, "distance_mm": 60.0, "reach_mm": 40.0, "pixel_mm": 2.0, "iterations": 20,
                 "material_c_m_s": 1500.0, "material_density_kg_m3": 1200.0, **target}
    return small_job(ONE_CASE, {
        "load": {"peak_Pa": 50.0, "footprint": footprint, "modulation": {"kind": "AM", "am_frequency_Hz": 200.0}},
        "domain": {"extent_mm": [96.0, 96.0], "spacing_mm": 2.0}, "time": {"duration_ms": 5.0, "output_interval_us": 250.0},
        "measure": {"settled_after_ms": 2.0}, "record": {"frames": True}})


FOCI_mm = ((-12.0, 6.0), (12.0, -3.0))
FOCI = {"target_foci_mm": [[-12, 6], [12, -3]]}
TRIANGLE = {"target_polygon_mm": [[-12, -12], [12, -12], [-12, 12]]}
PICTURE = {"target_png": "triangle.png", "target_width_mm": 36}


def columns(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:])


def triangles(path):
    """The vertices [triangle, corner, axis] and normals of a binary STL file."""
    content = path.read_bytes()
    count = int.from_bytes(content[80:84], "little")
    assert len(content) == 84 + 50 * count
    facets = np.frombuffer(content[84:], np.dtype([("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("rest", "<u2")]))
    return facets["corner"].astype(float), facets["normal"].astype(float)


class LensTest(ProgramTest):
    def lens(self, target):
        """The text of the program and the folder of the files."""
        job = self.write_job(lens_job(target))
        out = self.folder / "lens"
        return self.shearwake("lens", job, "--out", out).stdout, out

    def field(self, out):
        header, rows = columns(out / "field.csv")
        self.assertEqual(header, ["x_mm", "y_mm", "pressure"])
        return rows.astype(float)

    def share_in_triangle(self, out):
        x, y, pressure = self.field(out).T
        inside = (x >= -12.0) & (y >= -12.0) & (x + y <= 0.0)
        return np.sum(pressure[inside]) / np.sum(pressure), np.mean(inside)


class Files(LensTest):
    def test_the_printed_surface_is_closed_and_has_the_thickness_of_the_table(self):
        _, out = self.lens(FOCI)
        corners, normals = triangles(out / "lens.stl")
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        np.testing.assert_allclose(normals, across / np.linalg.norm(across, axis=1)[:, None], atol=1e-4)  # float32
        header, rows = columns(out / "thickness.csv")
        self.assertEqual(header, ["x_mm", "y_mm", "thickness_mm"])
        x, y, thickness = rows.astype(float).T
        # A pixel is at the stated place: the highest triangle above it has its thickness.
        for n in range(0, len(x), 37):
            middle = corners.mean(axis=1)
            above = (abs(middle[:, 0] - x[n]) < 0.9) & (abs(middle[:, 1] - y[n]) < 0.9) & (normals[:, 2] > 0.5)
            self.assertEqual(np.count_nonzero(above), 2 if thickness[n] > 0.0 else 0)
            np.testing.assert_allclose(corners[above][..., 2], thickness[n], atol=1e-5)
        self.assertTrue(np.all((thickness == 0.0) == (np.hypot(x, y) > 30.0)))
        # Between 1500 m/s and air of 346.1 m/s, a phase of 2 pi corresponds to 11.25 mm.
        self.assertLess(np.max(thickness), 1.0 + 11.26)
        picture = np.asarray(Image.open(out / "thickness.png"))
        side = round(np.sqrt(len(x)))
        expected = thickness.reshape(side, side).T[::-1] / np.max(thickness)  # y upwards
        np.testing.assert_allclose(picture / 255.0, expected, atol=0.5 / 255.0 + 1e-9)

    def test_the_field_has_its_foci_and_the_stated_quality(self):
        text, out = self.lens(FOCI)
        x, y, pressure = self.field(out).T
        self.assertLess(np.max(pressure), 1.0 + 1e-6)
        self.assertGreater(np.max(pressure), 0.95)  # the peak itself lies between the points, four per wavelength
        for focus in FOCI_mm:
            near = np.hypot(x - focus[0], y - focus[1]) < 2.0
            self.assertGreater(np.max(pressure[near]), 0.9)
        apart = np.min([np.hypot(x - a, y - b) for a, b in FOCI_mm], axis=0) > 9.0  # a wavelength of 8.65 mm
        self.assertLess(np.max(pressure[apart]), 0.5)
        header, rows = columns(out / "errors.csv")
        self.assertEqual(header, ["iteration", "error"])
        errors = rows[:, 1].astype(float)
        self.assertEqual(len(errors), 21)  # 20 iterations, and after the rounding of the phases
        self.assertTrue(np.all(np.diff(errors[:-1]) <= 1e-12))
        stated = float(re.search(r"error: ([\d.]+) of the power", text)[1])
        self.assertAlmostEqual(stated, errors[-1], delta=6e-5)
        efficiency = float(re.search(r"efficiency: ([\d.]+) %", text)[1])
        self.assertTrue(10.0 < efficiency < 100.0, efficiency)
        self.assertGreater(float(re.search(r"uniformity: ([\d.]+)", text)[1]), 0.95)

    @pytest.mark.extended
    def test_a_polygon_and_its_picture_give_the_same_field(self):
        picture = Image.new("L", (72, 72))  # half a millimetre per pixel, y downwards
        ImageDraw.Draw(picture).polygon([(12, 60), (60, 60), (12, 12)], fill=255)
        data = io.BytesIO()
        picture.save(data, "png")
        (self.folder / "triangle.png").write_bytes(data.getvalue())
        _, out = self.lens(TRIANGLE)
        drawn, area = self.share_in_triangle(out)
        first = self.field(out)[:, 2]
        self.assertGreater(drawn, 5.0 * area)
        _, out = self.lens(PICTURE)
        shown, _ = self.share_in_triangle(out)
        # The edges of the picture differ by up to a pixel of 0.5 mm, a tenth of the triangle's area.
        self.assertAlmostEqual(shown, drawn, delta=0.05)
        self.assertGreater(np.corrcoef(first, self.field(out)[:, 2])[0, 1], 0.95)

    @pytest.mark.extended
    def test_hostile_pictures_are_refused_with_a_reason(self):
        data = io.BytesIO()
        Image.new("L", (40, 40), 200).save(data, "png")
        good = data.getvalue()
        path = self.folder / "triangle.png"
        job = self.write_job(lens_job(PICTURE))
        huge = good.replace((40).to_bytes(4, "big"), (10 ** 9).to_bytes(4, "big"), 1)
        for content in (b"", b"no picture", good[:30], good[:-30], huge, good[:40] + b"\xff" * 20 + good[60:]):
            path.write_bytes(content)
            with self.subTest(content=content[:30], size=len(content)):
                done = self.shearwake("check", job, expect=None)
                self.assertEqual(done.returncode, 3, done.output)
                self.assertIn("target_png", done.output)


class Skin(LensTest):
    def test_the_pressure_of_a_lens_drives_the_skin_in_its_pattern(self):
        import h5py

        job = self.write_job(lens_job(FOCI))
        out = self.folder / "out"
        self.shearwake("run", job, "--out", out)
        with h5py.File(next((out / "cases").glob("*.h5")), "r") as file:
            frames = file["surface/u_z"][:, 0]
        strength = np.sqrt(np.mean(frames[8:] ** 2, axis=0))
        places = 2.0 * (np.arange(48) - 24)
        # Each focus has a maximum of the displacement within two nodes of it.
        for focus in FOCI_mm:
            i, j = (int(np.argmin(abs(places - value))) for value in focus)
            near = strength[i - 3:i + 4, j - 3:j + 4]
            self.assertTrue(np.all(abs(np.array(np.unravel_index(np.argmax(near), near.shape)) - 3) <= 2))
            self.assertGreater(np.max(near), 0.8 * np.max(strength))
