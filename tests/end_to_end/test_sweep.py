# SPDX-License-Identifier: BSD-3-Clause
"""A complete sweep with the commands check, plan, run, status, reduce and show, and the content of its files."""
import contextlib
import fcntl
import json
import os
import pty
import re
import signal
import struct
import subprocess
import termios
import tomllib

import h5py
import numpy
import xarray

from program import (AM, JOB, NO_FRAMES, PATIENCE_s, PSTD, SPECTRAL, ProgramTest, case_files, command, environment, journal, plan,
                     plan_ids, small_job, started, swept, table, without_reference)
from table_comparison import assert_same_table, exact_as, is_literal_ipr

PROVENANCE = ["title", "case_id", "case", "job", "program", "git_id", "compiler", "build_type",
              "mpi_version", "fftw_version", "hdf5_version", "host", "ranks", "wall_s", "started",
              "ended", "status"]


def numbers_of(path):
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
    with h5py.File(path) as file:
        file.visititems(visit)
    return found


class Sweep(ProgramTest):
    def sweep(self, ranks, name="small"):
        out = self.folder / "out" / name
        done = self.shearwake("run", "job.toml", "--out", out, ranks=ranks)
        return out, done

    def test_all_commands_in_turn(self):
        self.write_job()
        output = self.shearwake("check", "job.toml").output
        self.contains(output, "4 cases", "no errors")
        listed = re.findall(r"(?m)^([0-9a-f]{16}) ", self.shearwake("plan", "job.toml").output)
        self.assertEqual(len(listed), 4)

        output = self.shearwake("run", "job.toml").output
        self.contains(output, "4 computed now", "shearwake reduce out/small")
        self.assertEqual(sorted(plan_ids(self.out)), sorted(listed))
        self.assertEqual([path.stem for path in case_files(self.out)], sorted(listed))
        self.assertEqual((self.out / "job.toml").read_text(encoding="utf-8"), JOB)
        self.assertEqual(list(self.out.rglob("*.part")), [])

        before = {path: path.stat().st_mtime_ns for path in case_files(self.out)}
        output = self.shearwake("run", "job.toml").output
        self.contains(output, "0 computed now", "4 already complete")
        self.assertEqual(sorted(started(self.out)), sorted(listed), "a complete case was started again")
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in case_files(self.out)})

        self.contains(self.shearwake("status", self.out).output, "4 done", "0 failed", "reduce")
        output = self.shearwake("reduce", self.out).output
        self.contains(output, "4 cases: 4 complete", "small.csv", "small.md")
        rows = table(self.out)
        self.assertEqual([row["id"] for row in rows], plan_ids(self.out))
        self.assertEqual([row["load.modulation.am_frequency_Hz"] for row in rows], ["400", "500", "1000", ""])
        for column in ("eta_at_1", "eta_period_1", "ipr_at_1", "ipr_abs_period_mm2",
                       "participation_period_mm2", "peak_um", "focal_rms_um", "impulse_mN_ms",
                       "peak_frequency_Hz", "rms_40_400_um", "mach_angle_deg", "status", "note"):
            self.assertIn(column, rows[0])
        self.assertEqual({row["status"] for row in rows}, {"complete"})

        output = self.shearwake("show", self.out / "cases" / f"{plan_ids(self.out)[0]}.h5").output
        self.contains(output, plan_ids(self.out)[0], "a small sweep, \u03b7", "complete", "eta_at_1", "am_frequency_Hz")

    def test_results_do_not_depend_on_the_number_of_ranks(self):
        self.write_job()
        one, _ = self.sweep(1, "one")
        first = {path.stem: numbers_of(path) for path in case_files(one)}
        self.shearwake("reduce", one)
        for ranks, teams in ((2, 2), (3, 3)):
            out = self.folder / "out" / f"{ranks}-{teams}"
            self.reduced(out, "--ranks-per-case", teams, ranks=ranks)
            assert_same_table(self, table(one), table(out))
            self.assertEqual({path.stem for path in case_files(out)}, set(first))
            for path in case_files(out):
                other = numbers_of(path)
                self.assertEqual(set(other), set(first[path.stem]))
                self.assertIn("surface/u_z", other)
                for name, values in first[path.stem].items():
                    # Only the order of sums over slabs differs. The fit of the angle and the
                    # peak of the spectrum divide differences and are therefore less accurate.
                    fitted = name.startswith(("mach_angle", "peak_frequency"))
                    tolerance = 1e-9 if fitted else 1e-12
                    scale, here = first[path.stem][exact_as(name)], other[name]
                    if is_literal_ipr(name):
                        scale, here, values = map(numpy.sqrt, (scale, here, values))
                    largest = numpy.nanmax(numpy.abs(scale), initial=0.0)
                    numpy.testing.assert_allclose(here, values, rtol=0.0, atol=tolerance * largest, err_msg=name)
                self.assertTrue(numpy.isfinite(other["surface/u_z"]).all())

    def test_xarray_opens_a_case_file(self):
        self.write_job()
        out, _ = self.sweep(1)
        for path in case_files(out):
            for group in (None, "surface", "traces"):
                with xarray.open_dataset(path, group=group) as data:
                    self.assertGreater(len(data.data_vars), 0)
                    for name, variable in data.variables.items():
                        self.assertTrue(variable.attrs.get("long_name"), name)
                        # xarray converts times according to their units.
                        self.assertTrue(variable.attrs.get("units") or variable.encoding.get("units"), name)
            with xarray.open_dataset(path, group="surface") as data:
                self.assertEqual(data["u_z"].dims, ("time", "depth", "x", "y"))
                self.assertEqual(data["u_z"].shape, (40, 1, data.x.size, data.y.size))
                self.assertTrue(numpy.all(numpy.isfinite(data["u_z"])))
                largest = float(numpy.abs(data["u_z"]).max())
            with xarray.open_dataset(path) as data:
                self.assertEqual(data["eta"].dims, ("depth", "time"))
                self.assertEqual(float(data["peak"].max()), largest)
            with xarray.open_dataset(path, group="traces") as data:
                self.assertEqual(data["u_z"].dims, ("trace", "time"))
                self.assertEqual(data["amplitude"].dims, ("trace", "frequency"))

    def test_files_contain_their_provenance(self):
        self.write_job()
        out, _ = self.sweep(2)
        cases = {case["id"]: case for case in plan(out)["cases"]}
        for path in case_files(out):
            with h5py.File(path) as file:
                attributes = dict(file.attrs)
            text = {key: value.decode() if isinstance(value, bytes) else value for key, value in attributes.items()}
            for name in PROVENANCE:
                self.assertIn(name, text)
                self.assertNotEqual(text[name], "", name)
            self.assertEqual(text["case_id"], path.stem)
            self.assertEqual(text["job"], JOB)
            self.assertEqual(text["title"], "a small sweep, \u03b7 against frequency")
            self.assertEqual(text["status"], "complete")
            self.assertEqual(text["case"], cases[path.stem]["case"])
            self.assertIn("load", tomllib.loads(text["case"]))
            self.assertGreater(text["wall_s"], 0.0)
            self.assertRegex(text["started"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
            self.assertLessEqual(text["started"], text["ended"])
            self.assertEqual(json.loads(text["settings"]), cases[path.stem]["settings"])

    def test_long_plans_are_summarised(self):
        self.write_job(small_job({"sweep": {AM: {"linspace": [300, 1000, 40]}}}))
        self.shearwake("run", "job.toml", "-S", 'sweep."load.modulation.am_frequency_Hz"=[400]', "--out", "rate", "--quiet")
        short = self.shearwake("plan", "job.toml", "-n", 2).output
        listed = re.findall(r"(?m)^([0-9a-f]{16}) ", short)
        self.assertEqual((len(listed), len(set(listed))), (20, 20), short)
        self.contains(short, "26 further cases", "--all lists every case")
        self.assertRegex(short, r"41 cases on 2 ranks \(.*\): \S+ core hours, about (\S+ s|\d+ h \d\d min) of wall time, "
                                r"at most \d+ MB per rank, \S+ MB on disk\n")
        self.assertEqual(len(re.findall(r"(?m)^([0-9a-f]{16}) ", self.shearwake("plan", "job.toml", "--all").output)), 41)

    def test_a_terminal_shows_a_bar_and_a_file_shows_lines(self):
        self.write_job()
        primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 50, 0, 0))
        with open(primary, "rb", buffering=0, closefd=True) as screen:
            done = subprocess.Popen(command("run", "job.toml"), cwd=self.folder, env=environment(),
                                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=secondary)
            os.close(secondary)
            shown = b""
            with contextlib.suppress(OSError):  # the end of the program
                while part := screen.read(4096):
                    shown += part
            self.assertEqual(done.wait(timeout=PATIENCE_s), 0, shown)
        drawn = [part.split("\n")[0].rstrip("\r") for part in shown.decode().split("\r\x1b[K") if part.startswith("[")]
        self.assertEqual(drawn[-1], f"[{20 * '#'}] 100 % 4/4 cases done, 0 running, 0 failed"[:49])
        self.assertLessEqual(max(map(len, drawn)), 49)  # a line that wraps is not erased
        lines = self.shearwake("run", "job.toml", "--out", "again").stderr
        self.contains(lines, "4/4 cases done, 0 running, 0 failed")
        for sign in ("\r", "\x1b", "#"):
            self.assertNotIn(sign, lines)

    def test_progress_within_a_case_is_reported(self):
        # Far more steps than are computed before the run is stopped. The log and the record that `status` reads have the
        # same content, which is recorded first after two and ten seconds.
        self.write_job(without_reference(PSTD, swept(500), NO_FRAMES, {"time.duration_ms": 4000.0}))
        log = self.folder / "log.jsonl"

        def partial(folder, name):
            return [json.loads(line)["partial"] for path in folder.glob(name) for line in path.read_text(encoding="utf-8").splitlines()]

        run = self.start("run", "job.toml", "--force", "--log-json", log.name)
        self.wait_for(lambda: any(partial(self.out, "progress.*.json")), "progress within a case")
        shares = partial(self.out, "progress.*.json")
        os.kill(run.pid, signal.SIGTERM)
        run.communicate()
        shares += partial(self.folder, log.name)
        self.assertTrue(all(0.0 <= share <= 1.0 for share in shares), shares)
        self.assertEqual(shares[-1], 0.0)  # no case is running

    def test_status_states_progress_and_remaining_time_of_the_first_case(self):
        # A layered case of about a minute, which is killed after some seconds.
        domain = {"extent_mm": [384.0, 320.0], "spacing_mm": 0.5}
        self.write_job(without_reference(swept(500), NO_FRAMES, {"time.duration_ms": 40.0, "domain": domain}))
        run = self.start("run", "job.toml", "--force")

        def status():
            done = self.shearwake("status", self.out, "--json", expect=None)
            return json.loads(done.stdout) if done.returncode == 0 else {"partial": 0.0}

        self.wait_for(lambda: status()["partial"] > 0.0, "progress of the first case")
        found = status()
        self.assertEqual((found["done"], found["running"], found["state"]), (0, 1, "running"))
        self.assertGreater(found["seconds_left"], 0.0)
        self.contains(self.shearwake("status", self.out).output, "remaining: about", "the running case is", "% complete")
        os.killpg(run.pid, signal.SIGKILL)  # which leaves the record of the progress
        run.wait()
        killed = status()
        self.assertEqual((killed["partial"], killed["seconds_left"], killed["state"]), (0.0, None, "stopped"))

    def test_plan_distinguishes_swept_keys_that_end_in_the_same_word(self):
        body = {"shape": "ellipsoid", "semi_axes_mm": [5.0, 5.0, 3.0], "center_mm": [0.0, 0.0, 10.0], "c_s_m_s": 6.0}
        self.write_job(small_job(SPECTRAL, {"table": None, "medium.body": [body], "sweep": {
            "medium.body[1].c_s_m_s": [6, 7], "medium.layer[1].c_s_m_s": [4, 5], "load.peak_Pa": [10, 20]}}))
        self.contains(self.shearwake("plan", "job.toml").output,
                      "shear-wave speed, body 1 = 6 m/s; shear-wave speed, layer 1 = 4 m/s; peak pressure = 10 Pa")

    def test_quiet_prints_only_errors(self):
        self.write_job()
        self.assertEqual(self.shearwake("run", "job.toml", "--quiet", ranks=2).output, "")
        self.assertEqual(self.shearwake("verify", self.out, "--quiet").output, "")
        self.contains(self.shearwake("run", "job.toml", "--quiet", "-S", "load.peak_Pa=1e200", "--out", "bad", expect=4).output,
                      "failed")

    def test_messages_are_printed_by_one_rank(self):
        self.write_job()
        for name in ("check", "plan", "run"):
            output = self.shearwake(name, "job.toml", ranks=2).output
            lines = [line for line in output.splitlines() if len(line) > 20]
            self.assertEqual(len(lines), len(set(lines)), output)
        for name in ("status", "reduce"):
            output = self.shearwake(name, self.out, ranks=2).output
            lines = [line for line in output.splitlines() if line]
            self.assertEqual(len(lines), len(set(lines)), output)
        output = self.shearwake("check", "nowhere.toml", ranks=2, expect=6).output
        self.assertEqual(output.count("cannot read"), 1, output)

    def test_the_journal_records_the_run(self):
        self.write_job()
        out, _ = self.sweep(2)
        events = [line["event"] for line in journal(out)]
        self.assertEqual((events[0], events[-1]), ("run_started", "run_ended"))
        self.assertEqual(events.count("started"), 4)
        self.assertEqual(events.count("finished"), 4)
