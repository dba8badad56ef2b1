# SPDX-License-Identifier: BSD-3-Clause
"""The small size of the tests, which scripts/test runs, contains every command once."""
import ast
import os
import re
import subprocess
import sys

from program import ROOT


def small_tests():
    """The source of the test files without the tests that only --all or --long run, and that of their helpers."""
    for path in ROOT.glob("tests/*/*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in [node for node in ast.walk(tree) if isinstance(node, (ast.Module, ast.ClassDef))]:
            node.body = [part for part in node.body if not any(
                mark in ast.unparse(decorator) for decorator in getattr(part, "decorator_list", ())
                for mark in ("mark.long", "mark.extended"))]
        text = ast.unparse(tree)
        if "pytestmark = pytest.mark.extended" not in text and ("def test_" in text or not path.name.startswith("test_")):
            yield text


def test_the_small_size_has_every_command():
    declared = (ROOT / "src" / "app" / "commands" / "commands.hpp").read_text(encoding="utf-8")
    commands = re.findall(r"^    command\((\w+),", declared, re.MULTILINE)
    assert {"run", "reduce", "serve"} <= set(commands)
    tests = "\n".join(small_tests())
    assert [command for command in commands if f"'{command}'" not in tests] == []


def test_marks_choose_the_tests_of_a_size(tmp_path):
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "test_marks.py").write_text("import pytest\ndef test_small(): pass\n" + "".join(
        f"@pytest.mark.{mark}\ndef test_{mark}(): pass\n" for mark in ("extended", "long")), encoding="utf-8")
    rest = {name: value for name, value in os.environ.items() if not name.startswith("SHEARWAKE_")}
    for size, passed in (({"SHEARWAKE_SMALL": "1"}, 1), ({}, 2), ({"SHEARWAKE_LONG": "1"}, 3)):
        output = subprocess.run([sys.executable, "-m", "pytest", "-q", "-W", "ignore", tmp_path], capture_output=True, text=True,
                                env={**rest, **size}, check=True).stdout
        assert f"{passed} passed" in output
