# SPDX-License-Identifier: BSD-3-Clause
"""Studies that ask the program for cases: `converge` estimates numerical errors, `fit` estimates the keys of [uncertain] of a job from a
measured scan, and `optimise` finds the best modulation of a job with [optimise]; these two need SciPy. The commands of these names use
the same functions."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .convergence import converge
    from .fitting import fit
    from .optimising import optimise

MODULES = {"converge": "convergence", "fit": "fitting", "optimise": "optimising"}
__all__ = ["converge", "fit", "optimise"]


def __getattr__(name: str) -> Any:
    """Imports a study when it is needed, since not all need SciPy."""
    if name not in MODULES:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    import importlib
    return getattr(importlib.import_module(f".{MODULES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
