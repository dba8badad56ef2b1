# SPDX-License-Identifier: BSD-3-Clause
"""The elastic input file of k-Wave, which pstdElastic3D writes with 'SaveToDisk', with real numbers of 64 bits.

Their data_type is "double", where k-Wave writes "float" for 32 bits. The sensor_mask_type 2 adds sensor_mask_weights, (1, points, n),
for points that are weighted sums of n nodes each. A plane, which k-Wave does not write, has Nz = 1 and no layer along z."""
from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .record import FIELDS
from .study import Study

AXES = "xyz"
PLANES = ((0, 1), (0, 2), (1, 2))  # of sxy, sxz, syz
WITHOUT = ("p_source_flag", "transducer_source_flag", "nonlinear_flag", "axisymmetric_flag", "nonuniform_grid_flag")


def following(values: np.ndarray, axis: int) -> np.ndarray:
    """The values of the next nodes; the last node is its own."""
    return np.concatenate([values.take(range(1, values.shape[axis]), axis), values.take([-1], axis)], axis)


def half_point_mean(values: np.ndarray, axis: int) -> np.ndarray:
    return 0.5 * (values + following(values, axis)) if values.shape else values


def edge_mean(values: np.ndarray, axes: tuple[int, int]) -> np.ndarray:
    """The harmonic mean of four nodes, 0 next to a fluid. A node without a next node along one of the axes keeps its value."""
    if not values.shape:
        return values
    next_to = following(values, axes[0])
    around = [values, next_to, following(values, axes[1]), following(next_to, axes[1])]
    with np.errstate(divide="ignore"):
        found = 4.0 / sum(1.0 / one for one in around)
    last = np.zeros(values.shape, dtype=bool)
    for axis in axes:
        np.moveaxis(last, axis, 0)[-1] = True
    return np.where(last & (found > 0.0), values, found)


def medium_fields(study: Study) -> dict[str, np.ndarray]:
    """Densities and moduli at the points of the staggered grid."""
    rho, c_p, c_s = (study.medium[name] for name in ("density_kg_m3", "c_p_m_s", "c_s_m_s"))
    moduli = {"mu": rho * c_s ** 2}
    fields = {"lambda": rho * c_p ** 2 - 2.0 * moduli["mu"], **{f"rho0_sg{a}": half_point_mean(rho, n) for n, a in enumerate(AXES)}}
    if study.is_lossy:
        moduli["eta"], fields["chi"] = study.medium["eta_Pa_s"], study.medium["chi_Pa_s"]
    for name, values in moduli.items():
        fields.update({name: values, **{f"{name}_sg{AXES[a]}{AXES[b]}": edge_mean(values, (a, b)) for a, b in PLANES}})
    return fields


def along(values: np.ndarray, axis: int) -> np.ndarray:
    """Values of the points of an axis; complex numbers as pairs."""
    if np.iscomplexobj(values):
        values = np.stack([values.real, values.imag], axis=1).ravel()
    return values.reshape([-1 if n == axis else 1 for n in range(3)])


