# SPDX-License-Identifier: BSD-3-Clause
"""Writes the folder shearwake-VERSION.dist-info, by which pip and xarray recognise a package that CMake has installed.

Usage: python3 dist_info.py ANALYSIS FOLDER
"""
import re
import sys
import tomllib
from pathlib import Path

analysis, folder = map(Path, sys.argv[1:3])
project = tomllib.loads((analysis / "pyproject.toml").read_text(encoding="utf-8"))["project"]
version = re.search(r'^__version__ = "(.*)"', (analysis / "shearwake" / "__init__.py").read_text(encoding="utf-8"), re.MULTILINE)[1]
for old in folder.glob("shearwake-*.dist-info/*"):
    old.unlink()
for old in folder.glob("shearwake-*.dist-info"):
    old.rmdir()
made = folder / f"shearwake-{version}.dist-info"
made.mkdir()
lines = ["Metadata-Version: 2.1", "Name: shearwake", f"Version: {version}", f"Summary: {project['description']}",
         f"Requires-Python: {project['requires-python']}", *(f"Requires-Dist: {needed}" for needed in project["dependencies"])]
(made / "METADATA").write_text("\n".join(lines) + "\n", encoding="utf-8")
(made / "INSTALLER").write_text("cmake\n", encoding="utf-8")
