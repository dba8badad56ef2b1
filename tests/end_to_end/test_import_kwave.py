# SPDX-License-Identifier: BSD-3-Clause
"""Imports and runs k-Wave simulations; the fields must equal those computed by k-Wave."""
import os
import subprocess
import types
import unittest

import h5py
import numpy
import pytest
import scipy.io

from kwave import FIELDS, POINTS, import_kwave, reference, save, structures_of
from program import PATIENCE_s, PROGRAM, ROOT, ProgramTest, case_files, environment
from shearwake.kwave import pstd_elastic_3d
from shearwake.kwave.record import KWAVE


class ImportTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out" / "study"

    def imported(self, structures, *words, expect=0):
        save(self.folder / "study.mat", structures)
        code, said = import_kwave(self.folder, "study.mat", *words)
        self.assertEqual(code, expect, said)
        return said

    def worst(self, of, fields=tuple(FIELDS[:6])):
        """The largest difference of the sensor traces from those of k-Wave, relative to their largest value."""
        with h5py.File(case_files(self.out)[0], "r") as file:
            self.assertEqual(set(fields), set(FIELDS) & set(file["sensor"]))
            traces = [(file["sensor"][field][()], of["traces"][:, :, FIELDS.index(field)]) for field in fields]
        return max(numpy.abs(got - wanted).max() / numpy.abs(wanted).max() for got, wanted in traces)


class Imported(ImportTest):
    @pytest.mark.long
    def test_double_precision_agrees_with_kwave(self):
        for run, ranks in (("a_additive_pml10", 1), ("c_dirichlet_pml10", 2), ("c_dirichlet_pmloff", 1)):
            with self.subTest(run=run):
                of = reference(run)
                said = self.imported(structures_of(run, of), "--out", run)
                self.says(said, "48 x 40 x 32 nodes, 400 steps", "5 sensor nodes", f"next: shearwake run {run}.toml")
                self.out = self.folder / "out" / run
                self.shearwake("run", f"{run}.toml", ranks=ranks)
                self.assertLess(self.worst(of), 1e-12)  # rounding errors of 400 steps
                with h5py.File(case_files(self.out)[0], "r") as file:
                    impulse = file["impulse_mN_ms"]
                    self.assertTrue(numpy.isnan(impulse[()]))
                    self.assertIn(b"not a force on the surface", impulse.attrs["note"])

    def test_single_precision_agrees_with_kwave(self):
        of = reference("a_additive_pml10")
        self.imported(structures_of("a_additive_pml10", of), "--precision", "single")
        self.shearwake("run", "study.toml")
        worst = self.worst(of)
        self.assertLess(worst, 1e-4)  # 400 steps with rounding errors of 6e-8
        self.assertGreater(worst, 1e-9, "it was computed in double precision")

    def test_frames_show_the_displacement_of_the_driven_plane(self):
        of = reference("c_dirichlet_pmloff")
        self.imported(structures_of("c_dirichlet_pmloff", of))
        self.shearwake("run", "study.toml", "-S", "record.frames=true", "-S", "time.output_interval_us=10", ranks=2)
        with h5py.File(case_files(self.out)[0], "r") as file:
            frames, sensor = file["surface"]["u_z"][()], file["sensor"]
            at = [(n, int(sensor["i"][n]), int(sensor["j"][n])) for n in range(5) if int(sensor["k"][n]) == 13]
            self.assertTrue(at, "no sensor lies on the plane")
            for n, i, j in at:
                summed = 1e-5 * numpy.cumsum(sensor["uz"][n])
                shown = numpy.squeeze(frames)[:, i, j]
                scale = numpy.abs(summed).max()
                self.assertLess(numpy.abs(shown - summed).max(), 1e-6 * scale)  # frames may be float32

    @pytest.mark.long
    def test_a_stopped_study_is_resumed(self):
        of = reference("a_additive_pml10")
        self.imported(structures_of("a_additive_pml10", of))
        process = self.start_and_stop("run", "study.toml", "--checkpoint-steps", 1, ranks=2,
                                      faults={"PATH": "/checkpoints/*.h5", "CALL": "rename", "STOP_AT": 2})
        process.terminate()
        process.communicate(timeout=PATIENCE_s)
        self.assertEqual(case_files(self.out), [])
        self.shearwake("run", "study.toml")  # on another number of ranks
        self.assertLess(self.worst(of), 1e-12)

    @pytest.mark.long
    def test_a_constant_medium_given_at_every_node_equals_a_uniform_medium(self):
        of = reference("a_additive_pml10")
        structures = structures_of("a_additive_pml10", of)
        ones = numpy.ones(POINTS)
        structures["medium"] = {name: value * ones for name, value in structures["medium"].items()}
        self.imported(structures)
        self.shearwake("run", "study.toml", ranks=2)
        self.assertLess(self.worst(of), 1e-12)


