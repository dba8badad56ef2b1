# SPDX-License-Identifier: BSD-3-Clause
"""Converts a scan for `shearwake measure`, and aligns one for `shearwake fit`.

Usage: python3 -m shearwake.laboratory.measure_scan DATA REQUEST PREFIX
REQUEST is a JSON document of the program. Writes PREFIX.json and PREFIX.f64 (doubles of this machine): displacements of the surface
at the frames, (repetition, frame, x, y). Repetition 0 are the data, the others have noise of the measured strength added and leave
out a tenth of the points. Exit 0: written; 2: the scan cannot be used; 6: a file cannot be read or written.
"""
import hashlib
import json
import math
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from .scan import BadScan, Scan
from .scan_files import read_scan
from .scan_motion import MASK_RADII, Surface, displacement_m, filtered, noise_m_s, one_period

USAGE, ENVIRONMENT = 2, 6
LEFT_OUT = 0.1
MOST_m_s, MOST_m = 1.0, 5e-3  # radiation forces of a few mN move skin by less than a tenth of these
SAME_DIRECTION = 1e-3  # directions are printed with four digits


class Alignment:
    """Trigger delay, position and line of sight: those of the job, or of the file if the job has no vibrometer. The sign of the
    velocities is always that of the file."""

    def __init__(self, scan: Scan, request: dict) -> None:
        given = request.get("vibrometer")
        with np.errstate(invalid="ignore"):
            largest_m_s = float(np.nanmax(np.abs(scan.velocity_m_s[scan.quality > 0.0]), initial=0.0))
        self.notes = [*scan.notes, extent_text(scan, largest_m_s), *plausibility("velocity", largest_m_s, MOST_m_s, "m/s")]
        self.delay_s, self.offset_m = scan.trigger_delay_s, (0.0, 0.0)
        length = math.hypot(*scan.direction)
        self.direction = tuple(value / length for value in scan.direction)
        if abs(length - 1.0) > 1e-6:
            self.notes.append(f"the direction of the file has the length {length:.6g}; it is normalised")
        outwards = "; z of the file points out of the skin (--outwards)" if request.get("outwards") else ""
        self.notes.append(("positive velocities are taken as pointing into the skin, since the file states no direction"
                           if not scan.states_direction and not outwards else
                           f"line of sight: {vector(self.direction)}, z into the skin") + outwards)
        if given:
            self.delay_s, self.offset_m = given["trigger_delay_s"], given["offset_m"]
            default = " (the default if the job states none)"
            if scan.states_direction and math.dist(self.direction, given["direction"]) > SAME_DIRECTION:
                x, y, z = self.direction
                of_job = vector(given["direction"]) + (default if given["direction"][2] == 1.0 else "")
                self.notes.append(f"the line of sight of [vibrometer], {of_job}, is used instead of that of the file; for that of the "
                                  f"file set vibrometer.tilt_deg = {math.degrees(math.atan2(math.hypot(x, y), z)):.4g} and "
                                  f"azimuth_deg = {math.degrees(math.atan2(y, x)):.4g}")
            self.direction = given["direction"]
            if abs(scan.trigger_delay_s - self.delay_s) > 1e-9 and scan.trigger_delay_s != 0.0:
                of_job = f"{1e3 * self.delay_s:.6g} ms" + (default if self.delay_s == 0.0 else "")
                file_ms = f"{1e3 * scan.trigger_delay_s:.6g}"
                self.notes.append(f"the trigger delay of [vibrometer], {of_job}, is used instead of that of the file, {file_ms} ms; for "
                                  f"that of the file set vibrometer.trigger_delay_ms = {file_ms}")

    def text(self) -> str:
        return (f"start of the recording {1e3 * self.delay_s:.6g} ms after that of the load; points shifted by "
                f"{1e3 * self.offset_m[0]:.6g} and {1e3 * self.offset_m[1]:.6g} mm")


def extent_text(scan: Scan, largest_m_s: float) -> str:
    (x0, x1), (y0, y1) = ((1e3 * np.min(values), 1e3 * np.max(values)) for values in (scan.x_m, scan.y_m))
    return (f"{len(scan.x_m)} points, x {x0:.4g} to {x1:.4g} mm, y {y0:.4g} to {y1:.4g} mm; {len(scan.time_s)} samples at "
            f"{scan.rate_Hz:.8g} Hz, up to {1e3 * largest_m_s:.4g} mm/s")


def plausibility(what: str, largest: float, most: float, unit: str) -> list[str]:
    """A note if a velocity in m/s or a displacement in m is larger than ultrasound causes in skin."""
    return [] if not largest > most else [
        f"a {what} of {largest:.4g} {unit} is implausible for skin: values are read in m, s and m/s, unless the attribute units (HDF5) "
        "or the label of the ordinate (UFF) states another unit"]


def vector(direction: Iterable[float]) -> str:
    return "(" + ", ".join(f"{value + 0.0:.4g}" for value in direction) + ")"


