# SPDX-License-Identifier: BSD-3-Clause
"""Input files of import-kwave, made from the runs of k-Wave's pstdElastic3D in tests/data/pstd."""
import contextlib
import io
import os
import types
import unittest.mock

import h5py
import numpy

from program import ROOT
from shearwake.kwave import pstd_elastic_3d
from shearwake.kwave.main import main

DATA = ROOT / "tests" / "data" / "pstd"
POINTS = (48, 40, 32)
AXES = "xyz"
FIELDS = ["ux", "uy", "uz", "sxx", "syy", "szz", "sxy", "sxz", "syz"]


def put(group, name, value):
    """Stores a value as MATLAB does: with reversed indices, at least two dimensions, and text as character
    codes."""
    if isinstance(value, str):
        group[name] = numpy.array([[ord(letter)] for letter in value], dtype="u2")
        return
    value = numpy.asarray(value, dtype=float)
    group[name] = value.T if value.ndim > 1 else value.reshape(-1, 1) if value.ndim else value.reshape(1, 1)
    group[name].attrs["MATLAB_class"] = numpy.bytes_("double")


def save(path, structures):
    with h5py.File(path, "w") as file:
        words = file.create_group("#refs#")
        for name, fields in structures.items():
            group = file.create_group(name)
            for field, value in fields.items():
                if not isinstance(value, list):
                    put(group, field, value)
                    continue
                cells = group.create_dataset(field, (len(value), 1), dtype=h5py.ref_dtype)
                for number, word in enumerate(value):
                    put(words, f"{name}.{field}.{number}", word)
                    cells[number, 0] = words[f"{name}.{field}.{number}"].ref


def import_kwave(folder, *words):
    """Calls import-kwave in this process, since its start takes longer than the import of a small file. Returns the exit code and
    the output."""
    output, before = io.StringIO(), os.getcwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output), \
                unittest.mock.patch("sys.argv", ["import-kwave", *words]):
            return main(), output.getvalue()
    except SystemExit as end:
        return end.code, output.getvalue()
    finally:
        os.chdir(before)


def nodes_of(file, name):
    """The nodes of a dataset of indices, counted from 0."""
    points = [int(file[f"N{axis}"][0, 0, 0]) for axis in AXES]
    return numpy.stack(numpy.unravel_index(file[name][0, 0].astype(int) - 1, points, order="F"), axis=1)


def reference(run):
    """{traces, source_G, source_R, points_ijk0} of one of k-Wave's runs."""
    with h5py.File(DATA / f"{run}.h5", "r") as file:
        return {name: file[name][()] for name in ("traces", "source_G", "source_R", "points_ijk0")}


def structures_of(run, of):
    """That run as its user had it; corners of cuboids make the sensor."""
    mask = numpy.zeros(POINTS)
    mask[:, :, 13] = 1.0
    corners = of["points_ijk0"].astype(int).T + 1
    amplitude = 1e-3 * of["source_G"].ravel(order="F")
    return {
        "kgrid": {**{f"N{axis}": n for axis, n in zip("xyz", POINTS)}, "dx": 1e-3, "dy": 1e-3, "dz": 1e-3,
                  "dt": 1e-5, "Nt": 400},
        "medium": {"sound_speed_compression": 20.0, "sound_speed_shear": 5.0, "density": 1000.0},
        "source": {"u_mask": mask, "uz": amplitude[:, None] * of["source_R"][None, :],
                   "u_mode": "dirichlet" if "dirichlet" in run else "additive"},
        "sensor": {"mask": numpy.concatenate([corners, corners]), "record": ["p", "u"]},
        "options": {"PMLAlpha": 0.0 if "off" in run else 2.0},
    }


def at_half(values, axis):
    """Two-point means towards the next node; the last node keeps its value."""
    following = numpy.concatenate([values.take(range(1, values.shape[axis]), axis), values.take([-1], axis)], axis)
    return 0.5 * (values + following)


def at_edge(values, axes):
    """Four-point harmonic means; 0 next to a fluid. A node without a following node along one of the axes keeps its value."""
    with numpy.errstate(divide="ignore"):
        found = 1.0 / at_half(at_half(1.0 / values, axes[0]), axes[1])
    last = numpy.logical_or(*(numpy.arange(values.shape[a]).reshape([-1 if b == a else 1 for b in range(3)]) == values.shape[a] - 1 for a in axes))
    return numpy.where(last, values, found)


def matlab_order(mask):
    """The places in MATLAB's order (x fastest) of the nodes of a mask in C order."""
    nodes = numpy.argwhere(numpy.asarray(mask).T)[:, ::-1]
    return numpy.lexsort(nodes.T[::-1])


def in_matlab_order(kgrid, medium, source, sensor, **options):
    """The results of pstd_elastic_3d for rows of sources and the sensor in MATLAB's order."""
    source = types.SimpleNamespace(**vars(source))
    for mask, fields in (("u_mask", FIELDS[:3]), ("s_mask", FIELDS[3:])):
        if numpy.max(vars(source).get(mask, 0)) == 1:
            order = matlab_order(vars(source)[mask])
            for field, series in vars(source).items():
                if field in fields and numpy.ndim(series) == 2 and len(series) == len(order) > 1:
                    setattr(source, field, series[order])
    found = pstd_elastic_3d(kgrid, medium, source, sensor, quiet=True, **options)
    if isinstance(found, list) or numpy.ndim(sensor.mask) != 3:
        return found
    back = numpy.argsort(matlab_order(sensor.mask))
    return {name: values if values.ndim == 3 else values[back] for name, values in found.items()}
