# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the commands do not depend on the matplotlibrc of the user."""
import hashlib
import json
import subprocess
import sys

import h5py
import numpy as np
import pytest

from program import ROOT, environment
from synthetic import AM, PHYSICS, Folder, InFolder, sweep

pytestmark = pytest.mark.extended

# LaTeX is not installed on most machines; the backend does not exist.
HOSTILE = """backend: module://no_such_backend
text.usetex: True
lines.marker: o
lines.linestyle: :
font.size: 30
font.family: serif
figure.figsize: 2, 2
figure.constrained_layout.use: True
axes.prop_cycle: cycler("color", ["ff0000"])
axes.grid: True
axes.grid.which: both
axes.xmargin: 0.4
image.cmap: gray
image.origin: lower
savefig.bbox: tight
savefig.dpi: 20
savefig.facecolor: black
savefig.transparent: True
xtick.direction: in
"""
PLAIN = ""
COMPARED = "depths_m = [0.0]\n[solver]\nengine = \"layered\"\n"
EFFICIENCY = "from gallery import efficiency; from pathlib import Path; efficiency.draw_folder(Path('first'), Path('efficiency.png'))"

COMPARE = "import sys; from shearwake.report.compare.__main__ import main; sys.exit(main(sys.argv[1:]) != 1)"  # 1: differs


def fit(folder):
    """fit.json and fit.h5 of a line scan without waves."""
    folder.mkdir()
    (folder / "fit.json").write_text(json.dumps({"is_line": False, "estimates": {"c_s": 1, "mu": 2}, "correlations": [[1, 0.5], [0.5, 1]]}))
    with h5py.File(folder / "fit.h5", "w") as file:
        points = np.arange(6.0)
        file.update({"x": 1e-3 * points, "y": 1e-3 * points % 2e-3, "residual_rms": 1e-6 * (1 + points), "weight": points % 2.0,
                     "time": points, "measured": points, "predicted": points})


class UserMatplotlibrc(InFolder):
    def pictures(self, name, *command):
        """Digests of all pictures that a command writes with a matplotlibrc in its folder and one of the user."""
        for path in (self.root / "matplotlibrc", self.root / "user" / "matplotlibrc"):
            path.parent.mkdir(exist_ok=True)
            path.write_text(name)
        subprocess.run([sys.executable, *command], cwd=self.root, check=True, capture_output=True, timeout=300,
                       env={**environment(), "PYTHONPATH": str(ROOT / "analysis"), "MATPLOTLIBRC": str(self.root / "user")})
        files = [*self.root.rglob("*.png"), *self.root.glob("*.gif"), *self.root.glob("*.html"), *self.root.rglob("report/*.pdf")]
        found = {str(path.relative_to(self.root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
        for path in files:
            path.unlink()
        return found

    def test_each_command_draws_the_same_pictures_with_any_matplotlibrc(self):
        for name in ("first", "second", "third"):
            (self.root / name).mkdir()
        sweep(self.root / "first").save()
        for name, strength in (("second", 1.0), ("third", 2.0)):
            folder = Folder(self.root / name)
            folder.add({AM: 100.0}, strength=strength, physics=PHYSICS.format(kind="AM-STM") .replace("[measure]", "nx = 50\nny = 31\n[measure]") + COMPARED)
            folder.save()
        fit(self.root / "fit")
        course = {"t_s": [0, 1e-3, 2e-3], "x_m": [0, 1e-2, 2e-2], "y_m": [0, 0, 1e-3], "speed_m_s": [1, 2, 1], "gain": [0, 1, 0]}
        modulation = {"kind": "AM-STM", "foci_x_m": [], "foci_y_m": [], "frequency_Hz": 500, "run": course, "period": course}
        (self.root / "modulation.json").write_text(json.dumps(modulation))
        case = next((self.root / "first" / "cases").glob("*.h5"))
        commands = {"report": ("-m", "shearwake.report", "second"), "movie": ("-m", "shearwake.report.movie", str(case), "--out", "m", "--width", "320"),
                    "modulation": ("-m", "shearwake.report.modulation", "modulation.json", "modulation.png"),
                    "fit": ("-m", "shearwake.laboratory.fit_figures", "fit"), "gallery": ("-c", EFFICIENCY),
                    "compare": ("-c", COMPARE, "second", "third", "--page", "page.html")}
        for name, command in commands.items():
            with self.subTest(name):
                expected = self.pictures(PLAIN, *command)
                self.assertTrue(expected)
                self.assertEqual(self.pictures(HOSTILE, *command), expected)
