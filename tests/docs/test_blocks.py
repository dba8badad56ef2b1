# SPDX-License-Identifier: BSD-3-Clause
"""Every shell, Python, Octave and TOML block of docs/ works as it is printed."""
import json
import re
import shutil
import subprocess
import sys
import tomllib

import jsonschema
import pytest

from blocks import EXECUTED, FRAGMENT, SHOWN, VALIDATED, blocks, first_difference, make_reader_folder, pages
from program import PATIENCE_s, ProgramTest


PRINTED = re.compile(r"^print\(.*\) +# (\S.*)$", re.MULTILINE)  # Python that states its result in a comment


def interpreter(language):
    return {"sh": ["sh", "-eu", "-c"], "python": [sys.executable, "-c"], "octave": ["octave-cli", "--quiet", "--eval"]}[language]


class Blocks(ProgramTest):
    def test_every_block_names_a_known_language(self):
        for page in pages():
            for block in blocks(page):
                self.assertIn(block.language, EXECUTED | VALIDATED | SHOWN, str(block))

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

    def execute(self, page):
        """The executed blocks of a page in order, in one folder."""
        folder = self.folder / "reader"
        folder.mkdir()
        reader = make_reader_folder(folder)
        left_out = []
        session = {"python": "", "octave": ""}  # the blocks of one page share their variables
        output = None  # of the preceding block, if it was executed
        for block in blocks(page):
            if block.language == "text" and output is not None and page.parent.name in ("tutorial", "how-to"):
                self.assertEqual(first_difference(block.text, output), "", f"{block} shows what its commands do not print:\n{output}")
            if block.language not in EXECUTED:
                output = None
                continue
            if block.language == "octave" and not shutil.which("octave-cli"):
                left_out.append(str(block))
                continue
            text = block.text
            if block.language in session:
                session[block.language] += block.text
                text = session[block.language]
            done = subprocess.run([*interpreter(block.language), text], cwd=folder, env=reader,
                                  stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
                                  errors="replace", timeout=PATIENCE_s, check=False)
            self.assertEqual(done.returncode, 0, f"{block}:\n{block.text}\n{done.stdout}{done.stderr}")
            self.assertNotIn("NotValid: ", done.stderr, f"{block}: an example has readings that are not valid")
            output = done.stdout + done.stderr
            for printed in PRINTED.findall(block.text):
                self.assertIn(printed, done.stdout.splitlines(), f"{block} states another result than it prints")
        if left_out:
            self.skipTest(f"octave-cli is not installed: these blocks were not run: {', '.join(left_out)}")


def _add_pages():
    for page in pages():
        if any(block.language in EXECUTED for block in blocks(page)):
            name = f"{page.parent.name}_{page.stem}".replace("-", "_")

            def test(self, page=page):
                self.execute(page)
            if page.stem != "1-first-sweep":
                test = pytest.mark.long(test)  # of a lambda it would make a mark instead of a test
            setattr(Blocks, f"test_the_commands_of_{name}_work", test)


_add_pages()
