# SPDX-License-Identifier: BSD-3-Clause
"""Jobs: written as TOML, dictionaries or keywords, and checked and run by the program."""
from __future__ import annotations

import contextlib
import copy
import datetime
import html
import os
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import program
from .errors import CasesFailed, Diagnostic, ProgramError
from .keys import put
from .running import Progress, run_and_watch
from .sweep import Sweep

if TYPE_CHECKING:
    import pandas as pd

BYTE_ORDER_MARK = "\ufeff"  # of editors of Windows
Source = str | os.PathLike[str] | Mapping[str, Any] | None


@dataclass(frozen=True)
class Plan:
    """What `shearwake plan` estimates. `document` is its JSON document (docs/reference/json-output.md)."""

    document: dict[str, Any]

    @property
    def cases(self) -> pd.DataFrame:
        """One row per case with its id as index: the swept keys, grid, seconds, memory and disk."""
        import pandas as pd
        rows = [{**case["settings"], **{name: value for name, value in case.items() if name not in ("id", "settings")}}
                for case in self.document["cases"]]
        return pd.DataFrame(rows, index=pd.Index([case["id"] for case in self.document["cases"]], name="id"))

    @property
    def warnings(self) -> list[Diagnostic]:
        """The warnings about the job."""
        return program.diagnostics_of(self.document)

    @property
    def wall_s(self) -> float | None:
        """The estimated wall time in s; None if it is not known on this machine yet."""
        return self.document["wall_s"]

    @property
    def core_hours(self) -> float | None:
        """Ranks times wall time in hours; None as for wall_s."""
        return self.document["core_hours"]

    @property
    def memory_per_rank_B(self) -> float:
        """The largest memory of a rank in bytes."""
        return self.document["memory_per_rank_B"]

    @property
    def disk_B(self) -> float:
        """The size of all case files in bytes."""
        return self.document["disk_B"]

    def _repr_html_(self) -> str:
        """The first cases, for notebooks."""
        return f"<p>{html.escape(repr(self))}</p>" + self.cases.head(10).to_html()

    def __repr__(self) -> str:
        time = "time: not known on this machine yet" if self.wall_s is None else f"{self.wall_s:.3g} s"
        return (f"<shearwake.Plan {self.document['name']}: {len(self.document['cases'])} cases, {time}, "
                f"{self.memory_per_rank_B / 1e6:.3g} MB per rank, {self.disk_B / 1e6:.3g} MB>")


