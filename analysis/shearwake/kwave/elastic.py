# SPDX-License-Identifier: BSD-3-Clause
"""pstdElastic2D and pstdElastic3D of k-Wave as Python functions, which run the program `shearwake kwave`."""
from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Iterable, Sequence

import h5py
import numpy as np

from .. import program
from .layout import write_input
from .plane import in_space, is_plane
from .record import GRID, NAMES, SENSOR, flags_of
from .structures import BadInput, Structure
from .study import KNOWN, Study

AXES = "xyz"
Results = dict[str, np.ndarray] | list[dict[str, np.ndarray]]  # a list has one dictionary per cuboid
# Keywords and the options of pstdElastic3D.
OPTIONS = {"pml_size": "PMLSize", "pml_alpha": "PMLAlpha", "pml_inside": "PMLInside", "smooth": "Smooth", "smooth_p0": "Smooth",
           "multi_axial_pml_ratio": "MultiAxialPMLRatio", "scale_source_terms": "ScaleSourceTerms", "cart_interp": "CartInterp"}
REFUSED = ("time_reversal_boundary_data", "frequency_response")
# Options of k-wave-python about its processors and files.
IGNORED = {"use_kspace", "backend", "debug", "data_path", "binary_path"}
MUST_BE_OFF = ("use_fd", "use_finite_difference", "axisymmetric", "pml_auto", "save_to_disk_exit", "save_only")


def attribute(item: Any, name: str, default: Any = None) -> Any:
    """A field of a dictionary or object; k-wave-python raises NotImplementedError for some that its objects lack."""
    if isinstance(item, dict):
        return item.get(name, default)
    try:
        return getattr(item, name, default)
    except (NotImplementedError, TypeError, ValueError):
        return default


def structure(item: Any, name: str) -> Structure:
    """The fields of an object that pstdElastic3D has. Raises BadInput for another field with a value."""
    plain = item if isinstance(item, dict) else getattr(item, "__dict__", {})
    for field, value in plain.items():
        if field in REFUSED and value is not None and np.size(value) > 0:
            raise BadInput(f"{name}.{field} is not supported")
        if not field.startswith("_") and field not in KNOWN[name] and value is not None and np.size(value) > 0:
            raise BadInput(f"{name}.{field} is not a field that pstdElastic3D uses; the fields are {', '.join(sorted(KNOWN[name]))}")
    fields = {}
    for field in KNOWN[name]:
        value = attribute(item, field)
        if value is not None and np.size(value) > 0:  # an empty array as in MATLAB
            if np.iscomplexobj(value):
                if np.any(np.imag(value)):
                    raise BadInput(f"{name}.{field} contains complex numbers; pass their real part if that is meant")
                value = np.real(value)
            fields[field] = value if isinstance(value, str) else list(value) if field == "record" else np.asarray(value, dtype=float)
    return Structure(fields, name)


def grid_structure(kgrid: Any) -> Structure:
    fields: dict[str, Any] = {}
    for number, axis in enumerate(AXES):
        for name, of_all in (("N", "N"), ("d", "spacing")):
            value = attribute(kgrid, name + axis)
            everything = attribute(kgrid, of_all)
            if value is None and number < np.size(everything) <= 3 and everything is not None:
                value = np.ravel(everything)[number]
            fields[name + axis] = None if value is None else np.asarray(float(value))
    for name in ("dt", "Nt", "t_array"):
        value = attribute(kgrid, name)
        if value is not None:
            fields[name] = value if isinstance(value, str) else np.asarray(value, dtype=float)
    if "Nt" in fields and "dt" in fields:
        fields.pop("t_array", None)
    return Structure(fields, "kgrid")


def in_c_order(source: Structure) -> None:
    """Sorts the rows of signals, one per node, from C order of the mask into the order with x fastest."""
    for kind, fields in (("u", ("ux", "uy", "uz")), ("s", ("sxx", "syy", "szz", "sxy", "sxz", "syz"))):
        mask = source.values.get(f"{kind}_mask")
        if mask is None or mask.max() != 1:
            continue
        nodes = np.unravel_index(np.flatnonzero(mask.ravel(order="F")), mask.shape, order="F")
        rank = np.argsort(np.argsort(np.ravel_multi_index(nodes, mask.shape)))
        for field in fields:
            series = source.values.get(field)
            if series is not None and series.ndim == 2 and len(series) == len(rank) > 1:
                source.values[field] = series[rank]


