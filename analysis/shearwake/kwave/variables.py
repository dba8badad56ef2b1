# SPDX-License-Identifier: BSD-3-Clause
"""Which variables of a file are read, and names that may be misspelt."""
from __future__ import annotations

import difflib
from pathlib import Path
from typing import Iterable

from .structures import BadInput

NAMES = ("kgrid", "medium", "source", "sensor", "options")
ARGUMENTS = "input_args"  # usual in scripts: pstdElastic3D(kgrid, medium, source, sensor, input_args{:})
OTHERS = {"args": "options", "opts": "options", "option": "options", "input_options": "options", "inputs": "options",
          "settings": "options", "varargin": "options", "grid": "kgrid", "src": "source", "sources": "source",
          "detector": "sensor", "detectors": "sensor", "receiver": "sensor", "receivers": "sensor"}
SHOWN = 8  # names of other variables in a note


def intended(name: str) -> str | None:
    """The structure that a variable is probably meant to be, or None."""
    small = name.lower()
    if small in NAMES:
        return small
    near = difflib.get_close_matches(small, NAMES, n=1, cutoff=0.75)
    return OTHERS.get(small) or (near[0] if near else None)


def chosen_variables(path: Path, variables: Iterable[str]) -> tuple[dict[str, str], list[str]]:
    """The variable of each structure that the file contains, and notes about others. Raises BadInput if a missing
    structure seems to have another name."""
    chosen = {name: name for name in NAMES if name in variables}
    notes = []
    if ARGUMENTS in variables and "options" not in chosen:
        chosen["options"] = ARGUMENTS
        notes.append(f"the variable {ARGUMENTS} is read as options")
    others = sorted(set(variables) - set(chosen.values()))
    for name in others:
        meant = intended(name)
        if meant and meant not in chosen:
            raise BadInput(f"{path} has a variable {name} but none named {meant}; did you mean {meant}? Rename it with "
                           f"{meant} = {name}")
    if others:
        more = f" and {len(others) - SHOWN} more" if len(others) > SHOWN else ""
        notes.append(f"not read: {', '.join(others[:SHOWN])}{more} (the variables that are read are {', '.join(NAMES)})")
    return chosen, notes
