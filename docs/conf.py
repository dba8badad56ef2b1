# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the documentation site; scripts/docs builds it."""
import re
from pathlib import Path

_cmake = (Path(__file__).resolve().parent.parent / "CMakeLists.txt").read_text(encoding="utf-8")

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