class Records(ImportTest):
    """The case file has what pstd_elastic_3d returns, which tests/end_to_end/test_kwave_functions.py compares with k-Wave."""

    def results(self, **sensor):
        """The structures of a study of six stresses in a lossy medium, and what the function returns."""
        structures = scipy.io.loadmat(ROOT / "tests" / "data" / "kwave" / "stress_lossy_study.mat", simplify_cells=True)
        structures = {name: structures[name] for name in ("kgrid", "medium", "source", "sensor", "options")}
        options = structures["options"] = dict(zip(structures["options"][::2], structures["options"][1::2]))
        structures["sensor"].update(sensor)
        os.environ.update(environment(), SHEARWAKE=str(PROGRAM))
        parts = [types.SimpleNamespace(**structures[name]) for name in ("kgrid", "source", "sensor", "medium")]
        return structures, pstd_elastic_3d(*parts, quiet=True, pml_size=options["PMLSize"],
                                           multi_axial_pml_ratio=options["MultiAxialPMLRatio"])

    def equal(self, expected, tolerance):
        with h5py.File(case_files(self.out)[0]) as file:
            for name, values in expected.items():
                numpy.testing.assert_allclose(file["sensor"][name][()], values, rtol=0, atol=tolerance * numpy.abs(values).max(), err_msg=name)
            return {name: file["sensor"][name].attrs["units"] for name in expected}, file["sensor"]["x"][()] if "x" in file["sensor"] else None

    def test_all_records_of_kwave(self):
        structures, expected = self.results(record=KWAVE)
        self.imported(structures)
        self.shearwake("run", "study.toml", ranks=2)
        units, x_m = self.equal(expected, 1e-12)  # other sums of a velocity at the nodes: rounding errors
        self.assertEqual([units[name] for name in ("p_max_all", "ux_split_s", "Iy_avg")], [b"Pa", b"m/s", b"W/m2"])
        numpy.testing.assert_allclose(x_m[[0, 15]], [-15e-3, 0.0])
        with h5py.File(ROOT / "tests" / "data" / "kwave" / "stress_lossy_reference.h5") as file:
            of_kwave = {name: values[0] if len(values) == 1 else values[()].T for name, values in file["binary"].items()
                        if not name.startswith("sensor_") and not name.endswith("_final")}
        self.assertEqual(len(of_kwave), 20)
        self.equal(of_kwave, 1e-12)

    @pytest.mark.long
    def test_cartesian_points_on_several_ranks(self):
        at_m = numpy.array([[0.5e-3, 0.0, 1.1e-3], [-2.7e-3, 3e-3, -1.3e-3], [4e-3, 5e-3, 0.0]]).T
        structures, expected = self.results(mask=at_m, record=[name for name in KWAVE if name != "u_split_field"])
        self.imported(structures)
        self.shearwake("run", "study.toml", ranks=3)
        self.equal(expected, 1e-12)
        with h5py.File(case_files(self.out)[0]) as file:
            numpy.testing.assert_allclose(file["sensor"]["i"][()], at_m[0] / 1e-3 + 15, atol=1e-12)

    def test_different_spacings_along_x_and_y_are_computed_without_a_job(self):
        """The same study with permuted axes has a job."""
        points, steps = (10, 12, 14), 30
        mask = numpy.zeros(points)
        mask[5, 4:8, 6] = 1.0
        signal = numpy.sin(0.3 * numpy.arange(steps))[None, :]

        def study(order, field):
            spacings = numpy.array([1e-3, 1.5e-3, 1e-3])[list(order)]
            return {"kgrid": {**dict(zip(("Nx", "Ny", "Nz"), numpy.array(points)[list(order)])), "dt": 1e-5, "Nt": steps,
                              **dict(zip(("dx", "dy", "dz"), spacings))},
                    "medium": {"sound_speed_compression": 20.0, "sound_speed_shear": 5.0, "density": 1000.0},
                    "source": {"u_mask": mask.transpose(order), field: signal},
                    "sensor": {"mask": numpy.ones(points).transpose(order), "record": ["p"]}, "options": {"PMLSize": 3}}

        said = self.imported(study((0, 1, 2), "uy"))
        self.says(said, "kgrid.dx and kgrid.dy differ: no job is written")
        self.assertFalse((self.folder / "study.toml").exists())
        printed = said.splitlines()[-1].removeprefix("next: shearwake ")
        self.shearwake(*printed.split(), "--output_precision", "double")
        with h5py.File(self.folder / "study-output.h5") as file:
            found = file["p"][0].reshape(steps, *points[::-1]).transpose(0, 3, 2, 1)  # x is the fastest index of a row
        self.imported(study((0, 2, 1), "uz"))
        self.shearwake("run", "study.toml")
        with h5py.File(case_files(self.out)[0]) as file:
            expected = file["sensor"]["p"][()].T.reshape(steps, *numpy.array(points)[[1, 2, 0]]).transpose(0, 3, 1, 2)
        self.assertGreater(numpy.abs(expected).max(), 0.0)
        numpy.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * numpy.abs(expected).max())  # rounding errors
        # The job of that import remains beside a study without a job.
        self.says(self.imported(study((0, 1, 2), "uy")), "warning: study.toml is the job of another study")
        self.says(self.shearwake("check", "study.toml", expect=3).said, "domain.spacing_mm is 1, but the spacing of the study along y is")

    def test_mean_intensity_is_not_that_of_other_records(self):
        """The intensity needs series of p and u that the output does not contain."""
        _, expected = self.results(record=["I_avg", "p_max"])
        self.assertEqual(sorted(expected), ["Ix_avg", "Iy_avg", "Iz_avg", "p_max"])
        _, series = self.results(record=["I"])
        numpy.testing.assert_allclose(expected["Ix_avg"], series["Ix"].mean(axis=1), rtol=1e-12)


