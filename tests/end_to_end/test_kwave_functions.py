# SPDX-License-Identifier: BSD-3-Clause
"""shearwake.kwave.pstd_elastic_3d and pstdElastic3Dshearwake.m return what pstdElastic3D returns."""
import contextlib
import io
import json
import os
import sys
import types
import unittest
import unittest.mock

import h5py
import numpy
import pytest
import scipy.io

import shearwake
from kwave import in_matlab_order
from program import PROGRAM, ROOT, ProgramTest, environment
from shearwake.kwave import pstd_elastic_3d
from test_kwave_program import DATA, references

KEYWORDS = {"PMLSize": "pml_size", "PMLAlpha": "pml_alpha", "PMLInside": "pml_inside", "MultiAxialPMLRatio": "multi_axial_pml_ratio"}
# Largest difference relative to the largest value, measured as at most 1.1e-13 with the rounding errors of other FFTs. Grids
# and cuboids of the reference were stored with 32 bits (6e-8).
TOLERANCE, ROUNDED = 1e-12, 1e-7


def plain(value):
    if isinstance(value, numpy.ndarray) and value.dtype == object:
        return [plain(item) for item in value.ravel()]
    if isinstance(value, numpy.ndarray) and (value.size == 1 or value.dtype.kind == "U"):
        return value.ravel()[0].item()
    return value


def study(case):
    """The structures of a case, as namespaces, and its options as keywords."""
    file = scipy.io.loadmat(DATA / f"{case}_study.mat", struct_as_record=False)
    found = {}
    for name in ("kgrid", "medium", "source", "sensor"):
        one = file[name].ravel()[0]
        found[name] = types.SimpleNamespace(**{field: plain(getattr(one, field)) for field in one._fieldnames})
    options = plain(file["options"])
    return found, {KEYWORDS[name]: value for name, value in zip(options[::2], options[1::2])}


class KWaveObject:
    """Raises as the properties of kWaveMedium do."""

    def __init__(self, **fields):
        self.__dict__.update(fields)

    def __getattr__(self, name):
        raise NotImplementedError(name)


class FunctionsTest(ProgramTest):
    def setUp(self):
        super().setUp()
        os.environ.update(environment(), SHEARWAKE=str(PROGRAM))

    def compare(self, found, group, tolerance=TOLERANCE):
        in_plane = "Nz" not in group.file.attrs
        for name, number, _, expected, scale in references(group):
            values = numpy.asarray((found[number] if isinstance(found, list) else found)[name]).T  # entire grids are in the first
            if name.endswith(("_final", "_all")):
                values = values[(slice(None, None, 4),) * values.ndim]
            elif in_plane and values.ndim == 3:
                values = values[::6]
            numpy.testing.assert_allclose(values.reshape(expected.shape), expected, rtol=0.0, err_msg=name,
                                          atol=scale * (ROUNDED if expected.dtype == "f4" else tolerance))


