# SPDX-License-Identifier: BSD-3-Clause
"""What the unit tests of k-Wave's elastic code check, with pstd_elastic_3d and k-Wave's limits, against schemes that are written anew
with NumPy."""
import itertools
import os

import numpy
import pytest

from kwave import AXES, FIELDS, at_edge, at_half
from program import PROGRAM, ProgramTest, environment
from shearwake.kwave import pstd_elastic_3d



def derivative(values, spacing_m, axis, side):
    """Half a cell towards `side` of the values."""
    k = 2.0 * numpy.pi * numpy.fft.fftfreq(values.shape[axis], spacing_m[axis])
    k = k.reshape([-1 if a == axis else 1 for a in range(values.ndim)])
    return numpy.fft.ifft(1j * k * numpy.exp(side * 0.5j * k * spacing_m[axis]) * numpy.fft.fft(values, axis=axis), axis=axis).real


def fluid(points, spacing_m, step_s, steps, c, rho, source, at):
    """Pressure and velocities of a fluid on a staggered grid at the node `at` in all steps (4, steps), and finally everywhere. A signal of
    p has the sign of a pressure."""
    p, u, series, c_at = numpy.zeros(points), [numpy.zeros(points) for _ in AXES], [], c[tuple(source["at"])]
    between = [at_half(rho, axis) for axis in range(3)]
    for step in range(steps):
        u = [u[axis] - step_s / between[axis] * derivative(p, spacing_m, axis, 1) for axis in range(3)]
        for axis, name in enumerate(AXES):
            if f"u{name}" in source:
                change = source[f"u{name}"][step]
                at_source = u[axis][tuple(source["at"])]
                u[axis][tuple(source["at"])] = change if source["fixed"] else at_source + 2.0 * c_at * step_s / spacing_m[axis] * change
        p = p - step_s * rho * c ** 2 * sum(derivative(u[axis], spacing_m, axis, -1) for axis in range(3))
        if "p" in source:
            old = p[tuple(source["at"])]
            p[tuple(source["at"])] = source["p"][step] if source["fixed"] else old + 2.0 * c_at * step_s / spacing_m[0] * source["p"][step]
        if "p0" in source and step < 2:
            p = p + 0.5 * source["p0"]
        series.append([p[at], *(part[at] for part in u)])
    return numpy.array(series).T, [p, *u]


def elastic_2d(spacing_m, step_s, steps, medium, source):
    """The in-plane velocities (2, steps, ...) of plane strain, with both parts of each velocity."""
    c_p, c_s, rho, alpha_p, alpha_s = medium
    mu, c_at = rho * c_s ** 2, c_p[tuple(source["at"])]
    lam = rho * c_p ** 2 - 2.0 * mu
    neper = 100.0 * (1e-6 / (2.0 * numpy.pi)) ** 2 / (20.0 * numpy.log10(numpy.e))
    eta = 2.0 * rho * c_s ** 3 * neper * alpha_s
    chi = 2.0 * rho * c_p ** 3 * neper * alpha_p - 2.0 * eta
    mu_xy, eta_xy = (at_edge(values[..., None], (0, 1))[..., 0] for values in (mu, eta))
    between = [at_half(rho, axis) for axis in range(2)]
    s, u, found = numpy.zeros((2, 2, *c_p.shape)), numpy.zeros((2, 2, *c_p.shape)), []

    def change(values, axis, side):
        return derivative(values, spacing_m, axis, side)

    for step in range(steps):
        g = numpy.array([[change(s[i, j], j, 1 if i == j else -1) for j in range(2)] for i in range(2)])
        a = [g[i].sum(axis=0) / between[i] for i in range(2)]
        u = u + step_s * g / numpy.array(between)[:, None]
        here = tuple(source["at"])
        for axis in range(2) if source["kind"] == "u" else ():
            value = source["signal"][step]
            u[(axis, axis, *here)] = value if source["fixed"] else u[(axis, axis, *here)] + 2.0 * c_at * step_s / spacing_m[axis] * value
        total = u.sum(axis=1)
        for values, bulk, shear, shear_xy in ((total, lam, mu, mu_xy), (a, chi, eta, eta_xy)):
            strain = [change(values[i], i, -1) for i in range(2)]
            for i in range(2):
                s[i, i] += step_s * (bulk * sum(strain) + 2.0 * shear * strain[i])
            s[0, 1] += step_s * shear_xy * (change(values[0], 1, 1) + change(values[1], 0, 1))
        if source["kind"] == "p0" and step < 2:
            s[(0, 0, *here)] -= 0.5 * source["signal"]
            s[(1, 1, *here)] -= 0.5 * source["signal"]
        for i in range(2) if source["kind"] == "s" else ():
            value = source["signal"][step]
            s[(i, i, *here)] = value if source["fixed"] else s[(i, i, *here)] + 2.0 * c_at * step_s / spacing_m[0] * value
        s[1, 0] = s[0, 1]
        found.append(total)
    return numpy.array(found).transpose(1, 0, 2, 3)


