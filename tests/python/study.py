# SPDX-License-Identifier: BSD-3-Clause
"""Computes small sweeps for the tests of the package."""
import os
import tempfile
from pathlib import Path

import matplotlib

import program
import shearwake

matplotlib.use("Agg")
os.environ.update(program.environment(), SHEARWAKE=str(program.PROGRAM))
AM, FWHM = program.AM, "load.footprint.fwhm_mm"


class InFolder(program.Interrupting):
    """Runs the tests of a class in one temporary folder, which is the current folder."""

    @classmethod
    def setUpClass(cls):
        cls.before, cls.temporary = Path.cwd(), tempfile.TemporaryDirectory(prefix="shearwake-python-")
        cls.folder = Path(cls.temporary.name).resolve()
        os.chdir(cls.folder)
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.addClassCleanup(os.chdir, cls.before)


def job(*changes):
    """The small job of the end-to-end tests: three frequencies and their reference, with all frames."""
    return shearwake.Job(program.small_job(*changes))
