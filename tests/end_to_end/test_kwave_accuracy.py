# SPDX-License-Identifier: BSD-3-Clause
"""The error of pstd_elastic_3d at equal points per wavelength, against closed forms of plane shear waves. With -s the table of
docs/explanation/kwave-speed.md is printed."""
import math
import os

import numpy
import pytest

from program import PROGRAM, ProgramTest, environment
from shearwake.kwave import pstd_elastic_3d

C_P, SLOW, FAST, DENSITY = 10.0, 2.0, 3.0, 1000.0  # m/s and kg/m3; the second layer has the speed FAST
WAVELENGTH_m = 5e-3                              # of the shear wave at the centre frequency, in the first layer
WIDTH_s = 1.5e-3                                 # of the burst
DELAY_s = 5e-3
REACH_m = 0.08                                   # the wave does not come round the periodic grid in this time


def burst(times_s):
    return numpy.sin(2.0 * math.pi * SLOW / WAVELENGTH_m * (times_s - DELAY_s)) * numpy.exp(-((times_s - DELAY_s) / WIDTH_s) ** 2)


def errors(points_per_wavelength, layered, cfl=0.3):
    """The largest errors of the transmitted (or, in one medium, direct) wave and of the direct and reflected wave relative to the largest value of
    the incident wave, which is 1."""
    spacing_m = WAVELENGTH_m / points_per_wavelength
    steps = math.ceil(0.022 / (cfl * spacing_m / C_P))
    step_s = 0.022 / steps
    count = 2 * math.ceil(0.5 * REACH_m / spacing_m)
    source, interface, before, behind = (round(place_m / spacing_m) for place_m in (0.02, 0.035, 0.0275, 0.045))
    points = (4, 4, count)
    u_mask, mask = numpy.zeros(points), numpy.zeros(points)
    u_mask[:, :, source] = mask[0, 0, before] = mask[0, 0, behind] = 1.0
    c_s = numpy.full(points, SLOW)
    if layered:
        c_s[:, :, interface:] = FAST
    # Sample n of the source acts in the middle between the velocities of steps n - 1 and n.
    times_s = (numpy.arange(1, steps + 1) - 0.5) * step_s
    # An additive source is scaled with c_p and dx; a plane of nodes then emits the wave c_p/c_s f(t) dz/dx.
    found = pstd_elastic_3d({"N": points, "spacing": [spacing_m] * 3, "dt": step_s, "Nt": steps},
                            {"sound_speed_compression": C_P, "sound_speed_shear": c_s, "density": DENSITY},
                            {"u_mask": u_mask, "ux": SLOW / C_P * burst(times_s - 0.5 * step_s)[None]}, {"mask": mask, "record": ["u"]},
                            quiet=True, pml_size=0)["ux"]
    at_m = spacing_m * (numpy.array([before, behind, interface - 0.5]) - source)
    if not layered:
        return [numpy.abs(row - burst(times_s - place_m / SLOW)).max() for row, place_m in zip(found, at_m)][1:] + [0.0]
    # The interface of piecewise constant nodes lies between the nodes interface - 1 and interface.
    reflection = (SLOW - FAST) / (SLOW + FAST)
    expected = (burst(times_s - at_m[0] / SLOW) + reflection * burst(times_s - (2.0 * at_m[2] - at_m[0]) / SLOW),
                (1.0 + reflection) * burst(times_s - at_m[2] / SLOW - (at_m[1] - at_m[2]) / FAST))
    direct, transmitted = (numpy.abs(row - values).max() for row, values in zip(found, expected))
    return [transmitted, direct]


class Accuracy(ProgramTest):
    @pytest.mark.long
    def test_error_at_equal_points_per_wavelength(self):
        """One medium reaches 1 % between 4 and 6 points per wavelength, with an error that is of second order in time; the transmitted
        wave of two layers reaches it between 16 and 24, with an error of first order at the interface."""
        os.environ.update(environment(), SHEARWAKE=str(PROGRAM))
        found = {}
        print("\npoints per wavelength: one medium; transmitted, with the direct and reflected wave")
        for points in (4, 6, 8, 12, 16, 24):
            found[points] = [errors(points, False)[0], *errors(points, True)]
            print(points, *(f"{100.0 * value:.3g} %" for value in found[points]))
        self.assertTrue(found[4][0] > 0.01 > found[6][0])
        self.assertTrue(found[16][1] > 0.01 > found[24][1])
        self.assertAlmostEqual(found[12][0] / found[24][0], 4.0, delta=0.2)
        self.assertAlmostEqual(found[12][1] / found[24][1], 2.0, delta=0.2)
