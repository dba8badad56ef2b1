# SPDX-License-Identifier: BSD-3-Clause
"""pstd_elastic_2d and files with Nz = 1 return what pstdElastic2D of k-Wave returns."""
import types

import h5py
import numpy
import pytest
import scipy.io

from kwave import import_kwave
from shearwake.kwave import pstd_elastic_2d, pstd_elastic_3d
from test_kwave_functions import DATA, TOLERANCE, FunctionsTest, study
from test_kwave_program import KWaveTest, flags_of

CASES = (("layered_2d", "binary"), ("solids_2d", "corners"), ("p0_2d", "binary"), ("p0_2d", "cartesian_nearest"))


BOX = {"kgrid": {"Nx": 30, "Ny": 28, "Nz": 6, "dx": 1e-3, "dy": 1e-3, "dz": 1e-3, "dt": 1e-5, "Nt": 50}, "mask": numpy.zeros((30, 28)),
       "medium": {"sound_speed_compression": 20.0, "sound_speed_shear": 5.0, "density": 1000.0}, "wave": numpy.sin(0.4 * numpy.arange(25.0))[None]}
BOX["mask"][15, 10:18] = 1.0


def box_velocities(driven):
    """The velocities (30, 28, time) of a box that does not vary along z and has no layer there."""
    found = pstd_elastic_3d(BOX["kgrid"], BOX["medium"], {"u_mask": numpy.repeat(BOX["mask"][..., None], 6, axis=2), driven: BOX["wave"]},
                            {"record": ["u"]}, quiet=True, pml_size=[5, 5, 0])
    return {name: values.reshape(30, 28, 6, -1)[:, :, 3] for name, values in found.items()}


def reordered(mask):
    """The rows of a mask in C order for those in the order of MATLAB."""
    nodes = numpy.argwhere(numpy.asarray(mask).T)[:, ::-1]
    return numpy.argsort(numpy.lexsort(nodes.T[::-1]))


class References(FunctionsTest):
    def check(self, case, name, **options):
        """Runs a study with the sensor of a group of its reference."""
        found, keywords = study(case)
        with h5py.File(DATA / f"{case}_reference.h5") as file:
            group, sensor = file[name], found["sensor"]
            sensor.record = str(group.attrs["record"]).split()
            order = slice(None)
            if "sensor_mask_positions" in group:
                sensor.mask = group["sensor_mask_positions"][()].T
            elif name == "binary":
                order = reordered(sensor.mask)
            source = found["source"]  # the rows of its series in C order
            for mask, fields in (("u_mask", ("ux", "uy")), ("s_mask", ("sxx", "syy", "sxy"))):
                for field in fields:
                    series = getattr(source, field, None)
                    if series is not None and len(series) == numpy.count_nonzero(getattr(source, mask)):
                        setattr(source, field, series[numpy.argsort(reordered(getattr(source, mask)))])
            result = pstd_elastic_2d(found["kgrid"], found["medium"], source, sensor, quiet=True,
                                     cart_interp="nearest" if name == "cartesian_nearest" else "linear", **keywords, **options)
            if isinstance(result, dict):
                result = {name: values if name.endswith(("_all", "_final")) else values[order] for name, values in result.items()}
            self.compare(result, group)

    def test_functions_agree_with_kwave_in_every_record(self):
        for number, (case, name) in enumerate(CASES):
            with self.subTest(case=case, group=name):
                self.check(case, name, ranks=1 + number % 2)

    @pytest.mark.extended
    def test_imported_files_have_one_plane_on_any_number_of_ranks(self):
        for ranks, (case, name) in enumerate(CASES[:3], 1):
            with self.subTest(case=case), h5py.File(DATA / f"{case}_reference.h5") as file:
                code, output = import_kwave(self.folder, str(DATA / f"{case}_study.mat"))
                self.assertEqual(code, 0, output)
                group = file[name]
                output = self.shearwake("kwave", "-i", self.folder / f"{case}_study.h5", "-o", self.folder / "out.h5", "--output_precision", "double",
                                        "-s", str(int(group.attrs.get("record_start_index", 1))), *flags_of(group.attrs["record"]), ranks=ranks).output
                self.assertEqual(f"note: one of the {ranks} ranks computes the plane" in output, ranks > 1)
                with h5py.File(self.folder / "out.h5") as out:
                    self.assertEqual([name for name in out if name.startswith(("uz", "Iz")) and "source" not in name], [])
                    inside = tuple(slice(n, -n) if case == "p0_2d" else slice(None) for n in (int(out[f"pml_{axis}_size"][0, 0, 0]) for axis in "xy"))
                    names = [name for name in out if isinstance(out[name], h5py.Group) or out[name].size > 1]
                    boxes = range(1, 4) if name == "corners" else [None]
                    found = [{name: out[f"{name}/{box}"][()].T[:, :, 0] if box else out[name][0].T[inside] if name.endswith(("_all", "_final"))
                              else out[name][0].T for name in names} for box in boxes]
                    self.compare(found, group)


