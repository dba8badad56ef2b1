# SPDX-License-Identifier: BSD-3-Clause
"""The limits of the sliders of `shearwake explore` are those of their keys in the schema of jobs."""
import json
import re
import subprocess
import unittest
from pathlib import Path

from study import program

from shearwake.explore import page

SETTINGS = Path(page.__file__).parent / "page" / "settings.js"


def number(least, most):
    return {"type": "number", "minimum": least, "maximum": most}


def alternative(selector, name, properties):
    return {"if": {"properties": {selector: {"const": name}}}, "then": {"properties": properties}}


class Limits(unittest.TestCase):
    def test_alternatives_with_the_same_key_keep_their_limits(self):
        schema = {"properties": {"footprint": {"properties": {"gain": number(0, 1)}, "allOf": [
            alternative("shape", "array", {"distance_mm": number(20, 2000)}),
            alternative("shape", "lens", {"distance_mm": number(5, 2000)})]}}}
        self.assertEqual(page.ranges(schema), {
            "footprint.gain": {"": (0, 1)}, "footprint.distance_mm": {"array": (20, 2000), "lens": (5, 2000)}})

    def test_references_and_lists_are_followed(self):
        schema = {"properties": {"path": {"$ref": "#/$defs/path"}, "layer": {"items": {"properties": {"c": number(1, 2)}}}},
                  "$defs": {"path": {"allOf": [alternative("shape", "circle", {"radius": number(3, 4)})]}}}
        self.assertEqual(page.ranges(schema), {"path.radius": {"circle": (3, 4)}, "layer.c": {"": (1, 2)}})

    def test_sliders_name_keys_of_the_schema(self):
        schema = json.loads(subprocess.run([*program.command("schema")], capture_output=True, check=True, text=True).stdout)
        found = page.ranges(schema)
        text = SETTINGS.read_text("utf-8")
        sliders = re.findall(r'key: "([^"]+)"(?:, alternative: "([^"]+)")?', text)
        self.assertGreaterEqual(len(sliders), 9)
        for key, name in [*sliders, *((key, "") for key in re.findall(r': "(load.modulation.[a-z]+_frequency_Hz)"', text))]:
            self.assertIn(name, found[key], key)
        self.assertEqual(found["load.footprint.distance_mm"]["array"], (20.0, 2000.0))
