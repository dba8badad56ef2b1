# SPDX-License-Identifier: BSD-3-Clause
"""The reference pages state what the program prints: the columns of tables and the exit codes."""
import re
from pathlib import Path

from blocks import DOCS
from program import ROOT, ProgramTest, read_csv, small_job


def rows(markdown):
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in markdown.splitlines() if line.startswith("| ")]


def test_every_row_of_orders_has_a_test():
    """The tests themselves fail if a row is missing."""
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests" / "verify").glob("*.cpp"))
    found = rows((DOCS / "explanation" / "verification.md").read_text(encoding="utf-8"))[1:]
    assert len(found) == tests.count("check_order(") + 1  # one test has two sections
    assert [row[1] for row in found if f'TEST_CASE("{row[1]}"' not in tests] == []


class Reference(ProgramTest):
    def columns(self):
        """{name: unit} of the printed columns."""
        return {name.strip("`"): unit for name, unit, _ in rows(self.shearwake("columns").stdout)[1:]}

    def test_every_column_of_a_table_is_listed_with_its_unit(self):
        job = self.write_job(small_job({"afferents.where": "palm", "measure.sensation": True, "measure.depths_mm": [0.0, 1.5]}))
        self.reduced(self.out, job=job)
        header = read_csv(self.out / "tables" / "small.csv")[0]
        page = (DOCS / "reference" / "table-columns.md").read_text(encoding="utf-8")
        identification = re.findall(r"^\| `(\w+)`", page[page.index("## Identification"):], flags=re.MULTILINE)
        patterns = [re.compile(re.sub(r"\\\{\w+\\\}", ".+", re.escape(name)) + r"(_z[\d.]+mm)?") for name in self.columns()]
        for column in header:
            with self.subTest(column=column):
                self.assertTrue(column in identification or "." in column.split("_z")[0] or
                                any(pattern.fullmatch(column) for pattern in patterns))

    def test_names_end_in_their_units(self):
        for name, unit in self.columns().items():
            with self.subTest(name=name):
                ending = {"degree": "deg"}.get(unit, unit.replace(" ", "_"))
                self.assertTrue(name.endswith("_" + ending) or name == "periods", unit)

    def test_pages_name_columns_that_exist(self):
        text = (DOCS / "reference" / "table-columns.md").read_text(encoding="utf-8")
        named = set(re.findall(r"`((?:felt|mach|period|region|receptor|velocity|peak|focal)_\w+_(?:1|dB|Hz|deg|uJ|um|mm2?))`", text))
        self.assertEqual(named - set(self.columns()), set())
        self.assertGreater(len(named), 5)

    def test_help_lists_every_exit_code(self):
        defined = re.findall(r"^    \w+ =\s+(\d+)", (ROOT / "src" / "base" / "error.hpp").read_text(encoding="utf-8"), flags=re.MULTILINE)
        listed = re.findall(r"^  (\d+) +\S", self.shearwake("--help").stdout.partition("Exit codes:")[2], flags=re.MULTILINE)
        self.assertEqual(listed, defined)
        self.assertIn("75", listed)

    def test_architecture_names_every_file_that_declares_keys(self):
        page = (DOCS / "developer" / "architecture.md").read_text(encoding="utf-8")
        declared = [path for folder in ("problem", "config/document") for path in Path(ROOT, "src", folder).rglob("*.hpp")
                    if re.search(r'\{\.key = "\w', path.read_text(encoding="utf-8"))]
        self.assertGreater(len(declared), 10)
        for path in declared:
            with self.subTest(path=path):
                self.assertRegex(page, rf"[`/]{re.escape(path.name)}`")
