# SPDX-License-Identifier: BSD-3-Clause
"""Differences of tables, their tolerances, and files that are not tables."""
import tempfile
import unittest
from pathlib import Path

from shearwake.report.compare.compare_tables import NotATable, Table, compare_tables, match_rows, read_table
from shearwake.report.compare.tolerances import BadTolerance, Tolerances, default_tolerance, read_tolerances

HEADER = "id,reference,load.peak_Pa,eta_1,zero_um,wall_s,status,note\n"
BASE = HEADER + "a,,100,0.5,0,1.0,complete,\nb,,200,0.25,2,1.0,complete,\nc,yes,,0.125,4,1.0,complete,\n"


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def table(self, text):
        (self.path / "t.csv").write_bytes(text.encode())
        return read_table(self.path / "t.csv")

    def compared(self, now, reference=BASE, *tolerance):
        first, second = self.table(now), self.table(reference)
        return compare_tables(first, second, match_rows(first, second), read_tolerances(tolerance))

    def with_eta(self, eta, *tolerance):
        return self.compared(BASE.replace("b,,200,0.25", f"b,,200,{eta}"), BASE, *tolerance).moved()

    def test_seconds_notes_and_the_order_of_rows_and_columns_do_not_matter(self):
        found = self.compared("note,id,reference\nx,a,\n", "id,reference,note\na,,y\n")
        self.assertEqual((found.moved(), found.not_compared), ([], ["note"]))
        found = self.compared(HEADER + "c,yes,,0.125,4,7,complete,x\nb,,200.0,2.5e-1,2,7,complete,y\na,,100,0.5,-0,7,complete,z\n")
        self.assertEqual((found.moved(), len(found.matched.pairs), found.not_compared), ([], 3, ["wall_s", "note"]))

    def test_a_number_may_differ_by_at_most_its_tolerance(self):
        for eta in ("0.2502499", "0.2497501"):
            self.assertEqual(self.with_eta(eta, "eta_1=1e-3"), [])
        (column,) = self.with_eta("0.25025001", "eta_1=1e-3")
        (cell,) = column["cells"]
        self.assertEqual((column["column"], cell["case"]), ("eta_1", "load.peak_Pa=200"))
        self.assertAlmostEqual(cell["change"], 1e-3, delta=1e-7)
        self.assertEqual(self.with_eta("0.25000002"), [])  # 8e-8 of it, below the default
        self.assertEqual(len(self.with_eta("0.25000003")), 1)  # 1.2e-7

    def test_a_reference_of_zero_has_the_scale_of_its_column(self):
        now = BASE.replace("0.5,0,", "0.5,3e-7,")  # the largest of the column is 4
        self.assertEqual(self.compared(now).moved(), [])
        self.assertEqual(len(self.compared(now, BASE, "zero_um=1e-8").moved()), 1)
        (cell,) = self.compared("id,x\na,1\n", "id,x\na,0\n", "*=1").moved()[0]["cells"]  # the column is 0
        self.assertEqual(cell["over_tolerance"], float("inf"))

    def test_changes_in_dB_are_those_of_the_amplitude(self):
        for level, reference in (("0.08", "0"), ("60.08", "60")):
            now, base = (f"id,felt_path_dB\na,{value}\n" for value in (level, reference))
            self.assertEqual(self.compared(now, base, "*=0.01").moved(), [])
            (cell,) = self.compared(now, base, "*=0.009").moved()[0]["cells"]
            self.assertAlmostEqual(cell["change"], 10 ** (0.08 / 20) - 1, delta=1e-12)

    def test_a_number_never_equals_an_empty_cell_or_a_text(self):
        for eta in ("", "nan", "x", "inf", "0.25_0", "0,25", "1e999"):
            quoted = f'"{eta}"'
            (column,) = self.with_eta(quoted, "*=1e9")
            self.assertEqual((column["cells"][0]["now"], column["cells"][0]["over_tolerance"]), (eta, float("inf")))
        self.assertEqual(self.with_eta("", "*=1")[0]["cells"][0]["words"], "became empty")

    def test_another_unit_is_a_difference(self):
        tables = [Table(["id", "peak"], [{"id": "a", "peak": "1"}], {"peak": unit}) for unit in ("um", "mm")]
        (column,) = compare_tables(*tables, match_rows(*tables), Tolerances()).moved()
        self.assertEqual(column["cells"][0]["words"], "other unit")

    def test_the_largest_difference_is_first(self):
        moved = self.compared(HEADER + "a,,100,0.51,0,1,complete,\nb,,200,0.26,2.1,1,failed,\nc,yes,,0.125,4,1,complete,\n").moved()
        self.assertEqual([c["column"] for c in moved], ["status", "zero_um", "eta_1"])
        self.assertEqual([cell["case"] for cell in moved[2]["cells"]], ["load.peak_Pa=200", "load.peak_Pa=100"])

    def test_cases_and_columns_of_one_table_are_differences(self):
        found = self.compared("id,reference,load.peak_Pa,eta_1,status,new_1\na,,100,0.5,complete,1\nc,yes,,0.125,complete,1\n"
                              "d,,300,0.1,complete,1\n")
        self.assertEqual(([row["id"] for row in found.matched.missing], [row["id"] for row in found.matched.extra]), (["b"], ["d"]))
        self.assertEqual((found.missing_columns, found.extra_columns), (["zero_um"], ["new_1"]))

    def test_cases_of_other_ids_are_matched_by_unique_swept_values(self):
        found = self.compared(HEADER + "z,yes,,0.125,4,1,complete,\ny,,2e2,0.25,2,1,complete,\nx,,100,0.5,0,1,complete,\n")
        self.assertEqual((found.matched.by_settings, found.moved()), (3, []))
        for rows in ("x,,100,0.5,0,1,complete,\ny,,100,0.5,0,1,complete,\n",  # ambiguous settings
                     "a,,100,0.5,0,1,complete,\na,,100,0.5,0,1,complete,\n"):  # one id twice
            found = self.compared(HEADER + rows + "c,yes,,0.125,4,1,complete,\n")
            self.assertEqual((len(found.matched.pairs), len(found.matched.missing), len(found.matched.extra)), (1, 2, 2))

    def test_files_that_are_not_tables_are_named_with_the_line(self):
        for text, words in (("", ":1: this is not a valid table: the file is empty"), ("id,a\n1\n", ":2: this is not a valid table: 1 cells"),
                            ("id,id\n1,2\n", 'two columns are named "id"'), ('id,a\n1,"2\n', ":2: this is not a valid table"),
                            ("id,a\n1,2\n\n1,2,3\n", ":4:")):
            with self.subTest(text=text), self.assertRaises(NotATable) as raised:
                self.table(text)
            self.assertIn(words, str(raised.exception))
        (self.path / "t.csv").write_bytes(b"id,a\n1,\xff\n")
        self.assertRaises(NotATable, read_table, self.path / "t.csv")
        self.assertEqual(self.table("\ufeffid;a\r\n1;2\r\n").rows, [{"id": "1", "a": "2"}])


