# SPDX-License-Identifier: BSD-3-Clause
"""The exceptions of the package. Those of the program contain the text that the program printed."""
from __future__ import annotations

import difflib
import sys
import warnings
from dataclasses import dataclass, replace
from typing import Sequence


class ShearwakeError(Exception):
    """Base class of all exceptions of this package, apart from `Damaged`, which is a ValueError."""


class NotAnOutputFolder(ShearwakeError):
    """The folder was not written by `shearwake run`, or its plan is damaged."""


class NotRecorded(ShearwakeError):
    """The case has no complete file, or its file does not contain the requested data."""


class AxesDiffer(ShearwakeError):
    """The cases of a dataset have different axes, for example numbers of afferents."""


class NotValid(UserWarning):
    """A warning: readings that were requested are not valid. `Case.warnings` states why."""


# How a job records what a case does not contain.
HOW = {
    "surface": "set record.snapshots_ms or record.frames in the job", "traces": "set record.traces_mm in the job",
    "volume": "set record.volumes_ms in the job", "afferents": "add [afferents] to the job",
    "mean": "no whole period fits between measure.settled_after_ms and the end of the run",
    "sensation": "set measure.sensation in the job",
}


class GridsDiffer(UserWarning):
    """A warning: the grids of the cases in a dataset differ. Its axes contain the values of all of them, and values that a case does
    not have are NaN."""


def suggestion(name: str, known: list[str]) -> str:
    """The continuation of a sentence about a name that is not known."""
    near = difflib.get_close_matches(name, known, 1)
    return f"; did you mean {near[0]}?" if near else f"; there are {', '.join(known)}" if known else ""


def level_of_caller() -> int:
    """The `stacklevel` with which warnings.warn() names the line outside of this package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and frame.f_globals["__name__"].partition(".")[0] in (__package__, "functools"):  # of cached_property
        level, frame = level + 1, frame.f_back
    return level


def warn_of_invalid(warnings_of: Sequence[list[dict[str, str]]], what: str, stacklevel: int) -> None:
    """Warns with NotValid, at a caller of this function, if some of the cases with these warnings are not valid."""
    reasons = dict.fromkeys(w["message"] for found in warnings_of for w in found if w["severity"] == "error")
    more = f" ({len(reasons) - 1} more in `warnings` of the cases)" if len(reasons) > 1 else ""
    if reasons:
        warnings.warn(f"{what} not valid: {next(iter(reasons))}{more}", NotValid, stacklevel=stacklevel)


class ProgramNotFound(ShearwakeError):
    """The program `shearwake` is neither installed nor built. Reading results does not need it."""


@dataclass(frozen=True)
class Diagnostic:
    """An error or a warning of `check`. `line` and `column` count from 1; 0: no particular place."""

    severity: str
    file: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        return f"{place}: {self.severity}: {self.message}"


class ProgramError(ShearwakeError):
    """The program ended with an error. The text is that of the program; `exit_code` is documented in
    docs/reference/exit-codes.md."""

    def __init__(self, text: str, exit_code: int, diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(text)
        self.exit_code = exit_code
        self.diagnostics = list(diagnostics)

    def renamed(self, file: str, name: str) -> ProgramError:
        """This error with another name of a file."""
        self.args = (str(self).replace(file, name),)
        self.diagnostics = [replace(d, file=d.file.replace(file, name)) for d in self.diagnostics]
        return self


class UsageError(ProgramError):
    """An argument is wrong, or a folder does not fit the job (exit code 2)."""


class JobError(ProgramError):
    """The job has errors, or a case needs more memory or disk than the machine has (exit code 3). `diagnostics` lists the
    errors and warnings with their lines."""


class CasesFailed(ProgramError):
    """Some cases failed or are damaged (exit code 4). `sweep` is the output folder; its other cases are complete."""

    sweep: object = None


class EnvironmentFailed(ProgramError):
    """A file or the machine caused the failure, for example a full disk (exit code 6)."""


class Stopped(ProgramError):
    """The run was stopped early (exit code 75); running it again resumes it."""


BY_EXIT_CODE: dict[int, type[ProgramError]] = {2: UsageError, 3: JobError, 4: CasesFailed, 6: EnvironmentFailed, 75: Stopped}
