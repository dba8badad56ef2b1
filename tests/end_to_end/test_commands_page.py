# SPDX-License-Identifier: BSD-3-Clause
"""The reference of commands lists every command and every option of the program."""
import re
import unittest

from program import ROOT, ProgramTest

PAGE = ROOT / "docs" / "reference" / "commands.md"
OF_A_JOB = "Arguments of a job"  # described once for the commands that take a job


def sections():
    """Text below each heading of the second level, by heading without its backquotes."""
    parts = re.split(r"^## (.*)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {heading.replace("`", ""): text for heading, text in zip(parts[1::2], parts[2::2])}


class CommandsPage(ProgramTest):
    def test_every_command_and_option_is_described(self):
        described = sections()
        page = self.shearwake("help").stdout
        commands = re.findall(r"^  ([a-z]+)  +\S", page[page.index("Subcommands:"):], flags=re.MULTILINE)
        self.assertGreater(len(commands), 10)
        for command in commands:
            with self.subTest(command=command):
                text = "".join(body for heading, body in described.items()
                               if command in re.findall(r"[a-z]+", heading))
                self.assertTrue(text)
                usage = self.shearwake("help", command).stdout
                options = set(re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", usage.split("A first sweep")[0]))
                if re.search(r"^  JOB\b", usage, flags=re.MULTILINE):
                    text += described[OF_A_JOB]
                for option in options - {"-h", "--help"}:
                    self.assertIn(f"`{option}", text.replace(", `", ",`"))


if __name__ == "__main__":
    unittest.main()
