# SPDX-License-Identifier: BSD-3-Clause
"""Imports k-Wave simulations and runs the files; the fields must equal those computed by k-Wave."""
import os
import shlex
import types

import h5py
import numpy
import pytest
import scipy.io

from kwave import FIELDS, POINTS, import_kwave, in_matlab_order, nodes_of, reference, save, structures_of
from program import PROGRAM, ROOT, ProgramTest, environment
from shearwake.kwave.record import NAMES


class ImportTest(ProgramTest):
    def imported(self, structures, *words, expect=0):
        save(self.folder / "study.mat", structures)
        code, output = import_kwave(self.folder, "study.mat", *words)
        self.assertEqual(code, expect, output)
        return output

    def run_printed(self, output, *words, ranks=1):
        """Runs the command that the import has printed, and returns the path of its output."""
        printed = shlex.split(output.splitlines()[-1].removeprefix("next: shearwake "))
        self.shearwake(*printed, "--output_precision", "double", *words, ranks=ranks)
        return self.folder / printed[printed.index("-o") + 1]

    def worst(self, output, of):
        """The largest difference of the sensor traces from those of k-Wave, relative to their largest value. Each of the five cuboids is
        a node."""
        traces = dict(zip(FIELDS, numpy.moveaxis(of["traces"], 2, 0)))
        traces["p"] = -(traces["sxx"] + traces["syy"] + traces["szz"]) / 3.0
        with h5py.File(output) as file:
            return max(numpy.abs(numpy.stack([file[name][f"{n + 1}"][:, 0, 0, 0] for n in range(5)]) - traces[name]).max() /
                       numpy.abs(traces[name]).max() for name in ("p", "ux", "uy", "uz"))


class Imported(ImportTest):
    @pytest.mark.long
    def test_double_precision_agrees_with_kwave(self):
        for run, ranks in (("a_additive_pml10", 1), ("a_additive_pmloff", 3), ("c_dirichlet_pml10", 2), ("c_dirichlet_pmloff", 1)):
            with self.subTest(run=run):
                of = reference(run)
                output = self.imported(structures_of(run, of), "--out", run)
                self.contains(output, "48 x 40 x 32 nodes, 400 steps", "5 sensor nodes",
                              f"next: shearwake kwave -i {run}.h5 -o {run}-output.h5 --p_raw --u_raw -s 1")
                self.assertLess(self.worst(self.run_printed(output, ranks=ranks), of), 1e-12)  # rounding errors of 400 steps

    def test_single_precision_agrees_with_kwave(self):
        of = reference("a_additive_pml10")
        worst = self.worst(self.run_printed(self.imported(structures_of("a_additive_pml10", of)), "--precision", "single"), of)
        self.assertLess(worst, 1e-4)  # 400 steps with rounding errors of 6e-8
        self.assertGreater(worst, 1e-9, "it was computed in double precision")

    @pytest.mark.long
    def test_a_constant_medium_given_at_every_node_equals_a_uniform_medium(self):
        of = reference("a_additive_pml10")
        structures = structures_of("a_additive_pml10", of)
        ones = numpy.ones(POINTS)
        structures["medium"] = {name: value * ones for name, value in structures["medium"].items()}
        self.assertLess(self.worst(self.run_printed(self.imported(structures), ranks=2), of), 1e-12)


