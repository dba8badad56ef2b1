# SPDX-License-Identifier: BSD-3-Clause
"""Every notebook of docs/notebooks runs from its first to its last cell."""
import json
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import pytest

from study import InFolder, program

NOTEBOOKS = sorted((program.ROOT / "docs" / "notebooks").glob("*.ipynb"))
SHORT = "3-receptors"  # takes seconds


class Notebooks(InFolder):
    def test_there_are_notebooks_without_stored_output(self):
        self.assertGreaterEqual(len(NOTEBOOKS), 3)
        for path in NOTEBOOKS:
            for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
                self.assertEqual(cell.get("outputs", []), [], path)

    def execute(self, path):
        shutil.copy(path, path.name)
        done = subprocess.run(
            [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output", f"done-{path.name}",
             "--ExecutePreprocessor.timeout=-1", path.name], capture_output=True, text=True, check=False,
            timeout=program.PATIENCE_s, stdin=subprocess.DEVNULL, env={
                **os.environ, "PYTHONPATH": str(program.ROOT / "analysis")})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("NotValid: ", Path(f"done-{path.name}").read_text(encoding="utf-8"))
        cells = json.loads(Path(f"done-{path.name}").read_text(encoding="utf-8"))["cells"]
        pictures = [out for cell in cells for out in cell.get("outputs", []) if "image/png" in out.get("data", {})]
        self.assertGreater(len(pictures), 0)


def _add():
    for path in NOTEBOOKS:
        name = path.stem.replace("-", "_")

        def test(self, path=path):
            self.execute(path)
        setattr(Notebooks, f"test_{name}_runs", test if path.stem == SHORT else pytest.mark.long(test))


_add()

if __name__ == "__main__":
    unittest.main()