class Job:
    """A job from a TOML file, from TOML text, from a dictionary, from keywords, or from a mixture:

        Job("jobs/quickstart.toml")
        Job({"job": {"name": "a"}, "load": {...}})
        Job("jobs/quickstart.toml", load={"peak_Pa": 200.0}, name="stronger")

    Keywords are tables of the job, merged into the source. `name` and `title` set keys of [job]. The path of an
    unchanged file is given to the program itself. Other jobs are written to a temporary folder with links to their files;
    relative paths refer to `folder`, the folder of the source file or the current folder. Raises OSError and
    tomllib.TOMLDecodeError."""

    def __init__(self, source: Source = None, /, **tables: Any) -> None:
        self._path: Path | None = None
        self.folder = Path.cwd()
        if isinstance(source, Mapping):
            found: dict[str, Any] = copy.deepcopy(dict(source))
            text = None
        elif source is None:
            found, text = {}, None
        elif isinstance(source, str) and "\n" in source:
            found, text = {}, source.removeprefix(BYTE_ORDER_MARK)
        else:
            self._path = Path(source).resolve()
            self.folder = self._path.parent
            found, text = {}, self._path.read_text(encoding="utf-8-sig")
        self._text = text
        if tables or text is None:
            self._tables = found if text is None else tomllib.loads(text)
            for name in ("name", "title"):
                if name in tables:
                    tables["job"] = {**tables.get("job", {}), name: tables.pop(name)}
            merge(self._tables, tables)
            self._tables.setdefault("schema", 1)
            self._path, self._text = None, None

    @property
    def tables(self) -> dict[str, Any]:
        """A copy of the job as nested dictionaries. Raises tomllib.TOMLDecodeError."""
        return copy.deepcopy(self._tables) if self._text is None else tomllib.loads(self._text)

    @property
    def text(self) -> str:
        """The job as TOML. Raises TypeError for values that TOML cannot express, for example None."""
        if self._text is not None:
            return self._text
        import tomli_w
        return tomli_w.dumps(plain(self._tables, ""))

    def __repr__(self) -> str:
        return f"<shearwake.Job {self._path or self.name}>"

    def _repr_html_(self) -> str:
        """The text of the job, for notebooks."""
        return f"<details><summary>{html.escape(repr(self))}</summary><pre>{html.escape(self.text)}</pre></details>"

    @property
    def name(self) -> str:
        """The name of the job, which is that of its output folder; empty if it has none."""
        try:
            return str(self.tables.get("job", {}).get("name", ""))
        except (tomllib.TOMLDecodeError, AttributeError):
            return ""

    def change(self, values: Mapping[str, Any], /) -> Job:
        """A copy with changed keys: job.change({"load.peak_Pa": 200.0, "medium.layer[1].c_s_m_s": 4.0}). Raises KeyError for
        a list element that does not exist."""
        tables = self.tables
        for key, value in values.items():
            put(tables, key, copy.deepcopy(value))
        return self.with_tables(tables)

    def sweep(self, axes: Mapping[str, Any] | None = None, /, *, zip: Sequence[Mapping[str, Any]] = (),
              exclude: Sequence[Mapping[str, Any]] = (), x: str | None = None, reference: Mapping[str, Any] | None = None) -> Job:
        """A copy with another [sweep]: job.sweep({"load.modulation.am_frequency_Hz": [100, 200, 400]}).

        An axis is a list of values or a table such as {"linspace": [50, 800, 16]}; axes are combined with each other. `zip`
        contains groups of axes that vary together, `exclude` combinations that are omitted. `x` is the key on the horizontal
        axis of figures, by default the first one, and `reference` the keys of the modulation of reference cases."""
        tables = self.tables
        swept: dict[str, Any] = dict(axes or {})
        first = next(iter([*swept, *(key for group in zip for key in group)]), None)
        for name, groups in (("zip", zip), ("exclude", exclude)):
            if groups:
                swept[name] = [dict(group) for group in groups]
        tables["sweep"] = copy.deepcopy(swept)
        table = tables.setdefault("table", {})
        if x or first:
            table["x"] = x or (table["x"] if table.get("x") in swept else first)
        table["series"] = [key for key in table.get("series", []) if key in swept]
        if not table["series"]:
            del table["series"]
        if reference is not None:
            table["reference"] = dict(reference)
        return self.with_tables(tables)

    def with_tables(self, tables: dict[str, Any]) -> Job:
        """A job with other tables, whose relative paths refer to the same folder."""
        made = Job(tables)
        made.folder = self.folder
        return made

    @property
    def _label(self) -> str:
        """What texts of the program call the file of the job."""
        return str(self._path) if self._path else f"<Job {self.name}>" if self.name else "<Job>"

    @contextlib.contextmanager
    def file(self) -> Iterator[Path]:
        """The path of a file with the job. A temporary file lies in a folder of its own outside of the folder of the job, with
        links to the files to which the job refers, and is deleted afterwards."""
        if self._path is not None:
            yield self._path
            return
        text = self.text
        with tempfile.TemporaryDirectory(prefix="shearwake-job-") as root:
            path = link_files(text, Path(self.folder).resolve(), Path(root)) / f"{self.name if is_file_name(self.name) else 'job'}.toml"
            path.unlink(missing_ok=True)  # not the file to which a link of this name leads
            path.write_text(text, encoding="utf-8")
            try:
                yield path
            except ProgramError as error:
                raise error.renamed(str(path), self._label) from None

    def check(self, *, elsewhere: bool = False) -> list[Diagnostic]:
        """Returns the warnings about the job. Raises JobError with all errors. With `elsewhere`, the job is not compared with
        the memory and disk of this machine."""
        with self.file() as path:
            return self._check(path, elsewhere)

    def _check(self, path: Path, elsewhere: bool = False) -> list[Diagnostic]:
        document = program.call_json(["check", str(path), *(["--elsewhere"] if elsewhere else [])], (0, 3))
        found = [replace(d, file=d.file.replace(str(path), self._label)) for d in program.diagnostics_of(document)]
        if document["errors"]:
            raise program.error_of(3, "\n".join(str(d) for d in found if d.severity == "error"), found)
        return found

    def plan(self, ranks: int = 1, *, ranks_per_case: int | None = None) -> Plan:
        """The cases of the job with their estimated time, memory and disk. Raises JobError."""
        arguments = ["--ranks", str(ranks)] if ranks > 1 else []
        if ranks_per_case is not None:
            arguments += ["--ranks-per-case", str(ranks_per_case)]
        with self.file() as path:
            try:
                return Plan(program.call_json(["plan", str(path), *arguments]))
            except ProgramError as error:
                if error.exit_code == 3:
                    self._check(path)
                raise

    def run(self, ranks: int = 1, *, out: str | os.PathLike[str] | None = None,
            progress: bool | Callable[[Progress], None] = False, launch: Sequence[str] | None = None,
            options: Sequence[str] = ()) -> Sweep:
        """Computes the cases that are not complete yet, and the table, and opens the output folder.

        `out` is by default out/NAME in the current folder. `progress` prints a line that is updated, or is called with each
        Progress. `launch` replaces mpirun, for example ["srun", "-n", "64"]. `options` are further arguments of
        `shearwake run`, for example ["--retry-failed"]. If the call is interrupted, the run is stopped in an orderly way, and
        the same call resumes it. Warns with NotValid if readings are not valid. Raises JobError, UsageError, CasesFailed, EnvironmentFailed and Stopped."""
        folder = Path(out) if out is not None else Path("out") / self.name
        try:
            self.run_command("run", folder, ranks, progress, launch, options)
        except CasesFailed as error:
            error.sweep = reduced(folder)
            raise
        sweep = reduced(folder)
        sweep.warn_of_invalid(sweep.every_case)
        return sweep

    def run_command(self, command: str, folder: Path, ranks: int, progress: bool | Callable[[Progress], None],
                    launch: Sequence[str] | None, options: Sequence[str]) -> None:
        """Runs a command of the program for the job into an output folder, to its end. Raises JobError and the errors of run()."""
        with self.file() as path:
            try:
                run_and_watch([command, str(path), "--out", str(folder), *options], ranks, launch, progress)
            except ProgramError as error:
                if error.exit_code == 3:
                    self._check(path)
                raise


