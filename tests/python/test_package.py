# SPDX-License-Identifier: BSD-3-Clause
"""pip installs the package without network, and importing it imports no large package."""
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from study import InFolder, program

ANALYSIS = program.ROOT / "analysis"


class Package(InFolder):
    def command(self, *words, cwd=None):
        done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True, check=False,
                              timeout=program.PATIENCE_s)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    @pytest.mark.long
    def test_pip_installs_it_without_network(self):
        shutil.copytree(ANALYSIS, "analysis", ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
        self.command("/usr/bin/python3", "-m", "venv", "--system-site-packages", "env")
        # Debian's packages have versions such as 999 and names that pip does not know.
        self.command("env/bin/pip", "install", "-q", "--no-build-isolation", "--no-index", "--no-deps", "./analysis")
        printed = self.command("env/bin/python", "-I", "-c", "import shearwake; print(shearwake.__file__)").strip()
        self.assertTrue(Path(printed).is_relative_to(self.folder / "env"), printed)
        self.assertTrue(Path(printed).with_name("py.typed").is_file())
        label = self.command("env/bin/python", "-I", "-c", "from shearwake.keys import label; print(label('eta_period_1'))")
        self.assertEqual(label.strip(), "efficiency η")
        needed = self.command("env/bin/python", "-I", "-c", "import importlib.metadata as m; print(*m.requires('shearwake'))")
        needed = needed.replace(" (", "").replace(")", "")  # as setuptools writes them, depending on its version
        for name in ("numpy>=", "h5py>=", "xarray>=", "matplotlib>=", "xxhash>="):
            self.assertIn(name, needed)
        # Its command is replaced by the program that it finds, and explains what is missing without it.
        self.assertIn("shearwake 0", self.command("env/bin/shearwake", "--version"))
        alone = subprocess.run(["env/bin/shearwake", "--version"], capture_output=True, text=True, check=False,
                               env={"PATH": f"{self.folder}/env/bin:/usr/bin:/bin"})
        self.assertEqual(alone.returncode, 6)
        self.assertIn("is not on the PATH", alone.stderr)

    def test_a_program_without_jobs_is_an_error(self):
        folder = self.folder / "elsewhere" / "build"
        folder.mkdir(parents=True)
        shutil.copytree(ANALYSIS / "shearwake", folder / "package" / "a" / "shearwake", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy("/bin/true", folder / "shearwake")
        text = "import shearwake\ntry: shearwake.jobs()\nexcept shearwake.ProgramNotFound as error: print(error)"
        printed = self.command("env", f"PYTHONPATH={folder / 'package' / 'a'}", f"SHEARWAKE={folder / 'shearwake'}", sys.executable, "-c", text)
        self.assertIn("contain no jobs; install the program", printed)

    def test_importing_it_is_cheap(self):
        text = (f"import sys; sys.path.insert(0, {str(ANALYSIS)!r}); import shearwake; "
                "print([m for m in ('pandas', 'xarray', 'matplotlib', 'tomli_w') if m in sys.modules])")
        self.assertEqual(self.command(sys.executable, "-c", text).strip(), "[]")
