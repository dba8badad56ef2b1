# SPDX-License-Identifier: BSD-3-Clause
"""Kernels for several instruction sets: the choice, its record in the results, and equal results."""
import os
import re
import subprocess
import unittest
from unittest import mock

import pytest

from program import AM, PROGRAM, PSTD, SPECTRAL, ProgramTest, journal, read_by, swept, without_reference


class InstructionSets(ProgramTest):
    def available(self):
        output = self.shearwake("--version").output
        return re.search(r"^kernels +(\w+) of (.*?) \(", output, re.M).group(2).split(", ")

    def run_with(self, name, out):
        with mock.patch.dict(os.environ, {"SHEARWAKE_SIMD": name}):
            self.shearwake("run", "job.toml", "--out", out, "--quiet")
            self.contains(self.shearwake("--version").output, f"kernels   {name} of")
        started = next(line for line in journal(self.folder / out) if line["event"] == "run_started")
        self.assertEqual(started["kernels"], name)
        self.shearwake("reduce", out)

    def compare(self, text):
        self.write_job(text)
        names = self.available()
        for name in names:
            self.run_with(name, name)
        for name in names[:-1]:  # within the default tolerances of compare
            self.contains(self.shearwake("compare", name, names[-1]).output, "no difference")

    @pytest.mark.extended
    def test_tables_without_iterations_do_not_depend_on_the_instruction_set(self):
        self.compare(without_reference({"sweep": {AM: [400], "solver.engine": ["layered", "spectral"]}, "afferents": {}}))

    @pytest.mark.long
    def test_tables_with_iterations_do_not_depend_on_the_instruction_set(self):
        stiff = {"name": "lump", "shape": "ellipsoid", "center_mm": [0.0, 3.0, 8.0], "semi_axes_mm": [8.0, 6.0, 4.0], "c_s_m_s": 20.0}
        self.compare(without_reference(SPECTRAL, swept(400), {"medium.body": [stiff]}))

    @pytest.mark.long
    def test_pstd_gives_one_table_with_every_set(self):
        self.compare(without_reference(PSTD, swept(1250), read_by(1.0, settled_ms=0.2), {
            "domain.extent_mm": [36.0, 24.0], "load.modulation.path.from_mm": [-8.0, 0.0]}))

    @pytest.mark.extended
    def test_an_unknown_instruction_set_is_an_error_that_lists_the_allowed_ones(self):
        with mock.patch.dict(os.environ, {"SHEARWAKE_SIMD": "sse9"}):
            output = self.shearwake("--version", expect=2, ranks=2).output
        self.contains(output, "SHEARWAKE_SIMD=sse9 is not an instruction set", "baseline, avx2, avx512")


class Objects(unittest.TestCase):
    """Functions that the linker may take from any object must not require more than the baseline."""

    def test_kernels_share_no_function_with_other_objects(self):
        objects = sorted(PROGRAM.parent.glob("src/**/*_kernels_*.dir/**/*.o"))
        self.assertTrue(objects, "no objects of kernels beside the program")
        for path in objects:
            output = subprocess.run(["nm", "--demangle", str(path)], capture_output=True, text=True, check=True)
            # Sanitizers add the names of types and coverage adds counts, which are no instructions.
            shared = [line for line in output.stdout.splitlines() if re.search(r" [WVuw] (?!typeinfo |vtable |__covrec_|__prof|__llvm_)", line)]
            self.assertEqual(shared, [], f"{path} defines what others may define as well")
