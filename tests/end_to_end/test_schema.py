# SPDX-License-Identifier: BSD-3-Clause
"""The JSON Schema of job files: every job of the repository is valid, what it rejects `check` rejects too, and the language servers
taplo and tombi mark errors at their place."""
import json
import random
import re
import shutil
import subprocess
import tomllib

import jsonschema
import pytest

from limits import times
from program import JOB, PATIENCE_s, ROOT, ProgramTest, changed

JOBS = sorted((ROOT / "jobs").glob("*.toml"))
FOOTPRINT = 'footprint = { shape = "gaussian", fwhm_mm = 4.5 }'
PATH = 'path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }'
SWEPT = '"load.modulation.am_frequency_Hz" = [400, 500, 1000]'
END = 'reference = { kind = "STM" }\n'
# (text of the small job, what replaces it): each makes it invalid in one place.
INVALID = [
    ("schema = 1", "schema = 2"), ("schema = 1", 'schema = "1"'), ("schema = 1", ""),
    ('name = "small"', 'name = "../small"'), ('name = "small"', f'name = "{101 * "a"}"'), ('name = "small"', "name = 3"), ('name = "small"', ""),
    ('title = "a small', 'titel = "a small'),
    ('base = "rigid"', 'base = "rigit"'), ('base = "rigid"', "base = 1"), ('base = "rigid"', 'bass = "rigid"'),
    ('name = "tissue"', "name = 4"), ("thickness_mm = 20.0", "thickness_mm = 0.0"),
    ("thickness_mm = 20.0", "thickness_cm = 2.0"), ("thickness_mm = 20.0", 'thickness_mm = "20"'),
    ("density_kg_m3 = 1000.0", "density_kg_m3 = -1.0"), ("density_kg_m3 = 1000.0", "density_kg_m3 = [1000.0]"),
    ("c_s_m_s = 5.0", "c_s_m_s = 0"), ("c_s_m_s = 5.0", "c_s_mps = 5.0"), ("c_p_m_s = 1500.0", "c_p_m_s = true"),
    ("viscosity_Pa_s = 1.0", "viscosity_Pa_s = -1.0"), ("viscosity_Pa_s = 1.0", 'loss = "some"'),
    ("viscosity_Pa_s = 1.0", 'loss = { law = "maxwell" }'),
    ("viscosity_Pa_s = 1.0", 'loss = { law = "fractional", tau_us = 260.0, exponent = 1.5 }'),
    ("viscosity_Pa_s = 1.0", 'loss = { law = "kelvin-voigt", tau_us = 3.0, viscosity_Pa_s = 1.0 }'),
    ("viscosity_Pa_s = 1.0", 'viscosity_Pa_s = 1.0\n[[medium.body]]\nshape = "cone"'),
    ("viscosity_Pa_s = 1.0", 'viscosity_Pa_s = 1.0\n[[medium.body]]\nshape = "ellipsoid"\nradius_mm = 3.0\n'
                             "center_mm = [0.0, 0.0, 5.0]\nc_s_m_s = 9.0"),
    ("viscosity_Pa_s = 1.0", 'viscosity_Pa_s = 1.0\n[[medium.body]]\nshape = "box"\nsize_mm = [1.0, 2.0]\n'
                             "center_mm = [0.0, 0.0, 5.0]\nc_s_m_s = 9.0"),
    ("peak_Pa = 100.0", "peak_Pa = 0.0"), ("peak_Pa = 100.0", "peak_kPa = 0.1"), ("peak_Pa = 100.0", 'peak_Pa = "1"'),
    (FOOTPRINT, 'footprint = { shape = "square", fwhm_mm = 4.5 }'), (FOOTPRINT, "footprint = 4.5"),
    (FOOTPRINT, 'footprint = { shape = "gaussian", fwhm_mm = 4.5, pitch_mm = 10.0 }'),
    (FOOTPRINT, FOOTPRINT + '\ncarrier = "resolve"'),
    ('kind = "AM-STM"', 'kind = "AMSTM"'), ('kind = "AM-STM"', "kind = 3"),
    (PATH, 'path = { shape = "lime", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }'),
    (PATH, 'path = { shape = "line", from_mm = [-14.0], to_mm = [14.0, 0.0] }'),
    (PATH, 'path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0], at_end = "jump" }'),
    (PATH, 'path = { shape = "circle", radius_mm = 5.0, sweep_deg = 90.0 }'),
    (PATH, 'path = { shape = "circle", radius_mm = 0.0 }'),
    (PATH, 'path = { shape = "polygon", sides = 2, radius_mm = 5.0 }'),
    ("speed_m_s = 7.0", "speed_m_s = 0.0"), ("speed_m_s = 7.0", "speed = 7.0"), ("speed_m_s = 7.0", 'speed_m_s = "7"'),
    ("am_frequency_Hz = 500.0", "am_frequency_Hz = 500.0\nam_depth = 2.0"), ("am_frequency_Hz = 500.0", "am_frequenzy_Hz = 500.0"),
    ("am_frequency_Hz = 500.0", 'am_frequency_Hz = 500.0\nam_wave = "saw"'),
    ("extent_mm = [64.0, 48.0]", "extent_mm = 64.0"), ("extent_mm = [64.0, 48.0]", "extent_mm = [64.0, 48.0, 1.0]"),
    ("spacing_mm = 1.5", "spacing_mm = 0"), ("spacing_mm = 1.5", "spacing_mm = [1.5]"),
    ("duration_ms = 4.0", "duration_s = 0.004"), ("output_interval_us = 100.0", "output_interval_us = -100.0"),
    ('engine = "layered"', 'engine = "layerd"'), ('engine = "layered"', 'engine = "layered"\ndegree = 4'),
    ('engine = "layered"', 'engine = "spectral"\n[solver.spectral]\ndegree = 1'),
    ('engine = "layered"', 'engine = "pstd"\n[solver.pstd]\nprecision = "half"'),
    ("at_ms = 4.0", "at_ms = 0"), ("frames = true", 'frames = "yes"'), ("frames = true", "frame = true"),
    (SWEPT, '"load.modulation.am_frequency_Hz" = 400'),
    (SWEPT, '"load.modulation.am_frequency_Hz" = { linspace = [400, 1000, 1] }'),
    (SWEPT, '"load.modulation.am_frequency_Hz" = { linspace = [400, 1000] }'),
    (SWEPT, '"load.modulation.am_frequency_Hz" = { refine = [400, 1000], column = "peak_um", tolerance = 1, initial = 2 }'),
    (SWEPT, '"load.modulation.am_frequency_Hz" = { refine = [400, 1000], column = "peak_um", tolerance = 1, first = 3 }'),
    (SWEPT, '"modulation.am_frequency_Hz" = [400]'),
    ('x = "load.modulation.am_frequency_Hz"', "x = 1"), (END, 'referenz = { kind = "STM" }\n'),
    (END, END + '[afferents]\nwhere = "foot"\n'), (END, END + "[afferents]\nclasses = [\"SA2\"]\n"),
    (END, END + '[afferents]\nwhere = "grid"\nextent_mm = [10.0, 10.0]\npitch_mm = 0.0\n'),
    (END, END + "[afferents]\npin_line = { from_mm = [0.0, 0.0], to_mm = [1.0, 0.0], count = 1 }\n"),
    (END, END + "[afferents]\npin_line = { from_mm = [0.0, 0.0], to_mm = [1.0, 0.0], number = 3 }\n"),
    (END, END + "[afferents]\npin_grid = { extent_mm = [-1.0, 1.0], pitch_mm = 1.0 }\n"),
]


