# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the keys of [uncertain] of a job from a measured scan. The command `shearwake fit` is this module."""
from __future__ import annotations

import argparse
import contextlib
import fcntl
import json
import math
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..checksum import LINE_LENGTH, Damaged, verify_case, with_line
from ..engine import Engine, ParentEngine, diagnostics_in
from ..errors import EnvironmentFailed, JobError, ShearwakeError, UsageError
from ..job import Job
from ..laboratory import fit_figures
from ..laboratory.measure_scan import aligned_scan
from ..laboratory.scan import BadScan
from ..laboratory.scan_motion import is_line
from .least_squares import Estimate, FitResult, Parameter, Prior, Values, fit as fit_parameters, robust_chi_squared

LEAST_MAGNITUDE = 1e-9
LEAST_SAMPLES = 8
MARGIN_SHARE, LEAST_MARGIN = 8, 4  # of the frames: later samples of a longer trigger delay remain within the case
# Keys of [vibrometer] that a scan does not replace.
ALIGNMENT = ("trigger_delay_ms", "offset_x_mm", "offset_y_mm", "tilt_deg", "azimuth_deg", "spot_um", "high_pass_Hz", "low_pass_Hz")
# Values at which a material law is a simpler one.
SIMPLER_LAWS = (("viscosity_Pa_s", 0.0, "no loss"), ("exponent", 1.0 - 1e-9, "Kelvin-Voigt"), ("strength", 1e-9, "no loss"))

Overrides = list[tuple[str, str]]


@dataclass(frozen=True)
class FitProgress:
    """The number of predictions of a fit so far, of which `computed` were not known from an earlier, interrupted fit."""

    predictions: int
    computed: int


@dataclass(frozen=True)
class Fitted:
    """The result of fit(): `estimates` by key, `document` is the content of fit.json in `folder`."""

    folder: Path
    estimates: dict[str, Estimate]
    document: dict[str, Any]
    result: FitResult


@dataclass(frozen=True)
class Recording:
    """The velocities of the points of a scan that have a signal, (point, sample), and how they were recorded."""

    data: str
    sha256: str
    notes: list[str]
    x_m: np.ndarray
    y_m: np.ndarray
    velocity_m_s: np.ndarray
    start_s: float  # of the first sample after the trigger
    rate_Hz: float
    delay_s: float  # of the trigger after the start of the load
    direction: tuple[float, float, float]
    is_line: bool


def read_recording(data: str | os.PathLike[str], described: dict[str, Any], least_quality: float, outwards: bool) -> Recording:
    """Raises UsageError for a file that is not a usable scan, and EnvironmentFailed."""
    request = {"least_quality": least_quality, "outwards": outwards, "periodic": described["periodic"],
               "period_s": described["duration_s"], **({"vibrometer": described["vibrometer"]} if described["vibrometer"] else {})}
    try:
        scan, alignment, good, sha256 = aligned_scan(str(data), request)
    except BadScan as error:
        raise UsageError(f"{data}: {error}", 2) from None
    except MemoryError:
        raise EnvironmentFailed(f"{data}: out of memory", 6) from None
    except OSError as error:
        raise EnvironmentFailed(f"{error.filename or data}: {error.strerror or error}", 6) from None
    x, y, z = (float(value) for value in alignment.direction)
    return Recording(str(data), sha256, alignment.notes, scan.x_m[good], scan.y_m[good], scan.velocity_m_s[good], float(scan.time_s[0]),
                     float(scan.rate_Hz), float(alignment.delay_s), (x, y, z), bool(len(scan.x_m) > 1 and is_line(scan.x_m, scan.y_m)))


def toml_number(value: float) -> str:
    """Job files contain 0 or larger magnitudes."""
    return repr(0.0 if abs(value) < LEAST_MAGNITUDE else float(value))


def read_checked(path: Path) -> bytes | None:
    """The content of a file of write_checked(); None if it does not exist, is truncated or damaged. Raises OSError."""
    try:
        verify_case(path)
    except (Damaged, FileNotFoundError):
        return None
    return path.read_bytes()[:-LINE_LENGTH - 1]


