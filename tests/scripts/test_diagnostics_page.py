# SPDX-License-Identifier: BSD-3-Clause
"""The index of errors and warnings quotes messages as the program prints them."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "docs" / "reference" / "diagnostics.md"
LITERAL = re.compile(r'"(?:[^"\\\n]|\\.)*"')
JOINED = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*f?"(?:[^"\\\n]|\\.)*")*')
SHORTEST = 6  # a shorter piece between two placeholders could be part of anything


def messages():
    """All string literals of the program and its scripts; what is inserted into them stands as NUL."""
    sources = [*ROOT.glob("src/**/*.?pp"), *ROOT.glob("scripts/**/*.py"), *ROOT.glob("analysis/**/*.py")]
    texts = []
    for source in sources:
        for joined in JOINED.findall(source.read_text(encoding="utf-8")):
            text = "".join(part[1:-1] for part in LITERAL.findall(joined)).replace('\\"', '"')
            texts.append(re.sub(r"\{[^{}]*\}", "\0", text).replace("{{", "{").replace("}}", "}"))
    return "\n".join(texts)


def pieces():
    """What the first column of a table on the page quotes, split at its placeholders."""
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith("| `"):
            for quoted in re.findall(r"`([^`]+)`", line.split(" | ")[0]):
                for piece in quoted.split("..."):
                    if len(piece.strip(" ;:,()")) >= SHORTEST:
                        yield quoted, piece.strip(" ;:,()")


class DiagnosticsPage(unittest.TestCase):
    def test_every_quoted_message_is_one_that_the_program_prints(self):
        known = messages()
        outdated = sorted({f"{quoted}   (no source contains: {piece})"
                           for quoted, piece in pieces() if piece not in known})
        self.assertEqual(outdated, [], f"in {PAGE}:\n" + "\n".join(outdated))

    # So that a change of the page's layout cannot empty the test above.
    def test_more_than_two_hundred_patterns_are_found(self):
        self.assertGreater(len({quoted for quoted, _ in pieces()}), 200)


if __name__ == "__main__":
    unittest.main()
