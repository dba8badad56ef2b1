# SPDX-License-Identifier: BSD-3-Clause
"""`cmake --install` gives a complete program: it works from its prefix, far from the source tree."""
import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import pytest

from kwave import reference, save, structures_of
from program import PROGRAM, ROOT, ProgramTest, case_files, environment


class Installed(ProgramTest):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "a prefix"
        self.command("cmake", "--install", PROGRAM.parent, "--prefix", self.prefix)
        self.user = self.folder / "user"
        self.user.mkdir()

    def command(self, *words, cwd=None):
        """Runs a command that finds the installed program on the PATH, and nothing of the source tree."""
        found = {name: value for name, value in environment().items() if name != "SHEARWAKE"}
        found["PATH"] = f"{self.prefix / 'bin'}{os.pathsep}{found['PATH']}"
        return self.call(*words, cwd=cwd or self.folder, env=found).stdout

    @pytest.mark.long
    def test_the_main_job_runs_and_is_reported(self):
        job = self.prefix / "share" / "shearwake" / "jobs" / "quickstart.toml"
        self.command("mpirun", "-n", "2", "shearwake", "run", job,
                     "-S", 'sweep."load.modulation.am_frequency_Hz"=[200]', cwd=self.user)
        self.command("shearwake", "reduce", "out/quickstart", cwd=self.user)
        self.command("shearwake", "report", "out/quickstart", cwd=self.user)
        out = self.user / "out" / "quickstart"
        self.assertEqual(len(case_files(out)), 2)
        self.assertGreater((out / "report" / "index.html").stat().st_size, 10000)

    @pytest.mark.extended
    def test_a_kwave_study_is_imported_and_run(self):
        run = "a_additive_pml10"
        save(self.user / "study.mat", structures_of(run, reference(run)))
        output = self.command("shearwake-import-kwave", "study.mat", cwd=self.user)
        self.command(*output.splitlines()[-1].removeprefix("next: ").split(), cwd=self.user)
        self.assertTrue((self.user / "study-output.h5").exists())

    def test_the_elastic_program_of_kwave_is_installed(self):
        data = ROOT / "tests" / "data" / "kwave"
        output = self.command("kspaceFirstOrder-elastic", "-i", data / "plane_wave_input.h5", "-o", "out.h5", "-pt", "2", "--benchmark", "5",
                            cwd=self.user)
        self.contains(output, "2 ranks", "100 %")
        self.assertTrue((self.user / "out.h5").exists())
        folder, = self.prefix.glob("lib/python3*/*-packages")
        text = ("import sys; sys.path.insert(0, sys.argv[1]); import numpy; from shearwake.kwave import pstd_elastic_3d\n"
                "mask = numpy.zeros((12, 10, 8)); mask[6, 5, 4] = 1\n"
                "print(pstd_elastic_3d(dict(N=(12, 10, 8), spacing=(1e-3,) * 3, dt=1e-5, Nt=6), dict(sound_speed_compression=20.0, "
                "sound_speed_shear=5.0, density=1e3), dict(u_mask=mask, uz=numpy.ones((1, 6))), dict(mask=mask), pml_size=2, quiet=True)['p'].shape)")
        self.assertEqual(self.command(sys.executable, "-c", text, folder, cwd=self.user).strip(), "(1, 6)")
        if shutil.which("octave-cli"):
            text = (f"addpath('{self.prefix}/share/shearwake/analysis/matlab'); load('{data}/plane_wave_study.mat'); kgrid.Nt = 6; "
                    f"found = pstdElastic3Dshearwake(kgrid, medium, source, sensor, options{{:}}, 'Python', '{sys.executable}'); disp(size(found.p))")
            self.contains(self.command("octave-cli", "--quiet", "--eval", text, cwd=self.user), " 6\n")

    def test_the_python_package_is_installed_and_finds_the_program(self):
        folders = list(self.prefix.glob("lib/python3*/*-packages"))
        self.assertEqual(len(folders), 1)
        (self.user / "bad.toml").write_text("schema = 1\n")
        text = ("import sys; sys.path.insert(0, sys.argv[1]); import shearwake\n"
                "try: shearwake.Job('bad.toml').check()\nexcept shearwake.JobError as error: print(error)")
        self.assertIn("[medium] is missing", self.command(sys.executable, "-c", text, folders[0], cwd=self.user))

    @pytest.mark.long
    def test_the_notebooks_run_with_the_installed_package_and_with_a_wheel(self):
        shutil.copytree(ROOT / "analysis", self.folder / "analysis", ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
        pip, offline = ("/usr/bin/python3", "-m", "pip"), ("-q", "--no-index", "--no-deps")
        self.command(*pip, "wheel", *offline, "--no-build-isolation", "./analysis")
        self.command(*pip, "install", *offline, "--target", self.folder / "wheel", *self.folder.glob("*.whl"))
        installed, = self.prefix.glob("lib/python3*/*-packages")
        for folder in (installed, self.folder / "wheel"):
            for notebook in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")):
                with self.subTest(folder=folder, notebook=notebook.stem):
                    place = self.folder / f"{folder.name}-{notebook.stem}"
                    place.mkdir()
                    content = json.loads(notebook.read_text(encoding="utf-8"))
                    source = f"assert shearwake.__path__[0].startswith({str(folder)!r}), shearwake.__path__"
                    content["cells"].append({"cell_type": "code", "id": "last", "metadata": {}, "outputs": [], "execution_count": None, "source": [source]})
                    (place / notebook.name).write_text(json.dumps(content), encoding="utf-8")
                    self.command("env", f"PYTHONPATH={folder}", "/usr/bin/python3", "-m", "nbconvert", "--to", "notebook", "--execute",
                                 "--ExecutePreprocessor.timeout=-1", "--output", "done.ipynb", notebook.name, cwd=place)
                    self.assertNotIn("NotValid: ", (place / "done.ipynb").read_text(encoding="utf-8"))

    def test_the_scripts_find_their_parts(self):
        for name in ("shearwake-make-map", "shearwake-submit", "shearwake-nightly"):
            with self.subTest(script=name):
                self.assertIn("usage", self.command(name, "--help", cwd=self.user).lower())

    @pytest.mark.extended
    @unittest.skipUnless(shutil.which("groff") and shutil.which("help2man"), "groff or help2man is not installed")
    def test_the_manual_page_is_well_formed(self):
        page = self.prefix / "share" / "man" / "man1" / "shearwake.1"
        shown = subprocess.run(["groff", "-man", "-ww", "-Tascii", page], capture_output=True,
                               encoding="ascii", errors="replace", check=True)
        self.assertEqual(shown.stderr, "")
        for word in ("check", "SHEARWAKE_CACHE", "--retry-failed", "EXIT STATUS"):
            self.assertIn(word, re.sub(".\x08", "", shown.stdout))  # bold is printed twice

    def completed(self, *words):
        """What bash offers for the last word."""
        script = self.prefix / "share" / "bash-completion" / "completions" / "shearwake"
        text = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _shearwake; '
                'printf "%s\\n" "${COMPREPLY[@]}"')
        return self.command("bash", "-c", text, "bash", script, "shearwake", *words, cwd=self.user).split()

    @pytest.mark.extended
    def test_bash_completes_commands_options_values_and_files(self):
        for name in ("a.toml", "b.txt", "c.h5"):
            (self.user / name).touch()
        (self.user / "d").mkdir()
        self.assertEqual(self.completed("re"), ["reduce", "report", "respond"])
        self.assertEqual(self.completed("run", "--retry"), ["--retry-failed"])
        self.assertEqual(self.completed("bench", "lay"), ["layered"])
        self.assertEqual(self.completed("show", "--modul"), ["--modulation"])
        for command, files in (("check", ["a.toml"]), ("show", ["c.h5"]), ("reduce", []), ("measure", ["a.toml", "b.txt", "c.h5"])):
            offered = self.completed(command, "")
            for name in ("a.toml", "b.txt", "c.h5", "d"):
                self.assertEqual(name in offered, name in (*files, "d"), (command, name))
