# SPDX-License-Identifier: BSD-3-Clause
"""The program's table of classes of receptors is the only one."""
import json
import re
import subprocess

import program
from study import InFolder, job

# Files that name classes without listing them, in examples in docstrings.
NAMED = {"analysis/shearwake/case.py"}


def table():
    schema = json.loads(subprocess.run([program.PROGRAM, "schema"], capture_output=True, check=True, encoding="utf-8").stdout)
    return schema["properties"]["afferents"]["properties"]["classes"]["x-classes"]


class ReceptorClasses(InFolder):
    def test_every_class_has_a_label_and_colours(self):
        for name, properties in table().items():
            with self.subTest(name=name):
                self.assertTrue(properties["label"])
                for colour in ("colour", "colour_on_map"):
                    self.assertRegex(properties[colour], "^#[0-9A-F]{6}$")

    def test_case_files_state_the_colours_of_all_classes(self):
        case = job({"afferents": {"where": "grid", "extent_mm": [20.0, 20.0], "pitch_mm": 10.0}}).run(out="out").cases[0]
        expected = {name: properties["colour"] for name, properties in table().items()}
        self.assertEqual(case.receptor_colours(), expected)
        self.assertLessEqual(set(case.receptor_classes()), set(expected))

    def test_other_sources_do_not_list_the_classes(self):
        names = "|".join(table())
        for folder in ("analysis", "scripts"):
            for path in (program.ROOT / folder).rglob("*"):
                name = str(path.relative_to(program.ROOT))
                if path.suffix in (".py", ".js", ".html") and name not in NAMED:
                    with self.subTest(path=name):
                        self.assertIsNone(re.search(rf"""["'](?:{names})["']""", path.read_text(encoding="utf-8")))

    def test_keys_state_the_neurons_of_every_class(self):
        text = subprocess.run([program.PROGRAM, "keys"], capture_output=True, check=True, encoding="utf-8").stdout
        for name in table():
            self.assertRegex(text, rf"0 to \d+ for {name}\b")