class Records(ImportTest):
    """The output has what pstd_elastic_3d returns, which tests/end_to_end/test_kwave_functions.py compares with k-Wave."""

    def results(self, **sensor):
        """The structures of a study of six stresses in a lossy medium, and what the function returns."""
        structures = scipy.io.loadmat(ROOT / "tests" / "data" / "kwave" / "stress_lossy_study.mat", simplify_cells=True)
        structures = {name: structures[name] for name in ("kgrid", "medium", "source", "sensor", "options")}
        options = structures["options"] = dict(zip(structures["options"][::2], structures["options"][1::2]))
        structures["sensor"].update(sensor)
        os.environ.update(environment(), SHEARWAKE=str(PROGRAM))
        parts = [types.SimpleNamespace(**structures[name]) for name in ("kgrid", "medium", "source", "sensor")]
        return structures, in_matlab_order(*parts, pml_size=options["PMLSize"], multi_axial_pml_ratio=options["MultiAxialPMLRatio"])

    def equal(self, output, expected):
        with h5py.File(output) as file:
            for name, values in expected.items():
                found = file[name][()].T  # (x, y, z) of entire grids, (point, time, 1) of records at points
                numpy.testing.assert_allclose(found.reshape(values.shape), values, rtol=0, atol=1e-12 * numpy.abs(values).max(), err_msg=name)

    @pytest.mark.extended
    def test_all_records_of_kwave(self):
        structures, expected = self.results(record=NAMES)
        output = self.run_printed(self.imported(structures), ranks=2)
        self.equal(output, expected)  # other sums of a velocity at the nodes: rounding errors
        with h5py.File(ROOT / "tests" / "data" / "kwave" / "stress_lossy_reference.h5") as file:
            of_kwave = {name: values[()].T for name, values in file["binary"].items()
                        if not name.startswith("sensor_") and not name.endswith("_final")}
        self.assertEqual(len(of_kwave), 20)
        self.equal(output, of_kwave)
        with h5py.File(output) as file:
            self.assertEqual(file["p"].attrs["data_type"], b"double")

    @pytest.mark.long
    def test_cartesian_points_on_several_ranks(self):
        at_m = numpy.array([[0.5e-3, 0.0, 1.1e-3], [-2.7e-3, 3e-3, -1.3e-3], [4e-3, 5e-3, 0.0]]).T
        structures, expected = self.results(mask=at_m, record=[name for name in NAMES if name != "u_split_field"])
        output = self.run_printed(self.imported(structures), "--copy_sensor_mask", ranks=3)
        self.equal(output, expected)
        with h5py.File(output) as file:
            self.assertEqual(file["sensor_mask_type"][0, 0, 0], 2)
            x = numpy.sum(file["sensor_mask_weights"][0] * nodes_of(file, "sensor_mask_index")[:, 0].reshape(3, 8), axis=1)
            numpy.testing.assert_allclose(x, at_m[0] / 1e-3 + 15, atol=1e-12)

    @pytest.mark.extended
    def test_mean_intensity_is_not_that_of_other_records(self):
        """The intensity needs series of p and u that the output does not contain."""
        _, expected = self.results(record=["I_avg", "p_max"])
        self.assertEqual(sorted(expected), ["Ix_avg", "Iy_avg", "Iz_avg", "p_max"])
        _, series = self.results(record=["I"])
        numpy.testing.assert_allclose(expected["Ix_avg"], series["Ix"].mean(axis=1), rtol=1e-12)


