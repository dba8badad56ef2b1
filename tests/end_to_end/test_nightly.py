# SPDX-License-Identifier: BSD-3-Clause
"""scripts/nightly and scripts/update-baseline: nights that equal the baseline, that differ, that fail, or that are killed."""
import csv
import html
import os
import shlex
import shutil
import signal
import sqlite3
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest

from program import (LONG, MISSPELT, NO_FRAMES, PROGRAM, ROOT, SECOND_CASE, ProgramTest, changed_job, environment,
                     faulty_environment, peaks, small_job, swept, without_reference)

from shearwake.errors import NotAnOutputFolder
from shearwake.nightly import __main__ as nightly, night, table
from shearwake.nightly.history import UNFINISHED, History

TINY = small_job(swept(400, 500), NO_FRAMES)
STRONGER = changed_job(TINY, {"load.peak_Pa": 101.0})
KILLED_WITHIN = """\
import os
from shearwake.nightly.history import History
history = History({path!r})
night = history.begin("2026-01-03T00:00:00", "git", "host")
def readings():
    yield "tiny", "case", "eta_1", 1.0
    os.kill(os.getpid(), 9)
history.finish(night, "equal", [("tiny", "equal", "")], readings(), [])
"""


@pytest.mark.extended
def test_a_baseline_that_a_spreadsheet_has_saved_has_the_same_readings(tmp_path):
    baseline = ROOT / "tests" / "baselines" / "quickstart.csv"
    for separator in ",;\t":
        with open(baseline, newline="") as file, open(tmp_path / "edited.csv", "w", newline="", encoding="utf-8-sig") as edited:
            csv.writer(edited, delimiter=separator).writerows(csv.reader(file))
        assert table.readings(tmp_path / "edited.csv") == table.readings(baseline) != []


def test_files_that_are_no_tables_or_plans_are_refused(tmp_path):
    path, watched = tmp_path / "table.csv", night.Watched(tmp_path, "tiny", tmp_path, tmp_path, [])
    (tmp_path / "tables").mkdir()
    for content in (b"", b"id,eta_1\n1,2\n", b"status\n1\n", b"id,status\n1,\xff\n", b"id,status\n1,2,3\n", b"id,status\n" + b"a" * 200_000):
        path.write_bytes(content)
        with pytest.raises(ValueError, match="is not a (valid )?table"):
            table.read_cases(path)
    for content in (b"[]", b"{}", b"1", b"[" * 300_000, b'{"name": 1}', b"\xff", b""):
        (tmp_path / "plan.json").write_bytes(content)
        with pytest.raises(NotAnOutputFolder):
            watched.table()


