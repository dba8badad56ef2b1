# SPDX-License-Identifier: BSD-3-Clause
"""The documentation shows what a new user of Debian 12 and 13 sees."""
import subprocess

import pytest

from program import ROOT


@pytest.mark.long
@pytest.mark.parametrize("release", ["bookworm", "trixie"])
def test_pages_notebooks_and_figures_are_those_of_a_clean_root(release):
    done = subprocess.run([ROOT / "scripts" / "check-docs", release], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, encoding="utf-8", check=False)
    if "needs root and the package debootstrap" in done.stdout:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stdout
