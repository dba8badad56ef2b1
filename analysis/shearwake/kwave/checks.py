# SPDX-License-Identifier: BSD-3-Clause
"""Rejects media without meaning, and warns of values that are probably not intended. `shearwake kwave` checks the time step, the bulk
modulus and the faces between fluids and solids."""
from __future__ import annotations

from typing import Any

import numpy as np

from .structures import BadInput, Simulation

LARGEST_SPACING_m, LARGEST_SIZE_m = 0.1, 1.0  # of a body part; larger values are probably not in m
LEAST_DENSITY_kg_m3, LARGEST_DENSITY_kg_m3 = 10.0, 3e4  # no tissue, liquid or metal lies outside
ABOVE = 0.01  # share of the energy of a source above the supported frequency that causes a warning


def first_node(bad: Any, study: Simulation) -> str:
    """The first node where `bad` is true, counted from 1 in the grid of kgrid; empty for uniform values."""
    if not np.ndim(bad):
        return ""
    node = (np.argwhere(bad)[0] - study.first + 1)[:study.dimensions]
    return f" at node ({', '.join(str(int(n)) for n in node)})"


def check_range(values: Any, field: str, study: Simulation, positive: bool = False) -> None:
    """All values must be 0 or more, or positive."""
    bad = values <= 0.0 if positive else values < 0.0
    if np.any(bad):
        found = float(values[bad].flat[0] if np.ndim(values) else values)
        raise BadInput(f"{field} is {found:g}{first_node(bad, study)}; it must be "
                       f"{'greater than 0' if positive else '0 or more'}")


def check_medium(study: Simulation) -> None:
    c_p, c_s = study.medium["c_p_m_s"], study.medium["c_s_m_s"]
    bad = np.asarray(c_s > c_p)
    if np.any(bad):
        raise BadInput(f"medium.sound_speed_shear exceeds medium.sound_speed_compression{first_node(bad, study)}: "
                       "shear waves must be slower than compressional waves")


def check_plausible(study: Simulation) -> None:
    """Warns of values that are probably in other units than k-Wave expects. Raises BadInput for a grid that is in
    millimetres."""
    for axis, spacing_m, points in zip("xyz", study.spacing_m, study.points):
        if spacing_m > LARGEST_SPACING_m:
            raise BadInput(f"kgrid.d{axis} is {spacing_m:g} m, so that the grid would be {spacing_m * points:.4g} m long along "
                           f"{axis}; k-Wave expects metres. If kgrid.dx, dy and dz are in mm, save them divided by 1000: "
                           f"kgrid.d{axis} = {1e-3 * spacing_m:g}")
        if spacing_m * points > LARGEST_SIZE_m:
            study.warnings.append(f"kgrid.N{axis} * kgrid.d{axis} is {spacing_m * points:g} m, more than a body; k-Wave "
                                  "expects metres")
    density = study.medium["density_kg_m3"]
    for bad, value in ((density < LEAST_DENSITY_kg_m3, np.min(density)), (density > LARGEST_DENSITY_kg_m3, np.max(density))):
        if np.any(bad):
            study.warnings.append(f"medium.density is {value:g} kg/m3{first_node(bad, study)}; k-Wave expects kg/m3, "
                                  "about 1000 in tissue")


def in_layer(study: Simulation, nodes: np.ndarray) -> np.ndarray:
    """Which nodes lie inside the absorbing layer."""
    thick = np.where(study.layer_strength > 0.0, study.layer_points, 0.0)
    return np.any((nodes < thick) | (nodes >= study.points - thick), axis=1)


def check_layer_nodes(study: Simulation) -> None:
    """Warns if the layer absorbs at sources or sensor."""
    groups = [(f"source.{source['field']}", source["nodes"]) for source in study.sources]
    for name, nodes in [*groups, ("sensor.mask", study.sensor_nodes)]:
        inside = int(np.count_nonzero(in_layer(study, nodes)))
        if inside:
            study.warnings.append(f"{name}: {inside} of {len(nodes)} nodes lie inside the absorbing layer (options.PMLSize), "
                                  "where waves are damped")


def supported_frequency_Hz(study: Simulation) -> float:
    """The frequency whose shortest wave has two points per wavelength, as k-Wave reports it. Fluids have no shear
    waves."""
    c_p, c_s = np.broadcast_arrays(study.medium["c_p_m_s"], study.medium["c_s_m_s"])
    return float(np.min(np.where(c_s > 0.0, c_s, c_p)) / (2.0 * np.max(study.spacing_m)))


def energy_spectrum(series: np.ndarray, steps: int) -> np.ndarray:
    """The energy of all rows over frequency. The row of a source that acts until the last step is continued smoothly,
    since its end has no effect; its begin and an earlier end count as jumps."""
    energy = np.zeros(1)
    for first in range(0, len(series), 256):  # so that large sources need little memory
        rows = series[first:first + 256]
        rest = rows[:, ::-1] if rows.shape[1] >= steps else np.zeros_like(rows)
        energy = energy + np.sum(np.abs(np.fft.rfft(np.hstack([rows, rest, np.zeros_like(rows)]), axis=1)) ** 2, axis=0)
    return energy


def check_spectrum(study: Simulation) -> None:
    """Warns if the grid does not represent a part of a source's spectrum."""
    supported_Hz = supported_frequency_Hz(study)
    for source in study.sources:
        if source["is_initial"]:
            continue
        energy = energy_spectrum(source["series"], study.steps)
        frequency_Hz = np.fft.rfftfreq(3 * source["series"].shape[1], study.time_step_s)
        above = float(np.sum(energy[frequency_Hz > supported_Hz]))
        if above > ABOVE * float(np.sum(energy)):
            study.warnings.append(f"source.{source['field']}: {100.0 * above / float(np.sum(energy)):.2g} % of its energy lies "
                                  f"above {supported_Hz:.4g} Hz, the maximum supported frequency of the grid; reduce kgrid.dx or "
                                  "filter the source")
