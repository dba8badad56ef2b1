# SPDX-License-Identifier: BSD-3-Clause
"""The version of the program identifies the state of its source."""
import subprocess

import pytest

from program import ROOT, ProgramTest

pytestmark = pytest.mark.extended


class GitId(ProgramTest):
    def git(self, *words):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b.c", *words], cwd=self.folder,
                       check=True, capture_output=True)

    def version(self, source="."):
        header = self.folder.parent / f"{self.folder.name}.hpp"
        self.addCleanup(header.unlink, missing_ok=True)
        subprocess.run(["cmake", f"-DSOURCE={self.folder / source}", "-DVERSION=1.2", f"-DOUT={header}", "-P",
                        ROOT / "scripts" / "git_id.cmake"], check=True)
        return header.read_text(encoding="utf-8").split('"')[1]

    def test_trees_with_different_changes_have_different_versions(self):
        source = self.folder / "main.cpp"
        source.write_text("one", encoding="utf-8")
        self.git("init", "--quiet")
        self.git("add", ".")
        self.git("commit", "--quiet", "-m", "one")
        clean = self.version()
        self.assertRegex(clean, "^[0-9a-f]{12}$")
        changed = []
        for text in ("two;", "three"):
            source.write_text(text, encoding="utf-8")
            changed.append(self.version())
            self.assertRegex(changed[-1], f"^{clean}-dirty-[0-9a-f]{{8}}$")
            self.assertEqual(self.version(), changed[-1])
        self.assertNotEqual(*changed)

    def test_an_unpacked_archive_has_the_id_of_its_release(self):
        self.assertEqual(self.version(), "v1.2")
        (self.folder / "unpacked").mkdir()
        (self.folder / "unpacked" / "main.cpp").write_text("one", encoding="utf-8")
        self.git("init", "--quiet")  # a repository around the archive has other commits
        self.git("add", ".")
        self.git("commit", "--quiet", "-m", "one")
        self.assertEqual(self.version("unpacked"), "v1.2")
