# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake kwave` reproduces k-Wave's results from its elastic input files."""
import functools
import io
import shutil
import signal
import subprocess

import h5py
import numpy
import pytest

from limits import times
from program import PATIENCE_s, PROGRAM, ROOT, ProgramTest, environment

DATA = ROOT / "tests" / "data" / "kwave"
CASES = ("homogeneous", "ewp_3d", "p0_pml_outside", "stress_lossy", "dirichlet", "plane_wave")
AXES = ("x", "y", "z")
# Largest difference relative to the largest value. The input and output files have numbers of 32 bits (6e-8), whose
# effect on the fields of the six cases was measured as 7e-8 to 2.2e-6 in double and up to 3.3e-5 in single precision.
TOLERANCE = {"double": 1e-5, "single": 1e-4}


def flags_of(record):
    raw = {"p": ["--p_raw"], "u": ["--u_raw"], "u_non_staggered": ["--u_non_staggered_raw"],
           "u_split_field": ["--u_split_field_raw"], "I": ["--I_raw"]}
    return sorted({flag for name in record.split() for flag in raw.get(name, ["--" + name])})


def put(file, name, values, kind="long"):
    if name in file:
        del file[name]
    dataset = file.create_dataset(name, data=numpy.asarray(values, dtype="u8" if kind == "long" else "f4"))
    dataset.attrs["data_type"], dataset.attrs["domain_type"] = numpy.bytes_(kind), numpy.bytes_("real")


def references(group):
    """Each dataset of a reference: its name, the number and name of its cuboid, its values and the largest value of the quantity, of all
    components of a vector, since one may vanish by symmetry. There are at least three."""
    found = []
    for name in (name for name in group if not name.startswith("sensor_")):
        names = [name[0] + axis + name[2:] for axis in AXES if name[0] + axis + name[2:] in group] if name[0] in "uI" else [name]
        for number, key in enumerate(group[name] if isinstance(group[name], h5py.Group) else [None]):
            values = [(group[n][key] if key else group[n])[()] for n in (name, *names)]
            found.append((name, number, key, values[0], max(float(numpy.abs(v).max()) for v in values[1:])))
    assert len(found) >= 3
    return found


class KWaveTest(ProgramTest):
    def run_file(self, file, *options, ranks=1, expect=0):
        return self.shearwake("kwave", "-i", file, "-o", self.folder / "out.h5", *options, ranks=ranks, expect=expect).output

    def changed(self, case, change):
        path = self.folder / "in.h5"
        shutil.copyfile(DATA / f"{case}_input.h5", path)
        with h5py.File(path, "a") as file:
            change(file)
        return path


