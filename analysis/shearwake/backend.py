# SPDX-License-Identifier: BSD-3-Clause
"""Output folders and case files for xarray: xarray.open_dataset("out/quickstart", engine="shearwake")."""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Iterable

import xarray as xr
from xarray.backends import BackendEntrypoint

from .sweep import open_case, open_sweep


class Backend(BackendEntrypoint):
    """Opens an output folder, with all columns of its table or the `names` of Sweep.dataset, or a group of a case file."""

    description = "Output folders and case files of shearwake"
    open_dataset_parameters = ("filename_or_obj", "drop_variables", "names", "group")

    def open_dataset(self, filename_or_obj: Any, *, drop_variables: str | Iterable[str] | None = None,  # type: ignore[override]
                     names: Iterable[str] = (), group: str = "/") -> xr.Dataset:
        """See Sweep.dataset and Case.dataset for the errors."""
        path = Path(os.fspath(filename_or_obj))
        if path.is_dir():
            sweep = open_sweep(path)
            found = sweep.dataset(*(names or [column.name for column in sweep.columns]))
        else:
            found = open_case(path).dataset(group)
        dropped = [drop_variables] if isinstance(drop_variables, str) else list(drop_variables or ())
        return found.drop_vars(dropped, errors="ignore")

    def guess_can_open(self, filename_or_obj: Any) -> bool:
        """Whether this is an output folder. Case files are netCDF-4 files too, which other engines read."""
        return isinstance(filename_or_obj, (str, os.PathLike)) and (Path(filename_or_obj) / "plan.json").is_file()
