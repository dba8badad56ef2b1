"""What scripts/submit refuses and writes, without a Slurm."""
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "end_to_end"))

from program import PROGRAM, ROOT, ProgramTest, environment  # noqa: E402


class Submit(ProgramTest):
    def submit(self, *words, program=PROGRAM, expect=0):
        self.write_job()
        done = subprocess.run([ROOT / "scripts" / "submit", "job.toml", "--dry-run", *words], cwd=self.folder,
                              env={**environment(), "SHEARWAKE": str(program)}, capture_output=True,
                              encoding="utf-8", check=False)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_times_that_leave_nothing_to_compute_in_are_refused(self):
        for words in (["--warning", "0"], ["--warning", "-5"], ["--time", "0"], ["--time", "0:00"],
                      ["--time", "1-"], ["--time", "4", "--warning", "120"],
                      ["--time", "1:30", "--warning", "45"]):
            with self.subTest(words=words):
                said = self.submit(*words, expect=2)
                self.assertRegex(said, "--(time|warning) wants")
        self.assertFalse(self.out.exists())
        for words in (["--time", "1-0"], ["--time", "0-1:30"], ["--time", "4:01", "--warning", "120"]):
            self.submit(*words)

    def test_without_a_program_it_says_so_in_a_line(self):
        said = self.submit(program=self.folder / "nowhere" / "shearwake", expect=6)
        self.assertEqual(len(said.splitlines()), 1, said)
        self.says(said, "there is no program", "SHEARWAKE")

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


if __name__ == "__main__":
    unittest.main()
