# SPDX-License-Identifier: BSD-3-Clause
"""Movies of cases."""
import shutil
import subprocess
import unittest

from program import ProgramTest


def facts(path, entries):
    """Properties of the first stream of a movie, as ffprobe prints them."""
    done = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", f"stream={entries}", "-of",
                           "csv=p=0", str(path)], capture_output=True, text=True, check=True)
    return done.stdout.strip().split(",")


@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is missing: scripts/setup installs it")
class Movie(ProgramTest):
    def case(self, *options):
        self.write_job()
        self.shearwake("run", "job.toml", "-S", "record.frames=false", *options)
        return next((self.out / "cases").glob("*.h5"))

    def test_a_case_with_frames_becomes_an_mp4_and_a_gif(self):
        case = self.case("-S", "record.snapshots_ms=[1, 2, 3, 4]")
        said = self.shearwake("movie", case, "--out", "m", "--slow-down", "1000", "--width", "320").said
        self.says(said, "movie: m.mp4", "movie: m.gif")
        width, height, frames = facts(self.folder / "m.mp4", "width,height,nb_read_frames")
        self.assertEqual(int(width), 320)
        self.assertEqual(int(height) % 2, 0)
        # Four surfaces 1 ms apart are shown for 1 s each; ffmpeg repeats them at 2 frames per second, and the
        # last one may be shown once.
        self.assertIn(int(frames), (7, 8))
        self.assertIn(int(facts(self.folder / "m.gif", "nb_read_frames")[0]), (7, 8))
        self.assertEqual([path.name for path in self.folder.glob(".m*")], [])

    def test_a_case_with_one_surface_is_rejected(self):
        case = self.case("-S", "record.snapshots_ms=[4]")
        self.says(self.shearwake("movie", case, expect=6).said, "fewer than two surfaces", "record.frames = true",
                  "the movie was not written (exit 6)")

    def test_a_file_that_is_no_case_is_rejected(self):
        (self.folder / "no.h5").write_text("nothing", encoding="utf-8")
        self.says(self.shearwake("movie", "no.h5", expect=6).said, "no.h5 is not a valid case file")


if __name__ == "__main__":
    unittest.main()