class ReadTolerances(unittest.TestCase):
    def read(self, text, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "t.toml"
            path.write_text(text, encoding="utf-8")
            return read_tolerances([*arguments, str(path)])

    def test_a_file_and_the_command_line_give_tolerances_by_column(self):
        found = self.read('[tolerance]\neta_at_1 = 1e-5\nmach_angle_deg = inf\n"*" = 1e-6\npeak_um = 1e-3\n', "peak_um=0.5")
        self.assertEqual([found.for_column(name) for name in ("eta_at_1", "peak_um", "ipr_at_1")], [1e-5, 0.5, 1e-6])  # the command line precedes
        self.assertEqual([found.ignores(name) for name in ("mach_angle_deg", "wall_s", "note", "status")], [True, True, True, False])

    def test_only_sums_that_cancel_have_a_larger_default(self):
        self.assertEqual([default_tolerance(name) for name in
                          ("eta_at_1", "ipr_abs_period_mm2", "ipr_period_mm2", "ipr_at_1_z1.5mm")], [1e-7, 1e-7, 1e-4, 1e-4])

    def test_invalid_tolerances_are_rejected(self):
        for wrong in ("eta", "eta=", "=1", "eta=x", "eta=-1", "eta=nan", "eta=1e-3x"):
            with self.subTest(wrong), self.assertRaisesRegex(BadTolerance, "COLUMN=RELATIVE.*" + wrong):
                read_tolerances([wrong])
        for text, words in (("[tolerances]\n", "[tolerance] alone"), ("tolerance = 1\n", "[tolerance] alone"),
                            ("[tolerance]\na = -1\n", "a must be a number of at least 0"), ('[tolerance]\nb = "x"\n', "b must be"),
                            ("[tolerance]\nd = nan\n", "d must be"), ("[tolerance]\ne = true\n", "e must be"),
                            ("[tolerance\n", "t.toml: it is not valid TOML")):
            with self.subTest(text), self.assertRaises(BadTolerance) as raised:
                self.read(text)
            self.assertIn(words, str(raised.exception))
        with self.assertRaisesRegex(BadTolerance, "eta_2; did you mean eta_1"):
            read_tolerances(["eta_2=1"]).require_columns(["id", "eta_1"])
