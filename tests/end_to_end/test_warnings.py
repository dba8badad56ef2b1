# SPDX-License-Identifier: BSD-3-Clause
"""Warnings that are stored with a case."""
import json

import h5py
import pytest

from program import PSTD, SPECTRAL, ProgramTest, case_files, read_by, read_csv, swept, table, without_reference
from test_solver_notes import BONE, ELASTIC, SHORT

# A focus that rests at the centre of a domain of 24 mm for 30 ms: waves cross it seven times.
WAVES_RETURN = without_reference(read_by(30.0), swept(200), {
    "load.modulation": {"kind": "AM", "am_frequency_Hz": 500.0}, "domain.extent_mm": [24.0, 24.0], "record": {}})


class Warnings(ProgramTest):
    def test_a_settling_time_in_seconds_is_warned_of(self):
        self.write_job(WAVES_RETURN)
        for settled_ms, warns in (("0.02", True), ("2.0", False)):
            output = self.shearwake("check", "job.toml", "-S", f"measure.settled_after_ms={settled_ms}", "-S",
                                  "time.output_interval_us=20").output
            self.assertEqual("nothing settles in this time; settled_after_ms is in ms" in output, warns)

    def stored(self):
        found = []
        for path in case_files(self.out):
            with h5py.File(path) as file:
                found.append(json.loads(file.attrs["warnings"]))
        return found

    def notes(self):
        return [row["note"] for row in table(self.out)]

    @pytest.mark.long
    def test_returning_waves_make_a_reading_invalid_everywhere(self):
        self.write_job(WAVES_RETURN)
        invalid = "the readings of 1 case are not valid"
        self.contains(self.shearwake("run", "job.toml").output, "return through the opposite one", invalid)
        state = json.loads(self.shearwake("status", self.out, "--json").stdout)
        self.assertEqual((state["not_valid"], state["not_valid_cases"]), (1, [case_files(self.out)[0].stem]))
        [warnings] = self.stored()
        returned = [w for w in warnings if w["key"] == "domain.extent_mm"]
        self.assertEqual([w["severity"] for w in returned], ["error"])
        self.contains(returned[0]["message"], "the readings of this case are not valid")
        self.contains(self.shearwake("reduce", self.out).output, invalid)
        self.contains(self.notes()[0], "not valid: domain.extent_mm: waves of 5 m/s")
        table = self.out / "tables" / "small.csv"
        self.assertEqual([row["valid"] for row in read_csv(table)], ["no"])
        # A change of validity is a difference.
        (self.folder / "before.csv").write_text(table.read_text(encoding="utf-8").replace(",no,", ",yes,"), encoding="utf-8")
        changed_columns = json.loads(self.shearwake("compare", self.out, "before.csv", "--json", expect=1).stdout)["moved"]
        self.assertEqual([column["column"] for column in changed_columns], ["valid"])
        self.contains(self.shearwake("show", case_files(self.out)[0]).output, "not valid: domain.extent_mm")
        self.contains(self.shearwake("report", self.out).output, "No result is stated, because no case has valid readings")
        # The index of the folder has the same warnings as the file.
        next(self.out.glob("index*.jsonl")).unlink()
        first = self.notes()
        self.shearwake("reduce", self.out)
        self.assertEqual(self.notes(), first)

    def test_check_counts_the_warnings_of_engines(self):
        for changes, expected in (({**ELASTIC, **BONE}, "medium.body[1]: shear stiffness"), (PSTD, "is capped at 50 m/s, 10 times c_s")):
            with self.subTest(expected=expected):
                self.write_job(without_reference(changes, SHORT))
                done = self.shearwake("check", "job.toml").output
                lines = [line for line in done.splitlines() if ": warning: " in line]
                self.assertTrue(any(expected in line for line in lines), done)
                self.contains(done, f"{len(lines)} warning")
                counted = json.loads(self.shearwake("check", "job.toml", "--json").stdout)
                self.assertEqual(counted["warnings"], len(lines))
        self.contains(self.shearwake("check", "job.toml", "-S", "solver.pstd.time_step_us=20", expect=3).output,
                      "error: solver.pstd.time_step_us", "is unstable on this grid")

    def test_a_step_that_misses_the_accuracy_is_stored_with_its_key(self):
        self.write_job(without_reference(SPECTRAL, SHORT))
        self.shearwake("run", "job.toml")
        self.assertFalse([w for warnings in self.stored() for w in warnings if "accuracy" in w["message"]])
        self.shearwake("run", "job.toml", "--out", "long", "-S", "solver.spectral.time_step_us=100")
        self.out = self.folder / "long"
        for warnings in self.stored():
            [message] = [w["message"] for w in warnings if w["key"] == "solver.spectral.time_step_us"
                         and "accuracy" in w["message"]]
            self.assertRegex(message, "exceeds the accuracy of .*remove this key, or use a shorter step")