def is_file_name(name: str) -> bool:
    return name.replace("-", "").replace("_", "").isalnum()


def link_files(text: str, folder: Path, root: Path) -> Path:
    """A new folder below `root` in which the relative paths of a job lead to the same files as in `folder`: each path in the text
    that exists there is a symbolic link. Returns the folder."""
    def words(value: Any) -> Iterator[str]:
        if isinstance(value, str):
            yield value
        elif isinstance(value, (dict, list)):
            for part in value.values() if isinstance(value, dict) else value:
                yield from words(part)
    try:
        found = {word for word in words(tomllib.loads(text)) if word and "\0" not in word and not os.path.isabs(word)}
    except tomllib.TOMLDecodeError:
        found = set()  # the program reports the error
    up = max((os.path.normpath(word).split(os.sep).count("..") for word in found), default=0)
    place = root.joinpath(*["root"] * (up + 1), *folder.parts[1:])
    place.mkdir(parents=True)
    for word in sorted(found, key=len):
        try:
            exists = len(word) < 1000 and (folder / word).is_file()
        except OSError:
            exists = False
        link = Path(os.path.normpath(place / word))
        if exists:
            for parent in (link.parent, (place / word).parent):  # a/../b needs the folder a
                parent.mkdir(parents=True, exist_ok=True)
            if not link.exists():
                link.symlink_to((folder / word).resolve())
    return place


def reduced(folder: Path) -> Sweep:
    """Writes the table of an output folder and opens it. Cases that failed are stated in the table."""
    program.call(["reduce", str(folder)], (0, 4))
    return Sweep(folder)


def merge(into: dict[str, Any], tables: Mapping[str, Any]) -> None:
    """Adds nested tables; other values, also lists, are replaced."""
    for key, value in tables.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            merge(into[key], value)
        else:
            into[key] = copy.deepcopy(dict(value) if isinstance(value, Mapping) else value)


def plain(value: Any, key: str) -> Any:
    """Arrays, numbers and tuples as values that TOML can express. Raises TypeError, with `key`, for any other value."""
    if isinstance(value, Mapping):
        return {str(name): plain(entry, f"{key}.{name}" if key else str(name)) for name, entry in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist(), key)
    if isinstance(value, (list, tuple, range)):
        return [plain(entry, f"{key}[{place}]") for place, entry in enumerate(value, 1)]
    if value is None:
        raise TypeError(f"{key}: None is not a value of a job; omit the key, so that its default applies")
    if not isinstance(value, (bool, int, float, str, datetime.date, datetime.time)):
        raise TypeError(f"{key}: {type(value).__name__} is not a type of a job; use numbers, text, lists and tables")
    return value
