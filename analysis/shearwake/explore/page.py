# SPDX-License-Identifier: BSD-3-Clause
"""Puts the page together: one HTML document that loads nothing else."""
import base64
import hashlib
import json
from pathlib import Path

from .. import program
from ..keys import LABELS, label
from ..script_json import script_json

HERE = Path(__file__).resolve().parent
UPLOT = HERE.parent / "report" / "page" / "uplot"
SCRIPTS = ("presets.js", "settings.js", "source.js", "surface.js", "overlay.js", "plots.js", "controls.js", "drawing.js",
           "pins.js", "saving.js", "sweeps.js", "compare.js", "tour.js", "main.js")


Limits = tuple[float | None, float | None]


def ranges(schema: dict) -> dict[str, dict[str, Limits]]:
    """The limits of each number in the schema of jobs, by its key and the alternative that it belongs to: an array and a lens
    both have a distance. Keys of all alternatives have the alternative ""."""
    found: dict[str, dict[str, Limits]] = {}

    def visit(node: dict, key: str, alternative: str = "") -> None:
        if "$ref" in node:
            return visit(schema["$defs"][node["$ref"].rpartition("/")[2]], key)
        for name, below in node.get("properties", {}).items():
            if below:  # false: a key of other alternatives
                visit(below, f"{key}.{name}".lstrip("."), alternative)
        for part in node.get("allOf", []):
            chosen = [selected["const"] for selected in part.get("if", {}).get("properties", {}).values() if "const" in selected]
            visit(part.get("then", {}), key, *chosen)
        if "items" in node:
            visit(node["items"], key, alternative)
        if node.get("type") in ("number", "integer"):
            found.setdefault(key, {})[alternative] = (node.get("minimum", node.get("exclusiveMinimum")),
                                                      node.get("maximum", node.get("exclusiveMaximum")))
        return None

    visit(schema, "")
    return found


def keys_of() -> dict[str, dict]:
    """The presets of media, the classes of receptors and the limits of keys, from the schema that the program prints."""
    schema = json.loads(program.call(["schema"]).stdout)
    tables = {name: table["properties"] for name, table in schema["properties"].items() if "properties" in table}
    return {"presets": tables["medium"]["preset"]["x-presets"], "receptors": tables["afferents"]["classes"]["x-classes"],
            "ranges": (limits := ranges(schema)), "labels": {name: label(name) for name in (*limits, *LABELS)}}


def first_job() -> str:
    """The job of the settings with which the page begins."""
    return read(HERE / "page" / "first.toml")


def read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def script(text: str) -> str:
    return f"<script>{text}</script>"


def sources(configuration: dict) -> list[str]:
    """The scripts in order: the configuration, the plotting library and those of the page."""
    return [f"const CONFIGURATION = {script_json(configuration)};", read(UPLOT / "uPlot.iife.min.js"), *(read(HERE / "page" / s) for s in SCRIPTS)]


def document(configuration: dict) -> tuple[str, str]:
    """The page and the policy that allows its own scripts only."""
    scripts = sources(configuration)
    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in scripts)
    text = read(HERE / "page" / "page.html")
    for mark, part in (("STYLE", read(UPLOT / "uPlot.min.css") + read(HERE / "page" / "page.css")),
                       ("SCRIPTS", "".join(script(s) for s in scripts))):
        text = text.replace(f"<!--{mark}-->", part)
    policy = (f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'; "
              "base-uri 'none'; form-action 'none'; frame-ancestors 'none'")
    return text, policy