def results_of(records: Iterable[str], axes: str) -> list[str]:
    """The names of the results of some records."""
    names = []
    for record in records:
        if record == "u_split_field":
            names += [f"u{a}_split_{part}" for a in axes for part in "ps"]
        else:
            names += [f"{record[0]}{a}{record[1:]}" for a in axes] if record[0] in "uI" else [record]
    return names


def read_results(file: h5py.File, study: Study, records: Iterable[str], order: str) -> Results:
    """A dictionary of the output file, or one for each cuboid."""
    grid = tuple(slice(f, f + n) for f, n in zip(study.first, study.points - 2 * study.first))
    names = results_of(sorted(records), AXES[:study.dimensions])

    def in_dimensions(values: h5py.Dataset) -> np.ndarray:
        return values[()].T if study.dimensions == 3 else values[()].T[:, :, 0]
    grid = grid[:study.dimensions]
    grids = {name: in_dimensions(file[name])[grid] for name in names if name.endswith(GRID)}
    names = [name for name in names if name not in grids]
    if study.cuboids is not None:
        results = [{name: in_dimensions(file[name][str(number)]) for name in names} for number in range(1, len(study.cuboids) + 1)]
        results[0].update(grids)
        return results
    found = {name: file[name][0].T for name in names}  # (point, time); one time for statistics
    found = {name: values[:, 0] if name.endswith((*SENSOR, "_avg")) else values for name, values in found.items()}
    if order == "C":
        rows = np.lexsort(study.sensor_nodes.T[::-1])
        found = {name: values[rows] for name, values in found.items()}
    return {**{name: np.ascontiguousarray(values) for name, values in found.items()}, **grids}


def computed(arguments: Sequence[str], ranks: int, launch: Sequence[str] | None, progress: bool, quiet: bool) -> None:
    """Runs the program, and shows its progress on one line and, unless quiet, its warnings. Raises ProgramError with its message."""
    with (tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors,
          program.start(arguments, ranks, launch, stdout=subprocess.PIPE, stderr=errors, encoding="utf-8", errors="replace",
                        preexec_fn=program.stop_with_caller) as running):
        assert running.stdout
        try:
            for line in running.stdout:
                share = line[:4].strip()
                if not quiet and line.startswith(("warning: ", "note: ")):
                    print(line, end="", flush=True)
                if progress and share.isdigit() and line[4:6] == " %":
                    print(f"\r[{'#' * (int(share) // 5):<20}] {share:>3} %", end="", flush=True)
            running.wait()
            errors.seek(0)
            said = errors.read()
        except BaseException:
            running.terminate()
            raise
    if progress:
        print(flush=True)
    if running.returncode != 0:
        raise program.error_of(running.returncode, said)


def ranks_of(value: Any) -> int:
    """A number of ranks: of the argument or of num_threads, which may be "all"."""
    if value == "all":
        return len(os.sched_getaffinity(0))
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < 1:
        raise BadInput(f"the number of ranks must be a whole number from 1 on, not {value!r}")
    return int(value)


def precision_of(cast: Any, precision: str) -> str:
    """The precision of `data_cast` or `dtype` if it is given: "off", "double", "single", also with "gpuArray-", or a type of NumPy."""
    if precision not in ("double", "single"):
        raise BadInput(f"precision must be 'double' or 'single', not {precision!r}")
    if cast is None:
        return precision
    name = cast.removeprefix("gpuArray-") if isinstance(cast, str) else np.dtype(cast).name
    found = {"off": precision, "double": "double", "float64": "double", "single": "single", "float32": "single"}.get(name)
    if found is None:
        raise BadInput(f"data_cast must be 'off', 'double' or 'single', not {cast!r}")
    return found


def device_of(options: dict[str, Any]) -> list[str]:
    """Takes the options device and device_num away; the arguments of the program for them."""
    device, number = options.pop("device", None) or "cpu", options.pop("device_num", None)
    if device not in ("cpu", "gpu"):
        raise BadInput(f"device must be 'cpu' or 'gpu', not {device!r}")
    if device == "cpu":
        return []
    if number is not None and (isinstance(number, bool) or not isinstance(number, (int, np.integer)) or number < 0):
        raise BadInput(f"device_num must be a whole number from 0 on, not {number!r}")
    return ["--device", "gpu", *([] if number is None else ["-g", str(number)])]


