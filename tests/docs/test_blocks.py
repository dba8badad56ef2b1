# SPDX-License-Identifier: BSD-3-Clause
"""Every shell, Python, Octave and TOML block of docs/ works as it is printed."""
import json
import os
import tomllib
from unittest import mock

import jsonschema
import pytest

from blocks import EXECUTED, FRAGMENT, NEEDS, SHOWN, VALIDATED, blocks, execute, first_difference, make_reader_folder, needs, pages
from program import ROOT, ProgramTest


class Blocks(ProgramTest):
    def test_every_block_names_a_known_language(self):
        for page in pages():
            for block in blocks(page):
                self.assertIn(block.language, EXECUTED | VALIDATED | SHOWN, str(block))

    def test_blocks_that_are_left_out_exist(self):
        begins = [block.text for page in [ROOT / "README.md", *pages()] for block in blocks(page)]
        self.assertEqual([begin for begin in NEEDS if not any(text.startswith(begin) for text in begins)], [])

    def test_toml_blocks_are_jobs_or_parts_of_jobs(self):
        schema = json.loads(self.shearwake("schema").stdout)
        for rule in ("required", "if", "then", "else"):  # what only complete jobs must have
            schema.pop(rule)
        fragments = jsonschema.Draft202012Validator(schema)
        count = 0
        for page in pages():
            for block in blocks(page):
                if block.language != "toml":
                    continue
                count += 1
                with self.subTest(block=str(block)):
                    if block.text.startswith(FRAGMENT):
                        fragments.validate(tomllib.loads(block.text))
                    else:
                        self.shearwake("check", self.write_job(block.text))
        self.assertGreater(count, 0)

    def test_an_output_agrees_to_the_digits_shown(self):
        printed = "8 cases, peak_um\n  -4.746 % (1.2e+05 times), eta_1 0.188 6949606f6d6e1586"
        for shown in ("8 cases, ...\neta_1 0.19", "... peak_um -4.74 % (1e+05 times), ...", "6949606f6d6e1586"):
            self.assertEqual(first_difference(shown, printed), "", shown)
        for wrong in ("9 cases,", "peak_um ... 8 cases,", "peak_mm", "eta_1 0.190", "6949606f6d6e1587"):
            self.assertNotEqual(first_difference(wrong, printed), "", wrong)

    def test_a_shell_keeps_exported_variables_and_wrong_outputs_are_found(self):
        page = self.folder / "how-to" / "page.md"
        page.parent.mkdir()
        page.write_text("```console\n$ export A=5\n$ for i in 1 2; do\n>   echo $i $A; done\n1 5\n2 5\n```\n```sh\necho $A\n```\n"
                        "```text\n6\n```\n```console\n$ false\n```\n", encoding="utf-8")
        with mock.patch("blocks.ROOT", self.folder):
            faults = list(execute(page, self.folder, dict(os.environ), EXECUTED | {"console"}, lambda block: False))
        self.assertEqual([fault.split("\n")[0] for fault in faults],
                         ["how-to/page.md:11 shows what its commands do not print:", "how-to/page.md:14 fails:"])

    def execute(self, page):
        """The executed blocks of a page in order, in one folder."""
        folder = self.folder / "reader"
        folder.mkdir()
        left_out = []

        def is_left_out(block):
            if need := needs(block):
                left_out.append(f"{block} needs {need}")
            return bool(need)
        self.assertEqual(list(execute(page, folder, make_reader_folder(folder), EXECUTED, is_left_out)), [])
        if left_out:
            self.skipTest(f"these blocks were not run: {'; '.join(left_out)}")


def _add_pages():
    for page in pages():
        if any(block.language in EXECUTED for block in blocks(page)):
            name = f"{page.parent.name}_{page.stem}".replace("-", "_")

            def test(self, page=page):
                self.execute(page)
            # Of a lambda it would make a mark instead of a test.
            mark = pytest.mark.extended if page.stem == "1-first-sweep" else pytest.mark.long
            setattr(Blocks, f"test_the_commands_of_{name}_work", mark(test))


_add_pages()
