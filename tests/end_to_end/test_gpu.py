# SPDX-License-Identifier: BSD-3-Clause
"""Engine pstd and `kwave` on a GPU, which is a processor here (pocl). pocl keeps compiled kernels in its cache."""
import atexit
import ctypes.util
import functools
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy
import pytest

import test_kwave_functions
import test_kwave_plane
from program import PATIENCE_s, PROGRAM, ROOT, ProgramTest, case_files, command, environment, journal
from test_kwave_program import DATA, KWaveTest
from test_pstd import SAVED
from test_variation import BONE, MAP, make_map

SYSTEM = ctypes.util.find_library("OpenCL")
WITHOUT_GPU = "no (OpenCL" in subprocess.run([PROGRAM, "kwave", "--version"], capture_output=True, text=True, check=False, env=environment()).stdout
pytestmark = pytest.mark.skipif(WITHOUT_GPU or not SYSTEM or not list(Path("/etc/OpenCL/vendors").glob("*.icd")),
                                reason="OpenCL has no driver, or the program no GPU support: scripts/setup --tests installs both")
GPU = ("--device", "gpu")
# Largest difference from the processor relative to the largest value: rounding errors of some hundred steps.
TOLERANCE = {"double": 1e-12, "single": 2e-5}


@functools.cache
def failing_opencl():
    """A folder with faults/opencl.cpp as the library of OpenCL, and that of the system under another name."""
    folder = Path(tempfile.mkdtemp(prefix="shearwake-opencl-"))
    atexit.register(shutil.rmtree, folder)
    listed = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=True).stdout
    path = next(line.rpartition("=> ")[2] for line in listed.splitlines() if line.strip().startswith(SYSTEM))
    real = folder / "libRealCL.so.1"
    real.write_bytes(Path(path).read_bytes().replace(b"libOpenCL.so.1\0", b"libRealCL.so.1\0"))
    subprocess.run([os.environ.get("CXX", "g++"), "-shared", "-fPIC", "-O1", "-w", "-o", folder / "libOpenCL.so.1",
                    ROOT / "tests" / "faults" / "opencl.cpp", "-Wl,--no-as-needed", real, "-ldl", "-Wl,-rpath,$ORIGIN"], check=True)
    return folder


def faults(**named):
    return {"LD_LIBRARY_PATH": f"{failing_opencl()}:{os.environ.get('LD_LIBRARY_PATH', '')}",
            **{f"FAULT_{name}": str(value) for name, value in named.items()}}


class OnGpu(ProgramTest):
    def assert_equal_results(self, found, expected, tolerance, least=3):
        """Compares the large datasets of two files."""
        with h5py.File(found) as a, h5py.File(expected) as b:
            names = []
            b.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.size > 1 else None)
            self.assertGreaterEqual(len(names), least)
            for name in names:
                x, y = a[name][()], b[name][()]
                numpy.testing.assert_allclose(x, y, rtol=0.0, atol=tolerance * max(numpy.nanmax(numpy.abs(y)), 1e-300), err_msg=name)


class References(test_kwave_functions.FunctionsTest):
    """The studies whose results of k-Wave itself are known: all records, masks, sources and media, and planes."""

    def result(self, case, group="binary", **options):
        return test_kwave_functions.Functions.result(self, case, group, device="gpu", **options)

    @pytest.mark.extended
    def test_all_studies_agree_with_kwave(self):
        for case, group, options in (("homogeneous", "binary", {}), ("homogeneous", "corners", {}), ("homogeneous", "cartesian_linear", {}),
                                     ("p0_pml_outside", "binary", {}), ("stress_lossy", "binary", {}), ("dirichlet", "binary", {"device_num": 0}),
                                     ("ewp_3d", "corners", {}), ("plane_wave", "binary", {})):
            with self.subTest(case=case, group=group):
                self.result(case, group, **options)

    @pytest.mark.extended
    def test_planes_agree_with_kwave(self):
        for case, name in test_kwave_plane.CASES:
            with self.subTest(case=case, group=name):
                test_kwave_plane.References.check(self, case, name, device="gpu")

    def test_devices_that_do_not_exist_are_errors(self):
        with self.assertRaisesRegex(ValueError, "device must be 'cpu' or 'gpu', not 'tpu'"):
            test_kwave_functions.Functions.result(self, "homogeneous", device="tpu")
        with self.assertRaisesRegex(ValueError, "device_num must be a whole number from 0 on, not -1"):
            self.result("homogeneous", device_num=-1)
        with self.assertRaisesRegex(Exception, "there is no device 99; the devices are 0: "):
            self.result("homogeneous", device_num=99)


