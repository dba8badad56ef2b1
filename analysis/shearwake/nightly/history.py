# SPDX-License-Identifier: BSD-3-Clause
"""The results of all nights, in one SQLite file.

SQLite is used instead of CSV because a night is one transaction: after a kill or on a full disk it is
either complete or absent, and a damaged line cannot shift the columns of other lines.
"""
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

TABLES = """
CREATE TABLE IF NOT EXISTS night (id INTEGER PRIMARY KEY, started TEXT NOT NULL, git_id TEXT NOT NULL,
  host TEXT NOT NULL, verdict TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS job (night INTEGER NOT NULL REFERENCES night, name TEXT NOT NULL,
  verdict TEXT NOT NULL, message TEXT NOT NULL, PRIMARY KEY (night, name));
CREATE TABLE IF NOT EXISTS reading (night INTEGER NOT NULL REFERENCES night, job TEXT NOT NULL,
  case_name TEXT NOT NULL, column TEXT NOT NULL, value REAL NOT NULL,
  PRIMARY KEY (night, job, case_name, column)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS speed (night INTEGER NOT NULL REFERENCES night, name TEXT NOT NULL,
  ratio REAL NOT NULL, PRIMARY KEY (night, name));
"""
UNFINISHED = "unfinished"


class History:
    def __init__(self, path: Path | str) -> None:
        self._file = sqlite3.connect(path, timeout=60, isolation_level=None)
        self._file.execute("PRAGMA synchronous = FULL")
        self._file.executescript(TABLES)

    def close(self) -> None:
        self._file.close()

    def begin(self, started: str, git_id: str, host: str) -> int:
        """Adds a night and returns its number. The night is unfinished until `finish`."""
        cursor = self._file.execute("INSERT INTO night (started, git_id, host, verdict) VALUES (?, ?, ?, ?)",
                                    (started, git_id, host, UNFINISHED))
        return int(cursor.lastrowid or 0)

    def finish(self, night: int, verdict: str, jobs: Iterable[tuple], readings: Iterable[tuple],
               speeds: Iterable[tuple]) -> None:
        """Stores the results of a night in one transaction. jobs: (name, verdict, message); readings:
        (job, case, column, value); speeds: (name, ratio)."""
        self._file.execute("BEGIN IMMEDIATE")
        try:
            for table, rows, places in (("job", jobs, 3), ("reading", readings, 4), ("speed", speeds, 2)):
                self._file.executemany(f"INSERT INTO {table} VALUES (?{', ?' * places})",
                                       ((night, *row) for row in rows))
            self._file.execute("UPDATE night SET verdict = ? WHERE id = ?", (verdict, night))
            self._file.execute("COMMIT")
        except BaseException:
            if self._file.in_transaction:
                self._file.execute("ROLLBACK")
            raise

    def nights(self, most: int) -> list[tuple]:
        """The last nights, oldest first: (id, started, git_id, host, verdict)."""
        return self._rows("SELECT id, CAST(started AS TEXT), git_id, host, verdict FROM night ORDER BY id DESC LIMIT ?",
                          most)[::-1]

    def jobs(self, night: int) -> list[tuple]:
        return self._rows("SELECT name, verdict, message FROM job WHERE night = ? ORDER BY rowid", night)

    def readings(self, job: str, first_night: int) -> dict[str, dict[str, dict[int, float]]]:
        """{column: {case: {night: value}}}"""
        found: dict[str, dict[str, dict[int, float]]] = {}
        for column, case, night, value in self._rows(
                "SELECT column, case_name, night, value FROM reading WHERE job = ? AND night >= ?",
                job, first_night):
            found.setdefault(column, {}).setdefault(case, {})[night] = float(value)
        return found

    def speeds(self, first_night: int, host: str) -> dict[str, dict[int, float]]:
        """{name: {night: value}} of the nights on a host"""
        found: dict[str, dict[int, float]] = {}
        for name, night, value in self._rows("SELECT name, night, ratio FROM speed JOIN night ON night = night.id "
                                             "WHERE night >= ? AND host = ? ORDER BY speed.rowid", first_night, host):
            found.setdefault(name, {})[night] = float(value)
        return found

    def last_equal(self, job: str) -> tuple[str, str] | None:
        """The date and the program of the last night on which the table of a job was equal to its baseline."""
        rows = self._rows("SELECT substr(started, 1, 10), git_id FROM job JOIN night ON night = night.id "
                          "WHERE name = ? AND job.verdict = 'equal' ORDER BY night.id DESC LIMIT 1", job)
        return (rows[0][0], rows[0][1]) if rows else None

    def _rows(self, query: str, *values: Any) -> list[tuple]:
        with closing(self._file.execute(query, values)) as cursor:
            return cursor.fetchall()