def write_checked(path: Path, content: bytes) -> None:
    """Writes a file at once, with its checksum after the content."""
    path.parent.mkdir(exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_bytes(with_line(content))
    part.replace(path)


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Excludes other studies from a folder. File systems without locks exclude none. Raises UsageError."""
    with open(folder / "lock", "wb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise UsageError(f"{folder} is being used by another shearwake fit; wait for it or stop it", 2) from None
        except OSError:
            pass
        yield


class ScanModel:
    """Predicts what the vibrometer of a job records at the points and times of a scan, for values of the parameters. Predictions are
    stored in the folder `evaluations`, by the id of their case."""

    def __init__(self, engine: Engine, text: str, overrides: Overrides, described: dict[str, Any], parameters: Sequence[Parameter],
                 recording: Recording, folder: Path, progress: Callable[[FitProgress], None] | None = None) -> None:
        self.engine, self.text, self.overrides, self.described = engine, text, overrides, described
        self.parameters, self.recording, self.folder, self.progress = parameters, recording, folder, progress
        self.frames = self.predictions = self.computed = 0
        offset_mm = 1e3 * np.array((described["vibrometer"] or {"offset_m": (0.0, 0.0)})["offset_m"])
        points_mm = 1e3 * np.stack((recording.x_m, recording.y_m), axis=1)
        half_mm = 500.0 * np.array(described["extent_m"])
        for x, y in (points_mm + offset_mm)[np.any(np.abs(points_mm + offset_mm) > half_mm, axis=1)]:
            raise UsageError(f"the scan has a point at [{x:.6g}, {y:.6g}] mm outside of the domain of the job: enlarge domain.extent_mm, "
                             "or correct the positions", 2)
        # As a file, since a request is limited in length; a file has at least two points.
        self.points = (folder / "scan-points.csv").resolve()
        self.points.write_text("x_mm,y_mm\n" + "".join(f"{float(x)!r},{float(y)!r}\n" for x, y in points_mm), encoding="utf-8")
        self.scan = (("vibrometer.file", json.dumps(str(self.points), ensure_ascii=False)) if len(points_mm) > 1
                     else ("vibrometer.points_mm", repr(points_mm.tolist())))
        self.samples = self._covered_samples()

    def _covered_samples(self) -> int:
        """The number of the first samples of each point that the case covers; in the periodic regime all."""
        recorded, rate_Hz = self.recording.velocity_m_s.shape[1], self.recording.rate_Hz
        samples = self.described["duration_s"] * rate_Hz
        if self.described["periodic"]:
            if samples < 2.0 or abs(samples - round(samples)) > 1e-6 * samples:
                raise UsageError(f"the period of the load, {1e3 * self.described['duration_s']:.6g} ms, is not a whole number of samples "
                                 f"at {rate_Hz:.6g} Hz: choose another sampling rate or modulation frequency", 2)
            return recorded
        delay_s = self.delay_s([parameter.start for parameter in self.parameters])
        covered = min(recorded, max(0, math.floor((self.described["duration_s"] - delay_s) * rate_Hz + 1e-9) + 1))
        if covered < LEAST_SAMPLES:
            raise UsageError(f"the scan and the simulated time have fewer than {LEAST_SAMPLES} samples in common: compare "
                             "vibrometer.trigger_delay_ms and time.duration_ms", 2)
        return covered

    @property
    def observed(self) -> np.ndarray:
        return self.recording.velocity_m_s[:, :self.samples]

    def delay_s(self, values: Values) -> float:
        """From the start of the load to the first sample."""
        vibrometer = self.described["vibrometer"]
        delay_s = vibrometer["trigger_delay_s"] if vibrometer else self.recording.delay_s
        for parameter, value in zip(self.parameters, values):
            if parameter.key == "vibrometer.trigger_delay_ms":
                delay_s = 1e-3 * value
        return delay_s + self.recording.start_s

    def overrides_at(self, values: Values) -> Overrides:
        """The overrides of the job for the case of these values, with the scan as its vibrometer."""
        x, y, z = self.recording.direction
        vibrometer = self.described["vibrometer"] or {"tilt_rad": math.atan2(math.hypot(x, y), z), "azimuth_rad": math.atan2(y, x),
                                                      "offset_m": (0.0, 0.0), "spot_m": 0.0, "high_pass_Hz": 0.0, "low_pass_Hz": 0.0}
        keys = {"tilt_deg": math.degrees(vibrometer["tilt_rad"]), "azimuth_deg": math.degrees(vibrometer["azimuth_rad"]),
                "offset_x_mm": 1e3 * vibrometer["offset_m"][0], "offset_y_mm": 1e3 * vibrometer["offset_m"][1],
                "spot_um": 1e6 * vibrometer["spot_m"], "sampling_rate_kHz": 1e-3 * self.recording.rate_Hz,
                **{name: vibrometer[name] for name in ("high_pass_Hz", "low_pass_Hz") if vibrometer[name] > 0.0}}
        delay_s, interval_s = self.delay_s(values), self.described["interval_s"]
        if not self.described["periodic"]:
            # Later cases are never shorter, so that differences of predictions contain no effect of the end.
            frames = round(self.described["duration_s"] / interval_s)
            end = (delay_s + (self.samples - 1) / self.recording.rate_Hz) / interval_s
            if end > max(self.frames, frames):
                self.frames = math.ceil(end) + max(LEAST_MARGIN, frames // MARGIN_SHARE)
        return [*self.overrides, ("vibrometer", "{}"), ("record", "{}"),
                *((f"vibrometer.{name}", toml_number(value)) for name, value in keys.items()), self.scan,
                *([("time.duration_ms", repr(1e3 * self.frames * interval_s))] if self.frames else []),
                *((parameter.key, toml_number(value)) for parameter, value in zip(self.parameters, values)),
                ("vibrometer.trigger_delay_ms", toml_number(1e3 * delay_s))]

    def __call__(self, values: Values) -> np.ndarray | None:
        """The velocities (point, sample); None if there is no valid case with these values."""
        overrides = self.overrides_at(values)
        try:
            case = self.engine.describe(self.text, overrides)["case"]
        except JobError:
            if not self.predictions:  # of the start values
                raise
            return None
        path = self.folder / "evaluations" / f"{case}-{self.engine.hello['git_id'][:12]}"
        self.predictions += 1
        content = read_checked(path)
        if content is None:
            message, content = self.engine.request(self.text, overrides=overrides, arrays=["vibrometer/velocity"])
            if message["type"] != "result":
                return None
            self.computed += 1
            content = content[:message["bytes"] - 1]
            write_checked(path, content)
        if self.progress:
            self.progress(FitProgress(self.predictions, self.computed))
        found = np.frombuffer(content, "<f8").reshape(len(self.recording.x_m), -1)
        return found[:, np.arange(self.samples) % found.shape[1]]  # one period, or at least all samples


def simpler_laws(model: ScanModel, full: FitResult) -> list[dict[str, Any]]:
    """The fit with each law that has fewer parameters. A negative change of the Bayesian information criterion means that the simpler
    law suffices."""
    found = []
    for fixed, parameter in enumerate(model.parameters):
        for ending, value, law in SIMPLER_LAWS:
            if not parameter.key.endswith(ending):
                continue

            def reduced(values: Values, place: int = fixed, value: float = value) -> np.ndarray | None:
                return model([*values[:place], value, *values[place:]])

            others = [replace(other, start=estimate.value) for other, estimate in zip(model.parameters, full.estimates)]
            del others[fixed]
            predicted = fit_parameters(others, model.observed, reduced, full.noise).predicted if others else reduced([])
            if predicted is not None:
                squares = np.mean((predicted - model.observed) ** 2, axis=1)
                change = robust_chi_squared(squares, model.samples, full.noise) - full.chi_squared - math.log(model.observed.size)
                found.append({"key": parameter.key, "law": law, "bic_change": change, "suffices": change < 0.0})
    return found


def write_fit(folder: Path, job: str, model: ScanModel, result: FitResult, simpler: list[dict[str, Any]]) -> dict[str, Any]:
    """Writes fit.json and fit.h5 and returns the content of fit.json."""
    recording, hello = model.recording, model.engine.hello
    document = {
        "schema": 1, "job": job, "data": recording.data, "sha256": recording.sha256, "notes": recording.notes,
        "converged": result.has_converged, "solver": result.report,
        "estimates": {parameter.key: {"value": estimate.value, "standard_error": estimate.standard_error,
                                      "interval_95": [estimate.low_95, estimate.high_95], "bounds": [parameter.low, parameter.high],
                                      "at_bound": estimate.is_at_bound}
                      for parameter, estimate in zip(model.parameters, result.estimates)},
        "correlations": result.correlations.tolist(), "noise_m_s": result.noise, "points": len(recording.x_m), "outliers": result.outliers,
        "is_line": recording.is_line, "simpler_laws": simpler}
    time_s = recording.start_s + np.arange(model.samples) / recording.rate_Hz
    part = folder / "fit.part.h5"
    with h5py.File(part, "w") as file:
        file.attrs.update(program=f"shearwake {hello['version']}", git_id=hello["git_id"])
        for name, dimensions, values, units, meaning in (
                ("point", "point", np.arange(float(len(recording.x_m))), "1", "number of the point of the scan"),
                ("time", "time", time_s, "s", "time since the trigger"),
                ("x", "point", recording.x_m, "m", "position of the point along x"),
                ("y", "point", recording.y_m, "m", "position of the point along y"),
                ("measured", "point time", model.observed, "m/s", "measured velocity along the line of sight"),
                ("predicted", "point time", result.predicted, "m/s", "velocity of the model with the estimates"),
                ("residual_rms", "point", result.residual_rms, "m/s", "root mean square of measured minus predicted velocity"),
                ("weight", "point", result.weights, "1", "weight of the point in the fit; below 0.5: an outlier")):
            dataset = file.create_dataset(name, data=values)
            dataset.attrs.update(units=units, long_name=meaning)
            if name == dimensions:
                dataset.make_scale(name)
            for axis, dimension in enumerate(dimensions.split()):
                if name != dimension:
                    dataset.dims[axis].attach_scale(file[dimension])
    part.replace(folder / "fit.h5")
    part = folder / "fit.part.json"
    part.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    part.replace(folder / "fit.json")
    return document


def text_of(fitted: Fitted) -> str:
    """The estimates as the command prints them."""
    document, keys = fitted.document, list(fitted.estimates)
    width = max(9, *map(len, keys))
    lines = [*document["notes"], f"{'parameter':<{width}} {'estimate':>12} {'std. error':>12} {'95 % interval':>26}"]
    for key, e in fitted.estimates.items():
        at_bound = " (at its bound)" if e.is_at_bound else ""
        lines.append(f"{key:<{width}} {e.value:>12.6g} {e.standard_error:>12.3g} {e.low_95:>12.6g} {e.high_95:>13.6g}{at_bound}")
    lines += [f"correlation of {keys[i]} and {keys[j]}: {document['correlations'][i][j]:.2f}"
              for i in range(len(keys)) for j in range(i + 1, len(keys))]
    lines.append(f"residual: {1e6 * document['noise_m_s']:.4g} um/s per sample; {document['outliers']} of {document['points']} points are "
                 "outliers")
    lines += [f"simpler law ({law['law']}, without {law['key']}): {'suffices' if law['suffices'] else 'does not suffice'} (change of the "
              f"information criterion {law['bic_change']:+.4g})" for law in document["simpler_laws"]]
    return "\n".join(lines)


def read_overrides(texts: Sequence[str]) -> Overrides:
    """Overrides KEY=VALUE. Raises UsageError for one that is not, and for one of [sweep]."""
    for text in texts:
        if not text.partition("=")[1] or text.startswith("="):
            raise UsageError(f'-S "{text}": must be KEY=VALUE, for example -S load.peak_Pa=200', 2)
        if text.startswith("sweep") and text != "sweep={}":
            raise UsageError(f"-S {text}: this command uses one case; set the key itself, as in -S load.peak_Pa=200", 2)
    return [(key, value) for key, _, value in (text.partition("=") for text in texts)]


def has_effect(key: str) -> bool:
    """Whether an override changes a fit: a scan replaces its points and its noise."""
    return not key.startswith("vibrometer.") or key.endswith(ALIGNMENT)


def fit(job: Job | str | os.PathLike[str], data: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None,
        overrides: Sequence[str] = (), least_quality: float = 0.0, outwards: bool = False, ranks: int = 1,
        launch: Sequence[str] | None = None, progress: Callable[[FitProgress], None] | None = None,
        warn: Callable[[str], None] = lambda text: print(text, file=sys.stderr), _engine: Engine | None = None) -> Fitted:
    """Estimates the keys of [uncertain] of a job from the scan in the file `data`, and writes fit.json and fit.h5 to `out` (by default
    out/NAME.fit). Uniform and triangular distributions are bounds, the others priors. `overrides` are texts KEY=VALUE;
    `least_quality` ignores points below this quality; `outwards`: z and positive velocities of the file point out of the skin.
    `ranks` and `launch` are those of Job.run. `progress` is called after each prediction, and `warn` with each warning. An exception
    of `progress`, or an interrupt, ends the fit; the same call resumes it with the predictions in `out`/evaluations. Raises JobError,
    UsageError, EnvironmentFailed and OSError."""
    name = "<Job>" if isinstance(job, Job) or "\n" in str(job) else str(job)
    job = job if isinstance(job, Job) else Job(job)
    given = read_overrides(overrides)
    for key, _ in given:
        if not has_effect(key):
            warn(f"-S {key}: warning: the scan contains the recorded motion, so this override has no effect")
    options = ["--time-limit", "1e6", "--memory", "1e9", "--files", str(job.folder)]
    with contextlib.ExitStack() as stack:
        engine = stack.enter_context(_engine or Engine(ranks, launch=launch, options=options))
        described = engine.describe(job.text, given, name)
        for diagnostic in diagnostics_in(described, name):
            warn(str(diagnostic))
        if described["engine"] != "layered":
            raise JobError('solver.engine: fit computes with engine "layered" only', 3)
        parameters = [Parameter(entry["key"], entry["median"], entry["low"], entry["high"], Prior(**entry["prior"]) if entry["prior"] else None)
                      for entry in described["uncertain"]]
        if not parameters:
            raise JobError(f"{name}: [uncertain] names no key to be estimated", 3)
        folder = Path(out) if out is not None else Path("out") / f"{described['name']}.fit"
        folder.mkdir(parents=True, exist_ok=True)
        stack.enter_context(locked(folder))
        recording = read_recording(data, described, least_quality, outwards)
        model = ScanModel(engine, job.text, [(key, value) for key, value in given if has_effect(key)], described, parameters, recording,
                          folder, progress)
        result = fit_parameters(parameters, model.observed, model)
        document = write_fit(folder, name, model, result, simpler_laws(model, result))
        model.points.unlink()
    return Fitted(folder, {parameter.key: estimate for parameter, estimate in zip(parameters, result.estimates)}, document, result)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command `shearwake fit`, which passes its arguments on and computes the cases."""
    parser = argparse.ArgumentParser(prog="shearwake fit")
    parser.add_argument("job")
    parser.add_argument("--data", required=True)
    parser.add_argument("-S", dest="overrides", action="append", default=[])
    parser.add_argument("--least-quality", type=float, default=0.0)
    parser.add_argument("--outwards", action="store_true")
    parser.add_argument("--out")
    parser.add_argument("--engine", required=True)
    given = vars(parser.parse_args(arguments))
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # the program starts this module with SIGINT blocked
        fitted = fit(_engine=ParentEngine(int(given.pop("engine"))), **given)
        print(text_of(fitted))
        if not fitted.result.has_converged:
            print(f"warning: the fit has not converged: {fitted.result.report}", file=sys.stderr)
        sys.stdout.flush()
        if code := fit_figures.main(fitted.folder):
            return code
        print(f"files: {fitted.folder}")
    except KeyboardInterrupt:
        print("the fit was interrupted; rerun the command to resume it", file=sys.stderr)
        return 75
    except ShearwakeError as error:
        print(error, file=sys.stderr)
        return getattr(error, "exit_code", 6)
    except OSError as error:
        print(f"{error.filename or arguments}: {error.strerror or error}", file=sys.stderr)
        return 6
    return 0


if __name__ == "__main__":
    sys.exit(main())