class Program(KWaveTest, OnGpu):
    RECORDS = ("-p", "-u", "--p_rms", "--u_max_all", "--p_min_all", "--u_final", "--u_non_staggered_raw", "--u_split_field_raw", "--output_precision",
               "double")

    @pytest.mark.extended
    def test_single_precision_agrees_with_double(self):
        """p is the divergence times a modulus that is up to 52 times mu, and small compared with the parts of the stresses in the layer."""
        for case in ("stress_lossy", "p0_pml_outside"):
            for name, more in (("double", ()), ("single", ("--precision", "single", *GPU))):
                self.run_file(DATA / f"{case}_input.h5", *self.RECORDS, *more)
                shutil.move(self.folder / "out.h5", self.folder / f"{name}.h5")
            self.assert_equal_results(self.folder / "single.h5", self.folder / "double.h5", TOLERANCE["single"], least=20)

    @pytest.mark.extended
    def test_lines_longer_than_local_memory_agree(self):
        """The shortest line takes 2 * 26 * 16 B in double precision."""
        words = ("kwave", "-i", DATA / "stress_lossy_input.h5", *self.RECORDS)
        self.shearwake(*words, "-o", self.folder / "cpu.h5")
        self.call(*command(*words, "-o", self.folder / "gpu.h5", *GPU), variables=faults(LOCAL_B=800))
        self.assert_equal_results(self.folder / "gpu.h5", self.folder / "cpu.h5", TOLERANCE["double"], least=20)

    @pytest.mark.extended
    def test_processor_and_gpu_resume_from_each_others_checkpoints(self):
        file = DATA / "stress_lossy_input.h5"
        self.run_file(file, *self.RECORDS)
        shutil.copyfile(self.folder / "out.h5", self.folder / "complete.h5")
        for device in (GPU, (), GPU, ()):
            output = self.run_file(file, *self.RECORDS, *device, "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40")
        self.contains(output, "resumed after step 120")
        self.assert_equal_results(self.folder / "out.h5", self.folder / "complete.h5", TOLERANCE["double"])

    def test_signals_stop_a_run_on_a_device(self):
        """LLVM, with which pocl compiles, handles these signals as well."""
        words = command("kwave", "-i", DATA / "ewp_3d_input.h5", "-o", "out.h5", "-r", "1", *GPU, "--checkpoint_file", "c.h5", "--checkpoint_interval", "9999")
        with subprocess.Popen(words, cwd=self.folder, env=environment(), stdout=subprocess.PIPE, encoding="utf-8") as process:
            while "%" not in process.stdout.readline():
                self.assertIsNone(process.poll())
            process.send_signal(signal.SIGUSR1)
            output = process.communicate(timeout=PATIENCE_s)[0]
        self.assertEqual(process.returncode, 0)
        self.contains(output, "stopped after step ")

    def test_output_states_the_device_and_its_rate(self):
        file = DATA / "homogeneous_input.h5"
        output = self.run_file(file, "--benchmark", "20", *GPU, "-g", "0")
        self.assertRegex(output, r"device: .+ \(driver .+\)\n")
        self.assertRegex(output.splitlines()[-1], r" Mpoint/s, [0-9]+ % of the bandwidth of copies on the device$")
        self.assertNotIn("note: -g", output)
        self.contains(self.run_file(file, "--benchmark", "2", "-g", "0"), "note: -g is ignored without --device gpu")
        self.contains(self.run_file(file, *GPU, ranks=2, expect=1), "a GPU computes a grid in one rank: start kwave without mpirun")

    @pytest.mark.extended
    def test_bench_measures_steps_on_the_device(self):
        found = json.loads(self.shearwake("bench", "pstd", "--grid", "16x12x10", *GPU, "--json").stdout)["measurements"]
        self.assertEqual([m["name"].partition("s, ")[2] for m in found], ["lossless, double", "lossless, single", "lossy, double", "lossy, single"])
        for m in found:
            self.assertGreater(min(m["points_per_s"], m["share_of_copies"]), 0.0)
            self.assertIn("driver", m["device"])

    @pytest.mark.extended
    def test_two_runs_on_a_device_do_not_disturb_each_other(self):
        runs = {}
        for case in ("homogeneous", "dirichlet"):
            words = ["kwave", "-i", DATA / f"{case}_input.h5", "-p", "-u", "--output_precision", "double"]
            self.shearwake(*words, "-o", self.folder / f"{case}.h5")
            runs[case] = subprocess.Popen(command(*words, "-o", self.folder / f"{case}_gpu.h5", *GPU), env=environment(), stdout=subprocess.PIPE)
        for case, process in runs.items():
            process.communicate(timeout=PATIENCE_s)
            self.assertEqual(process.returncode, 0)
            self.assert_equal_results(self.folder / f"{case}_gpu.h5", self.folder / f"{case}.h5", TOLERANCE["double"])

    def test_opencl_is_loaded_only_for_a_gpu(self):
        self.assertNotIn("OpenCL", subprocess.run(["ldd", PROGRAM], capture_output=True, text=True, check=True).stdout)
        (self.folder / "libOpenCL.so.1").write_text("this is not a library")
        words = ("kwave", "-i", DATA / "homogeneous_input.h5", "-o", "out.h5", "--benchmark", "2")
        broken = {"LD_LIBRARY_PATH": f"{self.folder}:{os.environ.get('LD_LIBRARY_PATH', '')}"}
        self.call(*command(*words), variables=broken)
        output = self.call(*command(*words, *GPU), variables=broken, expect=1).output
        self.contains(output, 'device "gpu" requires OpenCL: ', "libOpenCL.so.1")

    @pytest.mark.extended
    def test_failures_of_the_device_have_reasons_and_leave_the_checkpoint(self):
        words = ("kwave", "-i", DATA / "stress_lossy_input.h5", "-o", "out.h5", *self.RECORDS, *GPU)
        output = self.call(*command(*words), variables=faults(MEMORY_B=1000000), expect=1).output
        needed = re.search(r"has 0\.001 GB of memory, .* the case needs ([0-9.]+) GB in arrays of up to ", output)
        self.assertGreater(float(needed[1]), 0.001, output)
        output = self.call(*command(*words), variables=faults(ARRAY_AT=20), expect=1).output
        self.contains(output, "allocating ", " MB failed: the memory of the device is exhausted")
        saving = (*words, "--checkpoint_file", "c.h5", "--checkpoint_timesteps", "40")
        self.call(*command(*saving))
        output = self.call(*command(*saving), variables=faults(KERNEL_AT=500), expect=1).output
        self.contains(output, "starting kernel ", " failed: the device is not available")
        for _ in range(3):
            self.call(*command(*saving))
        self.run_file(DATA / "stress_lossy_input.h5", *self.RECORDS)
        shutil.move(self.folder / "out.h5", self.folder / "cpu.h5")
        self.call(*command(*words))
        self.assert_equal_results(self.folder / "out.h5", self.folder / "cpu.h5", TOLERANCE["double"])


