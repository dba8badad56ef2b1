# SPDX-License-Identifier: BSD-3-Clause
"""Opens and computes sweeps of shearwake::

    import shearwake
    sweep = shearwake.open("out/quickstart")
    data = sweep.dataset("eta_t", "traces")

`open` reads the plan of an output folder, and everything else when it is needed. It does not need the program. `Job` checks
and runs jobs with the program.
"""
from contextlib import AbstractContextManager

from .case import Case
from .checksum import Damaged
from .engine import Engine, Evaluation
from .errors import (AxesDiffer, CasesFailed, Diagnostic, EnvironmentFailed, GridsDiffer, JobError, NotAnOutputFolder, NotRecorded,
                     NotValid, ProgramError, ProgramNotFound, ShearwakeError, Stopped, UsageError)
from .job import Job, Plan, Progress
from .plan import Column
from .program import jobs
from .sweep import Sweep, open_case
from .sweep import open_sweep as open  # noqa: A001  (as in `shearwake.open`)



def style(name: str = "report", columns: int = 2) -> AbstractContextManager[object]:
    """Sets the style of all following figures: "report" or "paper", see shearwake.figure_style.style."""
    from .figure_style import style as set_style  # here, since Matplotlib takes long to import
    return set_style(name, columns)


__version__ = "0.2.0"
__all__ = ["AxesDiffer", "Case", "CasesFailed", "Column", "Damaged", "Diagnostic", "Engine", "EnvironmentFailed", "Evaluation", "GridsDiffer", "Job", "JobError",
           "NotAnOutputFolder", "NotRecorded", "NotValid", "Plan", "ProgramError", "ProgramNotFound", "Progress", "ShearwakeError",
           "Stopped", "Sweep", "UsageError", "jobs", "open", "open_case", "style"]
