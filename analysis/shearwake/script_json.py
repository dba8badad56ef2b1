# SPDX-License-Identifier: BSD-3-Clause
"""JSON within the scripts of pages."""
import json
from typing import Any


def script_json(data: Any) -> str:
    """Compact JSON, also of NumPy arrays, for a script element of an HTML page: no text in it can end the element or begin a comment."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False, default=lambda value: value.tolist()).replace("<", "\\u003c")
