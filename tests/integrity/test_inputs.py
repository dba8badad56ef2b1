# SPDX-License-Identifier: BSD-3-Clause
"""Absurd input: unbounded quantities, devices, links to other files, and texts with a special meaning
in a terminal, a table, a page or a shell."""
import os
import shutil
import sys
from pathlib import Path

import h5py
import numpy
import pytest

from limits import accepted_or_refused
from program import ONE_CASE, PSTD, ROOT, SPECTRAL, ProgramTest, case_files, changed, command, csv_path, seal, small_job, without_reference

MAP = {**SPECTRAL, "medium.map": "input.h5"}
LAYER = "medium.layer[1]"
ABSURD = (
    {f"{LAYER}.thickness_mm": 1e308, **PSTD}, {f"{LAYER}.thickness_mm": 1e5, **SPECTRAL},
    {f"{LAYER}.thickness_mm": 1e4, f"{LAYER}.c_s_m_s": 1e-3, **SPECTRAL}, {f"{LAYER}.c_s_m_s": 1e-30, **SPECTRAL},
    {f"{LAYER}.density_kg_m3": 1e308, **SPECTRAL}, {f"{LAYER}.viscosity_Pa_s": 1e15, **PSTD},
    {"domain.extent_mm": [1e9, 1e9]}, {"domain": {"extent_mm": [1e4, 1e4], "spacing_mm": 1e-5}},
    {"time.duration_ms": 1e300}, {"time": {"duration_ms": 1e7, "output_interval_us": 1e-6}}, {"load.footprint.fwhm_mm": 1e-300})


class Sizes(ProgramTest):
    def ended(self, verb, codes, *more):
        """The output of a command, which must end with one of the exit codes."""
        return accepted_or_refused(self, command(verb, "job.toml", *more), codes, verb)[0]

    def test_absurd_quantities_are_refused_at_once(self):
        for changes in ABSURD:
            self.write_job(without_reference(changes))
            for verb in ("check", "plan", "run"):
                with self.subTest(changes=changes, verb=verb):
                    self.ended(verb, (3,))

    def test_cases_beyond_memory_or_disk_are_refused_unless_they_run_elsewhere(self):
        for name, changes, reason in (
                ("memory", {"domain": {"extent_mm": [1600.0, 1600.0], "spacing_mm": 0.05}}, r"needs \d+ MB per rank, and a rank may use"),
                ("disk", {"domain": {"extent_mm": [768.0, 768.0], "spacing_mm": 0.5}, "time.output_interval_us": 0.1},
                 r"need \d+ MB, and the disk with .* has \d+ MB left")):
            self.write_job(without_reference(changes))
            for verb in ("check", "plan"):
                with self.subTest(name=name, verb=verb):
                    self.assertRegex(self.ended(verb, (3,)), reason)
                    self.ended(verb, (0,), "--elsewhere")
            output = self.ended("run", (6,))
            self.assertRegex(output, reason)
            self.contains(output, "add --force")
            self.assertFalse(self.out.exists())

    def test_what_case_files_cannot_hold_is_refused_before_it_is_computed(self):
        self.write_job(changed(("[[0.0, 0.0], [3.2, 1.1]]", f"[{300000 * '[0,0],'}]")))  # in few bytes
        for verb in ("check", "plan", "run"):
            self.contains(self.ended(verb, (3,)), "traces")


