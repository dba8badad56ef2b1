# SPDX-License-Identifier: BSD-3-Clause
"""Movies of cases."""
import contextlib
import json
import os
import pty
import shutil
import subprocess
import unittest

import h5py
import pytest

from program import ProgramTest, case_files, command, environment


def facts(path, entries):
    """Properties of the first stream of a movie, as ffprobe prints them."""
    done = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", f"stream={entries}", "-of",
                           "csv=p=0", str(path)], capture_output=True, text=True, check=True)
    return done.stdout.strip().split(",")


def setting_of(path):
    """The AM frequency of a case of the sweep; nothing for the reference."""
    with h5py.File(path, "r") as file:
        settings = json.loads(file.attrs["settings"])
        return settings.get("load.modulation.am_frequency_Hz") if file.attrs["is_reference"] == b"no" else None


@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is missing: scripts/setup installs it")
class Movie(ProgramTest):
    def case(self, *options):
        self.write_job()
        self.shearwake("run", "job.toml", "-S", "record.frames=false", *options)
        return next((self.out / "cases").glob("*.h5"))

    def test_a_case_with_frames_becomes_an_mp4_and_a_gif(self):
        case = self.case("-S", "record.snapshots_ms=[1, 2, 3, 4]")
        output = self.shearwake("movie", case, "--out", "m", "--slow-down", "1000", "--width", "500").output
        self.contains(output, "movie: m.mp4", "movie: m.gif")
        width, height, frames = facts(self.folder / "m.mp4", "width,height,nb_read_frames")
        self.assertEqual(int(width), 500)
        self.assertEqual(int(height) % 2, 0)
        # Four surfaces 1 ms apart are shown for 1 s each; ffmpeg repeats them at 2 frames per second, and the
        # last one may be shown once.
        self.assertIn(int(frames), (7, 8))
        self.assertIn(int(facts(self.folder / "m.gif", "nb_read_frames")[0]), (7, 8))
        self.assertEqual([path.name for path in self.folder.glob(".m*")], [])

    @pytest.mark.extended
    def test_another_encoder_replaces_a_missing_one_and_the_gif_needs_none(self):
        case = self.case("-S", "record.snapshots_ms=[3, 4]")
        wrapper = self.folder / "bin" / "ffmpeg"
        wrapper.parent.mkdir()
        for hidden, written in ((" libx264 ", ["a.gif", "a.mp4"]), (" libx264 \\| libopenh264 \\| mpeg4 ", ["b.gif"])):
            wrapper.write_text(f"""#!/bin/sh
case "$*" in
    *-encoders) {shutil.which("ffmpeg")} "$@" | grep -v "{hidden}" ;;
    *) exec {shutil.which("ffmpeg")} "$@" ;;
esac
""", encoding="utf-8")
            wrapper.chmod(0o755)
            done = self.call(*command("movie", case, "--out", written[0][0], "--width", "320"),
                             variables={"PATH": f"{wrapper.parent}:{os.environ['PATH']}"})
            self.assertEqual(sorted(path.name for path in self.folder.glob(f"{written[0][0]}.*")), written)
            self.assertEqual("no MP4 is written" in done.stdout, len(written) == 1)

    def test_a_case_with_one_surface_is_rejected(self):
        case = self.case("-S", "record.snapshots_ms=[4]")
        self.contains(self.shearwake("movie", case, expect=6).output, "fewer than two surfaces", "record.frames = true",
                      "the movie was not written (exit 6)")

    @pytest.mark.extended
    def test_a_file_that_is_not_a_case_file_is_rejected(self):
        (self.folder / "no.h5").write_text("nothing", encoding="utf-8")
        self.contains(self.shearwake("movie", "no.h5", expect=6).output, "no.h5 is not a valid case file")
        self.contains(self.shearwake("movie", "none.h5", expect=6).output, "none.h5: no such case file; run the job first")

    @pytest.mark.extended
    def test_a_folder_in_place_of_a_case_names_a_case_file(self):
        case = self.case("-S", "record.snapshots_ms=[4]", "--quiet")
        output = self.shearwake("movie", self.out, expect=6).output
        self.contains(output, f"{self.out} is a folder; give one of its case files", str(case.parent))
        (self.folder / "empty").mkdir()
        self.contains(self.shearwake("movie", "empty", expect=6).output, "empty is a folder without case files")

    @pytest.mark.extended
    def test_the_case_the_part_and_the_stored_warning_are_stated(self):
        self.write_job()
        self.shearwake("run", "job.toml", "-S", "record.frames=false", "-S", "time.duration_ms=20", "-S",
                       "record.snapshots_ms=[18, 20]", "--quiet")
        case = next(path for path in case_files(self.out) if setting_of(path) == 500)
        output = self.shearwake("movie", case, "--out", "m", "--width", "320").output
        self.contains(output, "movie: AM frequency 500\u00a0Hz", "movie: not valid: waves of", "2 of 2 frames, 18 to 20 ms; shown: ",
                      "movie: m.mp4")

    @pytest.mark.extended
    def test_progress_is_a_bar_on_a_terminal(self):
        case = self.case("-S", "record.snapshots_ms=[1, 2, 3, 4]", "--quiet")
        main, other = pty.openpty()
        done = subprocess.Popen(command("movie", case, "--out", "m", "--width", "320"), cwd=self.folder, env=environment(),
                                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=other)
        os.close(other)
        shown = b""
        with os.fdopen(main, "rb", buffering=0) as terminal, contextlib.suppress(OSError):  # EIO: the program has ended
            while part := terminal.read(4096):
                shown += part
        self.assertEqual(done.wait(), 0)
        self.contains(shown.decode(), "movie: [#####...............] frame 1 of 4", "[####################] frame 4 of 4", "encoding")
