# SPDX-License-Identifier: BSD-3-Clause
"""What the report uses of the package `shearwake`, which lies next to this folder in source trees and installations."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from shearwake import inputs, wake  # noqa: E402
from shearwake.case import Case  # noqa: E402
from shearwake.checksum import sealed, verify_case  # noqa: E402
from shearwake.errors import NotAnOutputFolder, NotRecorded  # noqa: E402
from shearwake.from_cases import plan_of_cases  # noqa: E402
from shearwake.plan import first_line, read_plan, read_table  # noqa: E402
from shearwake.sweep import case_of_file  # noqa: E402
from shearwake.tables import Optima, read_adaptive, read_sensitivity, read_statistics  # noqa: E402

__all__ = ["UNREADABLE", "Case", "NotAnOutputFolder", "NotRecorded", "Optima", "case_of_file", "first_line", "inputs",
           "plan_of_cases", "read_adaptive", "read_plan", "read_sensitivity", "read_statistics", "read_table", "sealed", "verify_case", "wake"]

# What reading a case raises if it has no file, or if the file is damaged or lacks the data.
UNREADABLE = (OSError, RuntimeError, KeyError, ValueError, IndexError, TypeError, NotRecorded)
