# SPDX-License-Identifier: BSD-3-Clause
"""A client of `shearwake serve` for tests."""
import contextlib
import json
import os
import select
import signal
import subprocess
import time
from pathlib import Path

import numpy

from program import ONE_CASE, PATIENCE_s, changed_job, command, environment, small_job

ONE = small_job(ONE_CASE, {"job": {"name": "one"}, "medium": {"preset": "thesis-tissue"}, "solver": None, "measure": None, "record": {"frames": True}})


def one(*changes, peak=100.0):
    """A job of one case, computed in some hundredths of a second."""
    return changed_job(ONE, {"load.peak_Pa": peak}, *changes)


def extent(*mm):
    return {"domain.extent_mm": list(mm)}


class Server:
    """One process; `with Server() as server` ends it by closing its input."""

    def __init__(self, *arguments, ranks=1):
        self.process = subprocess.Popen(command("serve", *arguments, ranks=ranks), env=environment(), stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, start_new_session=True, bufsize=0)
        self.buffer = b""
        self.number = 0
        self.hello = self.receive()[0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()

    def end(self):
        """Closes the input and returns the exit code."""
        self.process.stdin.close()
        return self.process.wait(PATIENCE_s)

    def send_text(self, text):
        self.process.stdin.write(text.encode() if isinstance(text, str) else text)

    def send(self, job, **more):
        self.number += 1
        self.send_text(json.dumps({"type": "compute", "id": self.number, "job": job, **more}) + "\n")
        return self.number

    def read(self, is_enough):
        until = time.monotonic() + PATIENCE_s
        while not is_enough(self.buffer):
            ready, _, _ = select.select([self.process.stdout], [], [], max(0.0, until - time.monotonic()))
            part = os.read(self.process.stdout.fileno(), 1 << 20) if ready else b""
            if not part:
                raise AssertionError("serve is silent" if not ready else "serve has ended")
            self.buffer += part

    def receive(self):
        """The next message and its arrays by name."""
        self.read(lambda found: b"\n" in found)
        line, self.buffer = self.buffer.split(b"\n", 1)
        message = json.loads(line)
        size = message.get("bytes", 0)
        self.read(lambda found: len(found) >= size)
        content, self.buffer = self.buffer[:size], self.buffer[size:]
        arrays, offset = {}, 0
        for array in message.get("arrays", []):
            kind = numpy.dtype(array["type"]).newbyteorder("<")
            count = int(numpy.prod(array["shape"], dtype=int))
            arrays[array["name"]] = numpy.frombuffer(content, kind, count, offset).reshape(array["shape"])
            offset += count * kind.itemsize
        assert (content[offset:] == b"\n") if size else not content, (offset, size)
        return message, arrays

    def compute(self, job):
        """The result of a job, after the answers to earlier requests."""
        return self.receive_until(self.send(job))

    def receive_until(self, number):
        while True:
            message, arrays = self.receive()
            if message.get("id") == number:
                return message, arrays

    def resident_kB(self):
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
        raise AssertionError("no memory is stated")
