# SPDX-License-Identifier: BSD-3-Clause
"""The grid, medium, sources and sensor of a k-Wave simulation, with the sources of pstdElastic3D at each node."""
from __future__ import annotations

import difflib
import math
from typing import Any, Iterable

import numpy as np

from .checks import check_medium, check_plausible, check_range, check_spectrum, first_node
from .record import FIELDS, read_sensor
from .structures import BadInput, Simulation, Structure, text_of

PSTD_CFL = 0.1  # of pstdElastic3D: kspaceFirstOrder_setDefaults.m
# The fields that pstdElastic3D uses. Others, which belong to other k-Wave functions, are rejected.
KNOWN = {
    "medium": {"sound_speed_compression", "sound_speed_shear", "density", "alpha_coeff_compression",
               "alpha_coeff_shear", "sound_speed_ref"},
    "source": {"u_mask", "u_mode", "ux", "uy", "uz", "s_mask", "s_mode", "sxx", "syy", "szz", "sxy", "sxz",
               "syz", "p0"},
    "sensor": {"mask", "record", "record_start_index"},
    "options": {"PMLSize", "PMLRange", "PMLAlpha", "PMLInside", "MultiAxialPMLRatio", "Smooth", "ScaleSourceTerms", "CartInterp"},
}
# Options of pstdElastic3D about plots, files and the processor.
IGNORED = {"CreateLog", "DataCast", "DataRecast", "DisplayMask", "HDFCompressionLevel", "LogScale", "MeshPlot", "MovieArgs",
           "MovieName", "MovieProfile", "MovieType", "PlotFreq", "PlotLayout", "PlotPML", "PlotScale", "PlotSim",
           "RecordMovie", "SaveToDisk", "SaveToDiskExit", "StreamToDisk"}


def check_fields(structure: Structure, notes: list[str]) -> None:
    """Rejects fields that change the result in an unknown way."""
    name = structure.name
    known = KNOWN.get(name, set())
    for field in structure.fields() if known else []:
        if name == "options" and field in IGNORED:
            cast = "; shearwake kwave --precision single computes in single precision" if field == "DataCast" else ""
            notes.append(f"options.{field}: ignored, does not change the physics{cast}")
        elif field not in known:
            near = difflib.get_close_matches(field.lower(), [one.lower() for one in known], n=1)
            meant = next((f" (did you mean {one}?)" for one in known if near and one.lower() == near[0]), "")
            raise BadInput(f"{name}.{field} is not a field that pstdElastic3D uses{meant}; the fields are "
                           f"{', '.join(sorted(known))}")


def three(value: Any, name: str, integer: bool = False) -> np.ndarray:
    if np.size(value) == 2:  # k-Wave: the second value belongs to y and z
        value = np.ravel(value)[[0, 1, 1]]
    values = np.broadcast_to(np.ravel(value), 3) if np.size(value) in (1, 3) else None
    if values is None or np.any(values < 0) or (integer and np.any(values != np.floor(values))):
        raise BadInput(f"{name} must be one {'whole ' if integer else ''}number or three, 0 or more")
    return np.array(values, dtype=float)


def grid_of(points: Iterable[float]) -> tuple[int, ...]:
    """The shape of a grid for messages; that of a plane has two numbers."""
    shape = tuple(int(n) for n in points)
    return shape[:2] if shape[2:] == (1,) else shape


def shape_hint(values: np.ndarray, points: Iterable[float]) -> str:
    """What may be wrong with an array that does not have the shape of the grid."""
    shape, found = grid_of(points), grid_of(values.shape)
    if found == shape[::-1]:
        return "; its indices are in reverse order: HDF5 files that were not written by MATLAB need array.T"
    if sorted(found) == sorted(shape):
        return f"; its axes are permuted: they must be in the order x, y, z, as in {shape}"
    if values.size == math.prod(shape):
        return (f"; it has the right number of values: reshape it to {shape}, in Python with order='F' if x is the "
                "fastest index")
    return ""


def is_auto(structure: Structure, field: str) -> bool:
    return field in structure and text_of(structure.values[field]) == "auto"


def largest_factor(number: int) -> int:
    """The largest prime factor."""
    factor, largest = 2, 1
    while number > 1:
        while number % factor == 0:
            number, largest = number // factor, factor
        factor += 1
    return largest


