# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a sweep: --only, --shard, -S, --out."""
import fcntl
import json
import unittest

import jsonschema

from program import ROOT, ProgramTest, assert_same_table, case_files, changed, plan_ids, started, table


SCHEMA = json.loads((ROOT / "docs" / "reference" / "json-output.schema.json").read_text(encoding="utf-8"))


class Selection(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_job()

    def test_only_computes_the_selected_cases(self):
        self.shearwake("run", "job.toml", "--shard", "1/4")
        ids = plan_ids(self.out)
        said = self.shearwake("run", "job.toml", "--only", f"{ids[1]},{ids[3]}").said
        self.says(said, "2 computed now", "2 not selected")
        self.assertEqual(started(self.out), [ids[0], *sorted((ids[1], ids[3]), key=started(self.out).index)])
        self.assertEqual({path.stem for path in case_files(self.out)}, {ids[0], ids[1], ids[3]})
        self.says(self.shearwake("status", self.out).said, "3 done", "1 remaining", "shearwake run")

    def test_progress_is_logged_as_json(self):
        for shard in ("1/2", "2/2"):
            self.shearwake("run", "job.toml", "--shard", shard, "--quiet", "--log-json", "progress.jsonl")
            lines = (self.folder / "progress.jsonl").read_text(encoding="utf-8").splitlines()
            last = json.loads(lines[-1])
            self.assertEqual({name: last[name] for name in ("total", "done", "failed", "running")},
                             {"total": 2, "done": 2, "failed": 0, "running": 0})
            self.assertGreater(last["elapsed_s"], 0.0)
            self.assertRegex(last["time"], r"^\d{4}-\d\d-\d\dT")
            self.assertEqual((last["folder"], last["part"]), ("out/small", shard.replace("/", "-of-")))
            self.assertNotEqual(lines[-1], lines[-2])
            jsonschema.Draft202012Validator(SCHEMA).validate(last)
        self.assertGreaterEqual(len(lines), 2, "a second run adds to the first one's lines")

    def test_the_next_command_follows_the_last_run(self):
        def following():
            return self.shearwake("status", self.out).said.splitlines()[-1]

        self.shearwake("run", "job.toml", "--shard", "1/4", "--quiet")
        self.says(following(), "for k in 2 3 4; do shearwake run", "--shard $k/4")
        self.shearwake("run", "job.toml", "--shard", "1/2", "--quiet")  # shards of two sizes
        self.assertNotIn("--shard", following())
        (self.out / "journal.1-of-2.jsonl").unlink()
        self.says(following(), "for k in 2 4; do shearwake run", "--shard $k/4")
        (self.out / "STOP").touch()
        self.shearwake("run", "job.toml", expect=75)  # of the complete sweep
        (self.out / "STOP").unlink()
        self.assertNotIn("--shard", following())

    def test_shards_whose_cases_failed_are_not_left_to_other_runs(self):
        self.shearwake("run", "job.toml", "--shard", "1/2", "-S", "load.peak_Pa=1e200", expect=4)
        said = self.shearwake("run", "job.toml", "--shard", "2/2", "-S", "load.peak_Pa=1e200", expect=4).said
        self.assertNotIn("run the other shards", said)
        self.says(self.shearwake("status", self.out).said, "--retry-failed")

    def test_an_unknown_id_is_rejected(self):
        self.shearwake("run", "job.toml", "--shard", "1/4")
        name = plan_ids(self.out)[2]
        wrong = name[:-1] + ("0" if name[-1] != "0" else "1")
        said = self.shearwake("run", "job.toml", "--only", wrong, expect=2).said
        self.says(said, wrong, f"did you mean {name}")

    def test_shards_together_compute_all_cases(self):
        whole = self.folder / "whole"
        self.shearwake("run", "job.toml", "--out", whole)
        self.shearwake("reduce", whole)
        self.says(self.shearwake("run", "job.toml", "--shard", "1/2").said, "2 computed now",
                  "2 cases of the sweep that this run did not select are not complete", "next: run the other shards")
        last = self.shearwake("run", "job.toml", "--shard", "2/2").said
        self.says(last, "2 computed now", "next: shearwake reduce")
        self.assertNotIn("did not select are not complete", last)
        self.shearwake("reduce", self.out)
        self.assertEqual(len(set(started(self.out))), 4)
        assert_same_table(self, table(whole), table(self.out))
        for wrong in ("0/2", "3/2", "x", "1/0", "1/2/3", "-1/2"):
            self.says(self.shearwake("run", "job.toml", f"--shard={wrong}", expect=2).said, "I/N", wrong)

    def test_overrides_change_the_plan_and_are_recorded(self):
        self.shearwake("run", "job.toml", "--out", "twice", "-S", "load.peak_Pa=200", "-S",
                       'job.title="twice the load"')
        self.shearwake("run", "job.toml", "--out", "once")
        once, twice = self.folder / "once", self.folder / "twice"
        self.assertFalse(set(plan_ids(once)) & set(plan_ids(twice)))
        for out in (once, twice):
            self.shearwake("reduce", out)
        for a, b in zip(table(once), table(twice)):
            self.assertAlmostEqual(2.0 * float(a["peak_um"]), float(b["peak_um"]), delta=1e-6)
            self.assertAlmostEqual(float(a["eta_at_1"]), float(b["eta_at_1"]), delta=1e-8)
        said = self.shearwake("show", case_files(twice)[0]).said
        self.says(said, "twice the load", "load.peak_Pa=200")

    def test_status_prints_the_command_with_the_overrides(self):
        self.shearwake("run", "job.toml", "--out", "part", "-S", "load.peak_Pa=200", "--shard", "1/2")
        said = self.shearwake("status", "part").said
        command = next(line for line in said.splitlines() if line.startswith("next: shearwake "))
        words = command.removeprefix("next: shearwake ").replace("'", "").split()
        self.assertEqual(words[-2:], ["--shard", "2/2"])
        self.says(self.shearwake(*words).said, "2 computed now", "0 already complete", "2 not selected")

    def test_status_prints_a_command_for_the_shards_that_are_left(self):
        self.shearwake("run", "job.toml", "--shard", "2/4")
        said = self.shearwake("status", "out/small").said
        self.says(said, "next: for k in 1 3 4; do shearwake run out/small/job.toml --out out/small --shard $k/4; done")
        lock = self.out / "locks" / "1-of-4"
        with open(lock, "w", encoding="utf-8") as held, open(self.out / "locks" / "run", "a", encoding="utf-8") as run:
            fcntl.flock(held, fcntl.LOCK_EX)  # as the run of shard 1 holds them
            fcntl.flock(run, fcntl.LOCK_EX)
            self.says(self.shearwake("status", "out/small").said, "next: for k in 3 4; do")

    def test_an_invalid_override_is_rejected(self):
        self.says(self.shearwake("run", "job.toml", "-S", "load.peek_Pa=200", expect=3).said,
                  "peek_Pa", "did you mean peak_Pa")
        self.says(self.shearwake("run", "job.toml", "-S", "load.peak_Pa", expect=2).said, "KEY=VALUE")
        self.assertFalse(self.out.exists())

    def test_a_folder_of_another_plan_is_rejected(self):
        self.shearwake("run", "job.toml", "--shard", "1/4")
        before = (self.out / "plan.json").read_bytes()
        said = self.shearwake("run", "job.toml", "-S", "load.peak_Pa=50", expect=2).said
        self.says(said, "another plan", "--out")
        self.assertEqual((self.out / "plan.json").read_bytes(), before)
        other = self.folder / "other"
        other.mkdir()
        (other / "thesis.txt").write_text("not to be touched", encoding="utf-8")
        self.says(self.shearwake("run", "job.toml", "--out", other, expect=2).said, "not empty")
        self.assertEqual([path.name for path in other.iterdir()], ["thesis.txt"])

    def test_extend_keeps_the_cases_that_the_new_plan_contains(self):
        self.write_job()
        self.shearwake("run", "job.toml", "--quiet")
        cases = self.folder / "out/small/cases"
        before = {path.name: path.stat().st_mtime_ns for path in cases.glob("*.h5")}
        self.write_job(changed(("[400, 500, 1000]", "[400, 500, 600]")))
        self.says(self.shearwake("run", "job.toml", expect=2).said, "another plan", "--extend")
        said = self.shearwake("run", "job.toml", "--extend").said
        self.says(said, "1 case file in out/small/cases is not in this job and remains unused")
        after = {path.name: path.stat().st_mtime_ns for path in cases.glob("*.h5")}
        self.assertEqual({name: time for name, time in after.items() if name in before}, before)
        self.assertEqual(len(after), len(before) + 1)
        self.shearwake("reduce", "out/small")
        rows = (self.folder / "out/small/tables/small.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(rows), 5)  # a head, three cases and the reference
        self.assertTrue(all("complete" in row for row in rows[1:]))
        self.write_job(changed(('name = "small"', 'name = "other"')))
        self.says(self.shearwake("run", "job.toml", "--extend", "--out", "out/small", expect=2).said, "another plan")


if __name__ == "__main__":
    unittest.main()