class Schema(ProgramTest):
    def setUp(self):
        super().setUp()
        schema = json.loads(self.shearwake("schema").stdout)
        jsonschema.Draft202012Validator.check_schema(schema)
        self.validator = jsonschema.Draft202012Validator(schema)

    def rejects(self, text):
        return not self.validator.is_valid(tomllib.loads(text))

    def test_every_job_is_valid(self):
        for job in JOBS:
            errors = [error.message for error in self.validator.iter_errors(tomllib.loads(job.read_text("utf-8")))]
            self.assertEqual(errors, [], job.name)
        self.assertFalse(self.rejects(JOB))

    def test_what_it_rejects_the_program_rejects(self):
        self.assertGreater(len(INVALID), 50)
        for change in random.Random("schema").sample(INVALID, times(20, len(INVALID))):
            with self.subTest(change=change):
                text = changed(change)
                self.assertTrue(self.rejects(text), "the schema accepts it")
                self.shearwake("check", self.write_job(text), expect=3)

    @pytest.mark.extended
    def test_keys_may_come_from_the_sweep_alone(self):
        text = changed(("am_frequency_Hz = 500.0\n", ""))
        self.assertFalse(self.rejects(text))
        self.shearwake("check", self.write_job(text))

    def test_descriptions_state_meaning_unit_default_and_range(self):
        spacing = self.validator.schema["properties"]["domain"]["properties"]["spacing_mm"]
        self.assertIn("[mm]", spacing["description"])
        self.assertEqual((spacing["minimum"], spacing["maximum"]), (1e-9, 1e4))
        depth = self.validator.schema["properties"]["measure"]["properties"]["depths_mm"]
        self.assertEqual(depth["type"], "array")
        degree = self.validator.schema["properties"]["solver"]["properties"]["spectral"]["properties"]["degree"]
        self.assertEqual((degree["default"], degree["minimum"], degree["maximum"]), (8, 2, 16))


