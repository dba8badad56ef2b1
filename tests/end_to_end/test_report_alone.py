"""`shearwake report` on what a run has left behind, with the real program."""
import shutil
import unittest

from program import ProgramTest


class ReportAlone(ProgramTest):
    def test_the_case_files_alone_make_the_page(self):
        self.write_job()
        self.shearwake("run", "job.toml")
        shutil.copytree(self.out / "cases", self.folder / "copy" / "cases")
        said = self.shearwake("report", "copy").said
        self.says(said, "copy/report/index.html")
        page = (self.folder / "copy" / "report" / "index.html").read_text(encoding="utf-8")
        self.says(page, "a small sweep, \u03b7 against frequency",  # title, count, figure, job
                  "4 cases (of them 1 reference): 4 complete.", 'id="gain"',
                  "reference = { kind = &quot;STM&quot; }")
        self.assertTrue((self.folder / "copy" / "report" / "gain.pdf").exists())

    def test_a_folder_with_neither_plan_nor_cases_is_refused(self):
        (self.folder / "copy" / "cases").mkdir(parents=True)
        self.says(self.shearwake("report", "copy", expect=6).said, "cannot read copy/plan.json")


if __name__ == "__main__":
    unittest.main()
