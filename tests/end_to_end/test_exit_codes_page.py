# SPDX-License-Identifier: BSD-3-Clause
"""The loop on the page of exit codes resumes a run until it is complete."""
import re
import subprocess

from program import PATIENCE_s, ROOT, ProgramTest


class ExitCodesPage(ProgramTest):
    def test_the_loop_of_the_example_ends_when_the_study_is_complete_or_stopped(self):
        page = (ROOT / "docs" / "reference" / "exit-codes.md").read_text(encoding="utf-8")
        lines = re.search(r"```console\n(.*?)```", page, flags=re.DOTALL).group(1)
        script = "".join(line.removeprefix("$ ") + "\n" for line in lines.splitlines())
        (self.folder / "mpirun").write_text("#!/bin/sh\necho run >> runs\nset -- $(cat codes)\necho $2 $3 > codes\nexit $1\n")
        (self.folder / "sleep").write_text("#!/bin/sh\n")
        for name in ("mpirun", "sleep"):
            (self.folder / name).chmod(0o755)
        (self.folder / "out" / "quickstart").mkdir(parents=True)
        for codes, stop, runs in (("0", False, 1), ("75 75 0", False, 3), ("75 4 0", False, 2), ("75 75 75", True, 1)):
            with self.subTest(codes=codes, stop=stop):
                (self.folder / "codes").write_text(codes)
                (self.folder / "runs").write_text("")
                if stop:
                    (self.folder / "out" / "quickstart" / "STOP").touch()
                subprocess.run(["sh", "-c", script], cwd=self.folder, env={"PATH": f"{self.folder}:/usr/bin:/bin"}, check=False,
                               timeout=PATIENCE_s)
                self.assertEqual((self.folder / "runs").read_text().count("run"), runs)
