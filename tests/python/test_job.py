# SPDX-License-Identifier: BSD-3-Clause
"""Jobs of the package are checked, planned and run, and errors become exceptions with the text of the program."""
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from unittest import mock

from study import InFolder, job, program, shearwake


class Jobs(InFolder):
    def test_file_text_dictionary_and_keywords_give_the_same_cases(self):
        Path("a.toml").write_text(program.JOB)
        tables = tomllib.loads(program.JOB)
        jobs = [shearwake.Job("a.toml"), shearwake.Job(program.JOB), shearwake.Job(tables), shearwake.Job(**tables)]
        ids = [list(made.plan().cases.index) for made in jobs]
        self.assertEqual(len(ids[0]), 4)
        self.assertEqual(ids, [ids[0]] * 4)

    def test_changes_leave_the_original_as_it_is(self):
        first = job()
        second = first.change({"load.peak_Pa": 50.0, "medium.layer[1].c_s_m_s": 4.0})
        self.assertEqual((first.tables["load"]["peak_Pa"], second.tables["load"]["peak_Pa"]), (100.0, 50.0))
        self.assertEqual(second.tables["medium"]["layer"][0]["c_s_m_s"], 4.0)
        with self.assertRaisesRegex(KeyError, r"medium.layer\[2\]"):
            first.change({"medium.layer[2].c_s_m_s": 4.0})

    def test_values_that_a_job_cannot_contain_are_named(self):
        for value, text in ((None, "load.peak_Pa: None is not a value"), ({1}, "load.peak_Pa: set is not a type"),
                            ([1.0, None], "load.peak_Pa[2]: None is not a value")):
            with self.assertRaises(TypeError) as raised:
                job().change({"load.peak_Pa": value}).check()
            self.assertIn(text, str(raised.exception))

    def test_errors_have_the_text_and_the_lines_of_the_program(self):
        path = Path("bad.toml")
        path.write_text(program.changed(("peak_Pa", "peak_Pq"), ("spacing_mm = 1.5", "spacing_mm = -2")))
        printed = subprocess.run([program.PROGRAM, "check", path.resolve()], capture_output=True, text=True, check=False)
        bad = shearwake.Job(path)
        for call in (bad.check, bad.plan, bad.run):
            with self.assertRaises(shearwake.JobError) as caught:
                call()
            self.assertEqual(caught.exception.exit_code, 3)
            self.assertEqual([d.severity for d in caught.exception.diagnostics], ["error", "error"])
            for line in str(caught.exception).splitlines():
                self.assertIn(line, printed.stdout + printed.stderr)
            self.assertIn("did you mean peak_Pa?", str(caught.exception))

    def test_the_program_does_not_join_the_mpi_program_around_it(self):
        around = {"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": "1", "PMIX_RANK": "1", "PMIX_NAMESPACE": "x", "PMI_RANK": "1",
                  "PMI_SIZE": "2", "OMPI_MCA_ess_base_vpid": "1", "OMPI_MCA_orte_hnp_uri": "x", "HYDI_CONTROL_FD": "9"}
        of_users = {"OMPI_MCA_btl": "self", "OMPI_ALLOW_RUN_AS_ROOT": "1", "SHEARWAKE_OTHER": "1"}
        with mock.patch.dict(os.environ, {**around, **of_users}):
            found = shearwake.program.environment()
            self.assertEqual([name for name in around if name in found], [])
            self.assertEqual({name: found[name] for name in of_users}, of_users)

    def test_a_byte_order_mark_is_skipped(self):
        Path("mark.toml").write_bytes(b"\xef\xbb\xbf" + program.JOB.encode())
        for made in (shearwake.Job("mark.toml"), shearwake.Job("\ufeff" + program.JOB), shearwake.Job("mark.toml", title="other")):
            self.assertEqual(made.name, "small")
            self.assertFalse(made.text.startswith("\ufeff") and made._path is None)

    def test_warnings_are_returned(self):
        warnings = job({"domain.spacing_mm": 2.0}).check()
        self.assertTrue(warnings)
        self.assertEqual({w.severity for w in warnings}, {"warning"})
        self.assertEqual({w.file for w in warnings}, {"<Job small>"})

    def test_a_run_reports_its_progress_and_is_resumed(self):
        seen = []
        made = job({"job.name": "resumed"})
        first = made.run(2, options=["--only", made.plan().cases.index[0]])
        self.assertEqual([case.is_complete for case in first.every_case], [True, False, False, False])
        whole = made.run(progress=seen.append)
        self.assertTrue(all(case.is_complete for case in whole.every_case))
        self.assertEqual((seen[-1].done, seen[-1].total, seen[-1].failed), (3, 3, 0))
        self.assertEqual(whole.folder, Path("out/resumed"))

    def test_a_temporary_job_lies_outside_its_folder_and_finds_relative_files(self):
        Path("data").mkdir()
        Path("below/study").mkdir(parents=True)
        Path("data/cases.csv").write_text("load.peak_Pa\n50\n80\n")
        text = program.JOB.split("[sweep]")[0] + '[sweep]\nlist = "../../data/cases.csv"\n'
        Path("below/study/listed.toml").write_text(text)
        made = shearwake.Job("below/study/listed.toml", name="listed")
        os.chmod("below/study", 0o555)  # as for a job that the user may only read
        self.addCleanup(os.chmod, "below/study", 0o755)
        with made.file() as path:
            self.assertFalse(path.is_relative_to(Path.cwd()))
        self.assertFalse(path.exists())
        self.assertEqual([c.settings["load.peak_Pa"] for c in made.run(out="out/listed").cases], [50.0, 80.0])
        self.assertEqual(sorted(os.listdir("below/study")), ["listed.toml"])

    def test_links_of_a_temporary_job_lead_to_the_files_that_it_names(self):
        for name, content in (("study/c.csv", "own"), ("job/c.csv", "other"), ("study/job/c.csv", "below"), ("study/small.toml", "kept")):
            Path(name).parent.mkdir(parents=True, exist_ok=True)
            Path(name).write_text(content)
        Path("study/data").mkdir()
        words = {"c.csv": "own", "../job/c.csv": "other", "job/c.csv": "below", "data/../c.csv": "own", "small.toml": "kept"}
        made = shearwake.Job({"job": {"name": "small"}, "files": list(words)})
        made.folder = Path("study")
        with made.file() as path:
            self.assertEqual(path.name, "small.toml")
            self.assertIn("[job]", path.read_text())
            for word, content in words.items():
                if word != "small.toml":
                    self.assertEqual((path.parent / word).read_text(), content, word)
        self.assertEqual(Path("study/small.toml").read_text(), "kept")

    def test_a_folder_of_another_plan_is_a_usage_error(self):
        job().run(out="out/one")
        with self.assertRaisesRegex(shearwake.UsageError, "another plan"):
            job({"load.peak_Pa": 90.0}).run(out="out/one")

    def test_reading_does_not_need_the_program(self):
        job({"job.name": "reading"}).run()
        text = ("import shearwake; s = shearwake.open('out/reading'); print(float(s.dataset('peak_um').peak_um.max()))\n"
                "try: shearwake.Job('schema = 1\\n').check()\nexcept shearwake.ProgramNotFound as e: print(e)")
        shutil.copytree(Path(shearwake.__file__).parent, "elsewhere/lib/python/shearwake")
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True, env={
            **{k: v for k, v in os.environ.items() if k != "SHEARWAKE"}, "PATH": "/nowhere", "PYTHONPATH": "elsewhere/lib/python"})
        self.assertRegex(done.stdout.splitlines()[0], r"^\d+\.\d+$")
        self.assertIn("not on the PATH", done.stdout)
