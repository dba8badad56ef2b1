# SPDX-License-Identifier: BSD-3-Clause
"""Paths of the focus that are read from files."""

from program import ProgramTest, csv_path, small_job, without_reference

CSV = csv_path("paths/hook.csv")


class Loads(ProgramTest):
    def write_points(self, text, folder="."):
        (self.folder / folder / "paths").mkdir(parents=True)
        (self.folder / folder / "paths" / "hook.csv").write_text(text, encoding="utf-8")

    def test_files_of_points_are_relative_to_the_job(self):
        self.write_points("x_mm,y_mm\n-14,0\n0,0\n0,8\n", folder="elsewhere")
        self.write_job(small_job(CSV), name="elsewhere/job.toml")
        self.shearwake("check", "elsewhere/job.toml", ranks=2)
        self.write_job(small_job(CSV))
        output = self.shearwake("check", "job.toml", ranks=2, expect=3).output
        self.contains(output, "error: load.modulation.path.file cannot be used", "paths/hook.csv")

    def test_the_id_of_a_case_depends_on_the_content_of_the_file(self):
        def ids(text):
            (self.folder / "paths" / "hook.csv").write_text(text, encoding="utf-8")
            output = self.shearwake("plan", "job.toml").output
            return [line.split()[0] for line in output.splitlines() if "AM frequency" in line]
        self.write_points("")
        self.write_job(without_reference(CSV))
        first = ids("x_mm,y_mm\n-14,0\n0,0\n0,8\n")
        self.assertEqual(first, ids("# the same in m\nx_m,y_m\n-0.014,0\n0,0\n0,0.008\n"))
        self.assertNotEqual(first, ids("x_mm,y_mm\n-14,0\n0,0\n0,9\n"))