# (text of the small job, what replaces it): a misspelt key, a wrong type and a wrong choice, also of keys that belong to one of several
# alternatives. The schema alone can find them.
MARKED = [("peak_Pa = 100.0", "peek_Pa = 100.0"), (FOOTPRINT, FOOTPRINT.replace("fwhm_mm", "fwhm_m")),
          ("am_frequency_Hz = 500.0", "am_frequenzy_Hz = 500.0"), ('title = "a small', 'titel = "a small'),
          ("spacing_mm = 1.5", 'spacing_mm = "1.5"'), ("am_frequency_Hz = 500.0", 'am_frequency_Hz = "500"'),
          (PATH, PATH.replace("[-14.0, 0.0]", "3.0")), ("frames = true", 'frames = "yes"'), (SWEPT, '"load.modulation.am_frequency_Hz" = 400'),
          ('base = "rigid"', 'base = "rigit"'), ('kind = "AM-STM"', 'kind = "AMSTM"'), (PATH, PATH.replace('"line"', '"lime"')),
          ('engine = "layered"', 'engine = "layerd"')]


@pytest.mark.extended
class Editors(ProgramTest):
    """CONTRIBUTING.md states how to install the tools."""

    def check_with(self, tool, command):
        """`command` lints files, given the path of the schema."""
        if not shutil.which(tool):
            self.skipTest(f"{tool} is not installed, see CONTRIBUTING.md")
        for options in ((), ("--draft-7",)):
            schema = self.folder / "job.schema.json"
            schema.write_text(self.shearwake("schema", *options).stdout, encoding="utf-8")

            def lint(*files, schema=schema):
                done = subprocess.run([tool, *command(schema), *map(str, files)], cwd=self.folder, stdin=subprocess.DEVNULL, check=False,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", timeout=PATIENCE_s)
                return done.returncode, re.sub("\x1b\\[[0-9;]*m", "", done.stdout)

            jobs = [shutil.copy(job, self.folder) for job in JOBS]
            code, output = lint(*jobs)
            self.assertEqual((code, re.findall("(?i)error|warning", output)), (0, []), output)
            code, output = lint(*(self.write_job(changed(change), f"marked-{n}.toml") for n, change in enumerate(MARKED)))
            self.assertNotEqual(code, 0)
            for n, change in enumerate(MARKED):
                with self.subTest(options=options, change=change):
                    text = changed(change)
                    line = str(text[:text.index(change[1])].count("\n") + 1)
                    lines = set(re.findall(rf"marked-{n}\.toml:(\d+):\d+", output))
                    named = re.findall(rf"\('(\w+)' was unexpected\)\s+\S+ \S+marked-{n}\.toml:", output)
                    if named:  # taplo marks the table of a misspelt key as well
                        self.assertEqual((len(set(named)), line in lines), (1, True), output)
                        self.assertIn(named[0], change[1])
                    else:
                        self.assertEqual(lines, {line}, output)

    def test_taplo_marks_errors_and_no_valid_job(self):
        self.check_with("taplo", lambda schema: ["check", "--schema", f"file://{schema}"])

    def test_tombi_marks_errors_and_no_valid_job(self):
        (self.folder / "tombi.toml").write_text('[[schemas]]\npath = "job.schema.json"\ninclude = ["*.toml"]\n', encoding="utf-8")
        self.check_with("tombi", lambda _: ["lint", "--offline", "--error-on-warnings"])