class Files(ProgramTest):
    def test_devices_and_pipes_are_not_read(self):
        os.mkfifo(self.folder / "pipe.csv")
        for file in ("/dev/zero", "pipe.csv"):
            self.write_job(small_job(csv_path(file)))
            done = self.shearwake("check", "job.toml", expect=None)
            self.assertIn(done.returncode, (3, 6), done.output)
            self.contains(done.output, "not a regular file")
        for words in (("check", "/dev/zero"), ("check", "pipe.csv"), ("respond", "/dev/zero"),
                      ("respond", "pipe.csv"), ("show", "/dev/zero"), ("show", "pipe.csv")):
            done = self.shearwake(*words, expect=None)
            self.assertIn(done.returncode, (2, 3, 6), done.output)
            self.assertNotIn("internal error", done.stderr)

    def test_explore_refuses_folders_that_cannot_hold_results(self):
        (self.folder / "file").touch()
        (self.folder / "link").symlink_to("nowhere")
        for out, words in (("", "is empty"), ("-x", "write ./-x"), ("file", "is not a folder"), ("file/x", "is not a folder"),
                           ("/dev/null", "is not a folder"), ("a\nb", "control characters"), ("/proc/x", "cannot be written"),
                           ("link", "does not exist"), ("x" * 300, "too long")):
            with self.subTest(out=out):
                done = self.shearwake("explore", "--no-browser", "--out", out, expect=2)
                self.contains(done.output, "--out", words)
                self.assertNotIn("http", done.output)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["file", "link"])

    def test_links_of_maps_and_motions_are_named_and_not_followed(self):
        os.mkfifo(self.folder / "pipe.h5")  # opening it would block
        self.write_job(small_job(MAP))
        for name, link, code, words in (("input.h5", "c_s_m_s", 3, ("check", "job.toml")), ("motion.h5", "traces", 2, ("respond", "motion.h5"))):
            with h5py.File(self.folder / name, "w") as file:
                file[link] = h5py.ExternalLink("pipe.h5", "/")
            self.contains(self.shearwake(*words, expect=code).output, name, f'the link "{link}" leads to another file')

    def test_files_that_cannot_be_read_are_errors_of_the_job(self):
        for name, changes in (("input.csv", csv_path("input.csv")), ("input.csv", {"sweep.list": "input.csv"}), ("input.h5", MAP)):
            self.write_job(small_job(changes))
            path = self.folder / name
            for kind, make in (("missing", lambda path: None), ("folder", Path.mkdir), ("pipe", os.mkfifo),
                               ("loop", lambda path: path.symlink_to(path)), ("other contents", lambda path: path.write_bytes(b"\x89PNG"))):
                make(path)
                with self.subTest(changes=changes, kind=kind):
                    output, _ = accepted_or_refused(self, command("check", "job.toml", "--elsewhere"), (3,), kind)
                    self.assertIn(name, output)
                if kind == "folder":
                    path.rmdir()
                elif kind != "missing":
                    path.unlink()

    def test_truncated_and_foreign_motions_are_refused_with_a_reason(self):
        path, call = self.folder / "motion.h5", ("respond", "motion.h5", "-S", 'afferents.where="fingertip"')
        with h5py.File(path, "w") as file:
            file["trace_mm"], file["pin_xy_mm"], file.attrs["fs_hz"] = numpy.zeros((2, 50)), numpy.eye(2), 1000.0
        good = path.read_bytes()
        self.shearwake(*call)
        for content in (good[:len(good) // 2], good[:100], b"no HDF5\n", b""):
            path.write_bytes(content)
            with self.subTest(bytes=len(content)):
                self.contains(self.shearwake(*call, expect=2).output, "motion.h5", "it cannot be read as HDF5")

    def test_case_files_that_point_to_other_files_are_not_read(self):
        """With the checksum that everybody can compute."""
        self.write_job(small_job(ONE_CASE, {"record.traces_mm": [[0.0, 0.0]]}))
        self.shearwake("run", "job.toml")
        good = case_files(self.out)[0]
        case = self.folder / good.name
        with h5py.File(self.folder / "other.h5", "w") as file:
            file["d"] = numpy.full((2, 40), 12345.0)
        numpy.full(80, 12345.0).tofile(self.folder / "raw.bin")
        os.mkfifo(self.folder / "pipe.h5")

        def virtual(file):
            layout = h5py.VirtualLayout((2, 40), "f8")
            layout[...] = h5py.VirtualSource(str(self.folder / "other.h5"), "d", (2, 40))
            file.create_virtual_dataset("traces/u_z", layout)

        read = (f"import sys; sys.path.insert(0, {str(ROOT / 'analysis')!r}); import shearwake\ntry: print(shearwake.open_case(sys.argv[1]).dataset('traces')['u_z'].values)\n"
                "except shearwake.NotRecorded as error: sys.exit(str(error))")
        for kind, change in (
                ("link", lambda file: file.__setitem__("traces/u_z", h5py.ExternalLink(self.folder / "other.h5", "d"))),
                ("pipe", lambda file: file.__setitem__("traces/u_z", h5py.ExternalLink(self.folder / "pipe.h5", "d"))),
                ("storage", lambda file: file.create_dataset("traces/u_z", (2, 40), "f8", external=[(self.folder / "raw.bin", 0, 640)])),
                ("virtual", virtual)):
            shutil.copy(good, case)
            with h5py.File(case, "r+") as file:
                del file["traces/u_z"]
                change(file)
            seal(case)
            for call in ([sys.executable, "-c", read, case.name], command("compare", case.name, str(good)), command("show", case.name)):
                with self.subTest(kind=kind, call=call[-2:]):
                    output, _ = accepted_or_refused(self, call, (1, 4, 6), kind)
                    self.contains(output, case.name, "traces/u_z", "another file")
                    self.assertNotIn("12345", output.replace(case.stem, ""))

    def test_motions_with_absurd_times_are_refused(self):
        for step_ms in (1e-12, 1e15):
            (self.folder / "m.csv").write_text(
                "t_ms,u_um\n" + "".join(f"{n * step_ms:.17g},0.1\n" for n in range(3)), encoding="utf-8")
            done = self.shearwake("respond", "m.csv", "-S", "afferents.where=\"finger\"", expect=None)
            self.assertIn(done.returncode, (2, 3), done.output)
            self.assertNotIn("MPI_ABORT", done.output)

    def test_motions_with_too_many_points_are_refused_at_once(self):
        n = 99999  # and the time: the most cells of a line
        places = [(f"{i % 400 - 200:g}", f"{i // 400:g}") for i in range(n)]
        lines = ["t_ms," + ",".join(["u_um"] * n), "x_mm," + ",".join(x for x, _ in places),
                 "y_mm," + ",".join(y for _, y in places), "0," + ",".join(["0"] * n), "1," + ",".join(["1"] * n)]
        (self.folder / "m.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        done = self.shearwake("respond", "m.csv", expect=None)
        self.assertIn(done.returncode, (2, 3), done.output)
        self.contains(done.output, "99999 pins exceed the limit")


class Texts(ProgramTest):
    def test_control_characters_in_titles_and_names_are_refused(self):
        for text in ("a\x1b[2Jb", "a\nb", "a\0b", "a\x9bb", "a\u202eb"):
            self.write_job(small_job({"job.title": text}))
            done = self.shearwake("check", "job.toml", expect=3)
            self.contains(done.output, "control character")
            self.assertNotIn("\x1b", done.output)
        self.write_job(small_job({"job.name": "-rf"}))
        self.shearwake("check", "job.toml", expect=3)

    def test_control_characters_in_tables_are_not_printed(self):
        for name, column in (("a.csv", "a\x1b[2Jb"), ("b.csv", "b")):
            (self.folder / name).write_text(f"id,{column}\n1,2\n", encoding="utf-8")
        output = self.shearwake("compare", "a.csv", "b.csv", expect=1).output
        self.contains(output, "a?[2Jb")
        self.assertNotIn("\x1b", output)

    @pytest.mark.long
    def test_formulas_in_titles_are_drawn_as_they_are(self):
        title = r"$\frac{$ <b>&amp; | =1+1 `x`"
        self.write_job(small_job({"job.title": title, "medium.layer[1].name": r"$\frac{$"}))
        self.reduced(self.out)
        output = self.shearwake("report", self.out).output
        self.assertNotIn("Traceback", output)
        page = (self.out / "report" / "index.html").read_text(encoding="utf-8")
        self.contains(page, "&lt;b&gt;&amp;amp;")
        self.assertNotIn("<b>&amp; |", page)
        heading = (self.out / "tables" / "small.md").read_text(encoding="utf-8").splitlines()[0]
        self.contains(heading, "&lt;b>", r"\|", r"\`x\`")