def smoothed(values: np.ndarray, restores_maximum: bool = False) -> np.ndarray:
    """The values filtered in wave number space by k-Wave's window: a Blackman window over the distance from the origin,
    interpolated linearly between as many points as the longest axis has. An even axis is periodic, an odd one symmetric."""
    if values.shape[2:] == (1,):  # a plane
        return smoothed(values[..., 0], restores_maximum)[..., None]
    shape = values.shape
    points = [n if n % 2 else n + 1 for n in shape]
    most = max(points)
    angle = 2.0 * np.pi * np.arange(most) / (most - 1)
    blackman = 0.42 - 0.5 * np.cos(angle) + 0.08 * np.cos(2.0 * angle)
    half = 0.5 * (most - 1)
    axes = [np.linspace(-half, half, n)[:m] for n, m in zip(points, shape)]
    distance = np.sqrt(sum(axis ** 2 for axis in np.meshgrid(*axes, indexing="ij", sparse=True)))
    window = np.where(distance > half, 0.0, np.abs(np.interp(distance, np.linspace(-half, half, most), blackman)))
    found = np.real(np.fft.ifftn(np.fft.fftn(values) * np.fft.ifftshift(window)))
    return found * (np.max(np.abs(values)) / np.max(np.abs(found))) if restores_maximum else found


