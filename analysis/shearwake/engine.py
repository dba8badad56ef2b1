# SPDX-License-Identifier: BSD-3-Clause
"""The engine `layered` as a process of a script or a notebook: evaluates one case after the other without restarting the program."""
from __future__ import annotations

import contextlib
import functools
import json
import math
import os
import signal
import socket
import subprocess
import threading
from collections.abc import Mapping, Sequence
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from . import program
from .errors import Diagnostic, NotRecorded, ProgramError, suggestion, warn_of_invalid
from .job import Job, Source
from .keys import described

if TYPE_CHECKING:
    import xarray as xr

EXIT_CODES = {"bad_job": 3, "bad_request": 3, "refused": 3, "time_limit": 4, "failed": 4}


class Evaluation:
    """The result of one case: `columns`, the values of the table, and `arrays`, the quantities over time and the surface in SI units,
    with the names of a case file. `case_id` is that of `run`, `seconds` the time of computing."""

    def __init__(self, message: Mapping[str, Any], content: bytes) -> None:
        self.message = dict(message)
        self.case_id: str = message["case"]
        self.seconds: float = message["seconds"]
        self.warnings: list[dict[str, str]] = message["warnings"]
        self.columns: dict[str, float] = {name: math.nan if column["value"] is None else column["value"]
                                          for name, column in message["columns"].items()}
        self._content = content

    def __repr__(self) -> str:
        valid = "" if self.is_valid else ", not valid"
        return f"<shearwake.Evaluation {self.case_id}: {len(self.columns)} columns, {self.seconds:.3g} s{valid}>"

    @property
    def is_valid(self) -> bool:
        """Whether no warning states that the readings are not valid."""
        return all(warning["severity"] != "error" for warning in self.warnings)

    def value(self, column: str) -> float:
        """A column of the table; NaN if it is empty, for the reason in its `note`. Raises KeyError if it does not exist."""
        if column not in self.columns:
            raise KeyError(f"{column} is not a column{suggestion(column, list(self.columns))}")
        return self.columns[column]

    @functools.cached_property
    def arrays(self) -> dict[str, np.ndarray]:
        """All arrays by name: `u_z` (time, x, y) in m, `time`, `eta`, `traces/u_z` and so on."""
        found, start = {}, 0
        for entry in self.message["arrays"]:
            kind = np.dtype(entry["type"]).newbyteorder("<")
            count = math.prod(entry["shape"])
            found[entry["name"]] = np.frombuffer(self._content, kind, count, start).reshape(entry["shape"])
            start += count * kind.itemsize
        return found

    def dataset(self) -> xr.Dataset:
        """The surface and the quantities over time as a Dataset of xarray, with the attribute `valid` of `Case.dataset`. The arrays of
        groups (`traces/u_z`) are in `arrays`."""
        import xarray as xr
        variables = {entry["name"]: (entry["dimensions"], self.arrays[entry["name"]],
                                     described(entry["name"], entry["units"], entry["meaning"]))
                     for entry in self.message["arrays"] if "/" not in entry["name"]}
        if not variables:
            raise NotRecorded("the case has no arrays")
        shape, spacing_m = self.arrays["u_z"].shape[1:], self.message["spacing_m"]
        axes = {axis: (axis, spacing_m * (np.arange(points) - points // 2), {"units": "m", "long_name": f"position along {axis}"})
                for axis, points in zip("xy", shape)}
        return xr.Dataset(variables, axes, {"case": self.case_id, "valid": int(self.is_valid)})


class Engine:
    """A process of the engine `layered` that evaluates jobs one after the other, in a fraction of the time of `Job.run`, since it
    keeps transfer functions, plans and buffers:

        with shearwake.Engine() as engine:
            print(engine.evaluate("jobs/mach-cone.toml").value("eta_at_1"))

    A job contains one case ([sweep], [uncertain] and [table] are ignored) and refers to no files. Several threads may share an
    engine. `ranks` and `launch` are those of `Job.run`, `time_limit_s` ends a case that takes longer, and
    `options` are further arguments of `shearwake serve`."""

    def __init__(self, ranks: int = 1, *, launch: Sequence[str] | None = None, time_limit_s: float | None = None,
                 options: Sequence[str] = ()) -> None:
        limit = [] if time_limit_s is None else ["--time-limit", f"{time_limit_s:g}"]
        self._options: tuple[list[str], int, Sequence[str] | None] = (["serve", *limit, *options], ranks, launch)
        self._lock, self._number = threading.Lock(), 0
        self._start()

    def _start(self) -> None:
        self._process = program.start(*self._options, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                      start_new_session=True)
        assert self._process.stdin and self._process.stdout
        self._requests: IO[bytes] = self._process.stdin
        self._answers: IO[bytes] = self._process.stdout
        self._errors = b""
        self._reader = threading.Thread(target=self._read_errors, daemon=True)
        self._reader.start()
        self.hello = self._receive()[0]

    def __enter__(self) -> Engine:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        state = "closed" if self._process.poll() is not None else f"version {self.hello['version']}"
        return f"<shearwake.Engine: {state}>"

    def close(self) -> None:
        """Ends the process."""
        with contextlib.suppress(OSError):  # it has ended
            self._requests.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(10)
        self._kill()

    def _kill(self) -> None:
        if self._process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)  # with the ranks of mpirun
        self._process.wait()
        with contextlib.suppress(OSError):
            self._requests.close()
        self._answers.close()

    def evaluate(self, job: Source | Job = None, /, **tables: Any) -> Evaluation:
        """Computes the first case of a job, given as for `Job`. If the call is interrupted, the process is ended, and the next call
        starts another one. Warns with NotValid if the readings are not valid. Raises JobError with all errors, CasesFailed if the case cannot be computed, and EnvironmentFailed if the
        process has ended."""
        text = (job if isinstance(job, Job) and not tables else Job(job.tables if isinstance(job, Job) else job, **tables)).text
        message, content = self.request(text)
        if message["type"] == "result":
            warn_of_invalid([message["warnings"]], f"case {message['case']} is", stacklevel=3)
            return Evaluation(message, content)
        raise error_in(message, "<Job>")

    def describe(self, job: str, overrides: Sequence[tuple[str, str]] = (), name: str = "<Job>") -> dict[str, Any]:
        """The answer `description` of the program to the text of a job with overrides (docs/reference/serve.md). Raises JobError
        with all errors, in which the job is called `name`."""
        message, _ = self.request(job, type="describe", overrides=overrides)
        if message["type"] != "description":
            raise error_in(message, name)
        return message

    def request(self, job: str, type: str = "compute", **members: Any) -> tuple[dict[str, Any], bytes]:
        """Sends the text of a job, with further members of the request, and returns the answer (docs/reference/serve.md) with its
        arrays. Raises ProgramError if the process has ended, which the next request starts again."""
        with self._lock:
            if self._has_ended():
                self._start()
            self._number += 1
            try:
                self._send({"type": type, "id": self._number, "job": job, **members})
                while (answer := self._receive())[0].get("id", self._number) != self._number:
                    pass  # of an earlier request, whose call was interrupted
                return answer
            except BaseException:
                self._kill()
                raise

    def cancel(self) -> None:
        """Ends the request of another thread, whose answer is of the type `cancelled`. Raises ProgramError."""
        self._send({"type": "cancel"})

    def _read_errors(self) -> None:
        assert self._process.stderr
        with self._process.stderr as stream:
            for line in stream:
                self._errors = (self._errors + line)[-10_000:]

    def _send(self, message: Mapping[str, Any]) -> None:
        try:
            self._requests.write(json.dumps(message).encode() + b"\n")
            self._requests.flush()
        except (OSError, ValueError):
            raise self._ended() from None

    def _receive(self) -> tuple[dict[str, Any], bytes]:
        try:
            message: dict[str, Any] = json.loads(self._answers.readline())
            content = self._answers.read(message.get("bytes", 0))
        except ValueError:
            raise self._ended() from None
        if len(content) != message.get("bytes", 0):
            raise self._ended()
        return message, content

    def _has_ended(self) -> bool:
        return self._process.poll() is not None

    def _ended(self) -> ProgramError:
        try:
            code = self._process.wait(5)
        except subprocess.TimeoutExpired:
            code = 6
        self._reader.join(1)
        text = self._errors.decode("utf-8", "replace").strip()
        return program.error_of(code if code > 0 else 6, text or "the engine has ended; make a new shearwake.Engine")


class ParentEngine(Engine):
    """The program that has started this process, which answers on the socket with this descriptor."""

    def __init__(self, descriptor: int) -> None:
        self._lock, self._number = threading.Lock(), 0
        with socket.socket(fileno=descriptor) as end:
            self._answers, self._requests = end.makefile("rb"), end.makefile("wb")
        self.hello = self._receive()[0]

    def __repr__(self) -> str:
        return "<shearwake.ParentEngine>"

    def close(self) -> None:
        """Ends the requests."""
        for stream in (self._requests, self._answers):
            with contextlib.suppress(OSError):
                stream.close()

    def _kill(self) -> None:
        self.close()

    def _has_ended(self) -> bool:
        return False

    def _ended(self) -> ProgramError:
        return program.error_of(6, "the program has ended")


def diagnostics_in(message: Mapping[str, Any], name: str) -> list[Diagnostic]:
    """The errors and warnings of an answer about a job with this name."""
    return [Diagnostic(d["severity"], name if d["file"] == "job" else d["file"], d["line"], d["column"], d["message"])
            for d in message.get("diagnostics", [])]


def error_in(message: Mapping[str, Any], name: str) -> ProgramError:
    """The exception of an answer `error`."""
    found = diagnostics_in(message, name)
    lines = "\n".join(str(d) for d in found if d.severity == "error")
    return program.error_of(EXIT_CODES.get(message.get("code", ""), 1), lines or message.get("message", ""), found)