class Studies(ImportTest):
    """The content of the study file follows the rules of k-Wave."""

    def study(self, changes, *options):
        of = reference("a_additive_pml10")
        structures = structures_of("a_additive_pml10", of)
        for name, fields in changes.items():
            structures[name] = {field: value for field, value in {**structures.get(name, {}), **fields}.items()
                                if value is not None}
        self.imported(structures, *options)
        self.says(self.shearwake("check", "study.toml").said, "no errors")
        return h5py.File(self.folder / "study.h5", "r")

    def test_rows_of_labelled_masks_are_scaled_by_the_node_of_their_index(self):
        c_p = 20.0 + numpy.arange(48.0)[:, None, None] * numpy.ones(POINTS)
        mask = numpy.zeros(POINTS)
        mask[3, 5, 7], mask[9, 5, 7], mask[20, 6, 8] = 2, 1, 2
        series = numpy.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
        with self.study({"kgrid": {"dt": 5e-6}, "medium": {"sound_speed_compression": c_p},
                         "source": {"u_mask": mask, "uz": series}}) as study:
            source = study["source_0"]
            numpy.testing.assert_array_equal(source["nodes"][()], [[3, 5, 7], [9, 5, 7], [20, 6, 8]])
            numpy.testing.assert_array_equal(source["rows"][()], [1, 0, 1])
            # 2 c_p dt/dz; the first row uses c_p of the first node, the second row c_p of the second node.
            numpy.testing.assert_allclose(source["weights"][()], [2 * 29 * 5e-3, 2 * 23 * 5e-3, 2 * 29 * 5e-3],
                                          rtol=1e-14)

    def test_absorption_is_converted_to_viscosities(self):
        with self.study({"medium": {"alpha_coeff_compression": 3.0, "alpha_coeff_shear": 5.0}}) as study:
            # dB/(MHz^2 cm) to Np/(rad/s)^2/m: 1 dB is ln(10)/20 Np, 1/cm is 100/m.
            neper = 100 * numpy.log(10) / 20 * (1e-6 / (2 * numpy.pi)) ** 2
            eta = 2 * 1000 * 5.0 ** 3 * 5 * neper
            numpy.testing.assert_allclose(study["medium/eta_Pa_s"][()], eta, rtol=1e-12)
            numpy.testing.assert_allclose(study["medium/chi_Pa_s"][()], 2 * 1000 * 20.0 ** 3 * 3 * neper - 2 * eta,
                                          rtol=1e-12)

    def test_a_layer_outside_enlarges_the_grid(self):
        with self.study({"options": {"PMLInside": 0, "PMLSize": numpy.array([4.0, 5.0, 6.0])}}) as study:
            numpy.testing.assert_array_equal(study["grid/points"][()], [56, 50, 44])
            self.assertEqual(study["source_0/nodes"][:, 2].min(), 13 + 6)
            numpy.testing.assert_array_equal(study["sensor/nodes"][0],
                                             reference("a_additive_pml10")["points_ijk0"][0] + [4, 5, 6])

    @pytest.mark.long
    def test_any_field_can_be_recorded(self):
        with self.study({"sensor": {"record": ["syz", "uy", "sxy"]}}) as study:
            self.assertEqual(study["sensor"].attrs["fields"], b"uy sxy syz")
        of = reference("a_additive_pml10")
        self.shearwake("run", "study.toml", ranks=2)
        self.assertLess(self.worst(of, ("uy", "sxy", "syz")), 1e-12)

    def test_initial_pressure_is_applied_in_two_steps(self):
        p0 = numpy.zeros(POINTS)
        p0[10, 11, 12] = 7.0
        with self.study({"source": {"u_mask": None, "uz": None, "u_mode": None, "p0": p0},
                         "options": {"Smooth": 0}}) as study:
            self.assertEqual([study[f"source_{n}"].attrs["field"] for n in range(3)], [b"sxx", b"syy", b"szz"])
            self.assertEqual(study["source_0/weights"][()], [-3.5])
            numpy.testing.assert_array_equal(study["source_0/series"][()], [[1.0, 1.0]])

    def test_the_centre_of_a_symmetric_source_has_no_rounding_error(self):
        mask = numpy.zeros(POINTS)
        mask[20:29, 16:25, 13] = 1.0
        i, j = numpy.meshgrid(numpy.arange(9) - 4, numpy.arange(9) - 4, indexing="xy")
        series = numpy.exp(-0.1 * (i ** 2 + j ** 2)).ravel()[:, None] * numpy.ones((1, 30))
        with self.study({"source": {"u_mask": mask, "uz": series}}):
            self.says((self.folder / "study.toml").read_text(encoding="utf-8"), "position_mm = [0, 0]")

    def test_stress_sources_are_scaled_by_dx_and_dirichlet_sources_are_not_scaled(self):
        mask = numpy.zeros(POINTS)
        mask[3, 4, 5] = 1
        for mode, weight in (("additive", 2 * 20 * 1e-5 / 1e-3), ("dirichlet", 1.0)):
            with self.study({"source": {"u_mask": None, "uz": None, "u_mode": None, "s_mask": mask, "sxz": numpy.ones((1, 4)),
                                        "s_mode": mode}}) as study:
                numpy.testing.assert_allclose(study["source_0/weights"][()], [weight], rtol=1e-14)
                self.assertEqual(study["source_0"].attrs["field"], b"sxz")