class Checks(ProgramTest):
    def setUp(self):
        super().setUp()
        os.environ.update(environment(), SHEARWAKE=str(PROGRAM))

    def by_function(self, setup, sensor, record, **options):
        points, spacing_m, step_s, steps, medium, source = setup
        return pstd_elastic_3d({"N": points, "spacing": spacing_m, "dt": step_s, "Nt": steps}, medium, source, {"mask": sensor, "record": record},
                               smooth=False, quiet=True, **options)

    def same(self, found, expected, limit, name=""):
        self.assertGreater(numpy.abs(expected).max(), 0.0, name)
        numpy.testing.assert_allclose(found, expected, rtol=0, atol=limit * numpy.abs(expected).max(), err_msg=name)

    def test_one_series_equals_one_per_node(self):
        first = ((24, 20, 18), (1e-4, 1.1e-4, 0.9e-4), 5e-9, 60, {"sound_speed_compression": 1500.0, "sound_speed_shear": 1000.0, "density": 1000.0})
        mask = numpy.zeros((24, 20, 18))
        mask[12, 7:11, 6:9] = 1.0
        waves = {name: (n + 1.0) * numpy.sin((0.2 + 0.02 * n) * numpy.arange(60.0))[None] for n, name in enumerate(FIELDS[3:])}
        one, each = (self.by_function((*first, {"s_mask": mask, **{name: numpy.tile(wave, (count, 1)) for name, wave in waves.items()}}),
                                      numpy.ones((24, 20, 18)), ["p_final", "p_max"], pml_size=4) for count in (1, 12))
        for name in ("p_final", "p_max"):
            self.same(each[name], one[name], 1e-15)

    @pytest.mark.extended
    def test_fluid_equals_a_fluid_code(self):
        """Without an absorbing layer: an initial pressure, and a pressure and each velocity, added or prescribed."""
        points, spacing_m, step_s, steps = (24, 20, 18), (1e-3, 1.1e-3, 0.9e-3), 1e-7, 80
        c, rho = numpy.full(points, 1500.0), numpy.full(points, 1000.0)
        c[14:], rho[14:] = 1700.0, 1200.0
        mask, sensor, p0 = numpy.zeros(points), numpy.zeros(points), numpy.zeros(points)
        mask[6, 10, 8] = sensor[16, 13, 11] = 1.0
        p0[5:8, 9:12, 7:10] = 5.0
        wave = 20.0 * numpy.sin(0.25 * numpy.arange(float(steps)))
        for name, fixed in (("p0", False), *itertools.product(("p", "ux", "uy", "uz"), (False, True))):
            signal = wave if name == "p" else wave / 1.5e6
            source = {"p0": {"p0": p0}, "p": {"s_mask": mask, **dict.fromkeys(("sxx", "syy", "szz"), -signal[None])}}.get(
                name, {"u_mask": mask, name: signal[None]})
            if fixed:
                source["s_mode" if name == "p" else "u_mode"] = "dirichlet"
            setup = (points, spacing_m, step_s, steps, {"sound_speed_compression": c, "sound_speed_shear": 0.0, "density": rho}, source)
            series, final = fluid(points, spacing_m, step_s, steps, c, rho, {"at": (6, 10, 8), "fixed": fixed, name: p0 if name == "p0" else signal},
                                  (16, 13, 11))
            result = self.by_function(setup, sensor, ["p", "u", "p_final", "u_final"], pml_size=4, pml_alpha=0.0)
            for field, at_sensor, everywhere in zip(("p", "ux", "uy", "uz"), series, final):
                self.same(result[field].ravel(), at_sensor, 5e-13, f"{name} {fixed} {field}")
                self.same(result[f"{field}_final"], everywhere, 5e-13, f"{name} {fixed} {field}_final")

    def compare_2d(self, lossy, kind, fixed, layered, line):
        """A line source along an axis against plane strain in the plane of the others."""
        plane, depth, step_s, steps, at = (22, 20), 6, 5e-9, 60, (6, 8)
        spacing_m = (1e-4, 1.1e-4)
        solid = numpy.zeros(plane, dtype=bool)
        solid[11:] = layered
        uniform = numpy.ones(plane)
        medium = [numpy.where(solid, 2000.0, 1500.0), 800.0 * solid, numpy.where(solid, 1200.0, 1000.0), 0.5 * uniform * (1.0 + solid) * lossy,
                  0.5 * uniform * (1.0 + solid) * lossy]
        wave = 3.0 * numpy.sin(0.3 * numpy.arange(float(steps)))
        signal = {"p0": 3.0, "s": wave, "u": wave / 1.5e6}[kind]
        expected = elastic_2d(spacing_m, step_s, steps, medium, {"at": at, "kind": kind, "fixed": fixed, "signal": signal})

        def extended(values):
            return numpy.repeat(numpy.expand_dims(values, line), depth, axis=line)
        mask = numpy.zeros(plane)
        mask[at] = 1.0
        names = ("sound_speed_compression", "sound_speed_shear", "density", "alpha_coeff_compression", "alpha_coeff_shear")
        source = {"p0": 3.0 * extended(mask)} if kind == "p0" else {f"{kind}_mask": extended(mask), f"{kind}_mode": "dirichlet" if fixed else "additive",
                  **dict.fromkeys(("ux", "uy", "uz") if kind == "u" else ("sxx", "syy", "szz"), signal[None])}
        setup = (extended(mask).shape, tuple(numpy.insert(spacing_m, line, 1e-4)), step_s, steps,
                 {name: extended(values) for name, values in zip(names, medium) if lossy or not name.startswith("alpha")}, source)
        sensor = numpy.zeros(setup[0])
        numpy.moveaxis(sensor, line, 0)[depth // 2] = 1.0
        result = self.by_function(setup, sensor, ["u"], pml_size=2, pml_alpha=0.0)
        for values, axis in zip(expected, numpy.delete(numpy.arange(3), line)):
            series = result[f"u{AXES[axis]}"].reshape(*plane, steps)
            numpy.testing.assert_allclose(series.transpose(2, 0, 1), values, rtol=0, atol=1e-14 * numpy.abs(expected).max(),
                                          err_msg=f"{kind} {fixed} {line}")

    def cases_2d(self):
        return itertools.product((False, True), (("p0", False), ("s", False), ("s", True), ("u", False), ("u", True)), (False, True))

    @pytest.mark.long
    def test_line_source_along_each_axis_equals_two_dimensions(self):
        for (lossy, (kind, fixed), layered), line in itertools.product(self.cases_2d(), range(3)):
            self.compare_2d(lossy, kind, fixed, layered, line)