class Jobs(OnGpu):
    DEVICES = SAVED.partition("[sweep]")[0] + '[sweep]\n"solver.pstd.device" = ["cpu", "gpu"]\n'
    ON_GPU = SAVED.replace('engine = "pstd"', 'engine = "pstd"\npstd = { device = "gpu" }')

    @pytest.mark.extended
    def test_processor_and_gpu_agree_for_bodies_and_a_map(self):
        make_map(self)
        job = self.DEVICES.replace(*MAP).replace(*BONE)
        for long, short in (("duration_ms = 2.0", "duration_ms = 0.3"), ("volumes_ms = [0.1, 1.5]", "volumes_ms = [0.1]"),
                            ("at_ms = 1.0", "at_ms = 0.2"), ("settled_after_ms = 0.2", "settled_after_ms = 0.1")):
            self.assertEqual(job.count(long), 1)
            job = job.replace(long, short)
        self.write_job(job)
        self.shearwake("run", "job.toml", ranks=2)  # two teams of one rank
        cpu, gpu = case_files(self.out)
        self.assert_equal_results(gpu, cpu, 1e-9)  # measures near 0 are ratios of small numbers

    def test_the_default_is_not_part_of_the_id_of_a_case(self):
        def ids(job):
            self.write_job(job)
            return [case["id"] for case in json.loads(self.shearwake("plan", "job.toml", "--json").stdout)["cases"]]
        given = SAVED.replace('engine = "pstd"', 'engine = "pstd"\npstd = { device = "cpu" }')
        self.assertNotEqual(given, SAVED)
        self.assertEqual(ids(given), ids(SAVED))
        self.assertNotEqual(ids(self.ON_GPU), ids(SAVED))

    @pytest.mark.extended
    def test_plan_states_the_memory_that_a_case_needs_on_the_device(self):
        self.write_job(self.ON_GPU)
        planned = re.search(r"on a GPU, in ([0-9.e-]+) GB of its memory", self.shearwake("plan", "job.toml").stdout)
        output = self.call(*command("run", "job.toml"), variables=faults(MEMORY_B=1000000), expect=4).output
        needed = re.search(r"the case\s+needs ([0-9.e-]+) GB in arrays", output)
        self.assertAlmostEqual(float(planned[1]) / float(needed[1]), 1.0, delta=0.03)
        sizes = self.folder / "sizes.txt"
        self.call(*command("run", "job.toml", "--retry-failed"), variables=faults(SIZES_IN=sizes))
        allocated_GB = 1e-9 * sum(int(size) for size in sizes.read_text().split())
        self.assertAlmostEqual(float(planned[1]) / allocated_GB, 1.0, delta=0.03)  # tables and sums of displacements are left out

    @pytest.mark.extended
    def test_a_failure_of_the_device_ends_the_case_alone(self):
        self.write_job(self.ON_GPU)
        output = self.call(*command("run", "job.toml"), variables=faults(ARRAY_AT=30), expect=4).output
        self.contains(output, "1 computed now", "1 failed", "the memory of the device is exhausted")
        self.shearwake("run", "job.toml", "--retry-failed")
        self.assertEqual(len(case_files(self.out)), 2)

    @pytest.mark.extended
    def test_a_case_whose_device_is_lost_is_resumed_on_the_processor_or_a_gpu(self):
        self.write_job(self.ON_GPU)
        self.call(*command("run", "job.toml", "--checkpoint-steps", 20), variables=faults(KERNEL_AT=3000), expect=4)
        self.shearwake("run", "job.toml", "--retry-failed")
        resumed = [line for line in journal(self.out) if line["event"] == "resumed"]
        self.assertGreaterEqual(resumed[0]["step"], 20)
        self.assertEqual(len(case_files(self.out)), 2)
