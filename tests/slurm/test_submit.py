# SPDX-License-Identifier: BSD-3-Clause
"""scripts/submit without Slurm: the batch scripts that it writes and the options that it rejects."""
import json
import os
import shlex
import shutil
import subprocess
from pathlib import Path
from unittest import mock

from program import PROGRAM, ROOT, ProgramTest, environment


class Submit(ProgramTest):
    def submit(self, *options, program=PROGRAM, expect=0):
        self.write_job()
        done = subprocess.run([ROOT / "scripts" / "submit", "job.toml", "--dry-run", *options], cwd=self.folder,
                              env={**environment(), "SHEARWAKE": str(program)}, capture_output=True,
                              encoding="utf-8", check=False)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_times_too_short_to_compute_are_rejected(self):
        for words in (["--warning", "0"], ["--warning", "-5"], ["--time", "0"], ["--time", "0:00"],
                      ["--time", "1-"], ["--time", "4", "--warning", "120"],
                      ["--time", "1:30", "--warning", "45"]):
            with self.subTest(words=words):
                said = self.submit(*words, expect=2)
                self.assertRegex(said, "--(time|warning) must be")
        self.assertFalse(self.out.exists())
        for words in (["--time", "1-0"], ["--time", "0-1:30"], ["--time", "4:01", "--warning", "120"]):
            self.submit(*words)

    def test_the_time_limit_is_twice_the_time_that_plan_estimates(self):
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / "cache")}):
            said = self.submit()
            self.says(said, "time limit 4:00:00: time: not known on this machine yet; --time sets another limit")
            script = self.out / "slurm" / "single.sh"
            self.says(script.read_text(encoding="utf-8"), "#SBATCH --time=4:00:00")
            self.shearwake("run", "job.toml", "--quiet")
            planned_s = json.loads(self.shearwake("plan", "job.toml", "--json").stdout)["wall_s"]
            self.assertLess(planned_s, 300.0)  # so that the shortest limit applies
            self.says(self.submit(), "time limit 0:10:00: plan estimates")
            self.says(script.read_text(encoding="utf-8"), "#SBATCH --time=0:10:00")
            self.says(self.submit("--warning", "600"), "time limit 0:21:00: plan estimates")
            self.assertNotIn("time limit", self.submit("--time", "1:00:00"))

    def test_a_missing_program_is_reported_in_one_line(self):
        said = self.submit(program=self.folder / "nowhere" / "shearwake", expect=6)
        self.assertEqual(len(said.splitlines()), 1, said)
        self.says(said, "the program", "does not exist", "SHEARWAKE")

    def test_jobs_keep_their_program_when_another_one_is_built(self):
        built = self.folder / "shearwake"
        shutil.copy(PROGRAM, built)
        self.submit(program=built)
        copy, = (self.out / "slurm").glob("shearwake-*")
        script = self.out / "slurm" / "single.sh"
        self.says(script.read_text(encoding="utf-8"), f"{copy} run")
        with open(built, "ab") as file:
            file.write(b"another build")
        self.assertEqual(copy.read_bytes(), Path(PROGRAM).read_bytes())
        self.submit(program=built)
        self.assertNotIn(f"{copy} run", script.read_text(encoding="utf-8"))
        self.assertTrue(copy.exists())

    def test_a_percent_sign_in_the_output_folder_is_not_a_symbol_of_slurm(self):
        self.submit("--out", "50%j done")
        for name in ("single.sh", "report.sh"):
            script = (self.folder / "50%j done" / "slurm" / name).read_text(encoding="utf-8")
            logs = next(line for line in script.splitlines() if line.startswith("#SBATCH --output="))
            self.assertIn("50%%j done", logs)
            self.assertEqual(logs.count("%%"), 1)
        self.assertIn("50%j done", script.splitlines()[-1])

    def test_a_byte_order_mark_is_skipped(self):
        self.write_job()
        job = self.folder / "job.toml"
        text = job.read_bytes()
        self.write_job = lambda: job.write_bytes(b"\xef\xbb\xbf" + text)
        self.submit()
        self.assertTrue((self.out / "slurm" / "single.sh").is_file())

    def test_control_characters_and_leading_dashes_in_names_are_rejected(self):
        for words in (["--out", "a\ntouch /tmp/written"], ["--out", "a\x1b[2J"], ["--run=--quiet\ntrue"],
                      ["--", "--account=a\nb"]):
            with self.subTest(words=words):
                said = self.submit(*words, expect=2)
                self.says(said, "control character")
                self.assertNotIn("Traceback", said)
        for out in ("-rf", "some/-rf"):
            self.says(self.submit(f"--out={out}", expect=2), "starts with a dash")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["job.toml"])

    def test_names_of_the_template_in_a_path_are_not_replaced(self):
        for out in ("@NAME@", "@JOB@ @OUT@", "it's \"here\" $HOME `id`"):
            self.submit("--out", out)
            script = (self.folder / out / "slurm" / "single.sh").read_text(encoding="utf-8")
            subprocess.run(["sh", "-n"], input=script, encoding="utf-8", check=True)
            self.says(script, shlex.quote(str((self.folder / out).resolve())))
