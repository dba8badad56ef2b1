"""What a user gets wrong: the message says where, what and what instead; the exit code says whose."""
import random
import time
import unittest

from program import JOB, SWEEP, ProgramTest, changed

VERBS = ["check", "plan", "run", "status", "reduce", "report", "show", "bench"]


class JobMistakes(ProgramTest):
    def refused(self, text, *words):
        self.write_job(text)
        for verb in ("check", "run"):
            done = self.shearwake(verb, "job.toml", expect=3)
            self.says(done.said, *words)
            self.assertNotIn("internal error", done.said)
            self.assertFalse(self.out.exists(), "something was made of a bad job")
        return done.said

    def place(self, text, piece):
        """file:line of a piece of the job."""
        return f"job.toml:{text[:text.index(piece)].count(chr(10)) + 1}:"

    def test_a_typo_in_a_key(self):
        text = changed(("am_frequency_Hz = 500.0", "am_frequncy_Hz = 500.0"))
        said = self.refused(text, self.place(text, "am_frequncy_Hz"), "am_frequncy_Hz",
                            "did you mean", "am_frequency_Hz")
        self.assertRegex(said, r"job\.toml:\d+:\d+: ")

    def test_a_wrong_unit(self):
        text = changed(("thickness_mm = 20.0", "thickness_cm = 2.0"))
        self.refused(text, self.place(text, "thickness_cm"), "thickness_cm", "thickness_mm")

    def test_a_negative_thickness(self):
        text = changed(("thickness_mm = 20.0", "thickness_mm = -20.0"))
        self.refused(text, self.place(text, "thickness_mm"), "thickness_mm", "-20")

    def test_an_empty_axis(self):
        text = changed((SWEEP, '"load.modulation.am_frequency_Hz" = []'))
        self.refused(text, self.place(text, '"load.modulation.am_f'), "am_frequency_Hz", "no values")

    def test_two_axes_on_one_key(self):
        text = changed((SWEEP, f'{SWEEP}\nzip = [ {{ "load.modulation.am_frequency_Hz" = [1, 2], '
                               '"load.peak_Pa" = [1, 2] } ]'))
        self.refused(text, "load.modulation.am_frequency_Hz")

    def test_an_unknown_modulation(self):
        text = changed(('kind = "AM-STM"', 'kind = "AM-SMT"'))
        self.refused(text, self.place(text, "AM-SMT"), "AM-SMT", "did you mean", "AM-STM")

    def test_a_path_that_leaves_the_domain(self):
        text = changed(("to_mm = [14.0, 0.0]", "to_mm = [140.0, 0.0]"), ("from_mm = [-14.0", "from_mm = [20.0"),
                       ("duration_ms = 4.0", "duration_ms = 6.0"))
        self.refused(text, "leaves the domain", "domain.extent_mm")

    def test_all_mistakes_at_once(self):
        text = changed(("peak_Pa = 100.0", "peek_Pa = 100.0"), ("c_p_m_s = 1500.0", 'c_p_m_s = "fast"'),
                       ('engine = "layered"', 'engine = "layer"'))
        self.refused(text, "peek_Pa", "c_p_m_s", "layer")

    def test_no_toml_at_all(self):
        for text in ("", "schema = 1", "{", "\x00\x01", "schema = 1\nschema = 1", "[[[", "a" * 100000):
            with self.subTest(text[:20]):
                self.write_job(text)
                self.says(self.shearwake("check", "job.toml", expect=3).said, "job.toml")

    def test_noise(self):
        path = self.folder / "noise.toml"
        path.write_bytes(random.Random(1).randbytes(10_000_000))
        began = time.monotonic()
        said = self.shearwake("run", path, expect=3).said
        self.assertLess(time.monotonic() - began, 5.0)
        self.assertLess(len(said.encode()), 2000)
        small = self.folder / "small.toml"
        small.write_bytes(random.Random(2).randbytes(100_000))
        self.assertLess(len(self.shearwake("run", small, expect=3).said.encode()), 2000)

    def test_a_missing_job(self):
        self.says(self.shearwake("run", "nowhere.toml", expect=6).said, "nowhere.toml",
                  "No such file or directory")
        self.says(self.shearwake("run", self.folder, expect=6).said, "Is a directory")


class CommandLine(ProgramTest):
    def test_help(self):
        said = self.shearwake("--help").stdout
        self.says(said, *VERBS, "Exit codes")
        for verb in VERBS:
            with self.subTest(verb):
                self.says(self.shearwake(verb, "--help").stdout, "Usage")

    def test_version(self):
        said = self.shearwake("--version").stdout
        self.says(said, "shearwake", "git", "g++", "MPI", "FFTW", "HDF5")
        self.assertEqual(self.shearwake("--version", ranks=2).stdout.count("HDF5"), 1)

    def test_what_is_unknown(self):
        self.write_job(JOB)
        for words in ([], ["fly"], ["run"], ["run", "job.toml", "--fast"], ["run", "job.toml", "other"],
                      ["plan", "job.toml", "-n", "none"], ["plan", "job.toml", "-n", "0"],
                      ["run", "job.toml", "--ranks-per-case", "-1"], ["bench", "magic"]):
            with self.subTest(words):
                said = self.shearwake(*words, expect=2).said
                self.assertNotEqual(said, "")
                self.assertFalse(self.out.exists())
        self.assertEqual(self.shearwake("fly", ranks=2, expect=2).said.count("fly"), 1)


if __name__ == "__main__":
    unittest.main()