class Nightly(ProgramTest):
    def setUp(self):
        super().setUp()
        self.nights = self.folder / "nights"
        self.write_job(TINY, "tiny.toml")

    def script(self, name, *arguments, expect=0, typed=""):
        return self.call(*self.command(name, *arguments), env=self.environment(), input=typed, expect=expect).output

    def command(self, name, *arguments):
        return [str(ROOT / "scripts" / name), *map(str, arguments), "--out", "nights", "--baselines", "baselines"]

    @staticmethod
    def environment():
        return {**environment(), "SHEARWAKE": str(PROGRAM)}

    def night(self, *arguments, expect=0, job="tiny.toml"):
        return self.script("nightly", job, "--no-bench", "--ranks", "1", *arguments, expect=expect)

    def junit(self):
        """The name of the JUnit file, and (kind, message) of its entries by name."""
        root = ET.parse(self.nights / "junit.xml").getroot()
        self.assertEqual(root.tag, "testsuites")
        return root.get("name"), {case.get("name"): (case[0].tag if len(case) else "", case[0].get("message", "") if len(case) else "")
                                  for case in root.iter("testcase") if float(case.get("time")) >= 0.0}

    def first_lines(self, output):
        """The first line of the output, which page and JUnit file state too."""
        line, start = output.splitlines()[0], "Subject: shearwake nightly: "
        self.assertTrue(line.startswith(start), output)
        headline = line.removeprefix(start)
        self.assertIn(f">{html.escape(headline)}</h1>", self.page())
        self.assertEqual(self.junit()[0], headline)
        return headline

    def first_baseline(self):
        self.night(expect=6)
        self.script("update-baseline", "tiny.toml", "--yes")

    def page(self):
        return (self.nights / "index.html").read_text(encoding="utf-8")

    def query(self, query):
        with sqlite3.connect(self.nights / "history.sqlite") as file:
            rows = file.execute(query).fetchall()
        file.close()
        return rows

    def verdicts(self):
        return [verdict for verdict, in self.query("SELECT verdict FROM night ORDER BY id")]

    def start_night(self, job):
        process = subprocess.Popen(self.command("nightly", job, "--no-bench", "--ranks", "1"), cwd=self.folder,
                                   env={**faulty_environment(**SECOND_CASE), **self.environment()}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, start_new_session=True)
        self.addCleanup(self._end, process)
        self.wait_for_stop(process)
        return process

    @pytest.mark.extended
    def test_a_night_without_a_baseline_suggests_how_to_make_one(self):
        self.contains(self.night(expect=6), "has no baseline", "scripts/update-baseline", "tiny.toml --out")
        self.assertEqual(self.verdicts(), ["no baseline"])
        self.contains(self.script("update-baseline", "tiny.toml", expect=5, typed="n\n"), "3 cases", "the baseline is unchanged")
        self.assertFalse((self.folder / "baselines").exists())
        self.script("update-baseline", "tiny.toml", typed="y\n")
        header = (self.folder / "baselines" / "tiny.csv").read_text(encoding="utf-8").splitlines()[0]
        self.assertIn("eta_period_1", header)
        self.assertNotIn("wall_s", header)

    @pytest.mark.extended
    def test_equal_nights_then_one_that_differs(self):
        self.first_baseline()
        self.contains(self.night(), "tiny: equal to the baseline", "index.html")
        self.night("--ranks", "2")  # the number of ranks does not change the results
        self.assertIn("all tables equal their baselines", self.page())

        before = (self.folder / "baselines" / "tiny.csv").read_bytes()
        self.write_job(STRONGER, "tiny.toml")
        self.contains(self.night(expect=5), "tiny: differs from the baseline", "peak_um", "+1 %")
        self.assertEqual(self.verdicts(), ["no baseline", "equal", "equal", "differs"])
        page = self.page()
        moved = page[page.index("<ul>"):page.index("Trends of all numbers")]
        self.contains(moved, "peak_um", "+1 %", "3 of 3", "parameters of the job have changed")
        self.assertNotIn("eta_period_1", moved)  # a ratio, in which the strength of the load cancels
        drawn = self.query("SELECT DISTINCT column FROM reading UNION ALL SELECT DISTINCT name FROM speed")
        self.assertEqual(page.count("<svg"), len(drawn))
        self.assertNotIn("http", page)  # the page loads nothing
        self.assertEqual(len(self.query("SELECT * FROM reading WHERE column = 'peak_um'")), 4 * 3)

        self.contains(self.script("update-baseline", "tiny.toml", expect=5, typed="\n"), "peak_um", "+1 %", "[y/N]")
        self.assertEqual((self.folder / "baselines" / "tiny.csv").read_bytes(), before)
        self.contains(self.script("update-baseline", "tiny.toml", "--yes"), "peak_um", "written")
        self.night()
        self.contains(self.script("update-baseline", "tiny.toml"), "the baseline is up to date")

    @pytest.mark.extended
    def test_tolerances_next_to_the_baseline_are_used(self):
        self.first_baseline()
        self.write_job(STRONGER, "tiny.toml")
        (self.folder / "baselines" / "tiny.tolerances.toml").write_text('[tolerance]\n"*" = 0.02\n', encoding="utf-8")
        self.night()

    @pytest.mark.long
    def test_the_history_survives_a_killed_night(self):
        self.first_baseline()
        self.night()
        kept = self.query("SELECT * FROM reading ORDER BY night, job, case_name, column")
        self.write_job(LONG, "long.toml")
        process = self.start_night("long.toml")
        os.kill(process.pid, signal.SIGKILL)  # the program continues to run and holds the lock
        process.wait()
        self.contains(self.night(expect=6), "another night is running")
        os.killpg(process.pid, signal.SIGKILL)
        # The lock is released when its last process has ended, shortly after the signal.
        self.wait_for(lambda: self.lock_is_free(), "the lock")
        self.assertEqual(self.verdicts(), ["no baseline", "equal", UNFINISHED])
        self.assertEqual(self.query("SELECT * FROM reading ORDER BY night, job, case_name, column"), kept)
        self.night()
        self.assertEqual(self.verdicts(), ["no baseline", "equal", UNFINISHED, "equal"])
        self.assertIn(UNFINISHED, self.page())

    def lock_is_free(self):
        handle = nightly.lock(self.nights)
        if handle is None:
            return False
        os.close(handle)
        return True

    @pytest.mark.extended
    def test_a_night_killed_while_it_is_stored_leaves_no_partial_results(self):
        self.nights.mkdir()
        path = self.nights / "history.sqlite"
        history = History(path)
        history.finish(history.begin("2026-01-02T00:00:00", "git", "host"), "equal", [], [("tiny", "case", "eta_1", 0.5)], [])
        history.close()
        script = KILLED_WITHIN.format(path=str(path))
        self.call(sys.executable, "-c", script, env={**os.environ, "PYTHONPATH": str(ROOT / "analysis")}, expect=-signal.SIGKILL)
        self.assertEqual(self.verdicts(), ["equal", UNFINISHED])
        self.assertEqual(self.query("SELECT night, value FROM reading"), [(1, 0.5)])
        self.assertEqual(self.query("SELECT * FROM job"), [])

    @pytest.mark.extended
    def test_a_damaged_history_is_reported_and_not_overwritten(self):
        self.nights.mkdir()
        path = self.nights / "history.sqlite"
        path.write_bytes(b"no database, " * 100)
        before = path.read_bytes()
        self.contains(self.night(expect=6), "history.sqlite", "move it away")
        self.assertEqual(path.read_bytes(), before)

    @pytest.mark.extended
    def test_pipes_in_place_of_its_files_do_not_block_a_night(self):
        self.write_job(MISSPELT, "bad.toml")
        for name in ("history.sqlite", "index.html.part", "junit.xml.part", "nightly.log", "lock"):
            with self.subTest(name=name):
                self.nights.mkdir()
                os.mkfifo(self.nights / name)
                done = self.call(*self.command("nightly", "bad.toml", "--no-bench"), env=self.environment(), expect=None)
                self.assertNotIn("Traceback", done.stderr)
                self.assertNotEqual(done.returncode, 0)
                shutil.rmtree(self.nights)

    def test_a_failed_job_is_reported_and_the_others_continue(self):
        self.first_baseline()
        self.write_job(MISSPELT, "bad.toml")
        output = self.night("bad.toml", "nothing", "--ranks", "2", expect=3)
        self.contains(output, "tiny: equal", "bad: failed", "did you mean peak_Pa", "nothing: failed", "cannot read")
        self.assertNotIn("mpirun", output)
        self.assertNotIn("Primary job", output)
        self.assertEqual({name: kind for name, (kind, _) in self.junit()[1].items()}, {"tiny": "", "bad": "error", "nothing": "error"})
        self.contains(self.page(), "bad: failed", "did you mean peak_Pa")
        (self.folder / "build.log").write_text("x.cpp:1: error: <no such thing>\n", encoding="utf-8")
        self.contains(self.first_lines(self.night("--build-failed", "build.log", expect=1)), "build: x.cpp:1: error")
        self.assertIn("&lt;no such thing&gt;", self.page())

    @pytest.mark.extended
    def test_a_night_that_cannot_run_replaces_page_and_junit_file(self):
        self.first_baseline()
        self.night()
        (self.folder / "other").mkdir()
        shutil.copy(self.folder / "tiny.toml", self.folder / "other")
        handle = nightly.lock(self.nights)
        self.addCleanup(os.close, handle)
        empty = self.folder / "empty"
        empty.mkdir()
        for code, words, arguments, variables in (
                (2, "the same name", ["tiny.toml", "other/tiny.toml"], {}), (2, "must be greater than 0", ["--ranks", "0"], {}),
                (2, "unrecognized arguments: --new", ["--new"], {}), (6, "another night is running", ["tiny.toml"], {}),
                (6, "no Python with numpy", ["tiny.toml"], {"PATH": f"{empty}:/usr/bin", "PYTHONPATH": str(empty)})):
            with self.subTest(words=words):
                if "PATH" in variables:  # a Python that has no packages
                    (empty / "numpy.py").write_text("raise ImportError\n", encoding="utf-8")
                (self.nights / "index.html").write_text("all tables equal", encoding="utf-8")
                done = self.call(*self.command("nightly", *arguments), env={**self.environment(), **variables}, expect=code)
                self.contains(self.first_lines(done.stdout), "the night could not run", words)
                self.assertEqual([kind for kind, _ in self.junit()[1].values()], ["error"])

    @pytest.mark.extended
    def test_without_names_all_jobs_with_baselines_are_run(self):
        self.contains(self.script("nightly", "--no-bench", expect=2), "contains no baselines", "specify the jobs")
        (self.folder / "baselines").mkdir()
        (self.folder / "baselines" / "nothing.csv").write_text("id\n", encoding="utf-8")
        self.contains(self.first_lines(self.script("nightly", "--no-bench", expect=6)), "nothing failed", "cannot read")

    @pytest.mark.extended
    def test_ten_nights(self):
        """Equal, changed, slower, failed, missing case, new case, invalid job, study elsewhere, repaired, equal."""
        job = small_job(peaks(100.0, 200.0), NO_FRAMES)
        slow = self.folder / "slow"
        slow.write_text(f'#!/bin/sh\nif [ "$1" = run ]; then sleep 10; fi\nexec {PROGRAM} "$@"\n', encoding="utf-8")
        slow.chmod(0o755)

        def night(expect, text, *arguments, program=PROGRAM):  # 2000 %: no night is slower because the machine is busy
            self.write_job(text, "tiny.toml")
            done = self.call(*self.command("nightly", "--no-bench", "--ranks", "1", "--fail-slower", "2000", *arguments),
                             env={**self.environment(), "SHEARWAKE": str(program)}, expect=expect)
            kinds = {kind for kind, _ in self.junit()[1].values()} - {""}
            print(expect, kinds, self.first_lines(done.stdout), sep=" | ")
            return self.first_lines(done.stdout), kinds, done.stdout

        night(6, job, "tiny.toml")
        self.script("update-baseline", "tiny.toml", "--yes")
        self.assertEqual(night(0, job)[:2], ("all tables equal their baselines", set()))
        headline, kinds, output = night(5, changed_job(job, {"medium.layer[1].density_kg_m3": 1010.0}))
        self.assertEqual(kinds, {"failure"})
        self.contains(headline, "tiny differs from the baseline: -")
        self.contains(output, "parameters of the job have changed", "no commit since the last equal night")
        headline, kinds, _ = night(5, job, "--fail-slower", "100", program=slow)
        self.assertEqual(kinds, {"failure"})
        self.contains(headline, "tiny is slower: +", "instead of")
        headline, kinds, output = night(4, changed_job(job, peaks(100.0, 200.0, 1e200)))
        self.assertEqual(kinds, {"error"})
        self.contains(headline, "tiny failed: 1 of 3 cases failed, load.peak_Pa=1e+200: ", "not finite")
        self.assertIn("not finite", self.junit()[1]["load.peak_Pa=1e+200"][1])
        headline, kinds, _ = night(5, changed_job(job, peaks(100.0)))
        self.assertEqual((headline, kinds), ("tiny differs from the baseline: 1 missing case: load.peak_Pa=200", {"failure"}))
        headline, kinds, _ = night(5, changed_job(job, peaks(100.0, 200.0, 300.0)))
        self.assertEqual((headline, kinds), ("tiny differs from the baseline: 1 extra case: load.peak_Pa=300", {"failure"}))
        headline, kinds, _ = night(3, job.replace("peak_Pa = 100.0", "peek_Pa = 100.0"))
        self.assertEqual(kinds, {"error"})
        self.contains(headline, "tiny failed: run: ", "tiny.toml:19:1: error: load.peek_Pa is unknown")
        elsewhere = self.folder / "elsewhere" / "study.toml"
        elsewhere.parent.mkdir()
        elsewhere.write_text(job, encoding="utf-8")
        output = night(6, job, elsewhere)[2]
        command = next(line.partition("next: ")[2] for line in output.splitlines() if "next: " in line)
        subprocess.run([*shlex.split(command), "--yes"], cwd="/", env=self.environment(), check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(night(0, job)[:2], ("all tables equal their baselines", set()))
        self.assertEqual(sorted(self.junit()[1]), ["study", "tiny"])
        elsewhere.unlink()
        headline, kinds, output = night(6, job)
        self.contains(output, "tiny: equal", "study: failed", "cannot read")

    @pytest.mark.long
    def test_a_failed_case_is_rejected_as_baseline(self):
        self.first_baseline()
        self.write_job(without_reference(swept(400)), "tiny.toml")
        self.contains(self.night(expect=5), "missing case")
        table = self.nights / "runs" / "tiny" / "tables" / "small.csv"
        table.write_text(table.read_text(encoding="utf-8").replace("complete", "failed"), encoding="utf-8")
        self.contains(self.script("update-baseline", "tiny.toml", "--yes", expect=4), "not complete")

    @pytest.mark.long
    def test_speeds_of_engines_are_relative_to_ffts_of_the_same_night(self):
        self.first_baseline()
        self.script("nightly", "tiny.toml", "--ranks", "1")
        speeds = dict(self.query("SELECT name, ratio FROM speed"))
        for case in ("layered, 256 x 192 x 280 frames, periodic edges", "spectral, 256 x 192 x 25 levels, contrast 16"):
            self.assertGreater(speeds[f"{case}: time relative to its FFTs"], 0.0)
            self.assertIn(case, self.page())
        self.assertIn("tiny on 1 rank (s)", speeds)


@pytest.mark.extended
def test_a_job_is_slower_if_a_second_run_is_slower_too():
    earlier, runs = {"tiny (s)": {1: 9.0, 2: 10.0, 3: 30.0}}, iter((20.0, 12.0, 20.0, 18.0, 20.0, 18.0, 11.0))

    def measure():
        return night.Result("tiny", speeds={"tiny (s)": next(runs)})
    found = [nightly.measured(measure, earlier, percent) for percent in (None, None, 50.0, 50.0)]
    assert [(r.verdict, r.code) for r in found] == [("equal", 0), ("slower", 0), ("slower", 5), ("equal", 0)]
    assert "+80 % in tiny (s): 18 instead of 10, the median of 3 earlier nights" in found[1].headline
    assert nightly.slower({"tiny (s)": 1.2}, {"tiny (s)": {1: 0.4}}, 25.0) == []


@pytest.mark.extended
def test_commits_since_the_last_equal_night_are_listed(tmp_path, monkeypatch):
    def git(*words):
        return subprocess.run(["git", "-C", tmp_path, "-c", "user.name=n", "-c", "user.email=e", *words], check=True, capture_output=True,
                              encoding="utf-8").stdout.strip()
    git("init", "-q")
    ids = []
    for subject in ("Add a", "Fix b", "Change c"):
        git("commit", "-q", "--allow-empty", "-m", subject)
        ids.append(git("rev-parse", "--short=12", "HEAD"))
    monkeypatch.setattr(night, "ROOT", tmp_path)
    history = History(":memory:")
    assert night.commits(history, "tiny", ids[2]) == ["no earlier night was equal to the baseline"]
    for git_id, verdict in ((ids[0], "equal"), (ids[1], "differs")):
        history.finish(history.begin("2026-01-02T00:00:00", git_id, "host"), verdict, [("tiny", verdict, "")], [], [])
    since = f"since the last equal night, 2026-01-02 ({ids[0]})"
    found = night.commits(history, "tiny", ids[2])
    assert [line.split(maxsplit=1)[-1] for line in found[1:]] == ["Change c", "Fix b"] and found[0] == f"2 commits {since}"
    assert night.commits(history, "tiny", ids[0]) == [f"no commit {since}"]
    assert night.commits(history, "tiny", ids[0] + "-dirty-1") == [f"no commit {since}, but uncommitted changes"]
    assert night.commits(history, "tiny", "v0.2.0") == [f"program v0.2.0; the commits {since} are not known"]
    history.close()