class Functions(FunctionsTest):
    def result(self, case, group="binary", **options):
        found, keywords = study(case)
        with h5py.File(DATA / f"{case}_reference.h5") as file:
            one = file[group]
            found["sensor"].record = str(one.attrs["record"]).split()
            for name in ("sensor_mask_corners", "sensor_mask_positions"):
                if name in one:
                    found["sensor"].mask = one[name][()].T
            result = in_matlab_order(**found, **{**keywords, **options})
            self.compare([result] if isinstance(result, dict) and "corners" == group else result, one)
        return result

    def test_all_records_and_masks_agree_with_kwave(self):
        result = self.result("homogeneous", ranks=2)
        self.assertEqual((result["ux"].shape, result["Ix_avg"].shape, result["p_final"].shape), ((12, 116), (12,), (28, 25, 24)))
        self.result("homogeneous", "corners")
        self.result("homogeneous", "cartesian_linear")
        self.result("homogeneous", "cartesian_nearest", cart_interp="nearest")

    @pytest.mark.extended
    def test_sources_and_media_agree_with_kwave(self):
        self.result("p0_pml_outside")  # smoothed
        self.result("p0_pml_outside", "raw", smooth=False)
        self.result("stress_lossy")
        self.result("dirichlet")
        self.result("ewp_3d", "corners")
        self.result("plane_wave")

    @pytest.mark.extended
    def test_objects_may_be_dictionaries_and_raise_for_missing_fields(self):
        found, keywords = study("stress_lossy")
        expected = pstd_elastic_3d(**found, quiet=True, **keywords)["p"]
        result = pstd_elastic_3d(found["kgrid"], vars(found["medium"]), KWaveObject(**vars(found["source"])), found["sensor"], quiet=True, **keywords)
        numpy.testing.assert_allclose(result["p"], expected, rtol=0, atol=1e-12 * numpy.abs(expected).max())

    def test_faults_are_value_errors(self):
        found, keywords = study("homogeneous")

        def refused(words, change=None, **options):
            parts, _ = study("homogeneous")
            if change:
                change(parts)
            with self.assertRaisesRegex(ValueError, words):
                pstd_elastic_3d(parts["kgrid"], parts["medium"], parts["source"], parts["sensor"], quiet=True, **{**keywords, **options})
        for field in ("ux", "sxx", "p0", "u_mask"):
            refused(f"source.{field} contains complex numbers", lambda parts, field=field: setattr(parts["source"], field, [1.0, 1j]))
        refused("q_max", lambda parts: setattr(parts["sensor"], "record", ["q_max"]))
        refused("pml_thickness", pml_thickness=3)
        refused("time_reversal_boundary_data is not supported",
                lambda parts: setattr(parts["sensor"], "time_reversal_boundary_data", numpy.ones((12, 120))))
        refused("medium.alpha_power", lambda parts: setattr(parts["medium"], "alpha_power", 1.5))
        refused("use_sg", use_sg=False)
        for field, value in (("use_fd", 2), ("axisymmetric", True), ("pml_auto", True), ("save_to_disk_exit", True), ("save_only", True)):
            refused(f"{field} is not supported", **{field: value})
        refused("precision must be", precision="half")
        refused("data_cast must be", data_cast="int8")
        for ranks in (0, 1.5, "two"):
            refused("number of ranks", ranks=ranks)
        refused("number of ranks", num_threads=0)
        refused("three-dimensional", lambda parts: setattr(parts["kgrid"], "Nz", 1))
        refused("outside of the grid", lambda parts: setattr(parts["sensor"], "mask", numpy.full((3, 2), 1.0)))
        with self.assertRaisesRegex(shearwake.ShearwakeError, "unstable in this medium"):
            pstd_elastic_3d({**vars(found["kgrid"]), "dt": 1e-3}, found["medium"], found["source"], found["sensor"], quiet=True, **keywords)
        with self.assertRaises(shearwake.ShearwakeError):
            pstd_elastic_3d(found["kgrid"], found["medium"], found["source"], found["sensor"], quiet=True, launch=["false"], **keywords)

    def small(self, **changes):
        """A fluid over a lossy solid, 20 x 18 x 16 nodes, with a source of six velocities."""
        points = (20, 18, 16)
        c_s = numpy.zeros(points)
        c_s[9:] = 800.0
        mask = numpy.zeros(points)
        mask[5, 7:9, 6:9] = 1.0
        wave = numpy.sin(0.3 * numpy.arange(30.0))
        fields = {"kgrid": {"Nx": 20, "Ny": 18, "Nz": 16, "dx": 1e-4, "dy": 1.1e-4, "dz": 0.9e-4, "dt": 5e-9, "Nt": 60},
                  "medium": {"sound_speed_compression": numpy.where(c_s > 0, 2000.0, 1500.0), "sound_speed_shear": c_s,
                             "density": numpy.where(c_s > 0, 1200.0, 1000.0), "alpha_coeff_compression": 0.1,
                             "alpha_coeff_shear": numpy.where(c_s > 0, 0.5, 0.0)},
                  "source": {"u_mask": mask, "ux": numpy.arange(1.0, 7.0)[:, None] * wave},
                  "sensor": {"mask": numpy.ones(points), "record": ["p", "u"]}}
        for name, change in changes.items():
            if name in fields and isinstance(change, dict):
                fields[name].update(change)
            elif name in fields:
                fields[name] = change
        options = {name: value for name, value in changes.items() if name not in fields}
        return pstd_elastic_3d(**fields, quiet=True, **{"pml_size": 4, **options})

    @pytest.mark.extended
    def test_progress_is_one_line_to_its_end(self):
        for ranks in (1, 2):
            with contextlib.redirect_stdout(io.StringIO()) as output:
                self.small(ranks=ranks, progress=True)
            bars = output.getvalue().split("\r")
            self.assertEqual((bars[0], bars[1], bars[-1]), ("", "[#" + 19 * " " + "]   5 %", "[" + 20 * "#" + "] 100 %\n"))
            self.assertEqual(len(bars), 21)
        with contextlib.redirect_stdout(io.StringIO()) as output:
            self.small(launch=["sh", "-c", 'head -c 200000 /dev/zero >&2; exec "$@"', "sh"])  # more than a pipe holds
        self.assertEqual(output.getvalue(), "")

    @pytest.mark.extended
    def test_objects_of_kwave_python_and_folders_with_marks_of_the_shell(self):
        class Grid:  # properties as in kWaveGrid
            N, spacing, dim, dt, Nt, nonuniform = numpy.array([20, 18, 16]), numpy.array([1e-4, 1.1e-4, 0.9e-4]), 3, 5e-9, 60, False

            @property
            def Nx(self):
                return self.N[0]

            @property
            def t_array(self):
                return numpy.expand_dims(numpy.arange(self.Nt) * self.dt, axis=0)

        folder = self.folder / "it's a $HOME of \"\u00fc\" & more"
        folder.mkdir()
        with unittest.mock.patch("tempfile.tempdir", str(folder)):
            result = self.small(kgrid=Grid(), ranks=2)
        self.assertEqual(list(folder.iterdir()), [])
        for name, values in self.small().items():  # other sums on two ranks
            numpy.testing.assert_allclose(result[name], values, rtol=0, atol=1e-14 * numpy.abs(values).max())

    @pytest.mark.extended
    def test_empty_mask_is_none(self):
        """As in a unit test of k-Wave, which records final velocities only."""
        result = self.small(sensor={"mask": numpy.zeros((0, 0)), "record": ["u_final"]})
        self.assertEqual({name: values.shape for name, values in result.items()}, dict.fromkeys(("ux_final", "uy_final", "uz_final"), (20, 18, 16)))

    @pytest.mark.extended
    def test_runs_in_a_notebook(self):
        code = """\
import numpy as np
from types import SimpleNamespace
from shearwake.kwave import pstd_elastic_3d
mask = np.zeros((16, 14, 12))
mask[8, 7, 6] = 1.0
result = pstd_elastic_3d(SimpleNamespace(Nx=16, Ny=14, Nz=12, dx=1e-3, dy=1e-3, dz=1e-3, dt=1e-5, Nt=40),
                         SimpleNamespace(sound_speed_compression=20.0, sound_speed_shear=5.0, density=1000.0),
                         SimpleNamespace(u_mask=mask, uz=1e-3 * np.sin(0.3 * np.arange(40))), SimpleNamespace(mask=mask), pml_size=3, ranks=2)
print(result["p"].shape)
"""
        cell = {"cell_type": "code", "execution_count": None, "id": "only", "metadata": {}, "outputs": [], "source": code}
        (self.folder / "study.ipynb").write_text(json.dumps({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))
        self.call(sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output", "done.ipynb", "study.ipynb",
                  env={**os.environ, "PYTHONPATH": str(ROOT / "analysis")})
        outputs = json.loads((self.folder / "done.ipynb").read_text(encoding="utf-8"))["cells"][0]["outputs"]
        text = "".join("".join(output.get("text", "")) for output in outputs)
        self.contains(text, "absorbing layer: 3, 3, 3 points, inside the grid", "] 100 %\n", "(1, 40)")

    def test_a_rank_without_points_takes_part_in_their_interpolation(self):
        point = {"mask": numpy.array([[3.2e-4], [0.3e-4], [-1.1e-4]]), "record": ["p", "u"]}  # in the half of the second rank
        one, two = (self.small(sensor=point, ranks=ranks) for ranks in (1, 2))
        for name, values in one.items():
            numpy.testing.assert_allclose(two[name], values, rtol=0.0, atol=TOLERANCE * numpy.abs(values).max(), err_msg=name)

    @pytest.mark.extended
    def test_identities_of_kwaves_own_tests(self):
        """What the unit tests of k-Wave's elastic code compare, with their limits 1e-14 and 1e-15 relative to the largest value."""
        records = ["p", "u", "u_non_staggered", "I", "I_avg", *(f"{quantity}_{what}" for quantity in "pu" for what in ("max", "min", "rms"))]
        everything = self.small(sensor={"record": [*records, "u_split_field"]})

        def same(found, expected, limit=1e-14):
            self.assertGreater(numpy.abs(expected).max(), 0.0)
            numpy.testing.assert_allclose(found, expected, rtol=0, atol=limit * numpy.abs(expected).max())

        nodes = numpy.array([[14, 11, 3], [5, 7, 6], [10, 9, 8]])  # in an order of their own
        rows = numpy.ravel_multi_index(nodes.T, (20, 18, 16))
        for axis in "xyz":  # the parts of the velocity add up to it, by construction to the last bit but one
            same(everything[f"u{axis}_split_p"] + everything[f"u{axis}_split_s"], everything[f"u{axis}_non_staggered"], 1e-15)
        # Cartesian points at nodes; x = 0 is node N/2 counted from 0.
        places = (nodes - numpy.array([10, 9, 8])) * numpy.array([1e-4, 1.1e-4, 0.9e-4])
        for interpolation in ("linear", "nearest"):
            points = self.small(sensor={"mask": places.T, "record": records}, cart_interp=interpolation)
            self.assertEqual(len(points), 25)
            for name, values in points.items():
                same(values, everything[name][rows])
        # Corners of cuboids.
        box = self.small(sensor={"mask": numpy.array([[6, 8, 7, 8, 10, 9]]).T})[0]
        for name, values in box.items():
            same(values, everything[name].reshape(20, 18, 16, -1)[5:8, 7:10, 6:9], 1e-15)
        # Labels in place of one series per node.
        wave = numpy.sin(0.3 * numpy.arange(30.0))
        labels = numpy.zeros((20, 18, 16))
        labels[5, 7:9, 6:9] = numpy.arange(1.0, 7.0).reshape(2, 3)
        labelled = self.small(source={"u_mask": labels, "ux": numpy.arange(1.0, 7.0)[:, None] * wave})
        same(labelled["p"], everything["p"], 1e-15)
        # An axis is as good as another: the same problem with x and z exchanged.
        turned = self.small(kgrid={"Nx": 16, "Nz": 20, "dx": 0.9e-4, "dz": 1e-4},
                            medium={name: numpy.where(numpy.arange(20) < 9, below, above) * numpy.ones((16, 18, 1)) for name, below, above in (
                                ("sound_speed_compression", 1500.0, 2000.0), ("sound_speed_shear", 0.0, 800.0), ("density", 1000.0, 1200.0),
                                ("alpha_coeff_shear", 0.0, 0.5))},
                            source={"u_mask": labels.T, "ux": None, "uz": numpy.arange(1.0, 7.0)[:, None] * wave},
                            sensor={"mask": numpy.ones((16, 18, 20))})
        expected = everything["uz"].reshape(20, 18, 16, -1).transpose(2, 1, 0, 3)
        same(turned["ux"].reshape(expected.shape), expected, 1e-13)  # other sums in the FFTs

    @pytest.mark.extended
    def test_labels_may_have_one_sample_each(self):
        """A matrix of one column has one row per label, and is not a transposed series."""
        labels = numpy.zeros((20, 18, 16))
        labels[5, 7:9, 6:9] = [[1, 2, 3], [3, 2, 1]]
        mask = numpy.minimum(labels, 1.0)
        labelled = self.small(source={"u_mask": labels, "ux": numpy.array([[1.0], [2.0], [3.0]])})
        each = self.small(source={"u_mask": mask, "ux": labels[mask > 0][:, None]})
        numpy.testing.assert_allclose(labelled["p"], each["p"], rtol=0, atol=1e-14 * numpy.abs(each["p"]).max())

    @pytest.mark.extended
    def test_fluid_equals_the_closed_form_of_a_point_source(self):
        """p = d/dt S(t - r/c) dx^3 / (4 pi r c^2), where S is the stress per time that a node receives. At a distance of 10 nodes the
        difference was 1.5 % and 0.37 % of the largest value for steps of 0.2 and 0.1 us, so it is the second-order error of time."""
        spacing_m, c, peak_Pa, width_s = 1e-3, 1500.0, 1e4, 2.2e-6
        source, sensor = numpy.zeros((48, 48, 48)), numpy.zeros((48, 48, 48))
        source[24, 24, 24] = sensor[24, 32, 30] = 1.0
        errors = []
        for step_s in (2e-7, 1e-7):
            times_s = step_s * numpy.arange(1, round(2.4e-5 / step_s) + 1)
            pulse = -peak_Pa * numpy.exp(-((times_s - 8e-6) / width_s) ** 2)[None]
            found = pstd_elastic_3d({"N": [48] * 3, "spacing": [spacing_m] * 3, "dt": step_s, "Nt": times_s.size},
                                    {"sound_speed_compression": c, "sound_speed_shear": 0.0, "density": 1000.0},
                                    {"s_mask": source, "sxx": pulse, "syy": pulse, "szz": pulse}, {"mask": sensor}, quiet=True)["p"][0]
            # A sample acts in the middle between the steps before and after it.
            phase = (times_s + 0.5 * step_s - 10.0 * spacing_m / c - 8e-6) / width_s
            expected = (2.0 * c / spacing_m * peak_Pa * spacing_m ** 3 / (4.0 * numpy.pi * c ** 2 * 10.0 * spacing_m) *
                        (-2.0 * phase / width_s) * numpy.exp(-phase ** 2))
            errors.append(numpy.abs(found - expected).max() / numpy.abs(expected).max())
        self.assertLess(errors[1], 0.005)
        self.assertAlmostEqual(errors[0] / errors[1], 4.0, delta=0.3)

    @pytest.mark.long
    def test_multi_axial_layer_is_stable_where_the_plain_layer_is_not(self):
        """As in a unit test of k-Wave: a fluid over a solid with the layer outside, in single precision. The final velocity is above or
        below 1/(c_p rho) = 4e-7 m/s; after 1500 steps 2e-3 and 1e-10 m/s were measured for 1 Pa."""
        points, step_s = (28, 20, 20), 1.5e-8
        c_s = numpy.zeros(points)
        c_s[14:] = 800.0
        p0 = numpy.zeros(points)
        p0[10, 10, 10] = 1.0
        final = [max(numpy.abs(values).max() for values in pstd_elastic_3d(
            {"N": points, "spacing": [1e-4] * 3, "dt": step_s, "Nt": 1500},
            {"sound_speed_compression": numpy.where(c_s > 0, 2000.0, 1500.0), "sound_speed_shear": c_s,
             "density": numpy.where(c_s > 0, 1200.0, 1000.0)}, {"p0": p0}, {"mask": p0, "record": ["u_final"]}, quiet=True,
            pml_inside=False, multi_axial_pml_ratio=ratio, precision="single").values()) for ratio in (0.0, 0.1)]
        self.assertGreater(final[0], 1e-5)
        self.assertLess(final[1], 1e-8)
