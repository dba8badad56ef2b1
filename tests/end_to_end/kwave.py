# SPDX-License-Identifier: BSD-3-Clause
"""Input files of import-kwave, made from the runs of k-Wave's pstdElastic3D in tests/data/pstd."""
import contextlib
import io
import os
import unittest.mock

import h5py
import numpy

from program import ROOT
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
    said, before = io.StringIO(), os.getcwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), \
                unittest.mock.patch("sys.argv", ["import-kwave", *words]):
            return main(), said.getvalue()
    except SystemExit as end:
        return end.code, said.getvalue()
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


def layer(points, size, strength, speed_m_s, spacing_m, step_s, offset):
    """The factors of an absorbing layer along one axis, at nodes (offset 0) or half points (1/2)."""
    factors, q = numpy.ones(points), numpy.arange(1, size + 1)
    for place, depth in ((q - 1, size + 1 - q - offset), (points - size + q - 1, q + offset)):
        factors[place] = numpy.exp(-0.5 * step_s * strength * speed_m_s / spacing_m * (depth / size) ** 4)
    return factors


def elastic_file(path, points, spacing_m, step_s, steps, medium, source, sensor, pml_size=4, pml_alpha=2.0, ratio=0.1):
    """Writes the elastic input file that pstdElastic3D writes with 'SaveToDisk' for structures like its own, with the layer inside. The sensor
    is a mask or corners (6, C)."""
    c_p, c_s, rho = (numpy.broadcast_to(numpy.asarray(medium[name], dtype=float), points) for name in
                     ("sound_speed_compression", "sound_speed_shear", "density"))
    mu = rho * c_s ** 2
    lossy = "alpha_coeff_shear" in medium
    fields = {"lambda": rho * c_p ** 2 - 2.0 * mu, "mu": mu, **{f"rho0_sg{a}": at_half(rho, n) for n, a in enumerate(AXES)}}
    if lossy:
        neper = 100.0 * (1e-6 / (2.0 * numpy.pi)) ** 2 / (20.0 * numpy.log10(numpy.e))
        fields["eta"] = 2.0 * rho * c_s ** 3 * neper * medium["alpha_coeff_shear"]
        fields["chi"] = 2.0 * rho * c_p ** 3 * neper * medium["alpha_coeff_compression"] - 2.0 * fields["eta"]
    for name in ("mu", "eta") if lossy else ("mu",):
        fields.update({f"{name}_sg{AXES[a]}{AXES[b]}": at_edge(fields[name], (a, b)) for a, b in ((0, 1), (0, 2), (1, 2))})
    integers = {"Nt": steps, "elastic_flag": 1, "absorbing_flag": int(lossy), "sensor_mask_type": int(numpy.ndim(sensor) == 2), **dict.fromkeys((
        "p_source_flag", "p0_source_flag", "transducer_source_flag", "nonlinear_flag", "axisymmetric_flag", "nonuniform_grid_flag"), 0)}
    numbers = {"dt": step_s, "c_ref": c_p.max()}
    for n, a in enumerate(AXES):
        integers[f"N{a}"], numbers[f"d{a}"] = points[n], spacing_m[n]
        integers[f"pml_{a}_size"], numbers[f"pml_{a}_alpha"] = pml_size, numpy.broadcast_to(pml_alpha, 3)[n]
        k = 2.0 * numpy.pi * numpy.fft.fftfreq(points[n], spacing_m[n])
        half = k[:points[n] // 2 + 1]
        shape = [-1 if b == 2 - n else 1 for b in range(3)]
        used, ending = (half, "_r") if n == 0 else (k, "")
        for name, values in ((f"dd{a}_k_shift_pos{ending}", 1j * used * numpy.exp(0.5j * used * spacing_m[n])),
                             (f"dd{a}_k_shift_neg{ending}", 1j * used * numpy.exp(-0.5j * used * spacing_m[n])),
                             (f"{a}_shift_neg_r", numpy.exp(-0.5j * half * spacing_m[n]))):
            fields[name] = numpy.stack([values.real, values.imag], axis=1).reshape(shape)
        for name, share in (("pml", 1.0), ("mpml", ratio)):
            for ending, offset in (("", 0.0), (f"_sg{a}", 0.5)):
                fields[f"{name}_{a}{ending}"] = layer(points[n], pml_size, share * numbers[f"pml_{a}_alpha"], c_p.max(), spacing_m[n], step_s,
                                                      offset).reshape(shape)
    lists = {"sensor_mask_corners": numpy.transpose(sensor)[None]} if numpy.ndim(sensor) == 2 else \
        {"sensor_mask_index": numpy.flatnonzero(sensor.ravel(order="F"))[None, None] + 1}
    source = dict(source)
    if "p0" in source:  # two samples of a stress at all nodes
        p0 = source.pop("p0")
        integers["p0_source_flag"], fields["p0_source_input"] = 1, p0
        source.update(s_mask=numpy.ones(points), **dict.fromkeys(("sxx", "syy", "szz"), -0.5 * p0.ravel(order="F")[:, None] * [1.0, 1.0]))
    for kind, names in (("u", FIELDS[:3]), ("s", FIELDS[3:])):
        is_fixed = source.get(f"{kind}_mode") == "dirichlet"
        for name in names:
            series = source.get(name)
            integers[f"{name}_source_flag"] = 0 if series is None else series.shape[1]
            if series is None:
                continue
            at = numpy.flatnonzero(source[f"{kind}_mask"].ravel(order="F"))
            lists[f"{kind}_source_index"] = at[None, None] + 1
            integers[f"{kind}_source_mode"], integers[f"{kind}_source_many"] = (0 if is_fixed else 2 if kind == "u" else 1), int(len(series) > 1)
            scale = 1.0 if is_fixed or integers["p0_source_flag"] and kind == "s" else \
                2.0 * step_s * c_p.ravel(order="F")[at[:len(series)], None] / (spacing_m[AXES.index(name[1])] if kind == "u" else spacing_m[0])
            fields[f"{name}_source_input"] = (scale * series / (3.0 if kind == "s" else 1.0)).T[None]
    with h5py.File(path, "w") as file:
        for name, value in {"file_type": "input", "major_version": "1", "minor_version": "2", "created_by": "test", "file_description": "test",
                            "creation_date": "25-Nov-2026-14-27-14"}.items():
            file.attrs[name] = numpy.bytes_(value)
        for kind, values in (("long", {**integers, **lists}), ("float", {**numbers, **fields})):
            for name, value in values.items():
                value = numpy.asarray(value, dtype="u8" if kind == "long" else "f4")
                value = value.transpose() if value.shape == tuple(points) else value.reshape((1, 1, 1)) if value.ndim == 0 else value
                file[name] = value
                file[name].attrs["data_type"] = numpy.bytes_(kind)
                file[name].attrs["domain_type"] = numpy.bytes_("complex" if "shift" in name else "real")