def study_options(options: dict[str, Any]) -> tuple[Structure, dict[str, Any]]:
    """The structure `options` of pstdElastic3D, and the other options."""
    given = dict(options)
    for name in MUST_BE_OFF:
        if given.pop(name, None):
            raise BadInput(f"{name} is not supported")
    fields: dict[str, Any] = {}
    for keyword, name in OPTIONS.items():
        value = given.pop(keyword, None)
        if value is not None:
            fields[name] = value if isinstance(value, str) else np.asarray(value, dtype=float)
    if "smooth_p0" in options and "smooth" not in options:
        fields["Smooth"] = np.array([float(fields["Smooth"]), 0.0, 0.0])
    if not given.pop("use_sg", True):
        raise BadInput("use_sg must be True: the grid is staggered")
    return Structure(fields, "options"), {name: value for name, value in given.items() if name not in IGNORED}


def solve(parts: dict[str, Structure], notes: list[str], order: str, ranks: int = 1, launch: Sequence[str] | None = None,
          precision: str = "double", quiet: bool = True, progress: bool = False, dimensions: int = 3,
          device: Sequence[str] = ()) -> Results:
    """The results of structures with the fields of pstdElastic3D or, in two dimensions, pstdElastic2D. Rows of sources and of the
    sensor are in C or F (Fortran) order of their masks. Raises BadInput and ProgramError."""
    if is_plane(parts["kgrid"]) != (dimensions == 2):
        raise BadInput(f"kgrid is not {'two' if dimensions == 2 else 'three'}-dimensional")
    if dimensions == 2:
        parts = in_space(parts)
    given = parts.pop("sensor", None) or Structure({}, "sensor")
    records = {"u" if name == "u_staggered" else name for name in given.texts("record", ["p"])}
    if unknown := records - set(NAMES):
        raise BadInput(f"sensor.record {sorted(unknown)[0]!r} is unknown; known are {', '.join(NAMES)}, u_staggered")
    if order == "C":
        in_c_order(parts["source"])
    start = np.asarray(np.round(given.number("record_start_index", 1.0)))
    sensor = {**given.values, "record_start_index": start, "record": sorted(records)}
    if "mask" not in given:  # all nodes of the user's grid
        sensor["mask"] = np.ones([max(1, int(parts["kgrid"].number(f"N{axis}"))) for axis in AXES])
    study = Study({**parts, "sensor": Structure(sensor, "sensor")}, notes)
    if not quiet:
        sizes = ", ".join(f"{size:g}" for size in study.layer_points[:dimensions])
        print(f"absorbing layer: {sizes} points, {'outside' if np.any(study.first) else 'inside'} the grid")
        for text in [f"warning: {warning}" for warning in study.warnings] + study.notes:
            print(text)
    with tempfile.TemporaryDirectory(prefix="shearwake-kwave-") as folder:
        write_input(Path(folder) / "in.h5", study)
        computed(["kwave", "-i", f"{folder}/in.h5", "-o", f"{folder}/out.h5", "-s", str(study.sensor_start), "--precision", precision,
                  "--output_precision", "double", *device, *flags_of(study.sensor_fields)], ranks, launch, progress, quiet)
        with h5py.File(f"{folder}/out.h5", "r", locking=False) as file:
            is_mask = np.ndim(given.values.get("mask", np.zeros((1, 1, 1)))) == 3  # places keep their order
            return read_results(file, study, study.sensor_fields, order if is_mask else "F")