def derivative(values, axis, spacing_m, side):
    k = 2.0 * numpy.pi * numpy.fft.fftfreq(values.shape[axis], spacing_m)
    factor = 1j * k * numpy.exp(0.5j * side * k * spacing_m)
    return numpy.real(numpy.fft.ifft(numpy.fft.fft(values, axis=axis) * (factor[:, None] if axis == 0 else factor), axis=axis))


def mean(values, axis):
    return 0.5 * (values + numpy.concatenate([values.take(range(1, values.shape[axis]), axis), values.take([-1], axis)], axis))


def corner_mean(values):
    found = 1.0 / mean(mean(1.0 / values, 0), 1)
    found[-1], found[:, -1] = values[-1], values[:, -1]
    return found


def slow(s):
    """p, ux, uy of every step and node by the equations of pstdElastic2D, with all split parts. `s.parts`: (field, is dirichlet, mask,
    values (step, node) for each split part)."""
    d, dt = s.spacing_m, s.dt_s
    mu, lam = s.rho * s.c_s ** 2, s.rho * (s.c_p ** 2 - 2.0 * s.c_s ** 2)
    neper = 100.0 * (1e-6 / (2.0 * numpy.pi)) ** 2 / (20.0 * numpy.log10(numpy.e))
    eta = 2.0 * s.rho * s.c_s ** 3 * s.alpha[1] * neper
    chi = 2.0 * s.rho * s.c_p ** 3 * s.alpha[0] * neper - 2.0 * eta
    rho, mu_xy, eta_xy = [mean(s.rho, 0), mean(s.rho, 1)], corner_mean(mu), corner_mean(eta) if eta.any() else eta
    factors = {}
    for axis in (0, 1):
        n, size, at = s.rho.shape[axis], s.layer[axis], numpy.arange(s.rho.shape[axis])
        for half in (0.0, 0.5):
            depth = numpy.where(at < size, size - at - half, numpy.where(at >= n - size, at - n + size + 1 + half, 0.0)) / size
            for ratio in (1.0, s.ratio):
                values = numpy.exp(-0.5 * dt * ratio * s.strength[axis] * s.c_ref / d[axis] * depth ** 4)
                factors[axis, half, ratio == 1.0] = values[:, None] if axis == 0 else values
    places = {"ux": (0.5, 0.0), "uy": (0.0, 0.5), "sxx": (0.0, 0.0), "syy": (0.0, 0.0), "sxy": (0.5, 0.5)}
    damping = {(field, part): factors[0, half[0], part == 0] * factors[1, half[1], part == 1] for field, half in places.items() for part in (0, 1)}
    split = {key: numpy.zeros(s.rho.shape) for key in damping}

    def update(field, part, rate):
        split[field, part] = damping[field, part] * (damping[field, part] * split[field, part] + dt * rate)

    def total(field):
        return split[field, 0] + split[field, 1]

    def drive(fields, step):
        for field, is_dirichlet, mask, values in s.parts:
            if field in fields and step < len(values):
                for part in ((0, 1) if field[0] == "s" else ("xy".index(field[1]),)):
                    split[field, part][mask] = values[step] + (0.0 if is_dirichlet else split[field, part][mask])
    results = []
    for step in range(s.steps):
        g = {("ux", 0): derivative(total("sxx"), 0, d[0], 1), ("ux", 1): derivative(total("sxy"), 1, d[1], -1),
             ("uy", 0): derivative(total("sxy"), 0, d[0], -1), ("uy", 1): derivative(total("syy"), 1, d[1], 1)}
        rates = {}
        for a, field in enumerate(("ux", "uy")):
            for part in (0, 1):
                update(field, part, g[field, part] / rho[a])
            rates[field] = (g[field, 0] + g[field, 1]) / rho[a]
        drive(("ux", "uy"), step)
        e, de = ({(i, j): derivative(of(f"u{'xy'[i]}"), j, d[j], -1 if i == j else 1) for i in (0, 1) for j in (0, 1)}
                 for of in (total, rates.__getitem__))
        for i, field in ((0, "sxx"), (1, "syy")):
            for j in (0, 1):
                update(field, j, (lam + 2.0 * mu if i == j else lam) * e[j, j] + (chi + 2.0 * eta if i == j else chi) * de[j, j])
        update("sxy", 0, mu_xy * e[1, 0] + eta_xy * de[1, 0])
        update("sxy", 1, mu_xy * e[0, 1] + eta_xy * de[0, 1])
        drive(("sxx", "syy", "sxy"), step)
        results.append((-0.5 * (total("sxx") + total("syy")), total("ux"), total("uy")))
    return numpy.stack(results, axis=-1)


