# SPDX-License-Identifier: BSD-3-Clause
"""What a user reads when a library or a package is missing."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent


class Requirements(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-requirements-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_setup_lists_the_requirements_where_there_are_no_debian_packages(self):
        for tool in ("sh", "dirname", "awk", "sed"):
            (self.folder / tool).symlink_to(shutil.which(tool))
        for option, has_scipy in ((), True), (("--minimal",), False):
            done = subprocess.run(["/bin/sh", ROOT / "scripts" / "setup", *option], env={"PATH": str(self.folder)},
                                  capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stdout), (6, ""), done.stderr)
            for name in ("MPI 3.1", "HDF5 1.10 with MPI", "Matplotlib"):
                self.assertIn(name, done.stderr)
            self.assertEqual("SciPy" in done.stderr, has_scipy)
            self.assertNotIn("Catch2", done.stderr)

    def test_program_package_citation_and_changelog_have_one_version(self):
        program = Path(os.environ.get("SHEARWAKE", ROOT / "build" / "shearwake"))
        output = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
        version = output.split()[1]
        for file, line in (("analysis/shearwake/__init__.py", f'__version__ = "{version}"'),
                           ("CITATION.cff", f"version: {version}"), ("CHANGELOG.md", f"## {version}"), ("codemeta.json", f'"version": "{version}"'),
                           (".zenodo.json", f'"version": "{version}"'), ("packaging/conda/meta.yaml", f'version: "{version}"')):
            self.assertIn(line, (ROOT / file).read_text(encoding="utf-8"), file)

    def configure(self, *disabled):
        return subprocess.run(
            ["cmake", "-S", ROOT, "-B", self.folder / "build", "-G", "Ninja",
             *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in disabled)],
            env={**os.environ, "LC_ALL": "C"}, capture_output=True, text=True, check=False)

    @pytest.mark.long
    def test_all_missing_libraries_are_listed_with_their_options(self):
        done = self.configure("HDF5", "fmt")
        self.assertEqual(done.returncode, 1, done.stdout)
        for line in ("HDF5 with MPI (HDF5_ROOT)", "fmt (fmt_ROOT)"):
            self.assertIn(line, done.stderr)
        self.assertNotIn("FFTW", done.stderr)

    @pytest.mark.long
    def test_a_library_of_one_command_is_optional(self):
        done = self.configure("Catch2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Catch2 (Catch2_ROOT): no tests", done.stdout)
