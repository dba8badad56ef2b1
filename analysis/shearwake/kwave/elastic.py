# SPDX-License-Identifier: BSD-3-Clause
"""pstdElastic3D of k-Wave as a Python function, which runs the program `shearwake kwave`."""
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

from .. import program
from .main import write_study
from .record import GRID, KWAVE, SENSOR, flags_of
from .structures import BadInput, Structure
from .study import KNOWN, Study, three

AXES = "xyz"
# Keywords and the options of pstdElastic3D.
OPTIONS = {"pml_size": "PMLSize", "pml_alpha": "PMLAlpha", "pml_inside": "PMLInside", "smooth": "Smooth", "smooth_p0": "Smooth",
           "multi_axial_pml_ratio": "MultiAxialPMLRatio", "scale_source_terms": "ScaleSourceTerms", "cart_interp": "CartInterp"}
REFUSED = ("time_reversal_boundary_data", "frequency_response")
# Options of k-wave-python about its processors and files.
IGNORED = {"use_kspace", "backend", "device", "debug", "device_num", "data_path", "save_only", "binary_path"}
# The names in SimulationOptions of k-wave-python.
DEPRECATED = {"pml_size": "pml_size", "pml_alpha": "pml_alpha", "pml_inside": "pml_inside", "smooth_p0": "smooth_p0",
              "multi_axial_PML_ratio": "multi_axial_pml_ratio", "scale_source_terms": "scale_source_terms",
              "cart_interp": "cart_interp", "data_cast": "data_cast", "use_sg": "use_sg"}


def attribute(item, name, default=None):
    """A field of a dictionary or object; k-wave-python raises NotImplementedError for some that its objects lack."""
    if isinstance(item, dict):
        return item.get(name, default)
    try:
        return getattr(item, name, default)
    except (NotImplementedError, TypeError, ValueError):
        return default


def structure(item, name):
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
        if value is not None:
            fields[field] = value if isinstance(value, str) else list(value) if field == "record" else np.asarray(value, dtype=float)
    return Structure(fields, name)


def grid_structure(kgrid):
    fields = {}
    for number, axis in enumerate(AXES):
        for name, of_all in (("N", "N"), ("d", "spacing")):
            value = attribute(kgrid, name + axis)
            everything = attribute(kgrid, of_all)
            if value is None and np.size(everything) == 3:
                value = np.ravel(everything)[number]
            fields[name + axis] = None if value is None else np.asarray(float(value))
    for name in ("dt", "Nt", "t_array"):
        value = attribute(kgrid, name)
        if value is not None:
            fields[name] = value if isinstance(value, str) else np.asarray(value, dtype=float)
    if "Nt" in fields and "dt" in fields:
        fields.pop("t_array", None)
    return Structure(fields, "kgrid")


def in_c_order(source):
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


def results_of(records):
    """The names of the results of some records."""
    names = []
    for record in records:
        if record == "u_split_field":
            names += [f"u{a}_split_{part}" for a in AXES for part in "ps"]
        else:
            names += [f"{record[0]}{a}{record[1:]}" for a in AXES] if record[0] in "uI" else [record]
    return names


def read_results(file, study, records, order):
    """A dictionary of the output file, or one for each cuboid."""
    grid = tuple(slice(f, f + n) for f, n in zip(study.first, study.points - 2 * study.first))
    names = results_of(sorted(records))
    whole = {name: file[name][()].T[grid] for name in names if name.endswith(GRID)}
    flat = {name: file[name][0].T for name in names if name not in whole}  # (point, time); one time for statistics
    flat = {name: values[:, 0] if name.endswith((*SENSOR, "_avg")) else values for name, values in flat.items()}
    if study.cuboids is None:
        if order == "C":
            rows = np.lexsort(study.sensor_nodes.T[::-1])
            flat = {name: values[rows] for name, values in flat.items()}
        return {**{name: np.ascontiguousarray(values) for name, values in flat.items()}, **whole}
    results, first = [], 0
    for box in study.cuboids:
        shape = tuple(box[3:] - box[:3] + 1)
        part = slice(first, first := first + int(np.prod(shape)))
        results.append({name: values[part].reshape(*shape, *values.shape[1:], order="F") for name, values in flat.items()})
    results[0].update(whole)
    return results


