# SPDX-License-Identifier: BSD-3-Clause
"""Datasets of xarray over the cases of a sweep, which are read when their values are needed."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Sequence

import numpy as np
import xarray as xr

from . import stored
from .case import Case, SweepInterface
from .errors import HOW, NotRecorded, suggestion
from .keys import cf_unit, described, follows, label, short_keys, split_unit, typed
from .lazy import Cells, axis_of, lazy, union

MAIN = {"traces": "u_z", "surface": "u_z", "mean": "u_z_squared"}  # the variable that the name of a group stands for
OWN_TIME = ("surface", "volume")  # groups whose times are not those of the quantities over time


@dataclass
class Grid:
    """The cases on a grid of swept keys: `cells` is an array of cases or None, `dims` its dimensions, `coordinates` the
    values of all swept keys."""

    cells: np.ndarray
    dims: list[str]
    coordinates: dict[str, xr.Variable]


def values_of(cases: Sequence[Case], key: str) -> list[Any]:
    """The values of a key, numbers ascending, others in the order of the plan."""
    found = list(dict.fromkeys(case.settings.get(key) for case in cases))
    is_number = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in found)
    return sorted(found) if is_number else found


def typed_array(values: Sequence[Any]) -> np.ndarray:
    """Swept values with their types in the job: numbers, bool, text, or objects, which are tuples for lists."""
    found = np.empty(len(values), dtype=object)
    for n, value in enumerate(values):
        found[n] = typed(value)
    return found if any(isinstance(value, tuple) for value in found) else np.array(found.tolist())


def key_attributes(key: str) -> dict[str, str]:
    return {"key": key, "long_name": label(key), **({"units": cf_unit(unit)} if (unit := split_unit(key)[1]) else {})}


def grid_of(sweep: SweepInterface, cases: Sequence[Case]) -> Grid:
    """Arranges the cases. A key that follows from another one is a coordinate of the dimension of that key."""
    names = short_keys(sweep.swept_keys)
    chief: dict[str, str] = {}  # key -> the key of its dimension
    for key in sweep.swept_keys:
        chief[key] = next((other for other in sweep.swept_keys[: sweep.swept_keys.index(key)]
                           if chief[other] == other and follows((case.settings for case in cases), key, other)), key)
    keys = [key for key in sweep.swept_keys if chief[key] == key]
    values = {key: values_of(cases, key) for key in keys}
    place = {key: {value: n for n, value in enumerate(values[key])} for key in keys}
    cells = np.full([len(values[key]) for key in keys], None, dtype=object)
    for case in cases:
        cells[tuple(place[key][case.settings.get(key)] for key in keys)] = case
    coordinates = {names[key]: xr.Variable([names[key]], typed_array(values[key]), key_attributes(key)) for key in keys}
    for key in sweep.swept_keys:
        if chief[key] != key:
            of = {case.settings.get(chief[key]): case.settings.get(key) for case in cases}
            coordinates[names[key]] = xr.Variable([names[chief[key]]], typed_array([of[value] for value in values[chief[key]]]),
                                                  key_attributes(key))
    return Grid(cells, [names[key] for key in keys], coordinates)


def layout_of(case: Case) -> str:
    """The part of the parameters that determines the axes of the file: cases with equal texts have equal axes."""
    return case.parameters_text("domain", "time", "record", "measure")


class Builder:
    """Adds variables to a Dataset over a grid of cases."""

    def __init__(self, grid: Grid, complete: Sequence[Case]) -> None:
        self.grid, self.complete = grid, complete
        self.examples = list({layout_of(case): case for case in reversed(complete)}.values())[::-1]
        self.files = np.full(grid.cells.shape, None, dtype=object)
        for cell, case in np.ndenumerate(grid.cells):
            if case is not None and case.has_file:
                self.files[cell] = case.path
        self.coordinates: dict[str, xr.Variable] = dict(grid.coordinates)
        self.variables: dict[str, xr.Variable] = {}
        self.items: dict[str, dict[str, stored.Item]] = {}

    def items_of(self, group: str) -> dict[str, stored.Item]:
        """The variables of a group in the first complete case that has it. Raises NotRecorded."""
        if not self.complete:
            raise NotRecorded("no case is complete; run the job first")
        for case in self.complete if group not in self.items else ():
            try:
                self.items[group] = stored.items(case.path, group)
                break
            except KeyError:
                continue
        if group not in self.items:
            raise self.complete[0]._not_recorded(group)
        return self.items[group]

    def axis_values(self, path: str, length: int) -> np.ndarray:
        """The values on an axis of a file, united over cases with different grids."""
        found = []
        for case in self.examples:
            with stored.opened(case.path) as file:
                if path in file or case is self.complete[0]:
                    found.append(axis_of(file, path, length))
        return union(found, path)

    def axis(self, item: stored.Item, number: int, group: str) -> tuple[str, np.ndarray]:
        """The name and the values of an axis in the Dataset."""
        name, path = item.dims[number], item.axis_paths[number]
        values = self.axis_values(path, item.shape[number])
        wanted = f"{group}_{name}" if group in OWN_TIME and name == "time" else name
        known = self.coordinates.get(wanted)
        if known is not None and not (known.shape == values.shape and np.allclose(known.values, values, rtol=1e-9, atol=0)):
            wanted = f"{group.strip('/') or 'case'}_{name}"
        if wanted not in self.coordinates:
            described = self.items_of(group).get(name)
            self.coordinates[wanted] = xr.Variable([wanted], values, described.attributes if described else {})
        return wanted, values

    def add(self, name: str, group: str, variable: str) -> None:
        """Adds a variable of the files under a name."""
        item = self.items_of(group).get(variable)
        if item is None:
            raise KeyError(f"the cases contain no {group.strip('/')}{'/' if group != '/' else ''}{variable}"
                           f"{suggestion(variable, list(self.items_of(group)))}")
        axes = [self.axis(item, n, group) for n in range(len(item.dims))]
        array = Cells(self.files, item.path, list(item.axis_paths), [values for _, values in axes])
        self.variables[name] = lazy(array, [*self.grid.dims, *(dim for dim, _ in axes)], item.attributes)

    def add_traces_places(self) -> None:
        """The positions of the trace points of the first complete case as coordinates."""
        for axis in "xy":
            item = self.items_of("traces")[axis]
            self.coordinates[f"trace_{axis}"] = xr.Variable(["trace"], self.complete[0].array(f"traces/{axis}"),
                                                            item.attributes)


def of_cells(grid: Grid, value: Callable[[Case], float], attributes: dict[str, Any]) -> xr.Variable:
    """A number of each case; NaN in cells without a case."""
    values = np.array([math.nan if case is None else value(case) for case in grid.cells.flat], dtype=float)
    return xr.Variable(grid.dims, values.reshape(grid.cells.shape), attributes)


def of_sweep(sweep: SweepInterface, names: Sequence[str], references: bool) -> xr.Dataset:
    """See Sweep.dataset."""
    grid = grid_of(sweep, sweep.cases)
    if references:
        for cell, case in np.ndenumerate(grid.cells):
            grid.cells[cell] = case.reference if case is not None else None
    builder = Builder(grid, [case for case in grid.cells.flat if case is not None and case.has_file])
    for name in names:
        add_named(builder, sweep, name)
    has_ratios = not {c.name for c in sweep.columns if c.over_reference_of}.isdisjoint(names)
    judged = list(builder.complete)
    flags: dict[str, Callable[[Case], float]] = {"valid": lambda case: case.validity}
    if has_ratios:
        judged += [case.reference for case in builder.complete if case.reference is not None]
        flags = {"valid": lambda case: case.ratio_validity, "valid_case": lambda case: case.validity}
    sweep.warn_of_invalid({case.id: case for case in judged}.values(), stacklevel=4)
    for name, value in flags.items():
        builder.variables[name] = of_cells(grid, value, {
            "standard_name": "quality_flag", "long_name": "validity of the readings",
            "description": "1: the readings are valid, 0: they are not, NaN: no result",
            "flag_values": [0, 1], "flag_meanings": "not_valid valid"})
    return xr.Dataset(builder.variables, builder.coordinates)


def add_named(builder: Builder, sweep: SweepInterface, name: str) -> None:
    """Adds what a name of Sweep.dataset stands for. Raises KeyError and NotRecorded."""
    column = next((c for c in sweep.columns if c.name == name), None)
    if column is not None:
        builder.variables[name] = of_cells(builder.grid, lambda case: case.value(name), described(name, column.unit, column.meaning))
        return
    group, _, variable = name.partition("/")
    if variable:
        builder.add(name.replace("/", "_"), group, variable)
        return
    root = builder.items_of("/")
    series = name if name in root else name.removesuffix("_t")
    if series in root:
        builder.add(name, "/", series)
    elif name in MAIN:
        builder.add(name, name, MAIN[name])
    else:
        groups = builder.complete[0].groups
        if name not in groups:
            if name in HOW:
                raise builder.complete[0]._not_recorded(name)
            known = list(dict.fromkeys([*(c.name for c in sweep.columns), *root, *groups]))
            raise KeyError(f"{name} is not a column, a quantity over time or a group{suggestion(name, known)}")
        for variable, item in builder.items_of(name).items():
            if item.dims != (variable,):
                builder.add(f"{name}_{variable}", name, variable)
    if name == "traces":
        builder.add_traces_places()
