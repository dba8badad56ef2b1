# SPDX-License-Identifier: BSD-3-Clause
"""shearwake diff: its exit codes and its output."""
import json
import unittest

from program import SWEEP, ProgramTest, changed, plan_ids


class Diff(ProgramTest):
    def compute(self, text, out):
        self.write_job(text)
        self.shearwake("run", "job.toml", "--out", out, "--quiet")
        self.shearwake("reduce", out)

    def test_tables_of_other_ranks_are_equal_and_tables_of_another_load_differ(self):
        self.compute(changed(), "one")
        self.shearwake("run", "job.toml", "--out", "two", "--quiet", ranks=2)
        self.says(self.shearwake("diff", "two", "one", expect=6).said,
                  "two has no table yet", "next: shearwake reduce two")
        self.shearwake("reduce", "two")
        said = self.shearwake("diff", "two", "one").said
        self.says(said, "4 cases", "no difference", "not compared: wall_s, note")
        # The same comparison under mpirun, and with tables instead of folders.
        self.shearwake("diff", "two/tables/small.csv", "one/tables/small.csv", ranks=2)

        self.compute(changed(("peak_Pa = 100.0", "peak_Pa = 101.0")), "more")
        said = self.shearwake("diff", "more", "one", expect=5, ranks=2).said
        self.says(said, "peak_um", "+1 %", "4 cases with different ids", "4 of 4 cases changed")
        self.assertNotIn("eta_period_1", said)  # a ratio, in which the strength of the load cancels
        moved = json.loads(self.shearwake("diff", "more", "one", "--json", expect=5, ranks=2).stdout)
        columns = [column["column"] for column in moved["moved"]]
        self.says(columns, "peak_um", "impulse_mN_ms")
        self.assertNotIn("wall_s", columns)
        # Quantities that are proportional to the load increase by 1 %.
        self.shearwake("diff", "more", "one", "--tolerance", "*=0.011")
        (self.folder / "t.toml").write_text('[tolerance]\n"*" = 0.011\npeak_um = 1e-3\n', encoding="utf-8")
        said = self.shearwake("diff", "more", "one", "--tolerances", "t.toml", expect=5).said
        self.says(said, "peak_um", "1 column changed")
        self.shearwake("diff", "more", "one", "--tolerances", "t.toml", "--tolerance", "peak_um=0.011")

    def test_missing_and_extra_cases_are_differences(self):
        self.compute(changed(), "one")
        self.compute(changed((SWEEP, '"load.modulation.am_frequency_Hz" = [400, 500]')), "fewer")
        said = self.shearwake("diff", "fewer", "one", expect=5).said
        self.says(said, "missing case: load.modulation.am_frequency_Hz=1000", "3 cases")
        self.says(self.shearwake("diff", "one", "fewer", expect=5).said, "extra case")
        # A case that was not computed has a row, and a corresponding status.
        (self.folder / "one" / "cases" / f"{plan_ids(self.folder / 'one')[0]}.h5").unlink()
        self.shearwake("reduce", "one")
        self.says(self.shearwake("diff", "one", "fewer", expect=5).said, "complete -> missing")

    def test_an_invalid_table_is_an_error_of_the_environment(self):
        (self.folder / "bad.csv").write_text("id,a\n1\n", encoding="utf-8")
        (self.folder / "good.csv").write_text("id,a_1\nx,1\n", encoding="utf-8")
        self.says(self.shearwake("diff", "bad.csv", "good.csv", expect=6).said, "bad.csv:2:", "not a valid table")
        self.says(self.shearwake("diff", "none.csv", "good.csv", expect=6).said, "none.csv", "no such")
        self.shearwake("diff", self.folder, "good.csv", expect=6)

    def test_an_invalid_tolerance_is_a_usage_error(self):
        (self.folder / "good.csv").write_text("id,eta_1\nx,1\n", encoding="utf-8")
        (self.folder / "t.toml").write_text("[tolerance]\neta_1 = -1\n", encoding="utf-8")
        for wrong, word in (("eta_2=1", "did you mean eta_1?"), ("eta_1", "COLUMN=RELATIVE")):
            said = self.shearwake("diff", "good.csv", "good.csv", "--tolerance", wrong, expect=2).said
            self.says(said, wrong.split("=")[0], word)
        said = self.shearwake("diff", "good.csv", "good.csv", "--tolerances", "t.toml", expect=2).said
        self.says(said, "t.toml:2:", "at least 0")
        self.shearwake("diff", "good.csv", expect=2)


if __name__ == "__main__":
    unittest.main()
