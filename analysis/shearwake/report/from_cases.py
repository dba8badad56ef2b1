# SPDX-License-Identifier: BSD-3-Clause
"""Writes the plan of a folder without plan.json, as far as it follows from the case files.

Usage: python3 -m shearwake.report.from_cases DIR    writes DIR/tables/plan.json, which `shearwake reduce` and `shearwake report` then read
"""
import sys
from pathlib import Path

from ..checksum import sealed
from ..from_cases import plan_of_cases


def main(folder: str) -> None:
    plan = plan_of_cases(Path(folder))
    tables = Path(folder) / "tables"
    tables.mkdir(exist_ok=True)
    (tables / "plan.json").write_text(sealed(plan), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