class Scheme(FunctionsTest):
    def setUp(self):
        super().setUp()
        random = numpy.random.default_rng(5)
        x, y = numpy.indices((24, 21))
        lower = (x + y > 22).astype(float)
        self.random = random
        self.s = types.SimpleNamespace(spacing_m=(1e-4, 1.3e-4), dt_s=8e-9, steps=60, layer=(6, 5), strength=(1.5, 2.5), ratio=0.2,
                                       rho=1000.0 + 150.0 * lower, c_p=1600.0 + 300.0 * lower, c_s=700.0 + 200.0 * lower,
                                       alpha=(2.0, 4.0), c_ref=1900.0, parts=[])
        self.options = {"pml_size": [6, 5], "pml_alpha": [1.5, 2.5], "multi_axial_pml_ratio": 0.2}

    def check(self, source, **options):
        s = self.s
        kgrid = {"Nx": 24, "Ny": 21, "dx": s.spacing_m[0], "dy": s.spacing_m[1], "dt": s.dt_s, "Nt": s.steps}
        medium = {"sound_speed_compression": s.c_p, "sound_speed_shear": s.c_s, "density": s.rho,
                  "alpha_coeff_compression": s.alpha[0], "alpha_coeff_shear": s.alpha[1]}
        found = pstd_elastic_2d(kgrid, medium, source, {"record": ["p", "u"]}, quiet=True, **{**self.options, **options})
        expected = slow(s)
        scale_u = numpy.abs(expected[1:]).max()
        for values, name, scale in zip(expected, ("p", "ux", "uy"), (numpy.abs(expected[0]).max(), scale_u, scale_u)):
            self.assertGreater(scale, 0.0)
            numpy.testing.assert_allclose(found[name].reshape(values.shape), values, rtol=0.0, atol=TOLERANCE * scale, err_msg=name)

    def scale(self, mask, axis=0):
        return 2.0 * self.s.c_p[mask] * self.s.dt_s / self.s.spacing_m[axis]

    @pytest.mark.extended
    def test_stress_sources_inside_the_layer(self):
        """Where the layers meet, the parts of a stress decay differently."""
        mask = self.random.random((24, 21)) < 0.3
        series = self.random.standard_normal((numpy.count_nonzero(mask), 20))
        for mode in ("additive", "dirichlet"):
            self.s.parts = [(field, mode == "dirichlet", mask, sign * (series.T * (self.scale(mask) if mode == "additive" else 1.0)) / 2.0)
                            for field, sign in (("sxx", 1.0), ("syy", -2.0), ("sxy", 0.5))]
            self.check({"s_mask": mask, "s_mode": mode, "sxx": series, "syy": -2.0 * series, "sxy": 0.5 * series})

    @pytest.mark.extended
    def test_labelled_velocity_sources_have_the_speed_of_the_first_nodes(self):
        """Of the nodes with x fastest the number of the label."""
        labels = numpy.zeros((24, 21))
        labels[10:14, 3:9] = self.random.integers(1, 4, (4, 6))
        mask, series = labels > 0, self.random.standard_normal((3, 70))
        first = tuple(numpy.argwhere(mask.T)[:3, ::-1].T)
        for axis, field in enumerate(("ux", "uy")):
            scaled = series * self.scale(first, axis)[:, None]
            self.s.parts.append((field, False, mask, scaled[labels[mask].astype(int) - 1].T))
        self.check({"u_mask": labels, "ux": series, "uy": series})

    @pytest.mark.extended
    def test_sources_without_scaling_are_not_divided_among_the_parts(self):
        mask = numpy.zeros((24, 21), dtype=bool)
        mask[9:12, 8] = True
        wave = self.random.standard_normal((1, 30))
        self.s.parts = [("sxx", False, mask, wave.T), ("uy", False, mask, wave.T)]
        self.check({"s_mask": mask, "sxx": wave, "u_mask": mask, "uy": wave}, scale_source_terms=False)

    @pytest.mark.extended
    def test_initial_pressure_that_is_prescribed_and_initial_pressure_without_scaling(self):
        p0 = self.random.standard_normal((24, 21))
        everywhere = numpy.ones((24, 21), dtype=bool)
        for mode, parts in (("dirichlet", 2.0), ("additive", 1.0)):
            self.s.parts = [(field, mode == "dirichlet", everywhere, numpy.stack(2 * [-0.5 * p0[everywhere] / parts])) for field in ("sxx", "syy")]
            self.check({"p0": p0, "s_mode": mode}, smooth=False, scale_source_terms=mode == "dirichlet")

    @pytest.mark.extended
    def test_smoothing_follows_the_enlargement(self):
        """k-Wave smooths speeds and density on the enlarged grid; the layer has the unsmoothed speed."""
        mask = numpy.zeros((24, 21), dtype=bool)
        mask[12, 10] = True
        given = types.SimpleNamespace(**vars(self.s))
        pads = [(6, 6), (5, 5)]

        def smoothed(values):
            values = numpy.pad(values, pads, mode="edge")
            points = [n + 1 - n % 2 for n in values.shape]
            radius = numpy.sqrt(sum(axis ** 2 for axis in numpy.meshgrid(*[numpy.linspace(-1.0, 1.0, n)[:m] for n, m in zip(points, values.shape)],
                                                                         indexing="ij")))
            at = numpy.linspace(-1.0, 1.0, max(points))
            angle = numpy.pi * (at + 1.0)
            window = numpy.interp(radius, at, 0.42 - 0.5 * numpy.cos(angle) + 0.08 * numpy.cos(2.0 * angle), right=0.0)
            return numpy.real(numpy.fft.ifft2(numpy.fft.fft2(values) * numpy.fft.ifftshift(numpy.abs(window))))
        wave = numpy.sin(0.3 * numpy.arange(40.0))[None]
        s = self.s
        s.rho, s.c_p, s.c_s = smoothed(given.rho), smoothed(given.c_p), smoothed(given.c_s)
        large = numpy.pad(mask, pads)
        s.parts = [("ux", False, large, wave.T * 2.0 * s.c_p[large] * s.dt_s / s.spacing_m[0])]
        expected = slow(s)[:, 6:-6, 5:-5]
        self.s = given
        found = pstd_elastic_2d({"N": [24, 21], "spacing": given.spacing_m, "dt": s.dt_s, "Nt": s.steps},
                                {"sound_speed_compression": given.c_p, "sound_speed_shear": given.c_s, "density": given.rho,
                                 "alpha_coeff_compression": 2.0, "alpha_coeff_shear": 4.0}, {"u_mask": mask, "ux": wave},
                                {"record": ["p", "p_final"]}, quiet=True, smooth=[1, 1, 1], pml_inside=False, **self.options)
        numpy.testing.assert_allclose(found["p"].reshape(expected[0].shape), expected[0], rtol=0, atol=TOLERANCE * numpy.abs(expected[0]).max())
        numpy.testing.assert_array_equal(found["p_final"], found["p"].reshape(24, 21, -1)[..., -1])

    def test_sensors_and_defaults(self):
        """Points at nodes and between two of them, an axis as good as the other, and the layer of 20 points in two dimensions."""
        mask = numpy.zeros((48, 44))
        mask[24, 20:24] = 1.0
        wave = numpy.sin(0.4 * numpy.arange(25.0))[None]
        kgrid = {"Nx": 48, "Ny": 44, "dx": 1e-3, "dy": 1.2e-3, "dt": 1e-5, "Nt": 40}
        medium = {"sound_speed_compression": 20.0, "sound_speed_shear": 5.0, "density": 1000.0}
        source = {"u_mask": mask, "ux": wave}
        everything = pstd_elastic_2d(kgrid, medium, source, {"record": ["p", "u", "u_split_field"]}, quiet=True)
        p = everything["p"].reshape(48, 44, -1)
        self.assertEqual(sorted(everything), ["p", "ux", "ux_split_p", "ux_split_s", "uy", "uy_split_p", "uy_split_s"])
        places = numpy.array([[1e-3, -2.5e-3], [0.0, 1.2e-3]])  # x = 0 is node N/2 counted from 0
        points = pstd_elastic_2d(kgrid, medium, source, {"mask": places}, quiet=True, pml_size=20, pml_alpha=[2, 2])["p"]
        numpy.testing.assert_allclose(points, [p[25, 22], 0.5 * (p[21, 23] + p[22, 23])], rtol=0, atol=1e-14 * numpy.abs(p).max())
        boxes = pstd_elastic_2d(kgrid, medium, source, {"mask": numpy.array([[23, 22, 24, 25], [24, 21, 24, 21]]).T}, quiet=True)
        numpy.testing.assert_array_equal(boxes[0]["p"], p[22:24, 21:25])
        self.assertEqual(boxes[1]["p"].shape, (1, 1, 40))
        turned = pstd_elastic_2d({"Nx": 44, "Ny": 48, "dx": 1.2e-3, "dy": 1e-3, "dt": 1e-5, "Nt": 40}, medium, {"u_mask": mask.T, "uy": wave},
                                 {"mask": numpy.ones((44, 48))}, quiet=True)["p"].reshape(44, 48, -1)
        numpy.testing.assert_allclose(turned, p.transpose(1, 0, 2), rtol=0, atol=1e-13 * numpy.abs(p).max())

    @pytest.mark.extended
    def test_a_plane_equals_a_uniform_box_outside_the_layer(self):
        """Except for the pressure, which has another definition."""
        plane = pstd_elastic_2d({name: value for name, value in BOX["kgrid"].items() if "z" not in name}, BOX["medium"],
                                {"u_mask": BOX["mask"], "uy": BOX["wave"]}, {"record": ["u"]}, quiet=True, pml_size=5)
        volume = box_velocities("uy")
        for name, values in plane.items():
            numpy.testing.assert_allclose(values.reshape(volume[name].shape), volume[name], rtol=0, atol=1e-13 * numpy.abs(volume["uy"]).max())

    def test_faults_are_named(self):
        kgrid = {"Nx": 24, "Ny": 22, "dx": 1e-3, "dy": 1e-3, "dt": 1e-5, "Nt": 10}
        medium = {"sound_speed_compression": 20.0, "sound_speed_shear": 5.0, "density": 1000.0}
        mask = numpy.zeros((24, 22))
        mask[12, 11] = 1.0
        parts = {"kgrid": kgrid, "medium": medium, "source": {"u_mask": mask, "ux": [[1.0]]}, "sensor": {"mask": mask}}
        for words, change, options in (
                ("kgrid is not two-dimensional", {"kgrid": {**kgrid, "Nz": 20, "dz": 1e-3}}, {}),
                ("source.uz is not a field that pstdElastic2D uses", {"source": {"u_mask": mask, "uz": [[1.0]]}}, {}),
                (r"medium.density has the shape \(22, 24\); it must be one number, or have the shape \(24, 22\)",
                 {"medium": {**medium, "density": numpy.ones((22, 24))}}, {}),
                (r"source.u_mask has the shape \(24, 23\)", {"source": {"u_mask": numpy.ones((24, 23)), "ux": [[1.0]]}}, {}),
                (r"sensor.mask has the shape \(3, 4\); .*it appears to be transposed", {"sensor": {"mask": numpy.ones((3, 4))}}, {}),
                ("x1, y1, x2, y2 with x1 <= x2 and y1 <= y2", {"sensor": {"mask": [[9], [9], [9], [8]]}}, {}),
                ("outside of the grid", {"sensor": {"mask": [[1.0], [1.0]]}}, {}),
                ("options.PMLSize must be one number or two", {}, {"pml_size": [3, 4, 5]}),
                ("options.PMLSize is 20 along x", {}, {}),
                ("axisymmetric is not supported", {}, {"axisymmetric": True})):
            with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
                pstd_elastic_2d(**{**parts, **change}, quiet=True, **{**({} if words.endswith("along x") else {"pml_size": 5}), **options})
        with self.assertRaisesRegex(ValueError, "kgrid is not three-dimensional"):
            pstd_elastic_3d(**parts, quiet=True)