def usable_points(scan: Scan, request: dict) -> np.ndarray:
    """Points with finite velocities and a sufficient quality."""
    good = np.all(np.isfinite(scan.velocity_m_s), axis=1) & (scan.quality > 0.0)
    good &= scan.quality >= request.get("least_quality", 0.0)
    if not np.any(good):
        raise BadScan("no point has a signal of sufficient quality")
    return good


def surfaces(scan: Scan, good: np.ndarray, alignment: Alignment, request: dict) -> tuple[dict, Iterator]:
    """The description of the frames, and the frames of all repetitions."""
    grid, frames_s = request["grid"], np.array(request["frames_s"])
    repeats = request["periodic"]
    velocity, start_s, periods = scan.velocity_m_s[good], float(scan.time_s[0]) + alignment.delay_s, 1
    if repeats:
        velocity, periods = one_period(scan, request["period_s"])
        velocity = velocity[good]
    noise = noise_m_s(scan.velocity_m_s[good]) / np.sqrt(periods)
    x, y = scan.x_m + alignment.offset_m[0], scan.y_m + alignment.offset_m[1]
    grid_x, grid_y = (grid["spacing_m"] * (np.arange(n) - n // 2) for n in (grid["nx"], grid["ny"]))
    full = Surface(x[good], y[good], grid_x, grid_y)
    bad = np.stack((x[~good], y[~good]), axis=1)
    masks = request["gaps"] == "mask"
    if masks:
        full.without(bad, MASK_RADII * full.point_spacing)
    to_u_z = 1.0 / alignment.direction[2]

    def motion(values: np.ndarray) -> np.ndarray:
        smooth = filtered(values, scan.rate_Hz, request["high_pass_Hz"], repeats)
        return to_u_z * displacement_m(smooth, start_s, scan.rate_Hz, frames_s, repeats)

    def repetition(n: int) -> Iterator[np.ndarray]:
        if n == 0:
            measured = motion(velocity)
            about["notes"] += plausibility("displacement", float(np.max(np.abs(measured))), MOST_m, "m")
            yield from full.frames(measured)
            return
        rng = np.random.default_rng([request["seed"], n])
        used = np.sort(rng.permutation(len(velocity))[:max(4, round((1.0 - LEFT_OUT) * len(velocity)))])
        noisy = velocity + noise[:, None] * rng.normal(size=velocity.shape)
        part = Surface(x[good][used], y[good][used], grid_x, grid_y)
        if masks:
            part.without(bad, MASK_RADII * full.point_spacing)
        yield from part.frames(motion(noisy[used]))

    nodes = full.nodes[full.covered]
    about: dict = {"notes": [*alignment.notes,
                       f"{np.count_nonzero(good)} of {len(good)} points, {full.point_spacing * 1e3:.4g} mm apart, cover "
                       f"{100.0 * np.mean(full.covered):.1f} % of the domain; gaps are "
                       + ("masked" if masks else "interpolated"),
                       ("no high-pass" if request["high_pass_Hz"] <= 0 else f"high-pass {request['high_pass_Hz']:g} Hz")
                       + ", " + ("mean of " + str(periods) + " periods; the static displacement is unknown" if repeats
                                 else "integrated from rest"),
                       f"noise {1e6 * float(np.median(noise)):.4g} um/s per sample",
                       alignment.text()],
             "covered_from_m": [float(v) for v in nodes.min(axis=0)], "covered_to_m": [float(v) for v in nodes.max(axis=0)],
             "noise_m_s": float(np.median(noise)), "repetitions": request["repetitions"] + 1}
    return about, (repetition(n) for n in range(request["repetitions"] + 1))


def aligned_scan(data: str | Path, request: dict) -> tuple[Scan, Alignment, np.ndarray, str]:
    """A scan with its alignment, the points that are used, and the SHA-256 of the file. Raises BadScan and OSError."""
    scan = read_scan(data)
    if request.get("outwards"):
        scan = scan.along_z(z_outwards=True)
    if request["periodic"]:
        scan = scan.with_rate_of(request["period_s"])
    return scan, Alignment(scan, request), usable_points(scan, request), hashlib.sha256(Path(data).read_bytes()).hexdigest()


def main(data: str, request_file: str, prefix: str) -> int:
    try:
        request = json.loads(Path(request_file).read_text(encoding="utf-8"))
        scan, alignment, good, sha256 = aligned_scan(data, request)
        more, repetitions = surfaces(scan, good, alignment, request)
        with open(f"{prefix}.f64", "wb") as file:
            for repetition in repetitions:
                for frames in repetition:
                    file.write(np.ascontiguousarray(frames, dtype=float).tobytes())
        about = {"data": str(data), "sha256": sha256}
        Path(f"{prefix}.json").write_text(json.dumps({**about, **more}), encoding="utf-8")
    except BadScan as error:
        print(f"{data}: {error}", file=sys.stderr)
        return USAGE
    except MemoryError:
        print(f"{data}: out of memory", file=sys.stderr)
        return ENVIRONMENT
    except OSError as error:
        print(f"{error.filename or data}: {error.strerror or error}", file=sys.stderr)
        return ENVIRONMENT
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
