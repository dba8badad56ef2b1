# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the documentation site; scripts/docs builds it."""
import os
import re
import subprocess
from pathlib import Path

_ROOT = Path(__file__).resolve().parent.parent
_PROGRAM = os.environ.get("SHEARWAKE", _ROOT / "build" / "shearwake")
_cmake = (_ROOT / "CMakeLists.txt").read_text(encoding="utf-8")

project = "shearwake"
author = "the shearwake authors"
copyright = author  # the name is fixed by Sphinx
release = re.search(r"project\(shearwake VERSION ([\d.]+)", _cmake)[1]
version = release

extensions = ["myst_parser"]
exclude_patterns = ["_build"]
myst_heading_anchors = 4
nitpicky = True

html_theme = "furo"
html_title = f"shearwake {release}"
html_copy_source = False
html_show_sphinx = False


def _printed(*arguments):
    return subprocess.run(["shearwake", *arguments], executable=_PROGRAM, stdin=subprocess.DEVNULL, check=True,
                          capture_output=True, encoding="utf-8").stdout


def _add_printed(_app, page, source):
    """Adds to a page what the program prints: the keys of a job, and the help of each command below its heading."""
    if page == "reference/keys":
        source[0] = _printed("keys")
    elif page == "reference/commands":
        source[0] = re.sub(r"^## `(\w+)`\n", lambda heading: f"{heading[0]}\n```text\n{_printed('help', heading[1])}```\n",
                           source[0], flags=re.MULTILINE)


def setup(app):
    app.connect("source-read", _add_printed)