@pytest.mark.extended
class Files(KWaveTest, FunctionsTest):
    def plane_file(self, change):
        code, output = import_kwave(self.folder, str(DATA / "layered_2d_study.mat"))
        self.assertEqual(code, 0, output)
        self.contains(output, "64 x 72 nodes, 220 steps", "PMLSize 10, 8, inside", "x 20 to 22, y 36 to 38")
        path = self.folder / "layered_2d_study.h5"
        with h5py.File(path, "a") as file:
            change(file)
        return path

    def test_motion_along_z_is_computed_if_a_source_drives_it(self):
        """Shear waves that are polarised along z, as in a box that does not vary along z."""
        mask = BOX["mask"]
        plane = {name: value for name, value in BOX["kgrid"].items() if "z" not in name}
        scipy.io.savemat(self.folder / "plane.mat", {"kgrid": plane, "medium": BOX["medium"], "source": {"u_mask": mask, "ux": BOX["wave"]},
                                                     "sensor": {"mask": numpy.ones(mask.shape)}, "options": {"PMLSize": 5.0}})
        self.assertEqual(import_kwave(self.folder, "plane.mat")[0], 0)
        with h5py.File(self.folder / "plane.h5", "a") as file:
            file["uz_source_flag"][...], file["ux_source_flag"][...] = file["ux_source_flag"][()], 0
            file.move("ux_source_input", "uz_source_input")
        self.run_file(self.folder / "plane.h5", "--u_raw", "--output_precision", "double", ranks=2)
        expected = box_velocities("uz")["uz"]
        with h5py.File(self.folder / "out.h5") as out:
            found = out["uz"][0].T.reshape(expected.shape[1::-1] + expected.shape[2:]).transpose(1, 0, 2)
            numpy.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * numpy.abs(expected).max())
            self.assertEqual(numpy.abs(out["ux"][()]).max(), 0.0)

    def test_layers_along_z_are_refused(self):
        for name, value, *words in (("pml_z_size", 1, "pml_z_size is 1; it must be at most 0"),
                                    ("pml_z", 0.5, "pml_z is 0.5 at index 1; it must be 1: a plane has no absorbing layer along z"), ("Nx", 1, "Nx is 1; it must be 2")):
            def change(file, name=name, value=value):
                file[name][0, 0, 0] = value
            self.contains(self.run_file(self.plane_file(change), expect=1), *words)

    def test_messages_count_the_axes_of_kwave(self):
        def change(file):
            file["rho0_sgy"][0, 4, 2] = -1.0
        self.contains(self.run_file(self.plane_file(change), expect=1), "rho0_sgy is -1 at index (3, 5, 1)")