class Errors(ImportTest):
    def test_invalid_input_is_rejected(self):
        of = reference("a_additive_pml10")
        mask = numpy.zeros((2, 2, 2))
        for changes, words in (
                ({"medium": {"density": None}}, ["medium.density is missing"]),
                ({"medium": {"BonA": 6.0}}, ["medium.BonA is not a field", "sound_speed_shear"]),
                ({"medium": {"density": numpy.ones((3, 3, 3))}}, ["(3, 3, 3)", "(48, 40, 32)"]),
                ({"medium": {"alpha_coeff_shear": 1.0}}, ["must be specified together"]),
                ({"source": {"u_mask": mask}}, ["source.u_mask", "(2, 2, 2)"]),
                ({"source": {"u_mask": None}}, ["source.u_mask is missing"]),
                ({"source": {"uz": numpy.ones((7, 4))}}, ["7 rows, but its mask has 1920 nodes"]),
                ({"source": {"u_mode": "soft"}}, ["soft", '"additive" or "dirichlet"']),
                ({"kgrid": {"Nz": 1}}, ["at least 2"]), ({"kgrid": {"dt": None}}, ["kgrid.dt is missing"]),
                ({"sensor": {"record": "q"}}, ["sensor.record 'q' is unknown"])):
            with self.subTest(words=words):
                structures = structures_of("a_additive_pml10", of)
                for name, fields in changes.items():
                    structures[name] = {field: value for field, value in {**structures[name], **fields}.items()
                                        if value is not None}
                self.says(self.imported(structures, expect=3), *words)
        (self.folder / "text.mat").write_text("no HDF5", encoding="utf-8")
        done = subprocess.run([ROOT / "scripts" / "import-kwave", "text.mat"], cwd=self.folder, env=environment(),
                              capture_output=True, encoding="utf-8", check=False)
        self.assertEqual(done.returncode, 3)
        self.says(done.stderr, "is neither an HDF5 file nor a .mat file", "-v7.3")

    def test_a_job_that_does_not_fit_its_study_is_rejected(self):
        self.imported(structures_of("a_additive_pml10", reference("a_additive_pml10")))
        for words, said in ((("domain.spacing_mm=0.5",), "spacing"),
                            (("time.output_interval_us=16",), "multiple of the time step of the study"),
                            (("time.duration_ms=8",), "exceeds the duration of the study")):
            self.says(self.shearwake("check", "study.toml", *[word for key in words for word in ("-S", key)],
                                     expect=3).said, said)
        self.says(self.shearwake("check", "study.toml", "-S", "solver.pstd.study='none.h5'", expect=3).said,
                  "none.h5 does not exist")
        self.says(self.shearwake("check", "study.toml", "-S", "solver.pstd.time_step_us=1", expect=3).said,
                  "has no effect with a study")
        with h5py.File(self.folder / "study.h5", "r+") as file:
            file["source_0/nodes"][0, 2] = 32
        self.says(self.shearwake("check", "study.toml", expect=3).said, "a node at 32 along z")


if __name__ == "__main__":
    unittest.main()
