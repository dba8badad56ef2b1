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
from program import AM, JOB, PATIENCE_s, ROOT, ProgramTest, changed, small_job

JOBS = sorted((ROOT / "jobs").glob("*.toml"))
FOOTPRINT = 'footprint = { shape = "gaussian", fwhm_mm = 4.5 }'
PATH = 'path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }'
SWEPT = '"load.modulation.am_frequency_Hz" = [400, 500, 1000]'
LAYER, MODULATION = "medium.layer[1]", "load.modulation"
# Wrong values of keys of the small job. None: the key is missing.
WRONG = {
    "schema": [2, "1"], "job.name": ["../small", 101 * "a", 3, None], "job.titel": ["a small sweep"],
    "medium.base": ["rigit", 1], "medium.bass": ["rigid"],
    f"{LAYER}.name": [4], f"{LAYER}.thickness_mm": [0.0, "20"], f"{LAYER}.thickness_cm": [2.0], f"{LAYER}.density_kg_m3": [-1.0, [1000.0]],
    f"{LAYER}.c_s_m_s": [0], f"{LAYER}.c_s_mps": [5.0], f"{LAYER}.c_p_m_s": [True], f"{LAYER}.viscosity_Pa_s": [-1.0],
    "medium.body": [[{"shape": "cone"}],
                    [{"shape": "ellipsoid", "radius_mm": 3.0, "center_mm": [0.0, 0.0, 5.0], "c_s_m_s": 9.0}],
                    [{"shape": "box", "size_mm": [1.0, 2.0], "center_mm": [0.0, 0.0, 5.0], "c_s_m_s": 9.0}]],
    "load.peak_Pa": [0.0, "1"], "load.peak_kPa": [0.1], "load.carrier": ["resolve"],
    "load.footprint": [4.5, {"shape": "square", "fwhm_mm": 4.5}, {"shape": "gaussian", "fwhm_mm": 4.5, "pitch_mm": 10.0}],
    f"{MODULATION}.kind": ["AMSTM", 3], f"{MODULATION}.path.shape": ["lime"], f"{MODULATION}.path.from_mm": [[-14.0]], f"{MODULATION}.path.at_end": ["jump"],
    f"{MODULATION}.path": [{"shape": "circle", "radius_mm": 5.0, "sweep_deg": 90.0}, {"shape": "circle", "radius_mm": 0.0},
                             {"shape": "polygon", "sides": 2, "radius_mm": 5.0}],
    f"{MODULATION}.speed_m_s": [0.0, "7"], f"{MODULATION}.speed": [7.0], f"{MODULATION}.am_depth": [2.0], f"{MODULATION}.am_frequenzy_Hz": [500.0],
    f"{MODULATION}.am_wave": ["saw"],
    "domain.extent_mm": [64.0, [64.0, 48.0, 1.0]], "domain.spacing_mm": [0, [1.5]],
    "time.duration_s": [0.004], "time.output_interval_us": [-100.0],
    "solver.engine": ["layerd"], "solver.degree": [4], "measure.at_ms": [0], "record.frames": ["yes"], "record.frame": [True],
    "sweep": [{AM: 400}, {AM: {"linspace": [400, 1000, 1]}}, {AM: {"linspace": [400, 1000]}}, {"modulation.am_frequency_Hz": [400]},
              *({AM: {"refine": [400, 1000], "column": "peak_um", "tolerance": 1, **more}} for more in ({"initial": 2}, {"first": 3}))],
    "table.x": [1], "table.referenz": [{"kind": "STM"}],
    "afferents": [{"where": "foot"}, {"classes": ["SA2"]}, {"where": "grid", "extent_mm": [10.0, 10.0], "pitch_mm": 0.0},
                  {"pin_line": {"from_mm": [0.0, 0.0], "to_mm": [1.0, 0.0], "count": 1}},
                  {"pin_line": {"from_mm": [0.0, 0.0], "to_mm": [1.0, 0.0], "number": 3}},
                  {"pin_grid": {"extent_mm": [-1.0, 1.0], "pitch_mm": 1.0}}],
}
INVALID = [changed(("schema = 1", "")), *(small_job({key: value}) for key, values in WRONG.items() for value in values),
           *(small_job({f"{LAYER}.viscosity_Pa_s": None, f"{LAYER}.loss": loss}) for loss in (
               "some", {"law": "maxwell"}, {"law": "fractional", "tau_us": 260.0, "exponent": 1.5},
               {"law": "kelvin-voigt", "tau_us": 3.0, "viscosity_Pa_s": 1.0})),
           *(small_job({"solver": {"engine": engine, engine: options}}) for engine, options in (
               ("spectral", {"degree": 1}), ("pstd", {"precision": "half"})))]


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
        for text in random.Random("schema").sample(INVALID, times(20, len(INVALID))):
            with self.subTest(text=text):
                self.assertTrue(self.rejects(text), "the schema accepts it")
                self.shearwake("check", self.write_job(text), expect=3)

    @pytest.mark.extended
    def test_keys_may_come_from_the_sweep_alone(self):
        text = small_job({AM: None})
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
