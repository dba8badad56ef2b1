# SPDX-License-Identifier: BSD-3-Clause
"""Converts a k-Wave simulation to a job and its grid study, so that `shearwake run NAME.toml` computes the
same as pstdElastic3D. docs/how-to/kwave.md has an example."""
from __future__ import annotations

import argparse
import contextlib
import difflib
import errno
import os
import shlex
import sys
from pathlib import Path
from typing import Any, Iterator

import h5py
import numpy as np

from .checks import check_layer_nodes
from .describe import lines_of, summary_of
from .files import structures
from .record import flags_of
from .structures import BadInput
from .study import Study

SCHEMA = "shearwake grid study 1"


DESCRIPTION = """\
Converts a simulation of k-Wave (pstdElastic3D) to a job NAME.toml and its grid study NAME.h5 for the engine
pstd. Errors name the field of k-Wave to change."""

EPILOG = """\
structures in FILE (all fields: docs/how-to/kwave.md):
  kgrid    Nx, Ny, Nz, dx, dy, dz, dt, Nt (a struct, not the object kWaveGrid)
  medium   sound_speed_compression, sound_speed_shear, density; optionally absorption
  source   u_mask with ux, uy, uz; s_mask with sxx ... syz; p0
  sensor   mask, record (optional)
  options  PMLSize, PMLAlpha, PMLInside, MultiAxialPMLRatio, ScaleSourceTerms, Smooth (optional); a struct, or a
           cell array of names and values, which may also be named input_args

example:
  scripts/import-kwave study.mat        writes study.toml and study.h5
  shearwake check study.toml
  mpirun -n 2 shearwake run study.toml

The output lists the ranges of indices of sources and sensor, counted from 1 along x, y and z. Compare them
with k-Wave: an array that was stored with reversed indices (h5py without array.T) appears with x and z swapped.

exit codes: 0 done, 2 wrong arguments, 3 the simulation cannot be imported, 6 a file cannot be read or written
"""


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="import-kwave", description=DESCRIPTION, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, metavar="FILE",
                        help=".mat file of MATLAB, Octave or SciPy, or an HDF5 file with the structures below")
    parser.add_argument("--out", type=Path, metavar="NAME", help="output files without extension (default: the "
                        "name of the input file, in the working directory)")
    parser.add_argument("--plane", type=int, metavar="K", help="index along z, counted from 1, of the plane in "
                        "which u_z is recorded and measured (default: the plane with most nodes that drive u_z, "
                        "otherwise the plane with most source nodes)")
    parser.add_argument("--precision", choices=["double", "single"], default="double",
                        help="precision of the engine (default: double)")
    return parser.parse_args()


def put(group: h5py.Group, name: str, values: Any, units: str | None = None) -> None:
    group[name] = np.atleast_1d(np.asarray(values, dtype=float))
    if units:
        group[name].attrs["units"] = units


def text(group: h5py.Group, name: str, value: str) -> None:
    group.attrs.create(name, np.bytes_(value))


def write_study(path: Path, study: Study) -> None:
    units = {"density_kg_m3": "kg/m3", "c_p_m_s": "m/s", "c_s_m_s": "m/s", "eta_Pa_s": "Pa s", "chi_Pa_s": "Pa s"}
    with h5py.File(path, "w") as file:
        text(file, "schema", SCHEMA)
        file.attrs["sources"] = float(len(study.sources))
        grid = file.create_group("grid")
        put(grid, "points", study.points)
        put(grid, "spacing_m", study.spacing_m, "m")
        grid.attrs["time_step_s"], grid.attrs["steps"] = study.time_step_s, float(study.steps)
        layer = file.create_group("layer")
        put(layer, "points", study.layer_points)
        put(layer, "strength", study.layer_strength)
        layer.attrs["ratio"], layer.attrs["speed_m_s"] = study.layer_ratio, study.layer_speed_m_s
        medium = file.create_group("medium")
        for name, values in study.medium.items():
            put(medium, name, values, units[name])
        for number, source in enumerate(study.sources):
            group = file.create_group(f"source_{number}")
            text(group, "field", source["field"])
            text(group, "mode", source["mode"])
            for name in ("nodes", "weights", "rows", "series"):
                put(group, name, source[name])
        sensor = file.create_group("sensor")
        put(sensor, "nodes", study.sensor_nodes)
        if study.sensor_weights is not None:
            sensor["weights"] = study.sensor_weights
        text(sensor, "fields", " ".join(study.sensor_fields))
        sensor.attrs["start"] = float(study.sensor_start)


