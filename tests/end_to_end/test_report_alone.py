# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake report` on a folder that contains only case files."""
import shutil

import pytest

from program import UNRECORDED, ProgramTest


class ReportAlone(ProgramTest):
    @pytest.mark.long
    def test_case_files_suffice_for_the_page(self):
        self.write_job(UNRECORDED)
        self.shearwake("run", "job.toml")
        shutil.copytree(self.out / "cases", self.folder / "copy" / "cases")
        said = self.shearwake("report", "copy").said
        self.says(said, "copy/report/index.html")
        page = (self.folder / "copy" / "report" / "index.html").read_text(encoding="utf-8")
        self.says(page, "a small sweep, \u03b7 against frequency",  # title, count, figure, job
                  "4 cases (of them 1 reference): 4 complete.", 'id="gain"',
                  "reference = { kind = &quot;STM&quot; }")
        self.assertTrue((self.folder / "copy" / "report" / "gain.pdf").exists())

    def test_a_folder_with_neither_plan_nor_cases_is_rejected(self):
        (self.folder / "copy" / "cases").mkdir(parents=True)
        said = self.shearwake("report", "copy", expect=6).said
        self.says(said, "copy is not an output folder, since it contains no plan.json; run the job first")

    def test_a_folder_that_does_not_exist_asks_for_a_run(self):
        for command in (("report", "out/x"), ("reduce", "out/x"), ("status", "out/x"), ("compare", "out/x", "out/y")):
            with self.subTest(command=command):
                said = self.shearwake(*command, expect=6).said
                self.says(said, "out/x", "output folder", "run the job first")
                self.assertNotIn("cannot read", said)
