# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of a case as the program writes them: TOML with one table after another, most of which are equal in many cases."""
from __future__ import annotations

import functools
import re
import tomllib
from typing import Any

HEADER = re.compile(r"(\[{0,2})([\w.]*)\]{0,2}")


def sections(text: str) -> list[str]:
    """The text of each table, which begins with its header."""
    return re.split(r"\n(?=\[)", text)


def name_of(section: str) -> str:
    """"load.modulation" for the header [load.modulation] or [[load.modulation]]; empty before the first header."""
    return HEADER.match(section)[2]  # type: ignore[index]  # matches any text


@functools.lru_cache(4096)
def _entries(section: str) -> dict[str, Any]:
    """The entries of a table, without the tables within it."""
    node: Any = tomllib.loads(section)
    for part in filter(None, name_of(section).split(".")):
        node = node[part][0] if isinstance(node[part], list) else node[part]
    return node


def nested_tables(text: str) -> dict[str, Any]:
    """All tables. Lists of numbers are shared with other cases, so that callers must not change them. Raises
    tomllib.TOMLDecodeError if the text is damaged."""
    found: dict[str, Any] = {}
    for section in sections(text):
        node: Any = found
        *path, last = name_of(section).split(".")
        for part in path:
            node = node.setdefault(part, {})
            node = node[-1] if isinstance(node, list) else node
        if section.startswith("[["):
            node.setdefault(last, []).append(dict(_entries(section)))
        else:
            (node.setdefault(last, {}) if last else node).update(_entries(section))
    return found