def pstd_elastic_3d(kgrid: Any, medium: Any, source: Any, sensor: Any = None, *, ranks: int = 1, launch: Sequence[str] | None = None,
                    precision: str = "double", quiet: bool = False, progress: bool | None = None, **options: Any) -> Results:
    """Runs a simulation of k-Wave's pstdElastic3D with the program shearwake.

    kgrid, medium, source and sensor are objects of k-wave-python, namespaces or dictionaries with the fields of pstdElastic3D:
    Nx, Ny, Nz, dx, dy, dz [m], dt [s], Nt (or t_array); sound_speed_compression, sound_speed_shear [m/s], density [kg/m3],
    each a number or an array (Nx, Ny, Nz), alpha_coeff_compression, alpha_coeff_shear [dB/(MHz^2 cm)]; p0 [Pa], u_mask with ux,
    uy, uz [m/s], s_mask with sxx ... syz [Pa], u_mode, s_mode; mask, record, record_start_index. (A kWaveMedium cannot contain
    them.) A mask of the sensor has the shape of the grid, or contains corners (6, C) counted from 1, or points (3, N) in m, which
    are interpolated linearly in boxes (cart_interp="nearest": moved to nodes); without a mask all nodes are recorded.

    The defaults are those of pstdElastic3D in MATLAB, not those of kspaceFirstOrder: pml_size 10, pml_inside True, pml_alpha 2,
    multi_axial_pml_ratio 0.1, smooth (True, False, False) for p0, speeds and density, scale_source_terms True, record ["p"].
    Options that would change the result and are not supported are errors. `ranks` MPI ranks compute in "double" or "single"
    `precision`; `launch` replaces mpirun. device="gpu" computes on a GPU, device_num=N on the one with this number. `progress`
    (default: unless quiet) shows a bar.

    Returns a dictionary of float64: series (n, Nt) and statistics (n) of the n points, and values of the entire grid
    (Nx, Ny, Nz), without a layer that lies outside. With corners: a list of dictionaries, one per cuboid. Names: p, p_max, ...,
    ux, uy, uz for "u" at the staggered positions ("u_staggered" is a synonym; in kspaceFirstOrder "u" lies at the nodes),
    ux_non_staggered at the nodes, ux_split_p, ux_split_s, Ix, Ix_avg. Rows of sensor and sources are in C order of the mask (z
    fastest). Pressure belongs to the times n dt, velocities to
    (n - 1/2) dt, n = record_start_index, ...

    Raises ValueError for faults of the arguments, and ShearwakeError if the program fails."""
    return simulated(3, (kgrid, medium, source, sensor), options, ranks, launch, precision, quiet, progress)


def pstd_elastic_2d(kgrid: Any, medium: Any, source: Any, sensor: Any = None, *, ranks: int = 1, launch: Sequence[str] | None = None,
                    precision: str = "double", quiet: bool = False, progress: bool | None = None, **options: Any) -> Results:
    """Runs a simulation of k-Wave's pstdElastic2D with the program shearwake: plane strain in the plane x-y.

    The arguments are those of pstd_elastic_3d without the axis z: Nx, Ny, dx, dy; arrays (Nx, Ny); ux, uy, sxx,
    syy and sxy; a mask of the sensor with the shape of the grid, corners of rectangles (4, C), x1, y1, x2, y2 counted from 1, or
    points (2, N) in m. pml_size is 20 unless given; one or two numbers. The pressure is -(sxx + syy)/2.

    Returns the same results as pstd_elastic_3d without those of z: values of the entire grid (Nx, Ny), of rectangles (Cx, Cy, Nt).
    A rank computes the plane alone; more ranks have no use.

    Raises ValueError for faults of the arguments, and ShearwakeError if the program fails."""
    return simulated(2, (kgrid, medium, source, sensor), options, ranks, launch, precision, quiet, progress)


def simulated(dimensions: int, objects: Sequence[Any], options: dict[str, Any], ranks: Any, launch: Sequence[str] | None, precision: str,
              quiet: bool, progress: bool | None) -> Results:
    """The results of (kgrid, medium, source, sensor). Raises ValueError and ShearwakeError."""
    kgrid, medium, source, sensor = objects
    try:
        fields, others = study_options(options)
        dtype, cast = others.pop("dtype", None), others.pop("data_cast", None)
        precision = precision_of(dtype if cast is None else cast, precision)
        device, threads = device_of(others), others.pop("num_threads", None)
        ranks = 1 if device else ranks_of(ranks if threads is None else threads)
        if others:
            raise BadInput(f"unknown option: {', '.join(sorted(others))}; the options are {', '.join(sorted([*OPTIONS, 'device', 'device_num']))}")
        parts = {"kgrid": grid_structure(kgrid), "medium": structure(medium, "medium"), "source": structure(source, "source"),
                 "sensor": structure(sensor or {}, "sensor"), "options": fields}
        return solve(parts, [], "C", ranks, launch, precision, quiet, not quiet if progress is None else progress, dimensions, device)
    except BadInput as error:
        raise ValueError(str(error)) from error