class Reference(KWaveTest):
    def sensor(self, case, group):
        """The input file with the sensor of a group."""
        name = "sensor_mask_corners" if "sensor_mask_corners" in group else "sensor_mask_index"

        def change(file):
            if case == "p0_pml_outside":  # the file counts from the layer outside of the user's grid
                return
            nodes = group[name][()]
            put(file, name, nodes[None] if nodes.ndim == 2 else nodes[None, None])
            put(file, "sensor_mask_type", [[[int(nodes.ndim == 2)]]])
        return self.changed(case, change)

    def compare(self, group, points, tolerance):
        with h5py.File(self.folder / "out.h5") as out:
            for name, _, key, expected, scale in references(group):
                found = (out[name][key] if key else out[name])[()]
                if name.endswith(("_all", "_final")):
                    pad = [(n - m) // 2 for n, m in zip(found.shape, points)]
                    found = found[tuple(slice(p, p + m, 4) for p, m in zip(pad, points))]
                numpy.testing.assert_allclose(found.reshape(expected.shape), expected, rtol=0.0, atol=tolerance * scale, err_msg=name)

    def check(self, case, ranks, precision="double"):
        with h5py.File(DATA / f"{case}_reference.h5") as file:
            points = [int(file.attrs["N" + axis]) for axis in reversed(AXES)]
            for name in ("binary", "corners"):
                if name not in file:
                    continue
                group = file[name]
                self.run_file(self.sensor(case, group), "-s", str(int(group.attrs.get("record_start_index", 1))),
                              "--precision", precision, *flags_of(group.attrs["record"]), ranks=ranks)
                self.compare(group, points, TOLERANCE[precision])

    @pytest.mark.extended
    def test_all_cases_on_one_to_three_ranks(self):
        for case, ranks in (*((case, 1) for case in CASES), ("dirichlet", 2), ("stress_lossy", 3)):
            with self.subTest(case=case, ranks=ranks):
                self.check(case, ranks)

    @pytest.mark.extended
    def test_single_precision(self):
        for case in CASES[:times(1, len(CASES))]:
            with self.subTest(case=case):
                self.check(case, 1, "single")


class Program(KWaveTest):
    def test_output_has_the_layout_of_kwave(self):
        self.run_file(DATA / "homogeneous_input.h5", "-p", "--u_max", "--p_final", "-s", "11", "-c", "3", "--copy_sensor_mask")
        with h5py.File(self.folder / "out.h5") as out, h5py.File(DATA / "homogeneous_input.h5") as given:
            for name, value in {"file_type": b"output", "major_version": b"1", "minor_version": b"2"}.items():
                self.assertEqual(out.attrs[name], value)
            for name in ("created_by", "creation_date", "file_description", "host_names", "number_of_cpu_cores", "total_memory_in_use",
                         "peak_core_memory_in_use", "total_execution_time", "simulation_phase_execution_time",
                         "data_loading_phase_execution_time", "pre-processing_phase_execution_time",
                         "post-processing_phase_execution_time"):
                self.assertEqual(out.attrs.get_id(name).dtype.kind, "S", name)
            for name, shape in {"p": (1, 110, 12), "ux_max": (1, 1, 12), "uz_max": (1, 1, 12), "p_final": (24, 25, 28)}.items():
                self.assertEqual((out[name].shape, out[name].dtype), (shape, numpy.dtype("f4")))
                self.assertEqual((out[name].attrs["data_type"], out[name].attrs["domain_type"]), (b"float", b"real"))
            for name in ("Nx", "Ny", "Nz", "Nt", "t_index", "pml_x_size", "axisymmetric_flag", "ux_source_flag", "u_source_mode"):
                self.assertEqual((out[name].shape, out[name].dtype, out[name].attrs["data_type"]), ((1, 1, 1), numpy.dtype("u8"), b"long"))
            for name in ("dt", "dx", "dy", "dz", "c_ref", "pml_y_alpha", "sensor_mask_index"):
                numpy.testing.assert_array_equal(out[name][()], given[name][()])
            self.assertEqual((int(out["Nt"][0, 0, 0]), int(out["t_index"][0, 0, 0])), (120, 120))

    def test_extremes_of_the_last_step_alone_are_its_values(self):
        self.run_file(DATA / "homogeneous_input.h5", "--p_max_all", "--p_min_all", "--p_final", "-s", "120")
        with h5py.File(self.folder / "out.h5") as out:
            for name in ("p_max_all", "p_min_all"):
                numpy.testing.assert_array_equal(out[name][()], out["p_final"][()], name)

    def test_options_have_the_meaning_of_kwaves_programs(self):
        file = DATA / "homogeneous_input.h5"
        text = self.run_file(file, "--benchmark", "20", "-r", "10", "--u_non", "-g", "0", "--verbose", "2", "-t", "1")
        self.assertEqual(text.count(" %  step "), 10)
        self.contains(text, "-g is ignored")
        with h5py.File(self.folder / "out.h5") as out:
            self.assertEqual(out["ux_non_staggered"].shape, (1, 20, 12))
            self.assertNotIn("p", out)
        self.run_file(file)
        with h5py.File(self.folder / "out.h5") as out:  # without a record: p
            self.assertEqual([name for name in out if name[0] in "pu" and out[name].dtype == "f4" and out[name].size > 1], ["p"])
        for wrong in (["-s", "121"], ["-c", "10"], ["--verbose", "3"], ["--p_m"], ["--checkpoint_file", "c.h5"],
                      ["--checkpoint_timesteps", "3"], ["-r", "0"], ["-t", "0"]):
            self.run_file(file, *wrong, expect=1)
        done = self.call(PROGRAM, "kwave", expect=1)
        self.contains(done.stdout, "--checkpoint_timesteps")
        self.contains(done.stderr, "-i is required")
        for option in ("--help", "-h", "--version"):
            self.call(PROGRAM, "kwave", option)

    @pytest.mark.long
    def test_resumed_run_is_bit_identical(self):
        """Legs that end by themselves, on other numbers of ranks, and one that is killed."""
        records = ["-p", "-u", "--p_rms", "--u_max_all", "--u_final", "--p_min", "--u_non_staggered_raw",
                   "--u_split_field_raw", "--I_avg"]
        file = DATA / "stress_lossy_input.h5"
        self.run_file(file, *records)
        shutil.copyfile(self.folder / "out.h5", self.folder / "complete.h5")
        for leg, ranks in enumerate((1, 2, 3)):
            self.run_file(file, *records, "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40", ranks=ranks)
            with h5py.File(self.folder / "c.h5") as checkpoint:
                self.assertEqual(checkpoint.attrs["file_type"], b"checkpoint")
            with h5py.File(self.folder / "out.h5") as out:
                self.assertEqual((out["t_index"][0, 0, 0], out["p"].shape), (40 * (leg + 1), (1, 140, 9)))
        self.assertIn("belongs to another case; it must be an undamaged checkpoint of the same input file and options: remove ",
                      self.run_file(file, "-p", "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40", expect=1))
        self.kill(self.start_and_stop("kwave", "-i", file, "-o", "out.h5", *records, "--checkpoint_file", "c.h5",
                                      "--checkpoint_interval", "99", faults={"PATH": "/out.h5", "STOP_AT": 20}))
        self.run_file(file, *records, "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40")
        self.assertFalse((self.folder / "c.h5").exists())
        with h5py.File(self.folder / "complete.h5") as complete, h5py.File(self.folder / "out.h5") as out:
            for name in complete:
                if name in ("ux_non_staggered", "ux_split_s", "Ix_avg"):  # sums over ranks: other rounding errors
                    numpy.testing.assert_allclose(out[name][()], complete[name][()], rtol=0, atol=1e-6 * numpy.abs(complete[name][()]).max())
                else:
                    numpy.testing.assert_array_equal(out[name][()], complete[name][()], name)

    @pytest.mark.extended
    def test_the_previous_checkpoint_is_used_if_the_last_one_is_damaged(self):
        file, words = DATA / "stress_lossy_input.h5", ("--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40")
        self.run_file(file)
        expected = (self.folder / "out.h5").read_bytes()
        self.run_file(file, *words)
        self.run_file(file, *words)
        last, previous = (self.folder / name for name in ("c.h5", "c.h5.previous"))
        complete = last.read_bytes()
        last.write_bytes(complete[:-100])
        self.contains(self.run_file(file, *words), "c.h5 does not end in its checksum: it was truncated", "c.h5.previous is used", "resumed after step 40")
        for path in (last, previous):
            path.write_bytes(complete[:-100])
        self.contains(self.run_file(file, *words, expect=1), "truncated", "remove ", "c.h5.previous to start from the beginning")
        last.unlink()
        previous.write_bytes(complete)  # a run was killed between two names
        for _ in range(2):
            self.run_file(file, *words)
        with h5py.File(io.BytesIO(expected)) as complete, h5py.File(self.folder / "out.h5") as out:
            numpy.testing.assert_array_equal(out["p"][()], complete["p"][()])
        self.assertEqual([path.name for path in self.folder.glob("c.h5*")], [])

    @pytest.mark.extended
    def test_a_second_run_with_the_same_output_or_checkpoint_is_refused(self):
        file = DATA / "stress_lossy_input.h5"
        first = self.start_and_stop("kwave", "-i", file, "-o", "out.h5", "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40",
                                    faults={"PATH": "/c.h5", "STOP_AT": 3})
        files = {path: path.read_bytes() for path in self.folder.iterdir()}
        for words in (("-o", "out.h5"), ("-o", "other.h5", "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40")):
            self.contains(self.shearwake("kwave", "-i", file, *words, expect=2).output, "another process is writing")
        self.assertEqual({path: path.read_bytes() for path in self.folder.iterdir()}, files)
        self.signal_and_continue(first)
        self.contains(first.communicate(timeout=PATIENCE_s)[0], "stopped after step 40")
        self.assertEqual([path.name for path in self.folder.glob("*.lock")], [])

    @pytest.mark.extended
    def test_termination_saves_a_checkpoint(self):
        def longer(file):
            file["Nt"][...] = 100000
        path = self.changed("stress_lossy", longer)
        running = subprocess.Popen([PROGRAM, "kwave", "-i", path, "-o", "out.h5", "--checkpoint_file", "c.h5", "--checkpoint_interval",
                                    "9999", "-r", "1"], cwd=self.folder, env=environment(), stdout=subprocess.PIPE, encoding="utf-8")
        while " %" not in running.stdout.readline():
            pass
        running.send_signal(signal.SIGTERM)
        self.assertIn("repeat the command to resume", running.communicate(timeout=PATIENCE_s)[0])
        self.assertEqual(running.returncode, 0)
        self.assertTrue((self.folder / "c.h5").exists())

    @pytest.mark.extended
    def test_faces_between_fluid_and_solid_are_counted(self):
        with h5py.File(DATA / "ewp_3d_input.h5") as file:
            fluid = file["mu"][()] == 0.0
        faces = sum(int((numpy.diff(fluid.astype(int), axis=axis) != 0).sum()) for axis in range(3))
        self.assertGreater(faces, 100)
        for ranks in (1, 3):
            self.contains(self.run_file(DATA / "ewp_3d_input.h5", "--benchmark", "2", ranks=ranks), f"note: {faces} faces between fluid and solid")

    @pytest.mark.extended
    def test_name_of_kwave_starts_ranks(self):
        for options in (["-t", "2"], ["-pt", "2"], ["-t2", "-u"], ["-upt2"]):
            done = self.call(ROOT / "scripts" / "kspaceFirstOrder-elastic", "-i", DATA / "plane_wave_input.h5", "-o", "out.h5", *options,
                             "--benchmark", "5", variables={"SHEARWAKE": str(PROGRAM)})
            self.contains(done.stdout, "2 ranks", " 100 %")

    @pytest.mark.extended
    def test_readers_of_kwave_find_each_value_at_its_place(self):
        """A prescribed stress of all nodes makes p = step (10000 x + 100 y + z), with indices from 1, so that each index is seen."""
        with h5py.File(DATA / "homogeneous_input.h5") as given:
            points = [int(given["N" + axis][0, 0, 0]) for axis in AXES]
        x, y, z = numpy.meshgrid(*(numpy.arange(1, n + 1) for n in points), indexing="ij")
        field = 10000.0 * x + 100.0 * y + z

        def prescribed(file):
            put(file, "ux_source_flag", [[[0]]])
            put(file, "s_source_mode", [[[0]]])
            put(file, "s_source_many", [[[1]]])
            put(file, "s_source_index", numpy.arange(1, field.size + 1)[None, None])
            for name in ("sxx", "syy", "szz"):
                put(file, f"{name}_source_flag", [[[2]]])
                # the part of each of the three components of a split stress
                put(file, f"{name}_source_input", numpy.outer([1.0, 2.0], -field.ravel(order="F") / 3.0)[None], "float")

        path = self.changed("homogeneous", prescribed)
        self.run_file(path, "-p", "--p_max", "--p_final", "--benchmark", "2", "--copy_sensor_mask")
        with h5py.File(self.folder / "out.h5") as file:
            matlab = {name: file[name][()].T for name in file}               # h5read reverses the indices
            python = {name: file[name][:].squeeze() for name in file}  # as k-wave-python reads files
        rows = field.ravel(order="F")[matlab["sensor_mask_index"].ravel().astype(int) - 1]
        self.assertEqual((matlab["p"].shape, python["p"].shape), ((12, 2, 1), (2, 12)))
        close = functools.partial(numpy.testing.assert_allclose, rtol=1e-6)  # numbers of 32 bits
        close(matlab["p"][:, :, 0], numpy.outer(rows, [1.0, 2.0]))
        close(python["p"], numpy.outer([1.0, 2.0], rows))
        close(matlab["p_max"].ravel(), 2.0 * rows)
        close(python["p_max"], 2.0 * rows)
        close(matlab["p_final"], 2.0 * field)
        close(python["p_final"][2, 3, 4], 2.0 * 50403.0)
        with h5py.File(path, "a") as file:
            put(file, "sensor_mask_type", [[[1]]])
            put(file, "sensor_mask_corners", [[[3, 4, 5, 6, 6, 6], [28, 25, 24, 28, 25, 24]]])
        self.run_file(path, "-p", "--p_max", "--benchmark", "2")
        with h5py.File(self.folder / "out.h5") as file:
            close(file["p/1"][()].T, field[2:6, 3:6, 4:6, None] * [1.0, 2.0])
            close(file["p_max/2"][()].T, [[[2.0 * 282524.0]]])

    @pytest.mark.extended
    def test_run_that_is_killed_leaves_no_older_output(self):
        def longer(file):
            file["Nt"][...] = 100000
        (self.folder / "out.h5").write_bytes(b"older")
        running = subprocess.Popen([PROGRAM, "kwave", "-i", self.changed("stress_lossy", longer), "-o", "out.h5", "-r", "1"], cwd=self.folder,
                                   env=environment(), stdout=subprocess.PIPE, encoding="utf-8")
        self.assertTrue(any(" %" in line for line in running.stdout))  # stops at the first line of progress
        self.assertFalse((self.folder / "out.h5").exists())
        running.kill()
        running.communicate()
        self.assertFalse((self.folder / "out.h5").exists())
