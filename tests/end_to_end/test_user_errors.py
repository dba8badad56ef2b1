# SPDX-License-Identifier: BSD-3-Clause
"""Errors of users: messages state the location, the error and a suggestion; exit codes state the category."""
import concurrent.futures
import random

import pytest

from limits import accepted_or_refused
from program import AM, PROGRAM, ProgramTest, changed, small_job, swept

COMMANDS = ["check", "plan", "run", "status", "reduce", "report", "show", "bench"]


class JobMistakes(ProgramTest):
    def assert_rejected(self, text, *words):
        self.write_job(text)
        for command in ("check", "run"):
            done = self.shearwake(command, "job.toml", expect=3)
            self.contains(done.output, *words)
            self.assertNotIn("internal error", done.output)
            self.assertFalse(self.out.exists(), "something was made of a bad job")
        return done.output

    def place(self, text, piece):
        """file:line of a text in the job."""
        return f"job.toml:{text[:text.index(piece)].count(chr(10)) + 1}:"

    def test_a_misspelled_key_is_reported_with_a_suggestion(self):
        text = changed(("am_frequency_Hz = 500.0", "am_frequncy_Hz = 500.0"))
        output = self.assert_rejected(text, self.place(text, "am_frequncy_Hz"), "am_frequncy_Hz",
                            "did you mean", "am_frequency_Hz")
        self.assertRegex(output, r"job\.toml:\d+:\d+: ")

    def test_a_frequency_of_zero_is_explained(self):
        self.assert_rejected(small_job(swept(0, 400)), "but is 0", "am_depth = 0", 'kind = "STM"', 'reference = { kind = "STM" }')

        for kind in ("AM", "DTP"):  # STM cannot replace them
            constant = small_job(swept(1, 2, key="load.peak_Pa"), {"load.modulation.kind": kind, "table.x": None, AM: 0})
            output = self.assert_rejected(constant, "for a constant amplitude, set am_depth = 0")
            self.assertNotIn("STM\" instead", output)

    def test_decimal_commas_are_recognised(self):
        for old, new, number in (("peak_Pa = 100.0", "peak_Pa = 100,5", "100.5"),
                                 ("peak_Pa = 100.0", 'peak_Pa = "-1,5e3"', "-1.5e3"),
                                 ("fwhm_mm = 4.5 }", "fwhm_mm = 4,5 }", "4.5"),
                                 ("[64.0, 48.0]", "[64,5, 48,5]", "")):
            with self.subTest(new):
                self.assert_rejected(changed((old, new)), "decimal numbers with a point", number)
        self.write_job()
        self.contains(self.shearwake("check", "job.toml", "-S", "load.peak_Pa=1,5", expect=3).output, "1.5 instead of 1,5")
        self.write_job(changed(("traces_mm = [[0.0, 0.0], [3.2, 1.1]]", "traces_mm = [[1,2] [3,4]]")))
        self.assertNotIn("decimal", self.shearwake("check", "job.toml", expect=3).output)
        for array in ("[64,48 12]", "[64,\n    48,12 10]"):
            self.write_job(changed(("[64.0, 48.0]", array)))
            output = self.shearwake("check", "job.toml", expect=3).output
            self.contains(output, "not valid TOML")
            self.assertNotIn("decimal", output)

    def test_random_bytes_are_reported(self):
        path = self.folder / "noise.toml"
        path.write_bytes(random.Random(1).randbytes(10_000_000))
        output, _ = accepted_or_refused(self, [PROGRAM, "run", path], (3,), "random bytes")
        self.assertLess(len(output.encode()), 2000)
        small = self.folder / "small.toml"
        small.write_bytes(random.Random(2).randbytes(100_000))
        self.assertLess(len(self.shearwake("run", small, expect=3).output.encode()), 2000)

    def test_a_missing_job_is_reported(self):
        self.contains(self.shearwake("run", "nowhere.toml", expect=6).output, "nowhere.toml", "No such file or directory")
        self.contains(self.shearwake("run", self.folder, expect=2).output, "is a folder; give a job file")


