# SPDX-License-Identifier: BSD-3-Clause
"""Reads tables that `shearwake reduce` wrote: their watched numbers and the names of their cases."""
from pathlib import Path

from ..report.compare.compare_tables import NotATable, Table, number_of, read_table, row_name, swept_columns
from ..report.compare.tolerances import NEVER_COMPARED


def read_cases(path: Path) -> Table:
    """The table of the cases of a sweep. Raises NotATable, and OSError if it cannot be read."""
    table = read_table(path)
    if not {"id", "status"} <= set(table.columns) or "" in table.columns:
        raise NotATable(f"{path} is not a table of cases: its columns must be named, and contain id and status")
    return table


def readings(path: Path) -> list[tuple[str, str, float]]:
    """(case, column, value) of every watched number. If two cases have the same name, the first counts."""
    table = read_cases(path)
    unwatched = (*swept_columns(table), *NEVER_COMPARED, "id", "reference", "status")
    watched = [column for column in table.columns if column not in unwatched]
    found: dict[tuple[str, str], float] = {}
    for row in table.rows:
        for column in watched:
            value = number_of(row[column])
            if value is not None:
                found.setdefault((row_name(table, row), column), value)
    return [(case, column, value) for (case, column), value in found.items()]
