# SPDX-License-Identifier: BSD-3-Clause
"""One case of a sweep. Every part of its file is read when it is first needed."""
from __future__ import annotations

import contextlib
import functools
import html
import json
import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Protocol

import numpy as np

from . import checksum, parameters, stored
from .errors import HOW, NotRecorded, NotValid, level_of_caller, suggestion, warn_of_invalid
from .keys import axis_label
from .plan import Column, Table, first_line

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .plot import Plot

REQUIRED: Any = object()  # in place of a default: there is none


class SweepInterface(Protocol):
    """What cases and datasets need of a sweep."""

    swept_keys: list[str]
    cases: list[Case]
    _by_id: dict[str, Case]

    @property
    def columns(self) -> list[Column]: ...

    @property
    def reduced(self) -> Table | None: ...

    @property
    def _files(self) -> set[str]: ...

    def warn_of_invalid(self, cases: Iterable[Case], stacklevel: int = 3) -> None: ...


class Case:
    """A case: its settings, its values in the table, and the contents of its file.

    `id` is the hash of its physical parameters, `settings` the values of the swept keys, and `path` its file, which exists
    once the case is complete. Lengths in files are in m, times in s and stresses in Pa; the scalars of the table have the
    unit that their name states. `damage` states what verify() found to be wrong with the file, and is empty otherwise. The first
    reading of its file warns with NotValid if another program has changed it through HDF5; only verify() finds all changes.
    """

    def __init__(self, path: Path, entry: dict[str, Any], sweep: SweepInterface | None = None) -> None:
        self.path = path
        self.id: str = entry["id"]
        self.settings: dict[str, Any] = entry["settings"]
        self.is_reference: bool = entry["is_reference"]
        self.reference_id: str = entry["reference_id"]
        self.sweep = sweep
        self.damage = ""
        self._is_checked = False
        self._parameters_text: str = entry.get("case", "")

    def __repr__(self) -> str:
        settings = ", ".join(f"{key} = {value}" for key, value in self.settings.items())
        state = "" if self.status == "complete" else f", {self.status}"
        with contextlib.suppress(NotRecorded, OSError, ValueError):
            state = state or ("" if self.is_valid else ", not valid")
        return f"<shearwake.Case {self.id}{' (reference)' if self.is_reference else ''}: {settings or 'nothing swept'}{state}>"

    # ---- what plan and table state

    @property
    def _row(self) -> dict[str, Any]:
        """The row of the table of `reduce`; empty if there is none."""
        table = self.sweep.reduced if self.sweep is not None else None
        return table.rows.get(self.id, {}) if table else {}

    @property
    def has_file(self) -> bool:
        """Whether the case has a file, which may be damaged."""
        return self.path.name in self.sweep._files if self.sweep is not None else self.path.exists()

    @property
    def is_complete(self) -> bool:
        """Whether the case has a file that is not known to be damaged."""
        return self.status == "complete"

    @property
    def status(self) -> str:
        """`complete`, or `damaged` if verify() found damage, which is not looked for before; otherwise what `reduce` stated, for
        example `failed`, or `missing` if it is not computed."""
        if self.damage:
            return "damaged"
        state = self._row.get("status", "missing")
        if self.has_file:
            return "complete" if state == "missing" else state
        return "missing" if state == "complete" else state

    @property
    def reason(self) -> str:
        """Why the case is not complete, as stated by verify() or `reduce`; empty for a complete case."""
        if self.damage or self.status == "complete":
            return self.damage
        return self._row["note"] if self._row.get("status") == self.status else "not computed"

    @property
    def wall_s(self) -> float:
        """The computing time in s; NaN if the case is not complete."""
        return math.nan if self.status != "complete" else self._row["wall_s"] if "wall_s" in self._row else self.attributes["wall_s"]

    @property
    def note(self) -> str:
        """The column `note` of the table: the reason, or what is empty or not valid in a complete case."""
        return self.reason or self._row.get("note", "")

    @property
    def reference(self) -> Case | None:
        """The reference of this case, or None."""
        return self.sweep._by_id.get(self.reference_id) if self.sweep is not None else None

    @functools.cached_property
    def _scalars(self) -> tuple[dict[str, float], dict[str, str], dict[str, Any]]:
        return stored.scalars(self._file())

    @property
    def values(self) -> dict[str, float]:
        """The columns of the table for this case; NaN: empty. Without a table they are read from the file, which contains
        no ratios to the reference. A damaged case has none."""
        row = self._row
        if row.get("status") == "complete" and not self.damage:
            return row["values"]
        return self._scalars[0] if self.status == "complete" else {}

    @property
    def notes(self) -> dict[str, str]:
        """Why columns are empty."""
        row = self._row
        if row.get("status") == "complete":
            return row["notes"]
        return self._scalars[1] if self.status == "complete" else {}

    @property
    def columns(self) -> list[Column]:
        """The scalars of the file with their units and meanings."""
        return [Column(name, unit, meaning) for name, (unit, meaning) in self._scalars[2].items()]

    def value(self, column: str, default: Any = REQUIRED) -> float:
        """A column of the table; NaN if it is empty, or if the case is not complete. Returns `default` if the column does not
        exist, without which KeyError is raised, and NotRecorded if that is unknown because no case is complete."""
        values = self.values
        if column in values:
            return values[column]
        if default is not REQUIRED:
            return default
        known = [c.name for c in (self.sweep.columns if self.sweep is not None else [])] or [c.name for c in self.columns]
        if column not in known:
            raise KeyError(f"{column} is not a column{suggestion(column, known)}")
        return math.nan

    @property
    def warnings(self) -> list[dict[str, str]]:
        """The stored warnings: `severity` (`error`: the readings are not valid), `key` and `message`. Raises NotRecorded."""
        row = self._row
        if row.get("status") == "complete" and self.has_file:
            return row["warnings"]
        return json.loads(self.attributes.get("warnings") or "[]")

    @property
    def is_valid(self) -> bool:
        """Whether no warning states that the readings are not valid. Raises NotRecorded if the case is not complete."""
        return all(warning["severity"] != "error" for warning in self.warnings)

    @property
    def validity(self) -> float:
        """1 if the readings are valid, 0 if they are not, and NaN if the case is not complete."""
        return float(self.is_valid) if self.status == "complete" else math.nan

    @property
    def ratio_validity(self) -> float:
        """The validity of ratios to the reference: 1 if the readings of both are valid."""
        reference = self.reference
        return min(self.validity, reference.validity) if reference is not None and reference.status == "complete" else self.validity

    # ---- the file

    def _file(self) -> Path:
        """The path of the file. Raises NotRecorded if the case is not complete."""
        if not self.has_file:
            raise NotRecorded(f"case {self.id} has no file: {self.reason}")
        self._warn_if_changed()
        return self.path

    def _warn_if_changed(self) -> None:
        """Warns once if another program has changed the file through HDF5."""
        if not self._is_checked:
            self._is_checked = True
            with contextlib.suppress(OSError):  # raised again when the file is read
                try:
                    if not checksum.has_line(self.path):
                        checksum.verify_case(self.path)
                except checksum.Damaged as error:
                    warnings.warn(f"{self.path} is damaged: {error}", NotValid, stacklevel=level_of_caller())

    @functools.cached_property
    def attributes(self) -> dict[str, Any]:
        """The attributes of the file, which describe its origin (docs/reference/case-files.md)."""
        return stored.attributes(self._file())

    @functools.cached_property
    def parameters(self) -> dict[str, Any]:
        """All parameters of the case in SI units. Raises tomllib.TOMLDecodeError if the text is damaged."""
        return parameters.nested_tables(self._parameters_text or self.attributes["case"])

    def parameters_text(self, *tables: str) -> str:
        """The text of these tables of the parameters: "load.modulation.trajectory" does not include those within it. Cases with
        equal texts have equal parameters in them; this is faster than `parameters` for thousands of cases."""
        found = parameters.sections(self._parameters_text or self.attributes["case"])
        return "\n".join(section for section in found if parameters.name_of(section) in tables)

    def setting(self, *keys: str, default: Any = REQUIRED) -> Any:
        """A parameter in SI units: case.setting("measure", "at_s"). Parameters of alternatives that are not used, and some that
        have their default, are not stored: `default` is returned for them, without which KeyError is raised."""
        node: Any = self.parameters
        for key in keys:
            if not isinstance(node, dict) or key not in node:
                if default is not REQUIRED:
                    return default
                known = list(node) if isinstance(node, dict) else []
                raise KeyError(f"the parameters of the case contain no {'.'.join(keys)}{suggestion(key, known)}; pass default= for a "
                               "parameter that is not always stored")
            node = node[key]
        return node

    def verify(self) -> None:
        """Reads the entire file, and records in `damage` what is wrong with it. Raises Damaged if it does not match its checksum
        or is not the file of this case, OSError if it cannot be read, and NotRecorded without a file."""
        self.damage, self._is_checked = "", True
        path = self._file()
        for name in ("_scalars", "attributes", "parameters", "groups", "series", "over_time", "focus"):
            self.__dict__.pop(name, None)  # read from a file that may have been replaced
        try:
            checksum.verify_case(path)
            if stored.attributes(path, ["case_id"])["case_id"] != self.id:
                raise ValueError("it contains another case")
            self.parameters
        except OSError as error:
            self.damage = first_line(error)
            raise
        except (RuntimeError, KeyError, ValueError, IndexError, TypeError) as error:
            self.damage = f"{path} is damaged: {first_line(error)}"
            raise checksum.Damaged(self.damage) from error

    @functools.cached_property
    def groups(self) -> list[str]:
        """The groups of the file, for example ["mean", "surface", "traces"]."""
        return stored.groups(self._file())

    def _read(self, read: Callable[..., Any], name: str, *arguments: Any) -> Any:
        """What a function reads of the file. Raises NotRecorded if the file does not contain `name`."""
        try:
            return read(self._file(), name, *arguments)
        except KeyError:
            raise self._not_recorded(name) from None

    def dimensions(self, group: str = "/") -> dict[str, tuple[str, ...]]:
        """The names of the variables of a group and of their dimensions. Raises NotRecorded."""
        return {name: item.dims for name, item in self._read(stored.items, group).items()}

    def units(self, group: str = "/") -> dict[str, str]:
        """The units of the variables of a group. Raises NotRecorded."""
        return {name: item.attributes.get("units", "") for name, item in self._read(stored.items, group).items()}

    def arrays(self, group: str = "/") -> dict[str, np.ndarray]:
        """All arrays of a group, read now. Raises NotRecorded if the case has no such group."""
        return self._read(stored.arrays, group)

    def array(self, name: str, index: Any = ()) -> np.ndarray:
        """An array, or the part that the index selects: case.array("surface/u_z", (-1, 0)). Raises NotRecorded."""
        return self._read(stored.array, name, index)

    def snapshot(self, index: int = -1) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
        """Recorded surface number `index`, read now: t in s, x and y in m, and u_z(x, y) in m. Raises NotRecorded."""
        try:
            return stored.snapshot(self._file(), index)
        except (KeyError, IndexError):
            raise self._not_recorded("surface") from None

    def _not_recorded(self, name: str) -> NotRecorded:
        how = HOW.get(name.split("/")[0])
        return NotRecorded(f"case {self.id} contains no {name}" + (f": {how}" if how else ""))

    def dataset(self, group: str = "/") -> xr.Dataset:
        """A group of the file as a Dataset that is read when its values are needed. Its attribute `valid` is 0 if the readings of
        the case are not valid, which NotValid warns of, else 1. Raises NotRecorded."""
        from .lazy import of_group
        found = self._read(of_group, group)
        warn_of_invalid([self.warnings], f"case {self.id} is", stacklevel=3)
        return found.assign_attrs(case=self.id, valid=int(self.is_valid))

    @functools.cached_property
    def series(self) -> xr.Dataset:
        """The quantities over time: measures (depth, time), position of the focus in m and force in N (time)."""
        found = self.dataset()
        return found[[name for name, item in found.data_vars.items() if item.ndim]]

    @functools.cached_property
    def over_time(self) -> dict[str, np.ndarray]:
        """The quantities over time as arrays (time), measures at the first depth, read now. Raises NotRecorded."""
        return {name: values[0] if values.ndim == 2 else values for name, values in self.arrays().items() if name != "depth"}

    @functools.cached_property
    def focus(self) -> dict[str, np.ndarray]:
        """The time, the position of the focus and, if recorded, the force, as in `over_time`. Raises NotRecorded."""
        return stored.arrays(self._file(), "/", ("time", "focus_x", "focus_y", "force"))

    @property
    def surface(self) -> xr.DataArray:
        """The recorded displacement u_z in m (time, depth, x, y), positive into the tissue."""
        return self.dataset("surface")["u_z"]

    @property
    def traces(self) -> xr.DataArray:
        """The displacement u_z in m at the trace points (trace, time), with coordinates x and y in m."""
        found = self.dataset("traces")
        return found["u_z"].assign_coords(x=found["x"], y=found["y"])

    @property
    def volume(self) -> xr.Dataset:
        """The recorded volumes, one variable per component (time, z, y, x)."""
        return self.dataset("volume")

    def receptor_classes(self) -> np.ndarray:
        """The class of each afferent, for example "RA"."""
        return stored.receptor_classes(self._file())

    def receptor_colours(self) -> dict[str, str]:
        """The colours in which figures show the classes of receptors, for example {"RA": "#0072B2"}."""
        return stored.receptor_colours(self._file())

    @property
    def counted_s(self) -> float:
        """The time in which spikes count: the run, or the counted periods of a load that has always repeated."""
        periods = self.value("receptor_periods_1", math.nan)
        once_s = self.setting("time", "frames", default=math.nan) * self.setting("time", "interval_s", default=math.nan)
        return once_s if math.isnan(periods) else periods * once_s

    @property
    def afferents(self) -> pd.DataFrame:
        """One row per afferent: class (SA1, RA, PC), positions and depth in m, number of spikes, and mean rate in Hz."""
        import pandas as pd
        found = self.arrays("afferents")
        count = len(found["afferent"])
        rows = {name: values for name, values in found.items()
                if len(values) == count and name not in ("afferent", "spike", "spike_time")}
        rows["class"] = self.receptor_classes()
        for name in ("row", "spike_count"):
            rows[name] = found[name].astype(int)
        rows["rate_Hz"] = rows["spike_count"] / self.counted_s
        return pd.DataFrame(rows, index=pd.RangeIndex(count, name="afferent"))

    def spikes(self) -> pd.DataFrame:
        """One row per spike: the number of its afferent, the class of the afferent, and time_s."""
        import pandas as pd
        found = self.arrays("afferents")
        number = np.repeat(np.arange(len(found["afferent"])), found["spike_count"].astype(int))
        return pd.DataFrame({"afferent": number, "class": self.receptor_classes()[number], "time_s": found["spike_time"]})

    def _repr_html_(self) -> str:
        """Settings, and the values of the table, for notebooks."""
        import pandas as pd
        rows = [(axis_label(name), value) for name, value in (*self.settings.items(), *self.values.items())]
        table = pd.DataFrame(rows, columns=["name", "value"]).to_html(index=False)
        state = self.status if self.validity != 0.0 else "complete, not valid"
        return f"<p><b>Case {html.escape(self.id)}</b>: {html.escape(state)}</p>{table}"

    # ---- pictures

    @property
    def plot(self) -> Plot:
        """Draws this case: case.plot.surface(t), case.plot.wake()."""
        from .plot import Plot
        return Plot(self)

    def animate(self, **options: Any) -> Any:
        """The moving surface as a Matplotlib animation, see Plot.animate."""
        return self.plot.animate(**options)
