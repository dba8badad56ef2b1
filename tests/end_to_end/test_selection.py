# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a sweep: --only, -S, --out."""
import json

import jsonschema

from program import ROOT, ProgramTest, case_files, plan_ids, small_job, started, swept, table


SCHEMA = json.loads((ROOT / "docs" / "reference" / "json-output.schema.json").read_text(encoding="utf-8"))


class Selection(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_job()

    def test_only_computes_the_selected_cases(self):
        ids = self.compute_some()
        output = self.shearwake("run", "job.toml", "--only", f"{ids[1]},{ids[3]}").output
        self.contains(output, "2 computed now", "2 not selected", "1 case of the sweep that this run did not select is not complete",
                      "next: run the other cases")
        self.assertEqual(started(self.out), [ids[0], *sorted((ids[1], ids[3]), key=started(self.out).index)])
        self.assertEqual({path.stem for path in case_files(self.out)}, {ids[0], ids[1], ids[3]})
        self.contains(self.shearwake("status", self.out).output, "3 done", "1 remaining", "shearwake run")

    def test_progress_is_logged_as_json(self):
        for peak in (100, 200):
            self.shearwake("run", "job.toml", "-S", f"load.peak_Pa={peak}", "--out", f"out/{peak}", "--quiet", "--log-json",
                           "progress.jsonl")
            lines = (self.folder / "progress.jsonl").read_text(encoding="utf-8").splitlines()
            last = json.loads(lines[-1])
            self.assertEqual({name: last[name] for name in ("total", "done", "failed", "running")},
                             {"total": 4, "done": 4, "failed": 0, "running": 0})
            self.assertGreater(last["elapsed_s"], 0.0)
            self.assertRegex(last["time"], r"^\d{4}-\d\d-\d\dT")
            self.assertEqual(last["folder"], f"out/{peak}")
            self.assertNotEqual(lines[-1], lines[-2])
            jsonschema.Draft202012Validator(SCHEMA).validate(last)
        self.assertGreaterEqual(len(lines), 2, "a second run adds to the first one's lines")

    def test_an_unknown_id_is_rejected(self):
        self.compute_some()
        name = plan_ids(self.out)[2]
        wrong = name[:-1] + ("0" if name[-1] != "0" else "1")
        self.contains(self.shearwake("run", "job.toml", "--only", wrong, expect=2).output, wrong, f"did you mean {name}")

    def test_overrides_change_the_plan_and_are_recorded(self):
        self.shearwake("run", "job.toml", "--out", "twice", "-S", "load.peak_Pa=200", "-S", 'job.title="twice the load"')
        self.shearwake("run", "job.toml", "--out", "once")
        once, twice = self.folder / "once", self.folder / "twice"
        self.assertFalse(set(plan_ids(once)) & set(plan_ids(twice)))
        for out in (once, twice):
            self.shearwake("reduce", out)
        for a, b in zip(table(once), table(twice)):
            self.assertAlmostEqual(2.0 * float(a["peak_um"]), float(b["peak_um"]), delta=1e-6)
            self.assertAlmostEqual(float(a["eta_at_1"]), float(b["eta_at_1"]), delta=1e-8)
        self.contains(self.shearwake("show", case_files(twice)[0]).output, "twice the load", "load.peak_Pa=200")

    def test_status_prints_the_command_with_the_overrides(self):
        (self.folder / "part").mkdir()
        (self.folder / "part" / "STOP").touch()
        self.shearwake("run", "job.toml", "--out", "part", "-S", "load.peak_Pa=200", expect=75)
        (self.folder / "part" / "STOP").unlink()
        output = self.shearwake("status", "part").output
        command = next(line for line in output.splitlines() if line.startswith("next: shearwake "))
        words = command.removeprefix("next: shearwake ").replace("'", "").split()
        self.contains(self.shearwake(*words).output, "4 computed now", "0 already complete")

    def test_the_former_option_is_rejected_with_advice(self):
        for words in (["--shard", "1/3"], ["--shard=1/3"]):
            output = self.shearwake("run", "job.toml", *words, expect=2).output
            self.contains(output, "unknown option: --shard", "start the command without this option several times", "Slurm array")

    def test_an_invalid_override_is_rejected(self):
        self.contains(self.shearwake("run", "job.toml", "-S", "load.peak_Pa", expect=2).output, "KEY=VALUE")
        self.assertFalse(self.out.exists())

    def test_a_folder_of_another_plan_is_rejected(self):
        self.compute_some()
        before = (self.out / "plan.json").read_bytes()
        output = self.shearwake("run", "job.toml", "-S", "load.peak_Pa=50", expect=2).output
        self.contains(output, "another plan", "--out")
        self.assertEqual((self.out / "plan.json").read_bytes(), before)
        other = self.folder / "other"
        other.mkdir()
        (other / "thesis.txt").write_text("not to be touched", encoding="utf-8")
        self.contains(self.shearwake("run", "job.toml", "--out", other, expect=2).output, "not empty")
        self.assertEqual([path.name for path in other.iterdir()], ["thesis.txt"])

    def test_extend_keeps_the_cases_that_the_new_plan_contains(self):
        self.write_job()
        self.shearwake("run", "job.toml", "--quiet")
        cases = self.folder / "out/small/cases"
        before = {path.name: path.stat().st_mtime_ns for path in cases.glob("*.h5")}
        self.write_job(small_job(swept(400, 500, 600)))
        self.contains(self.shearwake("run", "job.toml", expect=2).output, "another plan", "--extend")
        output = self.shearwake("run", "job.toml", "--extend").output
        self.contains(output, "1 case file in out/small/cases is not in this job and remains unused")
        after = {path.name: path.stat().st_mtime_ns for path in cases.glob("*.h5")}
        self.assertEqual({name: time for name, time in after.items() if name in before}, before)
        self.assertEqual(len(after), len(before) + 1)
        self.shearwake("reduce", "out/small")
        rows = (self.folder / "out/small/tables/small.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(rows), 5)  # a head, three cases and the reference
        self.assertTrue(all("complete" in row for row in rows[1:]))
        self.write_job(small_job({"job.name": "other"}))
        self.contains(self.shearwake("run", "job.toml", "--extend", "--out", "out/small", expect=2).output, "another plan")
