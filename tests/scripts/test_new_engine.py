# SPDX-License-Identifier: BSD-3-Clause
"""A new engine needs its own folder and two registrations, as docs/developer/extending.md says.

The engine is docs/developer/springs. Every run of the tests compiles what refers to the registrations;
scripts/test --long also builds the complete program and runs a case."""
import filecmp
import json
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import pytest

from program import gaussian, job_text

ROOT = Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build"
SPRINGS = Path("src/engines/springs")

# file: (line, the line and the one to add), as in docs/developer/extending.md
REGISTRATIONS = {
    "src/problem/case/solver_options.hpp": [
        ("/// The options of the engine that computes a case.",
         (ROOT / "docs/developer/springs/springs_options.hpp").read_text(encoding="utf-8").partition("\n")[2]
         + "\n/// The options of the engine that computes a case."),
        ("SpectralOptions, PstdOptions>", "SpectralOptions, PstdOptions, SpringsOptions>")],
    "src/engines/registry/make_engine.cpp": [
        ('#include "engines/spectral/spectral_engine.hpp"\n',
         '#include "engines/spectral/spectral_engine.hpp"\n#include "engines/springs/springs_engine.hpp"\n'),
        ("                          [](const PstdOptions&)",
         "                          [](const SpringsOptions&) -> std::unique_ptr<Engine> {\n"
         "                              return std::make_unique<springs::SpringsEngine>();\n"
         "                          },\n"
         "                          [](const PstdOptions&)")],
}
# Each refers to the list of all engines or to the new one.
COMPILED = ["src/engines/registry/make_engine.cpp", "src/engines/springs/springs_engine.cpp",
            "src/config/sections/read_solver.cpp"]

JOB = job_text("springs", medium={"base": "rigid", "layer": [{"preset": "thesis-tissue"}]},
               load={"peak_Pa": 200.0, "footprint": gaussian(8.0), "modulation": {
                   "kind": "STM", "path": {"shape": "line", "from_mm": [-6, 0], "to_mm": [6, 0]}, "speed_m_s": 6.0}},
               domain={"extent_mm": [48, 48], "spacing_mm": 1.0}, time={"duration_ms": 2.0, "output_interval_us": 100.0},
               measure={"focal_radius_mm": 4.0}, solver={"engine": "springs", "springs": {"modulus_kPa": 200, "length_mm": 5}})


class NewEngine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="shearwake-test-")
        cls.addClassCleanup(folder.cleanup)
        cls.tree = Path(folder.name) / "tree"
        for part in ("src", "cmake", "scripts", "analysis"):
            shutil.copytree(ROOT / part, cls.tree / part, ignore=shutil.ignore_patterns("__pycache__"))
        for file in ("CMakeLists.txt", "CMakePresets.json"):
            shutil.copy(ROOT / file, cls.tree)
        shutil.copytree(ROOT / "docs/developer/springs", cls.tree / SPRINGS, ignore=shutil.ignore_patterns("springs_options.hpp"))
        for name, changes in REGISTRATIONS.items():
            text = (cls.tree / name).read_text(encoding="utf-8")
            for old, new in changes:
                assert text.count(old) == 1, f"{name} has changed: {old}"
                text = text.replace(old, new)
            (cls.tree / name).write_text(text, encoding="utf-8")

    def test_the_registrations_are_the_only_other_files(self):
        changed = [str(path.relative_to(self.tree)) for path in sorted(self.tree.rglob("*"))
                   if path.is_file() and SPRINGS not in path.relative_to(self.tree).parents
                   and not filecmp.cmp(path, ROOT / path.relative_to(self.tree), shallow=False)]
        self.assertEqual(changed, sorted(REGISTRATIONS))

    @pytest.mark.extended
    def test_the_layers_accept_it(self):
        done = subprocess.run([sys.executable, ROOT / "scripts/check_layers.py", self.tree], capture_output=True,
                              encoding="utf-8", check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    @pytest.mark.long
    def test_what_refers_to_the_registrations_compiles(self):
        commands = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
        options = next(entry for entry in commands if "/src/engines/registry/" in entry["file"])
        words = shlex.split(options["command"])
        kept = [word for word in words[words.index("-I" + str(ROOT / "src")) - 1:]
                if word.startswith(("-D", "-I", "-isystem", "-std", "/usr/"))]
        kept = [word.replace(str(ROOT / "src"), str(self.tree / "src")) for word in kept]
        for name in COMPILED:
            with self.subTest(name):
                done = subprocess.run(["c++", *kept, "-fsyntax-only", self.tree / name], capture_output=True,
                                      encoding="utf-8", cwd=options["directory"], check=False)
                self.assertEqual(done.returncode, 0, done.stderr)

    @pytest.mark.long
    def test_the_program_computes_a_case_with_it(self):
        build = self.tree.parent / "build"
        for command in (["cmake", "--preset", "release", "-B", build, "-DSHEARWAKE_TESTS=OFF"],
                        ["cmake", "--build", build, "--target", "shearwake"]):
            done = subprocess.run(command, cwd=self.tree, capture_output=True, encoding="utf-8", check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        work = self.tree.parent / "work"
        work.mkdir()
        (work / "springs.toml").write_text(JOB, encoding="utf-8")
        for command in (["plan", "springs.toml"], ["run", "springs.toml"], ["reduce", "out/springs"]):
            done = subprocess.run([build / "shearwake", *command], cwd=work, capture_output=True, encoding="utf-8", check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        table = (work / "out/springs/tables/springs.csv").read_text(encoding="utf-8")
        row = dict(zip(*(line.split(",") for line in table.splitlines()[-2:])))
        # 200 Pa * 5 mm / 200 kPa = 5 um; the peak lies within half a spacing of a point.
        self.assertAlmostEqual(float(row["peak_um"]), 5.0, delta=0.01)
