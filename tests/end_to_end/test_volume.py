# SPDX-License-Identifier: BSD-3-Clause
"""Volume snapshots for xarray."""
import shutil

import numpy
import pytest
import xarray

from program import HALF_SPACE, NO_FRAMES, SPECTRAL, ProgramTest, case_files, changed_job, swept, without_reference

KEPT = without_reference(SPECTRAL, swept(500), NO_FRAMES, {"record.snapshots_ms": [2.0, 4.0], "record.volumes_ms": [2.0, 4.0],
                                                           "record.volume_fields": ["u", "strain", "stress"]})
TENSOR = ["xx", "yy", "zz", "yz", "xz", "xy"]
NAMES = ["u_x", "u_y", "u_z", *(f"strain_{c}" for c in TENSOR), *(f"stress_{c}" for c in TENSOR)]
UNITS = {"u": "m", "strain": "1", "stress": "Pa"}


def along(values, axis, spacing_m):
    """The derivative of a periodic field without its highest mode."""
    count = values.shape[axis]
    k = 2j * numpy.pi * numpy.fft.fftfreq(count, spacing_m)
    k[count // 2] = 0.0
    modes = numpy.moveaxis(numpy.fft.fft(values, axis=axis), axis, -1) * k
    return numpy.moveaxis(numpy.fft.ifft(modes).real, -1, axis)


class Volume(ProgramTest):
    def run_case(self, ranks=1, job=KEPT):
        self.write_job(job)
        self.shearwake("run", "job.toml", "--ranks-per-case", ranks, ranks=ranks)
        return case_files(self.out)[0]

    def test_xarray_opens_the_volume(self):
        path = self.run_case(ranks=2)
        with (xarray.open_dataset(path, group="volume", decode_timedelta=False) as volume,
              xarray.open_dataset(path, group="surface", decode_timedelta=False) as surface):
            self.assertEqual(set(volume.data_vars), set(NAMES))
            for name in volume.data_vars:
                self.assertEqual(volume[name].dims, ("time", "z", "y", "x"))
                self.assertEqual(volume[name].attrs["units"], UNITS[name.split("_")[0]])
                self.assertRegex(volume[name].attrs["long_name"], "displacement along|component")
                self.assertTrue(numpy.isfinite(volume[name]).all())
            self.assertEqual((volume.sizes["x"], volume.sizes["y"]), (surface.sizes["x"], surface.sizes["y"]))
            self.assertEqual(float(volume.z[0]), 0.0)
            self.assertAlmostEqual(float(volume.z[-1]), 0.02)
            self.assertTrue((volume.z.diff("z") > 0).all())
            # The same field in both orders of x and y.
            top = volume.u_z.isel(z=0).transpose("time", "x", "y").values
            kept = surface.u_z.isel(depth=0).values
            scale = numpy.abs(kept).max()
            self.assertGreater(scale, 0.0)
            # The surface is interpolated between levels with weights that are exact to rounding.
            self.assertLess(numpy.abs(top - kept).max(), 1e-12 * scale)

    @pytest.mark.long
    def test_strains_match_the_displacement_also_above_an_absorbing_bottom(self):
        endless = changed_job(KEPT, HALF_SPACE)
        for job, ranks in ((KEPT, 1), (endless, 2)):
            shutil.rmtree(self.out, ignore_errors=True)
            path = self.run_case(ranks, job)
            with xarray.open_dataset(path, group="volume", decode_timedelta=False) as volume:
                u_x, u_y = volume.u_x.values, volume.u_y.values
                x_m, y_m = float(volume.x[1] - volume.x[0]), float(volume.y[1] - volume.y[0])
                xx, yy = along(u_x, -1, x_m), along(u_y, -2, y_m)
                xy = 0.5 * (along(u_x, -2, y_m) + along(u_y, -1, x_m))
                for name, expected in (("xx", xx), ("yy", yy), ("xy", xy)):
                    scale = numpy.abs(expected).max()
                    self.assertGreater(scale, 0.0)
                    difference = numpy.abs(volume[f"strain_{name}"].values - expected).max()
                    self.assertLess(difference, 1e-10 * scale, name)  # both are exact to rounding
                # Tissue is nearly incompressible: c_p is 300 c_s.
                self.assertLess(numpy.abs(xx + yy + volume.strain_zz.values).max(), 1e-2 * numpy.abs(xx).max())