def computed(arguments, ranks, launch, progress):
    """Runs the program and shows its progress on one line. Raises ProgramError with its message."""
    with subprocess.Popen(program.launched(arguments, ranks, launch), env=program.environment(), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", errors="replace") as running:
        try:
            for line in running.stdout:
                share = line[:4].strip()
                if progress and share.isdigit() and line[4:6] == " %":
                    print(f"\r[{'#' * (int(share) // 5):<20}] {share:>3} %", end="", flush=True)
            said = running.stderr.read()
        except BaseException:
            running.terminate()
            raise
    if progress:
        print(flush=True)
    if running.returncode != 0:
        raise program.error_of(running.returncode, said)


def study_options(options, simulation_options):
    """The structure `options` of pstdElastic3D, and the other options."""
    given = {}
    for name, keyword in DEPRECATED.items():
        value = attribute(simulation_options, name)
        if value is not None and not callable(value):
            given[keyword] = value
    given.update(options)
    fields = {}
    for keyword, name in OPTIONS.items():
        value = given.pop(keyword, None)
        if value is not None:
            fields[name] = value if isinstance(value, str) else np.asarray(value, dtype=float)
    if "smooth" not in options and "Smooth" in fields:
        fields["Smooth"] = np.array([float(fields["Smooth"]), 0.0, 0.0])  # of smooth_p0
    if not given.pop("use_sg", True):
        raise BadInput("use_sg must be True: the grid is staggered")
    return Structure(fields, "options"), {name: value for name, value in given.items() if name not in IGNORED}


def solve(parts, notes, order, ranks=1, launch=None, precision="double", quiet=True, progress=False):
    """The results of structures with the fields of pstdElastic3D. Rows of sources and of the sensor are in C or F (Fortran) order
    of their masks. Raises BadInput and ProgramError."""
    given = parts.pop("sensor", None) or Structure({}, "sensor")
    records = {"u" if name == "u_staggered" else name for name in given.texts("record", ["p"])}
    if unknown := records - set(KWAVE):
        raise BadInput(f"sensor.record {sorted(unknown)[0]!r} is unknown; known are {', '.join(KWAVE)}, u_staggered")
    if order == "C":
        in_c_order(parts["source"])
    start = np.asarray(np.round(given.number("record_start_index", 1.0)))
    sensor = {**given.values, "record_start_index": start, "record": sorted(records)}
    study = Study({**parts, "sensor": Structure(sensor, "sensor")}, notes)
    if "mask" not in given:  # all nodes of the user's grid
        study.sensor_nodes = np.argwhere(np.ones((study.points - 2 * study.first)[::-1]))[:, ::-1] + study.first
    records &= set(study.sensor_fields)
    if not quiet:
        sizes = three(study.layer_points, "PMLSize")
        print(f"absorbing layer: {sizes[0]:g}, {sizes[1]:g}, {sizes[2]:g} points, {'outside' if np.any(study.first) else 'inside'} the grid")
        for text in [f"warning: {warning}" for warning in study.warnings] + study.notes:
            print(text)
    with tempfile.TemporaryDirectory(prefix="shearwake-kwave-") as folder:
        write_study(Path(folder) / "in.h5", study)
        computed(["kwave", "-i", f"{folder}/in.h5", "-o", f"{folder}/out.h5", "-s", str(study.sensor_start), "--precision", precision,
                  "--output_precision", "double", *flags_of(records)], ranks, launch, progress)
        with h5py.File(f"{folder}/out.h5", "r") as file:
            is_mask = np.ndim(given.values.get("mask", np.zeros((1, 1, 1)))) == 3  # places keep their order
            return read_results(file, study, records, order if is_mask else "F")


def pstd_elastic_3d(kgrid, medium, source, sensor=None, simulation_options=None, execution_options=None, *, ranks=1, launch=None,
                    precision="double", quiet=False, progress=None, **options):
    """Runs a simulation of k-Wave's pstdElastic3D with the program shearwake.

    kgrid, medium, source and sensor are objects of k-wave-python, namespaces or dictionaries with the fields of pstdElastic3D:
    Nx, Ny, Nz, dx, dy, dz [m], dt [s], Nt (or t_array); sound_speed_compression, sound_speed_shear [m/s], density [kg/m3],
    each a number or an array (Nx, Ny, Nz), alpha_coeff_compression, alpha_coeff_shear [dB/(MHz^2 cm)]; p0 [Pa], u_mask with ux,
    uy, uz [m/s], s_mask with sxx ... syz [Pa], u_mode, s_mode; mask, record, record_start_index. (A kWaveMedium cannot contain
    them.) A mask of the sensor has the shape of the grid, or contains corners (6, C) counted from 1, or points (3, N) in m, which
    are interpolated linearly in boxes (cart_interp="nearest": moved to nodes); without a mask all nodes are recorded.

    The defaults are those of pstdElastic3D in MATLAB, not those of kspaceFirstOrder: pml_size 10, pml_inside True, pml_alpha 2,
    multi_axial_pml_ratio 0.1, smooth (True, False, False) for p0, speeds and density, scale_source_terms True, record ["p"].
    The arguments of the deprecated interface, (kgrid, source, sensor, medium, simulation_options, execution_options), are recognised
    by their fields. `ranks` MPI ranks compute in "double" or "single" `precision`; `launch` replaces mpirun. `progress` (default:
    unless quiet) shows a bar.

    Returns a dictionary of float64: series (n, Nt) and statistics (n) of the n points, and values of the entire grid
    (Nx, Ny, Nz), without a layer that lies outside. With corners: a list of dictionaries, one per cuboid. Names: p, p_max, ...,
    ux, uy, uz for "u" at the staggered positions ("u_staggered" is a synonym; in kspaceFirstOrder "u" lies at the nodes),
    ux_non_staggered at the nodes, ux_split_p, ux_split_s, Ix, Ix_avg. Rows of sensor and sources are in C order of the mask (z
    fastest), and with the deprecated order of arguments in Fortran order. Pressure belongs to the times n dt, velocities to
    (n - 1/2) dt, n = record_start_index, ...

    Raises ValueError for faults of the arguments, and ShearwakeError if the program fails."""
    order = "C"
    if attribute(sensor, "sound_speed_shear") is not None:
        medium, source, sensor, order = sensor, medium, source, "F"
    try:
        fields, others = study_options(options, simulation_options)
        cast = others.pop("data_cast", None) or others.pop("dtype", None)
        if cast is not None and np.dtype({"off": "float64"}.get(cast, cast) if isinstance(cast, str) else cast) == np.float32:
            precision = "single"
        ranks = others.pop("num_threads", None) or attribute(execution_options, "num_threads") or ranks
        if others:
            raise BadInput(f"unknown option: {', '.join(sorted(others))}; the options are {', '.join(sorted(OPTIONS))}")
        parts = {"kgrid": grid_structure(kgrid), "medium": structure(medium, "medium"), "source": structure(source, "source"),
                 "sensor": structure(sensor or {}, "sensor"), "options": fields}
        return solve(parts, [], order, int(ranks), launch, precision, quiet, not quiet if progress is None else progress)
    except BadInput as error:
        raise ValueError(str(error)) from error
