# SPDX-License-Identifier: BSD-3-Clause
"""The reference of commands lists every command and every option of the program."""
import re
import subprocess
import unittest

from program import ROOT, ProgramTest

PAGE = ROOT / "docs" / "reference" / "commands.md"
OF_A_JOB = "Arguments of a job"  # described once for the commands that take a job


def sections():
    """Text below each heading of the second level, by heading without its backquotes."""
    parts = re.split(r"^## (.*)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {heading.replace("`", ""): text for heading, text in zip(parts[1::2], parts[2::2])}


class ExitCodesPage(ProgramTest):
    def test_the_loop_of_the_example_ends_when_the_study_is_complete_or_stopped(self):
        page = (ROOT / "docs" / "reference" / "exit-codes.md").read_text(encoding="utf-8")
        lines = re.search(r"```console\n(.*?)```", page, flags=re.DOTALL).group(1)
        script = "".join(line.removeprefix("$ ") + "\n" for line in lines.splitlines())
        (self.folder / "mpirun").write_text("#!/bin/sh\necho run >> runs\nset -- $(cat codes)\necho $2 $3 > codes\nexit $1\n")
        (self.folder / "sleep").write_text("#!/bin/sh\n")
        for name in ("mpirun", "sleep"):
            (self.folder / name).chmod(0o755)
        (self.folder / "out" / "quickstart").mkdir(parents=True)
        for codes, stop, runs in (("0", False, 1), ("75 75 0", False, 3), ("75 4 0", False, 2), ("75 75 75", True, 1)):
            with self.subTest(codes=codes, stop=stop):
                (self.folder / "codes").write_text(codes)
                (self.folder / "runs").write_text("")
                if stop:
                    (self.folder / "out" / "quickstart" / "STOP").touch()
                subprocess.run(["sh", "-c", script], cwd=self.folder, env={"PATH": f"{self.folder}:/usr/bin:/bin"}, check=False,
                               timeout=60)
                self.assertEqual((self.folder / "runs").read_text().count("run"), runs)


class CommandsPage(ProgramTest):
    def test_every_command_and_option_is_described(self):
        described = sections()
        top = PAGE.read_text(encoding="utf-8").partition("\n## ")[0]
        page = self.shearwake("help").stdout
        commands = re.findall(r"^  ([a-z]+)  +\S", page[page.index("Subcommands:"):], flags=re.MULTILINE)
        self.assertGreater(len(commands), 10)
        for command in commands:
            with self.subTest(command=command):
                text = "".join(body for heading, body in described.items()
                               if command in re.findall(r"[a-z]+", heading))
                self.assertTrue(text)
                self.assertIn(f"`{command}`", top, "the first table lists every command")
                usage = self.shearwake("help", command).stdout
                options = set(re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", usage.split("A first sweep")[0]))
                if re.search(r"^  JOB\b", usage, flags=re.MULTILINE):
                    text += described[OF_A_JOB]
                for option in options - {"-h", "--help"}:
                    self.assertIn(f"`{option}", text.replace(", `", ",`"))


if __name__ == "__main__":
    unittest.main()
