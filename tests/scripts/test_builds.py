# SPDX-License-Identifier: BSD-3-Clause
"""Builds of the whole program that take long: with link-time optimisation, with clang, and on each supported Debian release."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.mark.long
class Builds(unittest.TestCase):
    def succeeds(self, *command):
        done = subprocess.run(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, encoding="utf-8", errors="replace", check=False)
        self.assertEqual(done.returncode, 0, done.stdout[-8000:])
        return done.stdout

    def test_link_time_optimisation_finds_no_type_that_differs_between_files(self):
        with tempfile.TemporaryDirectory() as folder:
            self.succeeds("cmake", "--preset", "lto", "-B", folder, "-DSHEARWAKE_WERROR=ON")
            self.succeeds("cmake", "--build", folder, "--target", "shearwake")

    def test_the_sanitizer_of_clang_finds_no_undefined_behaviour(self):
        """In the unit tests, and in the MPI tests on ranks of which some have no data."""
        if not shutil.which("clang++"):
            self.skipTest("scripts/setup --checks installs clang")
        with tempfile.TemporaryDirectory() as folder:
            self.succeeds("cmake", "--preset", "clang", "-B", folder)
            self.succeeds("cmake", "--build", folder, "--target", "build_tests")
            output = self.succeeds("ctest", "--test-dir", folder, "-R", "^unit_tests$|mpi_tests on [58]")
            self.assertIn("100% tests passed, 0 tests failed out of 3", output)

    def on_release(self, release):
        if os.geteuid() != 0 or not shutil.which("debootstrap"):
            self.skipTest("scripts/try-release needs root and debootstrap")
        self.succeeds("scripts/try-release", release, "scripts/quickstart")
        self.assertRegex(self.succeeds("scripts/try-release", release, "scripts/test"), r"\d+ passed, 0 failed\n\Z")

    def test_debian_12_builds_it_and_passes_all_tests(self):
        self.on_release("bookworm")

    def test_debian_13_builds_it_and_passes_all_tests(self):
        self.on_release("trixie")
