# SPDX-License-Identifier: BSD-3-Clause
"""Starts `shearwake explore` for tests."""
import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
from urllib.parse import parse_qs, urlsplit

from study import program


class Page:
    """The server of one page; `with Page(folder) as page` ends it as Ctrl-C does."""

    def __init__(self, folder, *options):
        self.process = subprocess.Popen(
            [*program.command("explore"), "--no-browser", "--out", str(folder), *options], cwd=folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, encoding="utf-8", start_new_session=True,
            env={**program.environment(), "SHEARWAKE_PYTHON": sys.executable})
        line = self.process.stdout.readline()
        if not re.match(r"http://127\.0\.0\.1:\d+/\?token=[\w-]{32}$", line):
            raise AssertionError(f"explore printed {line!r}")
        self.address = line.strip()
        parts = urlsplit(self.address)
        self.host, self.token = parts.netloc, parse_qs(parts.query)["token"][0]
        self.origin = f"http://{self.host}"
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGINT)
        try:
            self.process.wait(program.PATIENCE_s)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def children(self):
        """The processes that the command has started: {process id: command}."""
        parents, commands = {}, {}
        for name in filter(str.isdigit, os.listdir("/proc")):
            with contextlib.suppress(OSError):
                with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                    parents[int(name)] = int(file.read().rsplit(")", 1)[1].split()[1])
                with open(f"/proc/{name}/cmdline", encoding="utf-8", errors="replace") as file:
                    commands[int(name)] = file.read().replace("\0", " ").strip()

        def descends(process):
            return process == self.process.pid or (process in parents and descends(parents[process]))
        return {process: command for process, command in commands.items() if descends(process)}