class CommandLine(ProgramTest):
    def test_help_lists_the_commands(self):
        self.contains(self.shearwake("--help").stdout, *COMMANDS, "Exit codes")
        for command in COMMANDS:
            with self.subTest(command):
                self.contains(self.shearwake(command, "--help").stdout, "Usage")

    @pytest.mark.long
    def test_programs_that_start_at_once_do_not_disturb_each_other(self):
        # With a common session folder of Open MPI, one of 40 failed.
        with concurrent.futures.ThreadPoolExecutor(8) as starts:
            done = list(starts.map(lambda _: self.shearwake("--version"), range(200)))
        self.assertEqual({each.stderr for each in done}, {""})

    def test_version_lists_the_libraries(self):
        output = self.shearwake("--version").stdout
        self.contains(output, "shearwake", "git", "MPI", "FFTW", "HDF5")
        self.assertRegex(output, r"compiler  (g\+\+|clang\+\+) \d+\.\d+")
        self.assertEqual(self.shearwake("--version", ranks=2).stdout.count("HDF5"), 1)

    def test_mistyped_names_are_suggested(self):
        self.write_job()
        for words, meant in ((["chek", "job.toml"], "check"), (["Plan", "job.toml"], "plan"),
                             (["help", "stauts"], "status"), (["plan", "job.toml", "--rank", "2"], "--ranks"),
                             (["run", "job.toml", "--QUIET"], "--quiet"), (["run", "job.toml", "--wall-time=9"], "--walltime"),
                             (["bench", "Spectral"], "spectral")):
            with self.subTest(words):
                self.contains(self.shearwake(*words, expect=2).output, f"did you mean {meant}?")
        self.contains(self.shearwake("plan", "job.toml", "--out", "x", expect=2).output, "plan writes no files; give --out to run")
        self.contains(self.shearwake("run", "job.toml", "--ranks", 2, expect=2).output, "mpirun -n N shearwake run")

    def test_folders_and_jobs_are_distinguished(self):
        self.write_job()
        self.shearwake("run", "job.toml", "--quiet")
        for command in ("run", "check", "plan"):
            self.contains(self.shearwake(command, self.out, expect=2).output,
                          "is an output folder; give a job file", "job.toml --out ")

    def test_scripts_are_located(self):
        for name in ("import-kwave", "make-map"):
            self.contains(self.shearwake(name, "x", expect=2).output, f"run scripts/{name} in the source folder",
                          f"shearwake-{name} if the program is installed")

    def test_a_job_in_place_of_results_is_explained(self):
        self.write_job()
        for words in (["status"], ["verify"], ["reduce"], ["report"], ["compare", "job.toml"]):
            with self.subTest(words):
                self.contains(self.shearwake(*words, "job.toml", expect=2).output, "job.toml is a job file", "out/small")
        self.contains(self.shearwake("show", "job.toml", expect=6).output, "shearwake show --modulation job.toml")

    def test_the_answer_of_a_job_must_be_a_column(self):
        for answer, expected in (("felt_path_dB", 0), ("felt_path", 3)):
            self.write_job(small_job({"job.question": "Which is felt best?", "job.answer": answer}))
            output = self.shearwake("check", "job.toml", expect=expected).output
        self.contains(output, 'job.answer: tables have no column "felt_path"; did you mean "felt_path_dB"?')

    def test_unknown_commands_and_options_are_reported(self):
        self.write_job()
        for words in ([], ["fly"], ["run"], ["run", "job.toml", "--fast"], ["run", "job.toml", "other"],
                      ["plan", "job.toml", "-n", "none"], ["plan", "job.toml", "-n", "0"],
                      ["run", "job.toml", "--ranks-per-case", "-1"], ["bench", "magic"]):
            with self.subTest(words):
                output = self.shearwake(*words, expect=2).output
                self.assertNotEqual(output, "")
                self.assertFalse(self.out.exists())
        self.assertEqual(self.shearwake("fly", ranks=2, expect=2).output.count("fly"), 1)