class Layout(ImportTest):
    """The content of the input file follows the rules of k-Wave."""

    def study(self, changes, *options):
        of = reference("a_additive_pml10")
        structures = structures_of("a_additive_pml10", of)
        for name, fields in changes.items():
            structures[name] = {field: value for field, value in {**structures.get(name, {}), **fields}.items()
                                if value is not None}
        output = self.imported(structures, *options)
        self.run_printed(output, "--benchmark", "2")
        return h5py.File(self.folder / "study.h5", "r")

    @pytest.mark.extended
    def test_file_has_64_bits_and_the_attributes_of_kwave(self):
        with self.study({"medium": {"alpha_coeff_compression": 3.0, "alpha_coeff_shear": 5.0}}) as file, \
                h5py.File(ROOT / "tests" / "data" / "kwave" / "stress_lossy_input.h5") as of_kwave:
            self.assertEqual(file.attrs["file_type"], b"input")
            other = {"u_source_index", "u_source_mode", "u_source_many", "uz_source_input", "sensor_mask_corners"}
            theirs = {name for name in of_kwave if not name.startswith("s_source") and not name.endswith("source_input")}
            self.assertEqual(set(file) ^ theirs, {*other, "sensor_mask_index"})
            for name in set(file) & theirs:
                kind, domain = of_kwave[name].attrs["data_type"], of_kwave[name].attrs["domain_type"]
                self.assertEqual((file[name].attrs["data_type"], file[name].attrs["domain_type"], file[name].dtype.itemsize),
                                 (b"double" if kind == b"float" else kind, domain, 8), name)

    @pytest.mark.extended
    def test_rows_of_labelled_masks_are_scaled_by_the_node_of_their_index(self):
        c_p = 20.0 + numpy.arange(48.0)[:, None, None] * numpy.ones(POINTS)
        mask = numpy.zeros(POINTS)
        mask[3, 5, 7], mask[9, 5, 7], mask[20, 6, 8] = 2, 1, 2
        series = numpy.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
        with self.study({"kgrid": {"dt": 5e-6}, "medium": {"sound_speed_compression": c_p},
                         "source": {"u_mask": mask, "uz": series}}) as file:
            numpy.testing.assert_array_equal(nodes_of(file, "u_source_index"), [[3, 5, 7], [9, 5, 7], [20, 6, 8]])
            # 2 c_p dt/dz; the first row uses c_p of the first node, the second row c_p of the second node.
            scales = numpy.array([2 * 29 * 5e-3, 2 * 23 * 5e-3, 2 * 29 * 5e-3])
            numpy.testing.assert_allclose(file["uz_source_input"][0].T, scales[:, None] * series[[1, 0, 1]], rtol=1e-14)

    @pytest.mark.extended
    def test_one_series_for_all_nodes_is_one_row(self):
        with self.study({"source": {"uz": numpy.ones((1, 4))}}) as file:
            self.assertEqual((file["uz_source_input"].shape, file["u_source_many"][0, 0, 0]), ((1, 4, 1), 0))

    def test_absorption_is_converted_to_viscosities(self):
        with self.study({"medium": {"alpha_coeff_compression": 3.0, "alpha_coeff_shear": 5.0}}) as file:
            # dB/(MHz^2 cm) to Np/(rad/s)^2/m: 1 dB is ln(10)/20 Np, 1/cm is 100/m.
            neper = 100 * numpy.log(10) / 20 * (1e-6 / (2 * numpy.pi)) ** 2
            eta = 2 * 1000 * 5.0 ** 3 * 5 * neper
            numpy.testing.assert_allclose(file["eta"][()], eta, rtol=1e-12)
            numpy.testing.assert_allclose(file["chi"][()], 2 * 1000 * 20.0 ** 3 * 3 * neper - 2 * eta, rtol=1e-12)

    @pytest.mark.extended
    def test_a_layer_outside_enlarges_the_grid(self):
        with self.study({"options": {"PMLInside": 0, "PMLSize": numpy.array([4.0, 5.0, 6.0])}}) as file:
            self.assertEqual([file[f"N{axis}"][0, 0, 0] for axis in "xyz"], [56, 50, 44])
            self.assertEqual(nodes_of(file, "u_source_index")[:, 2].min(), 13 + 6)
            numpy.testing.assert_array_equal(file["sensor_mask_corners"][0, 0, :3],
                                             reference("a_additive_pml10")["points_ijk0"][0] + [5, 6, 7])

    @pytest.mark.extended
    def test_initial_pressure_is_applied_in_two_steps(self):
        p0 = numpy.zeros(POINTS)
        p0[10, 11, 12] = 7.0
        with self.study({"source": {"u_mask": None, "uz": None, "u_mode": None, "p0": p0}, "options": {"Smooth": 0}}) as file:
            numpy.testing.assert_array_equal(nodes_of(file, "s_source_index"), [[10, 11, 12]])
            for field in ("sxx", "syy", "szz"):  # a sixth in each of the three split parts
                numpy.testing.assert_allclose(file[f"{field}_source_input"][()], [[[-7.0 / 6.0]] * 2], rtol=1e-15)
            self.assertEqual((file["p0_source_flag"][0, 0, 0], file["p0_source_input"][12, 11, 10]), (1, 7.0))

    @pytest.mark.extended
    def test_stress_sources_are_scaled_by_dx_and_dirichlet_sources_are_not_scaled(self):
        mask = numpy.zeros(POINTS)
        mask[3, 4, 5] = 1
        for mode, weight in (("additive", 2 * 20 * 1e-5 / 1e-3), ("dirichlet", 1.0)):
            with self.study({"source": {"u_mask": None, "uz": None, "u_mode": None, "s_mask": mask, "sxz": numpy.ones((1, 4)),
                                        "s_mode": mode}}) as file:
                numpy.testing.assert_allclose(file["sxz_source_input"][()], numpy.full((1, 4, 1), weight / 3.0), rtol=1e-14)
                self.assertEqual([file[f"{field}_source_flag"][0, 0, 0] for field in FIELDS], [0, 0, 0, 0, 0, 0, 0, 4, 0])
                self.assertEqual(file["s_source_mode"][0, 0, 0], int(mode == "additive"))
