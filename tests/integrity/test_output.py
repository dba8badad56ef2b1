# SPDX-License-Identifier: BSD-3-Clause
"""Output that cannot be written, and changes to the output folder by other programs during a run."""
import os
import pty
import shutil
import signal
import subprocess
import time

import h5py
import pytest

from limits import times
from kwave import reference, save, structures_of
from program import MISSPELT, PATIENCE_s, ROOT, UNRECORDED, ProgramTest, command, environment, small_job, table

NOISE = ("Traceback", "MPI_ABORT", "MPI_Abort", "internal error", "terminate called")


class Output(ProgramTest):
    def run_with(self, words, **streams):
        done = subprocess.run(words, cwd=self.folder, env=environment(), stdin=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, encoding="utf-8", errors="replace", check=False, **streams)
        for word in NOISE:
            self.assertNotIn(word, done.stderr)
        return done

    def test_a_full_or_closed_output_ends_with_a_message(self):
        self.write_job()
        self.shearwake("run", "job.toml")
        case = next((self.out / "cases").glob("*.h5"))
        for words in (("check", "job.toml"), ("plan", "job.toml"), ("status", self.out), ("show", case),
                      ("reduce", self.out), ("verify", self.out), ("--help",)):
            with self.subTest(words=words, output="/dev/full"), open("/dev/full", "w", encoding="utf-8") as full:
                done = self.run_with(command(*words), stdout=full)
                self.assertEqual(done.returncode, 6, done.stderr)
                self.contains(done.stderr, "output")
            with self.subTest(words=words, output="closed"):
                done = self.run_with(["sh", "-c", '"$@" >&-', "sh", *command(*words)])
                self.assertEqual(done.returncode, 6, done.stderr)

    def test_a_reader_of_a_pipe_may_end_first(self):
        self.write_job()
        for words in (("schema",), ("keys",), ("presets",), ("plan", "job.toml", "--json")):
            with self.subTest(words=words):
                reader, writer = os.pipe()
                os.close(reader)
                done = self.run_with(command(*words), stdout=writer)
                os.close(writer)
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    @pytest.mark.extended
    def test_errors_have_colours_on_a_terminal_unless_they_are_unwanted(self):
        self.write_job(MISSPELT)
        for settings, expected in (({}, "\x1b[1;31merror:\x1b[0m load.peek_Pa"), ({"NO_COLOR": "1"}, ": error: load.peek_Pa")):
            mine, program = pty.openpty()
            subprocess.run(command("check", "job.toml"), cwd=self.folder, env={**environment(), **settings}, stderr=program,
                           stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, check=False)
            self.assertIn(expected, os.read(mine, 100_000).decode())
            os.close(mine)
            os.close(program)

    @pytest.mark.extended
    def test_warnings_of_a_valid_job_and_errors_without_a_place_have_colours_on_a_terminal(self):
        self.write_job(small_job({"domain.spacing_mm": 2.0}))
        for words, expected in ((("run", "job.toml"), "\x1b[1;33mwarning:\x1b[0m domain.spacing_mm"),
                                (("plan", "job.toml"), "\x1b[1;33mwarning:\x1b[0m domain.spacing_mm"),
                                (("run", "missing.toml"), "\x1b[1;31merror:\x1b[0m cannot read missing.toml")):
            with self.subTest(words=words):
                mine, program = pty.openpty()
                subprocess.run(command(*words), cwd=self.folder, env=environment(), stderr=program, stdout=program,
                               stdin=subprocess.DEVNULL, check=False)
                self.assertIn(expected, os.read(mine, 100_000).decode())
                os.close(mine)
                os.close(program)

    def test_reduce_shows_the_first_rows(self):
        self.write_job()
        self.shearwake("run", "job.toml")
        output = self.shearwake("reduce", self.out).output.splitlines()
        begin = next(number for number, line in enumerate(output) if line.endswith("valid"))  # the last line of the labels
        self.assertRegex(output[begin], r"^AM frequency \(Hz\)  efficiency η  ")
        first = output[begin + 1].split()
        row = table(self.out)[0]
        self.assertEqual(float(first[0]), float(row["load.modulation.am_frequency_Hz"]))
        self.assertEqual(first[1], f"{float(row['eta_period_1']):.4g}")

    def test_presets_have_values_and_sources(self):
        output = self.shearwake("presets").output
        for name in ("thesis-tissue", "ecoflex", "forearm", "palm", "fingertip", "three-layer-skin", "cortical-bone", "array-16x16", "array-249"):
            self.assertIn(f"\n# {name}\n# ", output)
        self.contains(output, "viscosity_Pa_s = 5.03", "PMID 20888282", "pitch_mm = 10.47")

    @pytest.mark.extended
    def test_nothing_to_reduce_is_an_error(self):
        self.write_job()
        self.shearwake("run", "job.toml")
        shutil.rmtree(self.out / "cases")
        self.contains(self.shearwake("reduce", self.out, expect=4).output, "nothing to reduce")


