# SPDX-License-Identifier: BSD-3-Clause
"""scripts/submit without Slurm: the batch scripts that it writes, what it passes to sbatch, and the options that it rejects."""
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from unittest import mock

from program import PROGRAM, ROOT, ProgramTest, csv_path, large_job, small_job, started

# Commands of a site that prints more than the id of the job, and whose queue contains the jobs in a file.
SITE = {"sbatch": """echo "$@" >>calls
echo "Welcome to the cluster of 2026"
echo "your project has 1000 hours left"
echo "$((40 + $(wc -l <calls)))${CLUSTER}"
echo "thank you"
""", "squeue": "echo \"$@\" >>queries; cat queue\n", "scontrol": "echo 'MaxArraySize            = 1001'\n"}


class Submit(ProgramTest):
    def submit(self, *options, program=PROGRAM, expect=0, mode=("--dry-run",), job="job.toml", **variables):
        if job == "job.toml":
            self.write_job()
        return self.call(ROOT / "scripts" / "submit", job, *mode, *options, expect=expect,
                         variables={"SHEARWAKE": str(program), **variables}).output

    def submit_to_site(self, *options, **keywords):
        """Submits to commands that stand for Slurm, and returns the output and the arguments of both calls of sbatch."""
        site = self.folder / "site"
        site.mkdir(exist_ok=True)
        for name, text in SITE.items():
            (site / name).write_text("#!/bin/sh\n" + text, encoding="utf-8")
            (site / name).chmod(0o755)
        (self.folder / "calls").write_text("", encoding="utf-8")
        output = self.submit(*options, mode=(), PATH=f"{site}:{os.environ['PATH']}", **keywords)
        return output, (self.folder / "calls").read_text(encoding="utf-8").splitlines()

    def script(self, name):
        return (self.out / "slurm" / name).read_text(encoding="utf-8")

    def test_the_report_gets_only_options_that_concern_both_jobs(self):
        shared = "--account=lab --partition=long --qos=low --constraint=fast --reservation=mine --mail-type=END --mail-user=me".split()
        _, (computes, reports) = self.submit_to_site(
            "--", "-A", "lab", "-plong", "-q", "low", "-C", "fast", "--reservation=mine", "--mail-type=END", "--mail-user", "me",
            "-d", "afterok:25", "-a", "1-4%2", "-J", "mine", "-o", "my.log", "-t", "2:00:00", "-n", "3", "-N", "2", "--exclusive")
        self.contains(computes, *shared, "--dependency=afterok:25", "-J mine", "-o my.log", "-N 2", "--exclusive")
        self.assertEqual(reports.split(), ["--parsable", *shared, str(self.out / "slurm" / "report.sh")])
        self.contains(self.script("report.sh"), "#SBATCH --dependency=afterany:41,afterok:25\n", "#SBATCH --ntasks=1\n")
        self.contains(self.script("array.sh"), "#SBATCH --array=1-4%2\n", "#SBATCH --time=2:00:00\n", "#SBATCH --ntasks=3\n")

    def test_alternative_dependencies_do_not_replace_that_of_the_report(self):
        self.submit("--", "--dependency=afterok:1?afterok:2")
        self.contains(self.script("report.sh"), "#SBATCH --dependency=afterany:JOB\n")

    def test_arrays_are_throttled_and_no_longer_than_slurm_permits(self):
        self.submit("--array", "40", "--throttle", "10")
        self.contains(self.script("array.sh"), "#SBATCH --array=1-40%10\n")
        output, calls = self.submit_to_site("--array", "1001", expect=2)
        self.contains(output, "up to 1000 (MaxArraySize)")
        self.assertEqual(calls, [])
        for words in (["--", "--array=1-x"], ["--array", "0"], ["--array", "4-2"]):
            self.contains(self.submit(*words, expect=2), "not a valid number or list of tasks")

    def test_the_id_of_a_job_is_found_among_the_lines_that_a_site_prints(self):
        self.contains(self.submit_to_site()[0], "submitted: job 41 computes, job 42 reduces")
        (self.folder / "queue").write_text("", encoding="utf-8")
        output, (_, reports) = self.submit_to_site("--", "-M", "east", CLUSTER=";east")
        self.contains(output, "submitted: job 41 computes")
        self.contains(reports, "--clusters=east")
        self.submit_to_site()
        self.contains((self.folder / "queries").read_text(encoding="utf-8"), "-j 41 -o %F --clusters=east")

    def test_a_job_in_the_queue_is_not_submitted_twice(self):
        self.submit_to_site("--array", "2")
        (self.folder / "queue").write_text("41\n", encoding="utf-8")
        output, calls = self.submit_to_site("--array", "2", expect=2)
        self.contains(output, "job 41", "still in the queue", "scancel 41")
        self.assertEqual(calls, [])

    def test_a_missing_sbatch_is_reported_in_one_line(self):
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "python3").symlink_to(sys.executable)
        output = self.submit(mode=(), expect=6, PATH=str(tools))
        self.assertEqual(len(output.splitlines()), 1, output)
        self.contains(output, "sbatch is not on the PATH", "--dry-run")

    def test_memory_is_requested_for_the_ranks_of_the_job_whatever_this_machine_has(self):
        large = self.write_job(small_job({"domain.spacing_mm": 0.004}), "large.toml")
        self.shearwake("plan", large, expect=3)
        for ranks in (2, 16):
            self.submit("--ranks", str(ranks), job=large)
            planned_B = json.loads(self.shearwake("plan", large, "-n", ranks, "--elsewhere", "--json").stdout)["memory_per_rank_B"]
            self.contains(self.script("single.sh"), f"#SBATCH --mem-per-cpu={math.ceil(1.2 * planned_B / 2**20)}M\n")
        self.submit("--", "--mem=8G", job=large)
        self.assertNotIn("--mem", self.script("single.sh").partition("cd ")[0])

    def test_copies_of_the_job_and_its_files_are_found_from_the_copy(self):
        points = "x_mm,y_mm\n-10,0\n10,0\n"
        elsewhere = self.folder / "other place"
        (self.folder / "jobs").mkdir()
        for folder in (self.folder / "points", elsewhere):
            folder.mkdir()
            (folder / "line.csv").write_text(points, encoding="utf-8")
        for named in ("../points/line.csv", str(elsewhere / "line.csv")):
            job = self.write_job(small_job(csv_path(named)), "jobs/up.toml")
            ids = [c["id"] for c in json.loads(self.shearwake("plan", job, "--json").stdout)["cases"]]
            self.submit(job=job)
            copy = re.search(r" run (\S+) --out", self.script("single.sh").splitlines()[-1])[1]
            self.assertTrue(Path(copy).is_relative_to(self.out / "slurm"))
            for path in (job, self.folder / "points", elsewhere):
                path.rename(f"{path}.gone")
            planned = json.loads(self.shearwake("plan", copy, "--json").stdout)
            self.assertEqual([c["id"] for c in planned["cases"]], ids)
            for path in (job, self.folder / "points", elsewhere):
                Path(f"{path}.gone").rename(path)

    def test_a_time_limit_below_the_plan_is_warned_about(self):
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / "cache")}):
            self.write_job()
            self.shearwake("run", "job.toml", "--quiet")
            large = self.write_job(large_job(1.0), "large.toml")
            self.contains(self.submit("--time", "1", "--warning", "5", job=large), "core hours", "warning: a case that saves no checkpoints takes",
                          "exit code 3")
            self.assertNotIn("warning: a case", self.submit("--time", "10-0", job=large))
            self.contains(self.shearwake("plan", large).stdout, "the longest case that saves no checkpoints may take")
            self.contains(self.shearwake("run", large, "--walltime", "60", "--out", "limited", expect=3).output, "but the time limit leaves", "saves no checkpoints")
            self.assertEqual(started(self.folder / "limited"), [])

    def start_step(self, command, job=1, retries=1):
        """Runs a command as the step of a batch script on a site, and returns the exit code, the output and the requeues so far."""
        site = self.folder / "site"
        site.mkdir(exist_ok=True)
        (self.folder / "small" / "slurm").mkdir(parents=True, exist_ok=True)
        for name, text in (("squeue", "echo RUNNING"), ("scontrol", 'echo "$@" >>requeues'), ("sleep", "true")):
            (site / name).write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
            (site / name).chmod(0o755)
        done = subprocess.run(["bash", "-c", f'. {ROOT}/jobs/slurm/step.sh; run_step small {retries} sh -c "$0"', command],
                              env={**os.environ, "PATH": f"{site}:{os.environ['PATH']}", "SHEARWAKE_LAUNCH": "env", "SLURM_JOB_ID": "9",
                                   "SLURM_ARRAY_JOB_ID": "9", "SLURM_ARRAY_TASK_ID": str(job)},
                              cwd=self.folder, capture_output=True, encoding="utf-8", check=False)
        requeues = self.folder / "requeues"
        return done.returncode, done.stdout + done.stderr, requeues.read_text(encoding="utf-8").splitlines() if requeues.exists() else []

    def test_a_step_is_requeued_while_it_completes_cases_or_saves_checkpoints(self):
        for folder in ("cases", "checkpoints"):
            self.assertEqual(self.start_step(f"mkdir -p small/{folder}; touch small/{folder}/1.h5; exit 75")[0], 4)
        self.assertEqual(self.start_step("touch small/cases/2.h5.part; exit 75")[2], 3 * ["requeue 9_1"])
        code, output, requeues = self.start_step("exit 75")
        self.assertEqual((code, len(requeues)), (3, 3))
        self.contains(output, "the last two starts completed no case and saved no checkpoint")
        (self.folder / "small" / "STOP").touch()
        code, output, requeues = self.start_step("exit 75", job=2)
        self.assertEqual((code, len(requeues)), (4, 3))
        self.contains(output, "small/STOP exists")

    def test_a_step_with_a_killed_rank_is_retried(self):
        self.assertEqual(self.start_step("kill -9 $$")[2], ["requeue 9_1"])
        code, _, requeues = self.start_step("kill -9 $$")
        self.assertEqual((code, len(requeues)), (137, 1))
        self.assertEqual(self.start_step("kill -9 $$", job=2, retries=0)[2], ["requeue 9_1"])
        self.assertEqual(self.start_step("exit 6", job=3)[::2], (6, ["requeue 9_1"]))

    def test_starts_that_end_with_their_node_are_retried_unless_they_make_progress(self):
        lost = "kill -9 $PPID"  # the batch script, as with a lost node: Slurm starts it again
        for command in (lost, lost, f"mkdir -p small/cases; touch small/cases/1.h5; {lost}", f"touch small/cases/2.h5; {lost}"):
            self.assertEqual(self.start_step(command, retries=2)[0], -9)
        self.assertEqual(self.start_step(lost, retries=2)[0], -9)
        code, output, requeues = self.start_step("touch started", retries=2)
        self.assertEqual((code, requeues), (4, []))
        self.contains(output, "not started: 3 starts ended because a rank was killed or a node was lost")
        self.assertFalse((self.folder / "started").exists())

    def test_times_too_short_to_compute_are_rejected(self):
        for words in (["--warning", "0"], ["--warning", "-5"], ["--time", "0"], ["--time", "0:00"],
                      ["--time", "1-"], ["--time", "4", "--warning", "120"],
                      ["--time", "1:30", "--warning", "45"]):
            with self.subTest(words=words):
                self.assertRegex(self.submit(*words, expect=2), "--(time|warning) must be")
        self.assertFalse(self.out.exists())
        for words in (["--time", "1-0"], ["--time", "0-1:30"], ["--time", "4:01", "--warning", "120"]):
            self.submit(*words)

    def test_the_time_limit_is_twice_the_time_that_plan_estimates(self):
        with mock.patch.dict(os.environ, {"SHEARWAKE_CACHE": str(self.folder / "cache")}):
            self.contains(self.submit(), "time limit 4:00:00: time: not known on this machine yet; --time sets another limit")
            script = self.out / "slurm" / "single.sh"
            self.contains(script.read_text(encoding="utf-8"), "#SBATCH --time=4:00:00")
            self.shearwake("run", "job.toml", "--quiet")
            planned_s = json.loads(self.shearwake("plan", "job.toml", "--json").stdout)["wall_s"]
            self.assertLess(planned_s, 300.0)  # so that the shortest limit applies
            self.contains(self.submit(), "time limit 0:10:00: plan estimates")
            self.contains(script.read_text(encoding="utf-8"), "#SBATCH --time=0:10:00")
            self.contains(self.submit("--warning", "600"), "time limit 0:21:00: plan estimates")
            self.assertNotIn("time limit", self.submit("--time", "1:00:00"))

    def test_a_missing_program_is_reported_in_one_line(self):
        output = self.submit(program=self.folder / "nowhere" / "shearwake", expect=6)
        self.assertEqual(len(output.splitlines()), 1, output)
        self.contains(output, "the program", "does not exist", "SHEARWAKE")

    def test_jobs_keep_their_program_when_another_one_is_built(self):
        built = self.folder / "shearwake"
        shutil.copy(PROGRAM, built)
        self.submit(program=built)
        copy, = (self.out / "slurm").glob("shearwake-*")
        script = self.out / "slurm" / "single.sh"
        self.contains(script.read_text(encoding="utf-8"), f"{copy} run")
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
        self.assertIn("50%j done'", script.partition("cd ")[2])

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
                output = self.submit(*words, expect=2)
                self.contains(output, "control character")
                self.assertNotIn("Traceback", output)
        for out in ("-rf", "some/-rf"):
            self.contains(self.submit(f"--out={out}", expect=2), "starts with a dash")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["job.toml"])

    def test_names_of_the_template_in_a_path_are_not_replaced(self):
        for out in ("@NAME@", "@JOB@ @OUT@", "it's \"here\" $HOME `id`"):
            self.submit("--out", out)
            script = (self.folder / out / "slurm" / "single.sh").read_text(encoding="utf-8")
            subprocess.run(["sh", "-n"], input=script, encoding="utf-8", check=True)
            self.contains(script, shlex.quote(str((self.folder / out).resolve())))
