# SPDX-License-Identifier: BSD-3-Clause
"""The output folder of a sweep. Opening it reads the plan; everything else is read when it is needed."""
from __future__ import annotations

import contextlib
import functools
import html
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Mapping, Sequence

from . import program, stored
from .case import Case
from .checksum import Damaged
from .errors import NotAnOutputFolder, NotRecorded, warn_of_invalid
from .keys import axis_label, by_short_key, split_unit, typed
from .plan import Column, Table, first_line, labels_of, read_plan, read_table
from .tables import Optima, Row, read_adaptive, read_sensitivity, read_statistics

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .plot import SweepPlot


class Sweep:
    """An output folder. `cases` are its cases in the order of the plan, `references` their references, and `every_case`
    both. `labels` are those of [table]: {(swept key, value): text}. `uncertain` is the design of [uncertain], empty without it, and `adaptive_axes` lists the adaptive axes."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        plan, self.job_text = read_plan(self.folder)
        self.name: str = plan["name"]
        self.title: str = plan["title"]
        self.swept_keys: list[str] = plan["swept_keys"]
        self.x: str = plan["table"]["x"]
        self.series_keys: list[str] = plan["table"]["series"]
        self.labels = labels_of(self.job_text, plan["cases"])
        self.uncertain: dict[str, Any] = plan.get("uncertain") or {}
        self.adaptive_axes: list[dict[str, Any]] = plan.get("adaptive", [])
        try:
            self.every_case = [Case(self.folder / "cases" / (entry["id"] + ".h5"), entry, self) for entry in plan["cases"]]
        except (KeyError, TypeError) as error:
            raise NotAnOutputFolder(f"{self.folder} is not an output folder of shearwake: {first_line(error)}") from error
        self.cases = [case for case in self.every_case if not case.is_reference]
        self.references = [case for case in self.every_case if case.is_reference]
        self._by_id = {case.id: case for case in self.every_case}

    def __getitem__(self, case_id: str) -> Case:
        return self._by_id[case_id]

    def __len__(self) -> int:
        return len(self.cases)

    def __iter__(self) -> Iterator[Case]:
        return iter(self.cases)

    def __repr__(self) -> str:
        return f"<shearwake.Sweep {self.name}: {len(self.cases)} cases over {', '.join(self.swept_keys) or 'nothing'}>"

    @functools.cached_property
    def _files(self) -> set[str]:
        try:
            return {entry.name for entry in os.scandir(self.folder / "cases")}
        except FileNotFoundError:
            return set()

    @functools.cached_property
    def reduced(self) -> Table | None:
        """The table of `shearwake reduce`; None if there is none. Raises NotAnOutputFolder if it is damaged."""
        try:
            return read_table(self.folder, self.name)
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            raise NotAnOutputFolder(f"{self.folder}: the table is damaged ({first_line(error)}); write it again with "
                                    f"shearwake reduce {self.folder}") from error

    def refresh(self) -> None:
        """Forgets which cases are complete or damaged, and the table, so that the results of an active run become visible."""
        for name in ("_files", "reduced"):
            self.__dict__.pop(name, None)
        for case in self.every_case:
            case.damage, case._is_checked = "", False

    def select(self, settings: Mapping[str, Any] | None = None, /, **short: Any) -> list[Case]:
        """The cases with these values of swept keys, given in full in a mapping or as keywords by their last part:
        sweep.select(am_frequency_Hz=400)."""
        wanted = self._wanted(settings, short)
        return [case for case in self.cases if all(typed(case.settings.get(key)) == typed(value) for key, value in wanted.items())]

    def _wanted(self, settings: Mapping[str, Any] | None, short: Mapping[str, Any]) -> dict[str, Any]:
        if not isinstance(settings, (Mapping, type(None))):
            raise TypeError(f"{settings!r} is not a mapping of swept keys to values, as in sweep.case(am_frequency_Hz=400); sweep.cases[0] is "
                            "the first case")
        wanted = {**(settings or {}), **by_short_key(self.swept_keys, short)}
        for key in wanted:
            if key not in self.swept_keys:
                raise KeyError(f"{key} is not swept; the swept keys are {', '.join(self.swept_keys) or 'none'}")
        return wanted

    def case(self, settings: Mapping[str, Any] | None = None, /, **short: Any) -> Case:
        """The only case with these values of swept keys, see select(). Raises KeyError if there is none or more, with the nearest value
        of a number that no case has."""
        found = self.select(settings, **short)
        if len(found) == 1:
            return found[0]
        for key, value in self._wanted(settings, short).items():
            known = {case.settings[key] for case in self.cases if isinstance(case.settings.get(key), (int, float))}
            if known and isinstance(value, (int, float)) and value not in known:
                raise KeyError(f"no case has {key} = {value:g}; the nearest value is {min(known, key=lambda v: abs(v - value)):g}")
        raise KeyError(f"{len(found)} cases match; name the values of enough swept keys: {', '.join(self.swept_keys)}")

    @property
    def columns(self) -> list[Column]:
        """The columns of the table, with units and meanings. Without a table they follow from the first complete case."""
        if self.reduced:
            return self.reduced.columns
        first = next((case for case in self.every_case if case.is_complete), None)
        return first.columns if first else []

    @property
    def table(self) -> pd.DataFrame:
        """The table: one row per case and reference with its id as index, the swept keys, status and reason, `valid` (False:
        the readings are not valid; NA: not complete), `valid_ratios` (the same for ratios to the reference, in sweeps that have
        references), and the columns. `table.attrs["units"]` contains the unit of each column, and `table.attrs["meanings"]` its meaning.

        The numbers are those of `shearwake reduce`, without opening a case file; whether files have changed since then is found by
        verify(). Without the table of `reduce` they are read from the case files."""
        import pandas as pd
        names = [column.name for column in self.columns]
        valid = ["valid", *(["valid_ratios"] if self.references else [])]
        rows = []
        for case in self.every_case:
            values = case.values
            rows.append({**{key: case.settings.get(key) for key in self.swept_keys}, "is_reference": case.is_reference,
                         "status": case.status, "reason": case.reason, **dict(zip(valid, (case.validity, case.ratio_validity))),
                         **{name: values.get(name, float("nan")) for name in names}})
        table = pd.DataFrame(rows, index=pd.Index([case.id for case in self.every_case], name="id"))
        table[valid] = table[valid].astype("boolean")
        table.attrs["units"] = {**{key: unit_of(key) for key in self.swept_keys},
                                **{column.name: column.unit for column in self.columns}}
        table.attrs["meanings"] = {column.name: column.meaning for column in self.columns}
        return table

    @property
    def statistics(self) -> pd.DataFrame:
        """The distribution of each column over the samples of [uncertain], as `shearwake reduce` wrote it: one row per swept
        values, column and statistic. Empty without [uncertain]. Raises NotAnOutputFolder if the file is damaged."""
        return self._frame("statistics", read_statistics)

    @property
    def sensitivity(self) -> pd.DataFrame:
        """The Sobol indices or Morris measures of each column and uncertain key, see `statistics`."""
        return self._frame("sensitivity", read_sensitivity)

    @property
    def adaptive(self) -> pd.DataFrame:
        """The intervals of adaptive axes with their estimated errors, and the extrema and crossings that were found, see
        `statistics`. Empty without adaptive axes."""
        return self._frame("adaptive", read_adaptive)

    @property
    def optima(self) -> pd.DataFrame:
        """The optima of `shearwake optimise` with their upper bounds: one row per case and strength, see `statistics`."""
        return self._frame("optimise", lambda folder, _: Optima(folder).rows)

    def _frame(self, kind: str, read: Callable[[Path, str], list[Row]]) -> pd.DataFrame:
        import pandas as pd
        try:
            return pd.DataFrame(read(self.folder, self.name))
        except (OSError, ValueError) as error:
            raise NotAnOutputFolder(f"{self.folder}: the table of kind {kind} is damaged ({first_line(error)}); write it again "
                                    "with the program") from error

    def dataset(self, *names: str, references: bool = False) -> xr.Dataset:
        """One Dataset of all cases with the swept keys as dimensions, which is read when its values are needed.

        A name is a column of the table ("eta_period_1"), a quantity over time ("eta" or "eta_t"), a group ("traces",
        "surface", "mean") or a variable of a group ("traces/amplitude"). A key that follows from another swept key is a
        coordinate of that dimension. Cases that were excluded or are not complete are NaN. With `references`, each cell
        contains the reference of its case. The variable `valid` is 1 where the readings of the case are valid, and those of
        its reference if a ratio is requested, 0 where they are not, and NaN without a result. With a ratio, `valid_case` does
        not depend on the reference. Warns with NotValid if a case
        is not valid, and with GridsDiffer if the cases have different grids. Raises NotRecorded and KeyError."""
        from .dataset import of_sweep
        if not names:
            raise NotRecorded("name at least one column, quantity or group: sweep.dataset(\"eta_t\", \"traces\")")
        return of_sweep(self, names, references).assign_attrs(title=self.title, job=self.name)

    def warn_of_invalid(self, cases: Iterable[Case], stacklevel: int = 3) -> None:
        """Warns with NotValid, at a caller of this function, if the readings of some complete cases are not valid."""
        cases = [case for case in cases if case.status == "complete"]
        wrong = [case for case in cases if not case.is_valid]
        warn_of_invalid([case.warnings for case in wrong], f"{len(wrong)} of {len(cases)} cases of {self.name} are", stacklevel + 1)

    @property
    def plot(self) -> SweepPlot:
        """Draws this sweep: sweep.plot("eta_period_1"), sweep.plot.heat_maps()."""
        from .plot import SweepPlot
        return SweepPlot(self)

    def report(self) -> Path:
        """Draws the figures and writes the page of the sweep. Returns the path of the page. Raises ProgramError."""
        return Path(program.call_json(["report", str(self.folder)])["page"])

    def compare(self, other: Sweep | str | os.PathLike[str]) -> dict[str, Any]:
        """The differences of columns, fields and traces from another sweep, as the JSON document of `shearwake compare`, whose
        member `equal` states whether they are within the default tolerances. Raises ProgramError."""
        folder = other.folder if isinstance(other, Sweep) else Path(other)
        return program.call_json(["compare", str(self.folder), str(folder)], (0, 1))

    def converge(self, ranks: int = 1, *, cases: int = 3, only: Sequence[str] = (), job: str | os.PathLike[str] | None = None,
                 launch: Sequence[str] | None = None) -> Sweep:
        """Estimates numerical errors: computes some cases with half the spacing, half the time step and twice the domain. Returns
        this sweep with its new table, whose columns have errors (`eta_period_1_error`). `only` selects cases by id; `job` is the job
        file for jobs that refer to other files. Raises ProgramError."""
        overrides = next((str(case.attributes.get("overrides", "")) for case in self.every_case if case.is_complete), "")
        chosen = ["--only", ",".join(only)] if only else ["--cases", str(cases)]
        program.call(["converge", str(job or self.folder / "job.toml"), "--out", str(self.folder), *chosen,
                      *(word for line in overrides.splitlines() for word in ("-S", line))], ranks=ranks, launch=launch)
        program.call(["reduce", str(self.folder)], (0, 4))
        return Sweep(self.folder)

    def _repr_html_(self) -> str:
        """The first rows of the table, for notebooks."""
        return f"<p><b>{html.escape(self.title or self.name)}</b>: {html.escape(repr(self))}</p>" + self.table.head(10).rename(columns=axis_label).to_html()

    def verify(self) -> dict[str, str]:
        """Verifies all case files. Returns the damage of each damaged case, whose status is "damaged" from now on."""
        for case in self.every_case:
            if case.has_file:
                with contextlib.suppress(Damaged, OSError):
                    case.verify()
        return {case.id: case.damage for case in self.every_case if case.damage}


def unit_of(key: str) -> str:
    """The unit at the end of a key of the job, as in the key: "mm" of "load.footprint.fwhm_mm"; "1" without one."""
    return split_unit(key)[1] or "1"


def open_sweep(folder: str | os.PathLike[str]) -> Sweep:
    """Opens the output folder of a sweep. Reads its plan only. Raises NotAnOutputFolder."""
    return Sweep(folder)


def case_of_file(path: Path) -> Case:
    """The case of a file. Raises OSError, RuntimeError, KeyError, ValueError or TypeError if it is not a case file."""
    with stored.opened(path):  # refuses links to other files
        found = stored.attributes(path)
    return Case(path, {"id": found["case_id"], "settings": json.loads(found["settings"]),
                       "is_reference": found["is_reference"] == "yes", "reference_id": found["reference_id"]})


def open_case(path: str | os.PathLike[str]) -> Case:
    """Opens a single case file. Reads its attributes only. Raises NotRecorded if it is not a case file."""
    path = Path(path)
    try:
        return case_of_file(path)
    except FileNotFoundError as error:
        raise NotRecorded(f"{path}: no such case file") from error
    except Damaged as error:
        raise NotRecorded(str(error)) from error
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise NotRecorded(f"{path} is not a valid case file: {first_line(error)}") from error