@pytest.mark.extended
class Surroundings(ProgramTest):
    def test_odd_paths_change_nothing(self):
        self.compute()
        reference = table(self.out)
        for name, ranks in (("a folder with spaces", 1), ("it's \"quoted\" $HOME", 1), ("x" * 200, 2)):
            out = self.folder / name / "small"
            self.reduced(out, "--ranks-per-case", ranks, ranks=ranks)
            if ranks == 1:  # two ranks add in another order
                self.assertEqual(table(out), reference)
            self.shearwake("verify", out)

    def with_decimal_commas(self):
        """The environment of a locale with decimal commas, which is generated if the machine can do so."""
        locales = self.folder / "locales"
        locales.mkdir()
        try:
            subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", locales / "de_DE.UTF-8"], check=False, capture_output=True)
        except FileNotFoundError:
            self.skipTest("localedef is not installed")
        env = {**environment(), "LOCPATH": str(locales), "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
        shown = subprocess.run(["locale", "decimal_point"], env=env, check=False, capture_output=True, encoding="utf-8")
        if shown.stdout.strip() != ",":
            self.skipTest("no locale with decimal commas can be generated")
        return env

    @pytest.mark.long
    def test_decimal_commas_change_nothing(self):
        env = self.with_decimal_commas()
        self.compute(UNRECORDED)
        out = self.folder / "commas"
        for words in (("check", "job.toml"), ("plan", "job.toml"), ("run", "job.toml", "--out", out), ("reduce", out),
                      ("report", out), ("verify", out)):
            self.call(*command(*words), env=env)
        self.assertEqual(table(out), table(self.out))

    @pytest.mark.long
    def test_a_home_and_a_cache_that_cannot_be_written_stop_nothing(self):
        self.write_job()
        wisdom = self.folder / "cache" / "shearwake"
        blocked = self.folder / "file"
        blocked.write_text("", encoding="utf-8")
        for variables in ({"XDG_CACHE_HOME": str(blocked), "HOME": str(blocked)},
                          {"HOME": "/proc", "XDG_CACHE_HOME": ""}, {"SHEARWAKE_CACHE": str(wisdom)},
                          {"SHEARWAKE_CACHE": str(wisdom)}):
            out = self.folder / f"out-{len(list(self.folder.iterdir()))}"
            self.call(*command("run", "job.toml", "--out", out), variables=variables)
            for path in wisdom.glob("*"):  # then every file of the cache is a folder
                if path.is_file():
                    path.unlink()
                    path.mkdir()

    def test_two_runs_that_write_one_cache_at_once(self):
        self.write_job()
        for n in range(times(2, 10)):
            env = {**environment(), "SHEARWAKE_CACHE": str(self.folder / f"cache-{n}")}
            both = [subprocess.Popen(command("run", "job.toml", "--out", self.folder / f"{n}-{m}"), cwd=self.folder,
                                     env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                    for m in range(2)]
            self.assertEqual([process.wait(PATIENCE_s) for process in both], [0, 0])

    def test_case_files_that_vanish_while_they_are_read(self):
        self.write_job(UNRECORDED)
        self.shearwake("run", "job.toml")
        kept = self.folder / "kept"
        shutil.copytree(self.out / "cases", kept)
        for n in range(times(4, 30)):
            verb = ("reduce", "status", "verify", "report")[n % 4]
            shutil.rmtree(self.out / "cases", ignore_errors=True)
            shutil.copytree(kept, self.out / "cases")
            process = subprocess.Popen(command(verb, self.out), cwd=self.folder, env=environment(),
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
            subprocess.run(["rm", "-rf", self.out / "cases"], check=True)
            output = process.communicate(timeout=PATIENCE_s)[0]
            self.assertIn(process.returncode, (0, 4, 6), output)
            for word in NOISE:
                self.assertNotIn(word, output)


class Kills(ProgramTest):
    """Programs that replace existing files, killed at any time."""

    def kill(self, words, after_s):
        process = subprocess.Popen(words, cwd=self.folder, env=environment(), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            process.wait(after_s)
            return False
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return True

    def kill_often(self, words, is_complete):
        began = time.monotonic()
        self.call(*words)
        whole_s = time.monotonic() - began
        self.assertTrue(is_complete())
        number = times(6, 30)
        kills = 0
        for n in range(number):
            kills += self.kill(words, whole_s * (n + 0.5) / number)
            self.assertTrue(is_complete())
        self.assertGreater(kills, 0, "it was too fast to be killed")
        self.call(*words)
        self.assertTrue(is_complete())

    @pytest.mark.long
    def test_a_killed_report_leaves_a_complete_one(self):
        self.compute(UNRECORDED)
        folder = self.out / "report"

        def is_complete():
            page = (folder / "index.html").read_text(encoding="utf-8")
            ends = [path.read_bytes()[-8:] for path in folder.glob("*.png")]
            return page.rstrip().endswith("</html>") and ends and all(end == b"IEND\xaeB`\x82" for end in ends)

        self.kill_often(command("report", self.out), is_complete)

    @pytest.mark.long
    def test_a_killed_import_leaves_a_complete_study(self):
        run = "a_additive_pml10"
        save(self.folder / "study.mat", structures_of(run, reference(run)))

        def is_complete():
            with h5py.File(self.folder / "study.h5") as file:
                file.visititems(lambda name, item: item[()] if isinstance(item, h5py.Dataset) else None)
                return "sensor_mask_corners" in file

        self.kill_often([ROOT / "scripts" / "import-kwave", "study.mat"], is_complete)
        self.assertEqual(list(self.folder.glob("*.part")), [])