class Study(Simulation):
    """Reads a simulation from the structures of k-Wave."""

    def __init__(self, parts: dict[str, Structure], notes: list[str]) -> None:
        self.notes, self.warnings = list(notes), []
        for structure in parts.values():
            check_fields(structure, self.notes)
        self.first = np.zeros(3, dtype=int)
        self.options = parts.get("options") or Structure({}, "options")
        self.read_grid(parts["kgrid"])
        self.read_medium(parts["medium"])
        self.read_times(parts["kgrid"])
        check_plausible(self)
        self.enlarge_if_layer_is_outside()
        self.smooth_medium()
        self.sources, self.p0_Pa = [], None
        self.read_sources(parts["source"])
        check_spectrum(self)
        read_sensor(self, parts.get("sensor") or Structure({}, "sensor"), self.nodes_of)

    # ---- the grid and its layer

    def read_grid(self, kgrid: Structure) -> None:
        self.points = np.array([kgrid.number(f"N{axis}") for axis in "xyz"])
        if np.any(self.points < [2, 2, 1]) or np.any(self.points != np.floor(self.points)):
            raise BadInput("kgrid.Nx, Ny and Nz must be whole numbers of at least 2")
        self.points = self.points.astype(int)
        self.spacing_m = np.array([kgrid.number(f"d{axis}") for axis in "xyz"])
        if np.any(self.spacing_m <= 0):
            raise BadInput("kgrid.dx, dy and dz must be greater than 0")
        option = self.options
        self.layer_points = self.automatic_layer() if is_auto(option, "PMLSize") else \
            three(option.array("PMLSize") if "PMLSize" in option else 10, "options.PMLSize", True)
        self.layer_strength = three(option.array("PMLAlpha") if "PMLAlpha" in option else 2.0, "options.PMLAlpha")
        self.layer_ratio = option.number("MultiAxialPMLRatio", 0.1)
        smooth = np.ravel(option.array("Smooth")) if "Smooth" in option else np.array([1.0, 0.0, 0.0])
        if smooth.size not in (1, 3):
            raise BadInput("options.Smooth must be one value or three, for p0, the speeds and the density")
        self.smooths = np.broadcast_to(smooth, 3) != 0.0
        self.scaled = option.number("ScaleSourceTerms", 1.0) != 0.0
        self.check_layer()

    def read_times(self, kgrid: Structure) -> None:
        given = [name for name in ("dt", "Nt", "t_array") if name in kgrid and not is_auto(kgrid, name)]
        self.times_are_automatic = not given and any(name in kgrid for name in ("dt", "Nt", "t_array"))
        if self.times_are_automatic:
            self.choose_times()
        elif "t_array" in given:
            self.read_t_array(kgrid, given)
        else:
            self.time_step_s, steps = kgrid.number("dt"), kgrid.number("Nt")
            self.steps = int(steps)
            if self.steps != steps:
                raise BadInput(f"kgrid.Nt is {steps:g}; it must be a whole number")
        if self.time_step_s <= 0 or self.steps < 1:
            raise BadInput("kgrid.dt and Nt must be greater than 0")

    def choose_times(self) -> None:
        """The times of makeTime in k-Wave, with the number that pstdElastic3D gives it."""
        speeds = np.concatenate([np.ravel(self.medium[name]) for name in ("c_p_m_s", "c_s_m_s")])
        speeds = speeds[speeds > 0.0]
        end_s = float(np.linalg.norm((self.points * self.spacing_m)[:self.dimensions]) / np.min(speeds))
        self.time_step_s = float(PSTD_CFL * np.min(self.spacing_m) / np.max(speeds))
        count = end_s / self.time_step_s
        is_recurring = count != round(count) and abs(count - round(count)) <= np.finfo(float).eps * count  # rem(end, dt) is 0
        self.steps = int(np.floor(count)) + 1 + int(is_recurring)
        self.notes.append(f"kgrid: the times \"auto\" are, as in k-Wave, {self.steps} steps of {1e6 * self.time_step_s:.6g} us (CFL "
                          f"{PSTD_CFL:g}, until the slowest wave has crossed the grid)")

    def read_t_array(self, kgrid: Structure, given: list[str]) -> None:
        times = np.ravel(kgrid.array("t_array"))
        if times.size < 2:
            raise BadInput("kgrid.t_array must contain the times of all steps")
        self.time_step_s, self.steps = float(times[-1] - times[0]) / (times.size - 1), times.size
        # Half a unit of the last place of each time, if all are numbers of single precision.
        is_single = np.all(times == times.astype(np.float32))
        rounding_s = float(np.finfo(np.float32).eps * np.max(np.abs(times))) if is_single else 0.0
        tolerance_s = 1e-6 * abs(self.time_step_s) + rounding_s
        if np.any(np.abs(np.diff(times) - self.time_step_s) > tolerance_s):
            raise BadInput("kgrid.t_array must be uniformly spaced")
        if "Nt" in given and kgrid.number("Nt") != self.steps:
            raise BadInput(f"kgrid.Nt is {kgrid.number('Nt'):g}, but kgrid.t_array contains {self.steps} times: they must agree")
        if "dt" in given:
            if abs(kgrid.number("dt") - self.time_step_s) > tolerance_s:
                raise BadInput(f"kgrid.dt is {kgrid.number('dt'):g} s, but the times of kgrid.t_array are {self.time_step_s:g} s apart: "
                               "they must agree")
            self.time_step_s = kgrid.number("dt")

    def automatic_layer(self) -> np.ndarray:
        """The sizes of getOptimalPMLSize in k-Wave: the enlarged grid has the smallest largest prime factor."""
        if self.options.number("PMLInside", 1.0) != 0.0:
            raise BadInput("options.PMLSize is \"auto\", which k-Wave supports only with options.PMLInside = false")
        least, most = (int(size) for size in np.ravel(self.options.array("PMLRange") if "PMLRange" in self.options else [10, 40]))
        if not 0 < least <= most:
            raise BadInput("options.PMLRange must be two whole numbers above 0 in ascending order")
        sizes = range(least, most + 1)
        found = np.array([min(sizes, key=lambda size: largest_factor(int(points) + 2 * size)) if points > 1 else 0 for points in self.points],
                         dtype=float)
        self.notes.append("options.PMLSize: \"auto\" is, as in k-Wave, " + ", ".join(f"{size:g}" for size in found[:self.dimensions]))
        return found

    def check_layer(self) -> None:
        outside = self.options.number("PMLInside", 1.0) == 0.0
        for axis, points, layer in zip("xyz", self.points, self.layer_points):
            if not outside and 2 * layer > points:
                raise BadInput(f"options.PMLSize is {layer:g} along {axis}: two such layers do not fit into "
                               f"kgrid.N{axis} = {points}")
        if self.layer_ratio < 0.0:
            raise BadInput("options.MultiAxialPMLRatio must be 0 or more")

    def enlarge_if_layer_is_outside(self) -> None:
        if self.options.number("PMLInside", 1.0) != 0.0:
            return
        self.first = self.layer_points.astype(int)
        pads = [(int(n), int(n)) for n in self.first]
        self.given_points, self.points = self.points, self.points + 2 * self.first
        for name, values in self.medium.items():
            if values.shape:
                self.medium[name] = np.pad(values, pads, mode="edge")

    # ---- the medium

    def read_medium(self, medium: Structure) -> None:
        def values(field: str) -> np.ndarray:
            found = medium.array(field)
            if found.shape not in ((), tuple(self.points)):
                raise BadInput(f"medium.{field} has the shape {grid_of(found.shape)}; it must be one number, or have the "
                               f"shape {grid_of(self.points)} of the grid{shape_hint(found, self.points)}")
            check_range(found, f"medium.{field}", self, positive=field in ("density", "sound_speed_compression"))
            return found

        for field in ("sound_speed_compression", "sound_speed_shear", "density"):
            if field not in medium:
                raise BadInput(f"medium.{field} is missing")
        c_p, c_s, rho = (values(f) for f in ("sound_speed_compression", "sound_speed_shear", "density"))
        self.medium = {"density_kg_m3": rho, "c_p_m_s": c_p, "c_s_m_s": c_s}
        absorbs = [f"alpha_coeff_{wave}" in medium for wave in ("compression", "shear")]
        if any(absorbs):
            if not all(absorbs):
                raise BadInput("medium.alpha_coeff_compression and medium.alpha_coeff_shear must be specified "
                               "together")
            # of compressional waves chi + 2 eta; without the density and the speeds, which may be smoothed later
            self.medium.update(eta_Pa_s=values("alpha_coeff_shear"), chi_Pa_s=values("alpha_coeff_compression"))
        self.reference_speed_m_s = float(np.max(c_p))
        if "sound_speed_ref" in medium:
            try:
                self.reference_speed_m_s = medium.number("sound_speed_ref")
            except BadInput as no_number:
                named: dict[str, Any] = {"min": np.min, "mean": np.mean, "max": np.max}
                word = medium.text("sound_speed_ref", "max")
                if word not in named:
                    raise BadInput("medium.sound_speed_ref must be a number, \"min\", \"mean\" or "
                                   "\"max\"") from no_number
                self.reference_speed_m_s = float(named[word](c_p))
            if self.reference_speed_m_s <= 0.0:
                raise BadInput(f"medium.sound_speed_ref is {self.reference_speed_m_s:g}; it must be greater than 0")
        check_medium(self)

    def smooth_medium(self) -> None:
        """Smooths speeds and density if that is asked for, on the enlarged grid as in k-Wave, and completes the viscosities."""
        medium = self.medium
        for number, name, field in ((1, "c_p_m_s", "sound_speed_compression"), (1, "c_s_m_s", "sound_speed_shear"),
                                    (2, "density_kg_m3", "density")):
            if self.smooths[number] and medium[name].shape:
                medium[name] = smoothed(medium[name])
                check_range(medium[name], f"medium.{field} (smoothed)", self, positive=name != "c_s_m_s")
        if self.is_lossy:
            # dB/(MHz^2 cm) as Np (rad/s)^-2 m^-1
            neper = 100.0 * (1e-6 / (2.0 * math.pi)) ** 2 / (20.0 * math.log10(math.e))
            eta, modulus = (2.0 * medium["density_kg_m3"] * medium[speed] ** 3 * medium[alpha] * neper
                            for speed, alpha in (("c_s_m_s", "eta_Pa_s"), ("c_p_m_s", "chi_Pa_s")))
            medium.update(eta_Pa_s=eta, chi_Pa_s=modulus - 2.0 * eta)

    @property
    def is_lossy(self) -> bool:
        return "eta_Pa_s" in self.medium

    def c_p_at(self, nodes: np.ndarray) -> np.ndarray:
        c_p = self.medium["c_p_m_s"]
        return c_p[tuple(nodes.T)] if c_p.shape else np.full(len(nodes), float(c_p))

    # ---- the sources

    def nodes_of(self, mask: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Nodes of a mask, in k-Wave's order with x fastest, and their labels."""
        given = tuple(self.points - 2 * self.first)
        if mask.shape != given:
            raise BadInput(f"{name} has the shape {grid_of(mask.shape)}; it must be that of the grid, "
                           f"{grid_of(given)}{shape_hint(mask, given)}")
        bad = (mask != np.floor(mask)) | (mask < 0.0)
        if np.any(bad):
            raise BadInput(f"{name} is {mask[bad].flat[0]:g}{first_node(np.pad(bad, [(n, n) for n in self.first]), self)}; a "
                           "mask contains 0 and 1, or labels 1, 2, ... of the series of a source")
        flat = mask.ravel(order="F")
        at = np.flatnonzero(flat)
        if at.size == 0:
            raise BadInput(f"{name} does not mark any node")
        return np.stack(np.unravel_index(at, given, order="F"), axis=1) + self.first, flat[at]

    def read_sources(self, source: Structure) -> None:
        for kind, fields in (("u", FIELDS[:3]), ("s", FIELDS[3:])):
            driven = [field for field in fields if field in source]
            if not driven:
                continue
            if f"{kind}_mask" not in source:
                raise BadInput(f"source.{kind}_mask is missing; source.{driven[0]} requires it")
            nodes, labels = self.nodes_of(source.array(f"{kind}_mask"), f"source.{kind}_mask")
            mode = source.text(f"{kind}_mode", "additive")
            if mode == "additive-no-correction" and kind == "u":
                mode = "additive"  # the same in pstdElastic3D
            if mode not in ("additive", "dirichlet"):
                raise BadInput(f"source.{kind}_mode is \"{mode}\"; it must be \"additive\" or \"dirichlet\"")
            for field in driven:
                self.add_source(field, mode, nodes, labels, source.array(field))
        if self.times_are_automatic and self.sources:
            self.notes.append("kgrid: k-Wave itself chooses times only for an initial pressure, and stops at a study with a source "
                              "that varies with time and the times \"auto\"")
        if "p0" in source and np.any(source.array("p0")):
            if any(field in source for field in ("sxx", "syy", "szz")):
                self.notes.append("source.p0 replaces the normal stresses of the source, as in k-Wave")
                self.sources = [one for one in self.sources if one["field"] not in ("sxx", "syy", "szz")]
            if shear := [one["field"] for one in self.sources if one["field"] in FIELDS[6:]]:
                raise BadInput(f"source.{shear[0]} cannot be combined with source.p0, whose nodes replace source.s_mask in pstdElastic3D")
            self.add_initial_pressure(source.array("p0"), source.text("s_mode", "additive"))
        if not self.sources:
            raise BadInput("source has none of the fields ux ... uz, sxx ... syz and p0")

    def add_source(self, field: str, mode: str, nodes: np.ndarray, labels: np.ndarray, series: np.ndarray) -> None:
        series = np.atleast_2d(series)
        if series.shape[1] == 1 and series.shape[0] not in (1, len(nodes), labels.max()):
            series = series.T
        count, samples = series.shape
        if samples > self.steps:
            self.notes.append(f"source.{field} has {samples} samples, but kgrid.Nt is {self.steps}: later samples are not "
                              "used")
        elif samples < self.steps:
            self.notes.append(f"source.{field} has {samples} samples, but kgrid.Nt is {self.steps}: as in k-Wave, the source "
                              f"does not act after step {samples}")
        labelled = not np.all(labels == 1)
        if labelled:
            if np.any(labels != np.floor(labels)) or labels.max() != count:
                raise BadInput(f"source.{field} has {count} rows, but the largest label of its mask is "
                               f"{labels.max():g}: they must be equal")
            rows = labels.astype(int) - 1
        elif count == 1:
            rows = np.zeros(len(nodes), dtype=int)
        elif count == len(nodes):
            rows = np.arange(count)
        else:
            transposed = series.shape[1] == len(nodes)
            raise BadInput(f"source.{field} has {count} rows, but its mask has {len(nodes)} nodes: there must be "
                           "one row, or one per node" +
                           ("; it appears to be transposed: its columns must be the time steps" if transposed else ""))
        weights = np.ones(len(nodes))
        if mode == "additive" and self.scaled:
            # k-Wave scales by 2 c_p dt/d, where d is the spacing along the axis of a velocity, and dx for a
            # stress. c_p is that of the node; with fewer rows than nodes k-Wave uses that of the node whose
            # index equals the index of the row.
            axis = FIELDS.index(field) if field in FIELDS[:3] else 0
            scales = 2.0 * self.c_p_at(nodes) * self.time_step_s / self.spacing_m[axis]
            weights = scales if count == len(nodes) and not labelled else scales[rows]
        self.sources.append({"field": field, "mode": mode, "nodes": nodes, "weights": weights, "rows": rows,
                             "series": series[:, :self.steps], "is_initial": False})

    def add_initial_pressure(self, p0: np.ndarray, mode: str) -> None:
        if p0.shape == tuple(self.points - 2 * self.first) and self.smooths[0]:
            p0 = smoothed(p0, restores_maximum=True)
        everywhere = mode == "dirichlet"  # prescribes the stresses of all nodes for two steps
        nodes, _ = self.nodes_of(np.where((p0 != 0.0) | everywhere, 1.0, 0.0), "source.p0")
        self.p0_Pa = np.pad(p0, [(n, n) for n in self.first])
        weights = -0.5 * p0[tuple((nodes - self.first).T)]
        for field in FIELDS[3:3 + self.dimensions]:
            self.sources.append({"field": field, "mode": mode, "nodes": nodes, "weights": weights,
                                 "rows": np.zeros(len(nodes), dtype=int), "series": np.ones((1, 2)), "is_initial": True})
