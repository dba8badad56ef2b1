# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake kwave` rejects damaged files and files that are not elastic inputs of k-Wave, and writes no result."""
import os
import zlib

import h5py
import numpy
import pytest

from program import PROGRAM
from test_kwave_program import DATA, KWaveTest, put


class Errors(KWaveTest):
    def refused(self, change, *words, case="homogeneous", ranks=1, options=()):
        self.contains(self.run_file(self.changed(case, change), *options, ranks=ranks, expect=1), "in.h5", *words)
        self.assertFalse((self.folder / "out.h5").exists())
        self.assertFalse((self.folder / "out.h5.part").exists())

    def set_to(self, name, value, at=(0, 0, 0)):
        def change(file):
            file[name][at] = value
        return change

    def test_each_fault_is_named(self):
        for name, value, *words in (
                ("elastic_flag", 0, "acoustic"), ("nonlinear_flag", 1, "nonlinear_flag"), ("axisymmetric_flag", 1, "axisymmetric_flag"),
                ("p_source_flag", 3, "time reversal"), ("transducer_source_flag", 1, "transducer"), ("absorbing_flag", 2, "absorbing_flag"),
                ("nonuniform_grid_flag", 1, "nonuniform_grid_flag"), ("Nx", 1, "Nx is 1"), ("Nz", 0, "Nz is 0"),
                ("Nt", 0, "Nt is 0"), ("Nx", 29, "expected"), ("dx", 0.0, "dx is 0"), ("dt", numpy.nan, "dt contains nan"),
                ("dt", 2e-4, "dt", "unstable"), ("dx", 1.01e-3, "ddx_k_shift_pos_r"), ("u_source_mode", 3, "u_source_mode"),
                ("ux_source_flag", 41, "ux_source_input", "(1, 41, 1)"), ("mu", -1.0, "mu is -1"), ("rho0_sgy", 0.0, "rho0_sgy is 0"),
                ("lambda", -1e9, "lambda + 2 mu"), ("pml_x_size", 15, "pml_x_size"), ("sensor_mask_type", 3, "sensor_mask_type"), ("sensor_mask_type", 2, "sensor_mask_weights is missing"),
                ("sensor_mask_index", 0, "sensor_mask_index contains 0"), ("sensor_mask_index", 16801, "16801"),
                ("u_source_index", 16801, "u_source_index contains 16801"), ("pml_x", 1.5, "pml_x is 1.5", "index 1")):
            with self.subTest(name=name, value=value):
                self.refused(self.set_to(name, value), *words)
        self.refused(self.set_to("p0_source_input", numpy.nan, (3, 2, 1)), "p0_source_input contains nan", "(2, 3, 4)",
                     case="p0_pml_outside")

    def test_failed_run_leaves_no_older_output(self):
        for ranks in (1, 2):
            (self.folder / "out.h5").write_bytes(b"older")
            self.refused(self.set_to("mu", -1.0), "mu is -1", ranks=ranks)
        (self.folder / "out.h5").write_bytes(b"older")
        self.run_file(self.folder / "absent.h5", expect=1)
        self.assertFalse((self.folder / "out.h5").exists())

    @pytest.mark.extended
    def test_failed_resumption_names_the_older_output(self):
        self.run_file(DATA / "homogeneous_input.h5", "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "3")
        output = self.run_file(DATA / "dirichlet_input.h5", "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "3", expect=1)
        self.contains(output, "must be an undamaged checkpoint of the same input file and options", "out.h5 is of an earlier run")
        with h5py.File(self.folder / "out.h5") as out:
            self.assertEqual((out["t_index"][0, 0, 0], out["Nt"][0, 0, 0]), (3, 120))

    @pytest.mark.extended
    def test_small_files_that_need_much_memory_are_rejected(self):
        """Compressed data of 1 GB, and cuboids with 8e8 nodes."""
        def series(file):
            del file["ux_source_input"]
            block = zlib.compress(bytes(1 << 24), 1)
            dataset = file.create_dataset("ux_source_input", (1, 1 << 28, 1), "f4", chunks=(1, 1 << 22, 1), compression="gzip")
            for number in range(64):
                dataset.id.write_direct_chunk((0, number << 22, 0), block)
            dataset.attrs["data_type"], dataset.attrs["domain_type"] = numpy.bytes_("float"), numpy.bytes_("real")
            put(file, "ux_source_flag", [[[1 << 28]]])

        def cuboids(file):
            put(file, "sensor_mask_type", [[[1]]])
            put(file, "sensor_mask_corners", numpy.tile([1, 1, 1, 28, 25, 24], (1, 50000, 1)))

        for change, name in ((series, "ux_source_input"), (cuboids, "sensor_mask_corners")):
            path = self.changed("homogeneous", change)
            self.assertLess(path.stat().st_size, 5e6)
            done = self.call("sh", "-c", 'ulimit -v 1000000; exec "$@"', "sh", PROGRAM, "kwave", "-i", path, "-o", "out.h5", expect=1)
            self.contains(done.stderr, f"in.h5: {name} and what precedes it need ", " GB are available")

    @pytest.mark.extended
    def test_only_regular_files_are_replaced(self):
        os.mkfifo(self.folder / "pipe.h5")
        for out, words in (("pipe.h5", "pipe.h5 is not a regular file"), ("", "-o requires the name of a file"),
                           ("x" * 300, "File name too long"), ("x" * 300 + "/y", "the folder does not exist")):
            with self.subTest(out=out):
                done = self.call(PROGRAM, "kwave", "-i", DATA / "homogeneous_input.h5", "-o", out, "--benchmark", "2", expect=1)
                self.contains(done.stderr, words)
                self.assertNotIn("MPI_ABORT", done.stderr)
                self.assertNotIn("step 1", done.stdout)
        self.assertTrue((self.folder / "pipe.h5").is_fifo())

    @pytest.mark.extended
    def test_a_folder_without_room_for_the_lock_ends_as_other_errors(self):
        (self.folder / "out.h5.lock").mkdir()
        self.contains(self.run_file(DATA / "homogeneous_input.h5", expect=1), "cannot open", "out.h5.lock")

    @pytest.mark.extended
    def test_negative_bulk_modulus_is_warned_of(self):
        with h5py.File(DATA / "homogeneous_input.h5") as file:
            mu = float(file["mu"][0, 0, 0])
        output = self.run_file(self.changed("homogeneous", self.set_to("lambda", -0.9 * mu)), "--benchmark", "2")
        self.contains(output, "warning: lambda + 2 mu/3, the bulk modulus, is negative at")

    @pytest.mark.extended
    def test_fault_of_a_node_is_named_on_every_number_of_ranks(self):
        for ranks in (1, 2):
            self.refused(self.set_to("mu_sgxz", numpy.nan, (3, 4, 20)), "mu_sgxz contains nan", "(21, 5, 4)", case="dirichlet", ranks=ranks)

    def test_structure_is_validated(self):
        def replaced(name, values, kind="long"):
            return lambda file: put(file, name, values, kind)

        def double(file):
            value = file["lambda"][()].astype("f8")
            put(file, "lambda", value, "float")
            attributes = dict(file["lambda"].attrs)
            del file["lambda"]
            file["lambda"] = value
            file["lambda"].attrs.update(attributes)

        def attribute(node, name, value):
            return lambda file: file[node].attrs.update({name: numpy.bytes_(value)})

        def mask(kind, name, values, data="long"):
            return lambda file: (put(file, "sensor_mask_type", [[[kind]]]), put(file, name, values, data))

        def link(file):
            del file["mu"]
            file["mu"] = h5py.ExternalLink("elsewhere.h5", "mu")

        for change, *words in (
                (lambda file: file.pop("mu_sgxy"), "mu_sgxy is missing"), (double, "lambda", 'must be "double" and "real"'),
                (attribute("mu", "data_type", "long"), "mu", "data_type"),
                (lambda file: file["u_source_index"].write_direct(numpy.full((1, 1, 12), 1, "u8")), "u_source_index", "more than once"),
                (replaced("ux_source_input", numpy.ones((1, 40, 3)), "float"), "3 series for 12 source nodes", "labelled"),
                (attribute("/", "file_type", "output"), "file_type", "output"), (attribute("/", "major_version", "2"), "version 2.2"),
                (mask(1, "sensor_mask_corners", [[[3, 1, 1, 2, 4, 4]]]), "sensor_mask_corners", "cuboid 1"),
                (mask(2, "sensor_mask_weights", numpy.ones((1, 5, 8)), "float"), "(1, 5, 8), but (1, 1, 8) is expected"),  # 12 nodes
                (link, '"mu" leads to another file')):
            with self.subTest(words=words):
                self.refused(change, *words)

    @pytest.mark.extended
    def test_attributes_of_other_writers_are_read(self):
        def change(file):
            file["mu"].attrs["data_type"] = "float"  # of variable length
            file["Nx"].attrs["domain_type"] = numpy.bytes_("real\0")
            file.attrs["file_type"] = numpy.bytes_("input\0")
        self.run_file(self.changed("homogeneous", change), "--benchmark", "2")

    @pytest.mark.extended
    def test_growing_field_ends_with_an_error(self):
        def change(file):  # an additive source whose values overflow
            file["ux_source_input"][...] = 1e38
            file["u_source_mode"][...] = 0
        self.refused(change, "no longer finite at step", options=("--precision", "single"))

    def test_truncated_and_foreign_files_are_refused(self):
        valid = (DATA / "homogeneous_input.h5").read_bytes()
        for content in (valid[:len(valid) // 2], valid[:100], b"no HDF5\n", b""):
            (self.folder / "in.h5").write_bytes(content)
            with self.subTest(bytes=len(content)):
                self.contains(self.run_file(self.folder / "in.h5", expect=1), "in.h5: it cannot be read as HDF5")
                self.assertFalse((self.folder / "out.h5").exists())
                self.assertFalse((self.folder / "out.h5.part").exists())