def good_even(n: int) -> int:
    """The largest even product of 2, 3, 5 and 7 that is at most n: a number of points that a domain may
    have."""
    for length in range(n - n % 2, 1, -2):
        rest = length
        for prime in (2, 3, 5, 7):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return length
    raise BadInput(f"kgrid has only {n} points along x or y: at least 2 are required")


def place_of_sources(study: Study) -> tuple[int, np.ndarray, float]:
    """Plane, centre (x, y in m relative to the middle of the domain) and width of the sources of u_z, or of
    all sources if none drives u_z."""
    chosen = [s for s in study.sources if s["field"] == "uz"] or study.sources
    nodes = np.concatenate([s["nodes"] for s in chosen])
    power = np.concatenate([np.abs(s["weights"]) * np.sqrt(np.mean(s["series"] ** 2, axis=1))[s["rows"]]
                            for s in chosen])
    power = power / power.sum() if power.sum() > 0 else np.full(len(nodes), 1.0 / len(nodes))
    plane = int(np.bincount(nodes[:, 2]).argmax())
    at = (nodes[:, :2] - study.points[:2] // 2) * study.spacing_m[:2]
    centre = np.round(power @ at, 9) + 0.0  # 1 nm: jobs do not accept rounding errors as lengths
    width = np.sqrt(8.0 * np.log(2.0) * (power @ np.sum((at - centre) ** 2, axis=1)) / 2.0)
    return plane, centre, max(float(width), 2.0 * float(study.spacing_m[0]))


def material_of_plane(study: Study, plane: int) -> tuple[float, float, float]:
    """Density, c_p and c_s in the middle of the plane; if it is a fluid, c_s of the softest solid."""
    def value(name: str) -> float:
        values = study.medium[name]
        return float(values if not values.shape else values[study.points[0] // 2, study.points[1] // 2, plane])

    c_s = value("c_s_m_s")
    solid = study.medium["c_s_m_s"][study.medium["c_s_m_s"] > 0.0]
    if c_s == 0.0 and solid.size:
        c_s = float(solid.min())
    return value("density_kg_m3"), value("c_p_m_s"), c_s


def job_text(name: str, study: Study, plane: int, precision: str, source_file: str) -> str:
    d_mm = 1e3 * study.spacing_m
    _, centre, width_m = place_of_sources(study)
    density, c_p, c_s = material_of_plane(study, plane)
    if c_s == 0.0:
        raise BadInput("medium.sound_speed_shear is 0 everywhere: at least a part of the medium must be solid")
    every = max(1, study.steps // 200)
    count = [good_even(int(n)) for n in study.points[:2]]
    margin = max(int(n) for n in study.layer_points[:2]) * d_mm[0] if np.any(study.layer_strength[:2]) else 0.0
    if 2.0 * margin >= min(count) * d_mm[0]:
        margin = 0.0
    return f"""\
# Converted from {source_file} by scripts/import-kwave. The grid, absorbing layer, medium, sources and sensor
# are in {name}.h5, the `solver.pstd.study` of this job. [medium] and [load] below do not affect the solution:
# the measures use them for the shear wave speed and the position of the focus. If the focus moves, specify
# its path in [load.modulation].
schema = 1

[job]
name = "{name}"
title = "{name}, from k-Wave"

[medium]
base = "half-space"

[[medium.layer]]
name = "plane {plane + 1}"
density_kg_m3 = {float(density)!r}
c_p_m_s = {float(max(c_p, 1.2 * c_s))!r}
c_s_m_s = {float(c_s)!r}

[load]
peak_Pa = 1.0
footprint = {{ shape = "gaussian", fwhm_mm = {1e3 * width_m:.6g} }}

[load.modulation]
kind = "custom"
[[load.modulation.trajectory]]
move = "hold"
position_mm = [{1e3 * centre[0]:.9g}, {1e3 * centre[1]:.9g}]

[domain]
extent_mm = [{count[0] * d_mm[0]:.12g}, {count[1] * d_mm[1]:.12g}]
spacing_mm = {d_mm[0]:.15g}
sponge_mm = {margin:.12g} # excludes the absorbing layer from the measures

[time]
duration_ms = {1e3 * (study.steps // every) * every * study.time_step_s:.12g}
output_interval_us = {1e6 * every * study.time_step_s:.12g} # {every} steps

[solver]
engine = "pstd"

[solver.pstd]
study = "{name}.h5"
precision = "{precision}"

[measure]
depths_mm = [{(plane + 0.5) * d_mm[2]:.12g}] # u_z of plane {plane + 1} of {study.points[2]}
"""


@contextlib.contextmanager
def complete(path: Path) -> Iterator[Path]:
    """A temporary name for the file, which is renamed when it is complete."""
    part = path.with_name(path.name + ".part")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def missing_file(path: Path) -> str:
    near = difflib.get_close_matches(path.name, [entry.name for entry in path.parent.iterdir() if entry.is_file()]
                                     if path.parent.is_dir() else [], n=1)
    return (f"{path}: no such file" + (f"; did you mean {path.with_name(near[0])}?" if near else
            f"; the working directory is {Path.cwd()}"))


def output_of(chosen: argparse.Namespace) -> Path:
    """The path of the output files without extension. Raises BadInput and NotADirectoryError."""
    out = chosen.out or Path(chosen.file.stem)
    if out.suffix.lower() in (".toml", ".h5"):
        out = out.with_suffix("")
    if not out.parent.is_dir():
        raise NotADirectoryError(errno.ENOENT, "the folder of the output files does not exist", str(out.parent))
    if out.with_name(out.name + ".h5").resolve() == chosen.file.resolve():
        raise BadInput(f"{out}.h5 would replace the input file; choose another name with --out")
    return out


def main() -> int:
    chosen = options()
    try:
        study = Study(*structures(chosen.file))
        has_job = abs(study.spacing_m[0] - study.spacing_m[1]) <= 1e-9 * study.spacing_m[0]
        plane = place_of_sources(study)[0]
        if chosen.plane is not None:
            plane = chosen.plane - 1 + int(study.first[2])
            if not 0 <= plane < study.points[2]:
                raise BadInput(f"--plane must be 1 to {study.points[2] - 2 * study.first[2]}")
        check_layer_nodes(study, plane)
        out = output_of(chosen)
        job = job_text(out.name, study, plane, chosen.precision, chosen.file.name) if has_job else ""
        with complete(out.with_name(out.name + ".h5")) as part:
            write_study(part, study)
        if has_job:
            with complete(out.with_name(out.name + ".toml")) as part:
                part.write_text(job, encoding="utf-8")
    except BadInput as problem:
        print(f"import-kwave: {problem}", file=sys.stderr)
        return 3
    except FileNotFoundError as problem:
        print(f"import-kwave: {missing_file(Path(problem.filename))}", file=sys.stderr)
        return 6
    except OSError as problem:
        print(f"import-kwave: {problem.filename or chosen.file}: {problem.strerror or problem}", file=sys.stderr)
        return 6
    except MemoryError:
        print(f"import-kwave: {chosen.file} needs more memory than there is", file=sys.stderr)
        return 6
    except Exception as problem:  # users cannot do anything with a traceback
        print(f"import-kwave: {chosen.file} cannot be converted: {type(problem).__name__}: {problem}",
              file=sys.stderr)
        return 3
    for warning in study.warnings:
        print(f"warning: {warning}")
    for note in study.notes:
        print(f"note: {note}")
    if not has_job:
        print("note: kgrid.dx and kgrid.dy differ: no job is written, since the surface of a job has square cells; shearwake kwave "
              "runs the study. For a job, permute the axes so that only the spacing along z differs")
        if Path(f"{out}.toml").exists():
            print(f"warning: {out}.toml is the job of another study; run and check reject it")
    print(summary_of(out, study, has_job))
    for line in lines_of(study, plane):
        print(f"  {line}")
    print(f"next: shearwake run {shlex.quote(f'{out}.toml')}" if has_job else
          f"next: shearwake kwave -i {shlex.quote(f'{out}.h5')} -o {shlex.quote(f'{out}-output.h5')} {' '.join(flags_of(study.sensor_fields))} -s {study.sensor_start}"
          + (" --precision single" if chosen.precision == "single" else ""))
    return 0


if __name__ == "__main__":
    sys.exit(main())
