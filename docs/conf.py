# SPDX-License-Identifier: BSD-3-Clause
"""Configuration of the documentation site; scripts/docs builds it."""
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

_ROOT = Path(__file__).resolve().parent.parent
_PROGRAM = os.path.abspath(os.environ.get("SHEARWAKE", _ROOT / "build" / "shearwake"))
_DOCUMENTS = _ROOT / "docs" / "reference" / "json-output.schema.json"
_package = (_ROOT / "analysis" / "shearwake" / "__init__.py").read_text(encoding="utf-8")

project = "shearwake"
author = "the shearwake authors"
copyright = author  # the name is fixed by Sphinx
release = re.search(r'^__version__ = "(.*)"', _package, flags=re.MULTILINE)[1]
version = release

_NOTEBOOKS = sorted((_ROOT / "docs" / "notebooks").glob("*.ipynb"))
_executes = all(importlib.util.find_spec(name) for name in ("nbconvert", "ipykernel"))  # without them the site links the files

sys.path.insert(0, str(_ROOT / "analysis"))
extensions = ["myst_parser", "sphinx.ext.autodoc"]
autodoc_member_order = "bysource"
default_role = "code"  # of `names` in docstrings
exclude_patterns = ["_build"]
myst_heading_anchors = 4
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]  # types in signatures, of which most belong to other packages

html_theme = "sphinx_rtd_theme"
html_title = f"shearwake {release}"
html_static_path = ["site"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False


def _printed(*arguments):
    return subprocess.run(["shearwake", *arguments], executable=_PROGRAM, stdin=subprocess.DEVNULL, check=True,
                          capture_output=True, encoding="utf-8").stdout


def _help(command):
    """The usage and the options of a command in lines that fit on a page, as a block."""
    lines = [line for line in _printed("help", command).splitlines()[1:]
             if "-h,--help" not in line and not line.startswith("shearwake --help")]
    text = "\n".join(textwrap.fill(line, 84, subsequent_indent=30 * " ") for line in lines)
    return f"\n```text\n{text.strip().removesuffix('Options:').strip()}\n```\n"


def _exit_codes():
    """The exit codes that the program lists, as a table."""
    codes = re.findall(r"^  (\d+) +(.*)$", _printed("--help").partition("Exit codes:\n")[2], flags=re.MULTILINE)
    return "| code | meaning |\n|---|---|\n" + "".join(f"| {code} | {meaning} |\n" for code, meaning in codes)


def _members(properties, prefix=""):
    """The rows of the table of a JSON document. Members of lists that have descriptions have rows of their own."""
    for name, value in properties.items():
        items = value.get("items", {}).get("properties", {})
        described = any("description" in item for item in items.values())
        names = "" if described or not items else " (" + ", ".join(f"`{item}`" for item in items) + ")"
        if "description" in value:
            yield f"| `{prefix}{name}` | {value['description']}{names} |\n"
        if described:
            yield from _members(items, f"{name}[].")


def _documents():
    schema = json.loads(_DOCUMENTS.read_text(encoding="utf-8"))
    for name, document in schema["$defs"].items():
        if "command" in document.get("properties", {}):
            yield f"\n## `{name}`\n\n| member | meaning |\n|---|---|\n" + "".join(_members(document["properties"]))


def _thumbnails(gallery):
    """The first picture of each section of the gallery, as a link to the section."""
    sections = re.findall(r"^### (.*?)\n(.*?)(?=^##|\Z)", gallery, flags=re.MULTILINE | re.DOTALL)
    for heading, text in sections:
        picture = re.search(r"!\[(.*)\]\((gallery/.*)\)", text)
        anchor = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        if picture:
            yield f"[![{picture[1]}]({picture[2]}) {heading.split(',')[0]}](#{anchor})\n"


def _executed(app):
    """The notebooks with the outputs of their cells, as pages of the site. An error in a cell is an error."""
    if not _executes:
        print("nbconvert or ipykernel is missing: the site contains the notebooks without outputs", file=sys.stderr)
        return
    from nbconvert import HTMLExporter
    from traitlets.config import Config
    os.environ.update(PYTHONPATH=str(_ROOT / "analysis"), PYDEVD_DISABLE_FILE_VALIDATION="1")
    exporter = HTMLExporter(template_name="basic", exclude_anchor_links=True, config=Config({
        "ExecutePreprocessor": {"enabled": True, "timeout": None}}))
    for path in _NOTEBOOKS:
        with tempfile.TemporaryDirectory() as folder, open(path, encoding="utf-8") as file:
            body, _ = exporter.from_file(file, resources={"metadata": {"path": folder}})
        title = re.search("<h1[^>]*>(.*?)</h1>", body)[1]
        yield f"notebooks/{path.stem}", {"title": title, "body": f'<div class="notebook">{body}</div>'}, "page.html"


def _linked(text):
    """Links to the executed notebooks instead of to their files."""
    return re.sub(r"\[([^]]*)\]\(((?:\.\./)?notebooks/[\w-]+)\.ipynb\)", r'<a href="\2.html">\1</a>', text) if _executes else text


def _add_generated(app, page, source):
    """Adds the keys of a job, the columns of tables, the help of each command below its heading, the exit codes, the members of the
    JSON documents, thumbnails to the gallery, and links to executed notebooks."""
    source[0] = _linked(source[0])
    if page.removeprefix("reference/") in ("keys", "presets", "table-columns", "commands", "exit-codes", "json-output"):
        app.env.note_dependency(str(_DOCUMENTS if page == "reference/json-output" else _PROGRAM))
    if page == "reference/keys":
        source[0] = _printed("keys")
    elif page == "reference/presets":
        source[0] += f"\n```toml\n{_printed('presets')}```\n"
    elif page == "reference/table-columns":
        source[0] += "\n" + _printed("columns")
    elif page == "reference/exit-codes":
        source[0] = source[0].replace("\n## Details", f"\n{_exit_codes()}\n## Details", 1)
    elif page == "reference/commands":
        source[0] = re.sub(r"^## `(\w+)`\n", lambda heading: heading[0] + _help(heading[1]), source[0],
                           flags=re.MULTILINE)
    elif page == "reference/json-output":
        source[0] += "".join(_documents())
    elif page == "gallery":
        block = "```{container} thumbnails\n" + "\n".join(_thumbnails(source[0])) + "```\n\n"
        source[0] = source[0].replace("## First steps", block + "## First steps", 1)


def setup(app):
    app.connect("source-read", _add_generated)
    app.connect("html-collect-pages", _executed)