def operators(study: Study, axis: int) -> dict[str, np.ndarray]:
    """The derivatives half a cell on and back, and the shift half a cell back, in wave number space. A real transform is along x."""
    points, spacing_m, name = int(study.points[axis]), float(study.spacing_m[axis]), AXES[axis]
    k = 2.0 * np.pi * np.fft.fftfreq(points, spacing_m)
    half = k[:points // 2 + 1]
    used, end = (half, "_r") if axis == 0 else (k, "")
    found = {f"dd{name}_k_shift_{word}{end}": 1j * used * np.exp(0.5j * side * used * spacing_m) for word, side in (("pos", 1), ("neg", -1))}
    found[f"{name}_shift_neg_r"] = np.exp(-0.5j * half * spacing_m)
    return {label: along(values, axis) for label, values in found.items()}


def layer_factors(study: Study, axis: int) -> dict[str, np.ndarray]:
    """The factors of the absorbing layer at the nodes and half a cell on."""
    points, size, name = int(study.points[axis]), int(study.layer_points[axis]), AXES[axis]
    at, found = np.arange(points), {}
    for end, offset in (("", 0.0), (f"_sg{name}", 0.5)):
        depth = np.where(at < size, size - at - offset, at - (points - size) + 1 + offset)
        inside = (at < size) | (at >= points - size)
        exponent = np.where(inside, -0.5 * study.time_step_s * study.layer_strength[axis] * study.reference_speed_m_s / study.spacing_m[axis] *
                            (depth / max(size, 1)) ** 4, 0.0)
        found[f"pml_{name}{end}"], found[f"mpml_{name}{end}"] = np.exp(exponent), np.exp(study.layer_ratio * exponent)
    return {label: along(values, axis) for label, values in found.items()}


def indices(study: Study, nodes: np.ndarray) -> np.ndarray:
    """Nodes counted from 1, x fastest."""
    return np.ravel_multi_index(tuple(nodes.T), tuple(study.points.astype(int)), order="F")[:, None, None] + 1


def put_sources(study: Study, integers: dict[str, Any], reals: dict[str, Any]) -> None:
    """The scaled series, of which stresses go into each split part by a third, in a plane by a half. Without scaling k-Wave does not
    divide them either."""
    parts = study.dimensions if study.scaled else 1
    for field in FIELDS:
        integers[f"{field}_source_flag"] = 0
    for source in study.sources:
        field, kind, is_additive = source["field"], source["field"][0], source["mode"] == "additive"
        series = source["weights"][:, None] * source["series"][source["rows"]]
        if len(series) > 1 and np.all(series == series[:1]):
            series = series[:1]
        integers.update({f"{field}_source_flag": series.shape[1], f"{kind}_source_index": indices(study, source["nodes"]),
                         f"{kind}_source_mode": (2 if kind == "u" else 1) if is_additive else 0})
        integers[f"{kind}_source_many"] = max(int(len(series) > 1), integers.get(f"{kind}_source_many", 0))
        reals[f"{field}_source_input"] = (series if kind == "u" else series / parts)[:, :, None]
    integers["p0_source_flag"] = int(study.p0_Pa is not None)
    if study.p0_Pa is not None:
        reals["p0_source_input"] = study.p0_Pa


def put_sensor(study: Study, integers: dict[str, Any], reals: dict[str, Any]) -> None:
    integers["sensor_mask_type"] = 1 if study.cuboids is not None else 0
    if study.cuboids is not None:
        integers["sensor_mask_corners"] = (study.cuboids + np.tile(study.first, 2) + 1).T[:, :, None]
        return
    integers["sensor_mask_index"] = indices(study, study.sensor_nodes)
    if study.sensor_weights is not None:
        integers["sensor_mask_type"], reals["sensor_mask_weights"] = 2, study.sensor_weights.T[:, :, None]


def write_input(path: Path, study: Study) -> None:
    """Writes the file. Arrays have the indices of MATLAB, which HDF5 reverses."""
    integers: dict[str, Any] = {"Nt": study.steps, "elastic_flag": 1, "absorbing_flag": int(study.is_lossy), **dict.fromkeys(WITHOUT, 0)}
    reals: dict[str, Any] = {"dt": study.time_step_s, "c_ref": study.reference_speed_m_s, **medium_fields(study)}
    for axis, name in enumerate(AXES):
        integers.update({f"N{name}": int(study.points[axis]), f"pml_{name}_size": int(study.layer_points[axis])})
        reals.update({f"d{name}": study.spacing_m[axis], f"pml_{name}_alpha": study.layer_strength[axis], **operators(study, axis),
                      **layer_factors(study, axis)})
    put_sources(study, integers, reals)
    put_sensor(study, integers, reals)
    with h5py.File(path, "w", locking=False) as file:
        for name, text in (("file_type", "input"), ("major_version", "1"), ("minor_version", "2"), ("created_by", "shearwake"),
                           ("creation_date", f"{datetime.now():%d-%b-%Y-%H-%M-%S}"), ("file_description", "elastic study")):
            file.attrs.create(name, np.bytes_(text))
        for kind, number, values in (("long", "<u8", integers), ("double", "<f8", reals)):
            for name, value in values.items():
                array = np.asarray(value, dtype=number)
                dataset = file.create_dataset(name, data=array.T if array.ndim else array.reshape(1, 1, 1))
                dataset.attrs.create("data_type", np.bytes_(kind))
                dataset.attrs.create("domain_type", np.bytes_("complex" if "shift" in name else "real"))
