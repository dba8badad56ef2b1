# SPDX-License-Identifier: BSD-3-Clause
"""Documents that commands print with --json match the published schema and the text output."""
import json

import jsonschema
import pytest

from program import JOB, MISSPELT, ROOT, UNRECORDED, ProgramTest, case_files, peaks, plan_ids, small_job

SCHEMA = json.loads((ROOT / "docs" / "reference" / "json-output.schema.json").read_text(encoding="utf-8"))


class Json(ProgramTest):
    def run_with(self, definition, *words, **options):
        """A run of a command, and its document, which matches a definition of the schema."""
        done = self.shearwake(*words, "--json", **options)
        document = json.loads(done.stdout)
        for schema in ({**SCHEMA, "oneOf": [{"$ref": f"#/$defs/{definition}"}]}, SCHEMA):  # the first one for clear messages
            jsonschema.Draft202012Validator(schema).validate(document)
        return done, document

    def document(self, command, *arguments, **options):
        return self.run_with(command, command, *arguments, **options)[1]

    def errors(self, command, *arguments, expect):
        """The messages of the document that a failing command prints; they also go to the standard error."""
        done, document = self.run_with("errors", command, *arguments, expect=expect)
        self.assertEqual(document["command"], command)
        messages = [error["message"] for error in document["errors"]]
        for message in messages:
            self.contains(done.stderr, message)
        return messages

    def test_failing_commands_print_their_errors(self):
        self.write_job(MISSPELT)
        for command in ("plan", "run", "evaluate"):
            with self.subTest(command):
                self.contains("\n".join(self.errors(command, "job.toml", expect=3)), "did you mean peak_Pa?")
                self.contains(self.errors(command, "nowhere.toml", expect=6)[0], "nowhere.toml")
        self.write_job()
        for command in ("status", "verify", "reduce", "report", "show"):
            with self.subTest(command):
                self.contains(self.errors(command, "nowhere", expect=6)[0], "nowhere")
        self.contains(self.errors("compare", "job.toml", "job.toml", expect=2)[0],
                      "is a job file; give the output folder of its run, by default out/small")
        self.contains(self.errors("run", "job.toml", "--quite", expect=2)[0], "did you mean --quiet?")
        self.contains(self.errors("bench", "nothing", expect=2)[0], "nothing")
        missing = self.document("check", "nowhere.toml", expect=6)
        self.assertEqual((missing["job"], missing["cases"], missing["errors"]), ("nowhere.toml", None, 1))
        self.assertEqual(self.document("check", "--quite", expect=2)["errors"], 1)

    @pytest.mark.extended
    def test_a_run_its_tables_and_its_report_are_described(self):
        self.write_job(UNRECORDED)
        ids = [case["id"] for case in self.document("plan", "job.toml")["cases"]]
        part = self.document("run", "job.toml", "--only", f"{ids[0]},{ids[1]}", "--quiet")
        self.assertEqual((part["cases"], part["computed"], part["not_selected"], part["state"]), (4, 2, 2, "finished"))
        self.contains(part["next"], "run the other cases")
        done = self.document("run", "job.toml", ranks=2)
        self.assertEqual((done["computed"], done["already_complete"], done["failed_cases"]), (2, 2, []))
        self.assertEqual(done["folder"], "out/small")
        self.contains(done["next"], "shearwake reduce out/small")
        reduced = self.document("reduce", self.out)
        self.assertEqual((reduced["cases"], reduced["complete"], reduced["damaged"]), (4, 4, []))
        self.assertTrue((self.folder / reduced["csv"]).exists())
        self.assertIsNone(reduced["sensitivity"])
        report = self.document("report", self.out)
        self.assertTrue((self.folder / report["page"]).exists())
        self.assertGreater(len(report["result"]), 10)
        failed = self.document("run", "job.toml", "-S", "load.peak_Pa=1e200", "--out", "bad", expect=4)
        self.assertEqual((failed["computed"], len(failed["failed_cases"])), (0, 4))
        self.contains(failed["failed_cases"][0]["reason"], "not finite")

    def test_check_lists_diagnostics(self):
        self.write_job()
        sound = self.document("check", "job.toml", ranks=2)
        self.assertEqual((sound["cases"], sound["errors"]), (4, 0))
        self.write_job(MISSPELT)
        bad = self.document("check", "job.toml", expect=3)
        self.assertEqual((bad["cases"], bad["errors"]), (None, 1))
        error, = [d for d in bad["diagnostics"] if d["severity"] == "error"]
        self.assertEqual((error["file"], error["line"]), ("job.toml", JOB[:JOB.index("peak_Pa")].count("\n") + 1))
        self.contains(error["message"], "did you mean peak_Pa?")
        self.write_job(small_job({"domain": {"extent_mm": [1600.0, 1600.0], "spacing_mm": 0.05}}))
        large = self.document("check", "job.toml", expect=3)
        self.contains(large["diagnostics"][-1]["message"], "MB per rank, and a rank may use")
        refused = self.document("plan", "job.toml", expect=3)
        self.assertIsNotNone(refused["error"])
        self.assertIsNone(refused["next"])

    @pytest.mark.long
    def test_results_are_described(self):
        self.write_job()
        self.shearwake("run", "job.toml", "--quiet", "--out", "rate")
        plan = self.document("plan", "job.toml", "-n", 3, "--ranks-per-case", 1)
        self.assertEqual((plan["ranks"], plan["teams"], plan["ranks_per_case"]), (3, 3, 1))
        self.assertEqual(plan["next"], "mpirun -n 3 shearwake run job.toml --ranks-per-case 1")
        self.assertAlmostEqual(plan["core_hours"], 3 * plan["wall_s"] / 3600)
        self.assertAlmostEqual(plan["disk_B"], sum(case["disk_B"] for case in plan["cases"]))
        self.shearwake("run", "job.toml", "--only", plan["cases"][0]["id"], "--quiet")
        part = self.document("status", self.out)
        self.assertEqual((part["cases"], part["done"], part["remaining"], part["is_active"]), (4, 1, 3, False))
        self.assertEqual((part["state"], part["not_valid"], part["not_valid_cases"]), ("stopped", 0, []))
        self.assertAlmostEqual(part["seconds_left"], 3 * part["seconds_per_case"])  # on one team
        self.contains(part["next"], "shearwake run")
        self.shearwake("run", "job.toml", "--quiet", ranks=2)
        self.assertEqual([case["id"] for case in plan["cases"]], plan_ids(self.out))
        done = self.document("status", self.out, ranks=2)
        self.assertEqual((done["done"], done["remaining"], done["seconds_left"]), (4, 0, 0))
        shown = self.document("show", case_files(self.out)[0])
        self.assertEqual(shown["settings"], next(case["settings"] for case in plan["cases"] if case["id"] == shown["id"]))
        measures = [measure["name"] for measure in shown["measures"]]
        self.assertIn("peak_um", measures)
        self.assertEqual(measures, sorted(measures, key=lambda name: "_at_" in name))  # readings at one instant come last
        self.assertIn("_at_", measures[-1])
        self.shearwake("reduce", self.out)
        self.assertTrue(self.document("compare", self.out, self.out)["equal"])
        self.write_job(small_job({"load.peak_Pa": 101.0}))
        self.shearwake("run", "job.toml", "--out", "more", "--quiet")
        compared = self.document("compare", "more", self.out, expect=1)
        self.assertIn("peak_um", [column["column"] for column in compared["moved"]])
        self.assertEqual(len(compared["pairs"]), 4)
        self.assertEqual(compared["direction"], "first minus second, relative to the second")
        case_files(self.out)[0].write_bytes(b"damaged")
        damaged = self.document("verify", self.out, expect=4)
        self.assertEqual([entry["id"] for entry in damaged["damaged"]], [shown["id"]])
        self.assertEqual(self.document("status", self.out)["damaged_cases"][0]["id"], shown["id"])

    def test_failed_cases_are_listed_with_their_reasons(self):
        self.write_job(small_job(peaks(100.0, 1e200)))
        self.shearwake("run", "job.toml", expect=4)
        failed, = self.document("status", self.out)["failed_cases"]
        self.assertEqual(failed["settings"], {"load.peak_Pa": 1e200})
        self.assertNotEqual(failed["reason"], "")

    def test_an_evaluation_lists_the_values_of_one_case(self):
        self.write_job()
        done = self.document("evaluate", "job.toml", "--set", "load.modulation.am_frequency_Hz=450", ranks=2)
        self.assertEqual((done["status"], done["valid"]), ("complete", True))
        self.assertEqual(done["folder"], f"out/small.evaluate/{done['id']}")
        self.assertTrue((self.folder / done["folder"] / "cases" / f"{done['id']}.h5").exists())
        self.assertGreater(done["values"]["eta_period_over_reference_1"], 0.0)
        failed = self.document("evaluate", "job.toml", "--set", "load.peak_Pa=1e200", expect=4)
        self.assertEqual((failed["status"], failed["valid"]), ("failed", False))
        self.assertNotEqual(failed["note"], "")
        self.assertIsNone(failed["values"]["eta_period_over_reference_1"])
        self.contains(self.errors("evaluate", "job.toml", "--set", "load.peak=1", expect=3)[0], "the unit of peak is Pa: use peak_Pa")

    def test_bench_lists_measurements(self):
        for engine, grid in (("spectral", "32x24x9"), ("pstd", "16x12x10")):
            self.assertEqual(self.document("bench", engine, "--grid", grid)["name"], engine)

    def test_the_schema_describes_every_member(self):
        documents = [document["properties"] for document in SCHEMA["$defs"].values() if "properties" in document]
        for properties in (*documents, SCHEMA["$defs"]["compare"]["properties"]["pairs"]["items"]["properties"]):
            for member in properties.keys() - {"schema", "command"}:
                self.assertTrue(properties[member].get("description"), member)
