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

from study import InFolder, program

import browser
from test_browser import need_chromium

# Moves a slider as a user does, waits for the result of the change, and returns the time in ms until it was drawn.
MOVE = """(async (name, value) => {
  const input = document.querySelector(`[data-setting="${name}"] input`), before = explorer.waits_ms.length;
  input.value = value;
  input.dispatchEvent(new Event("input"));
  while (explorer.waits_ms.length === before || explorer.active || explorer.changed_ms !== undefined) await new Promise(r => setTimeout(r, 2));
  return explorer.waits_ms.at(-1);
})"""


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


class PageTest(InFolder):
    """Tests of the page in a headless chromium."""

    @classmethod
    def setUpClass(cls):
        need_chromium()
        super().setUpClass()
        cls.server = cls.enterClassContext(Page(cls.folder))
        # Pages at rest: the processor would draw the playback of all pages.
        cls.browser = cls.enterClassContext(browser.Browser((*browser.SOFTWARE_WEBGL, "--force-prefers-reduced-motion")))

    def open(self, width=1280, more=""):
        page = self.browser.open(self.server.address + more, width, 900 if width > 700 else 844)
        self.addCleanup(page.send, "Page.navigate", url="about:blank")  # the server accepts 16 pages at a time
        self.assertTrue(page.wait("typeof explorer === 'object' && explorer.waits_ms.length > 0"))
        return page

    def use(self, page, changes, until="explorer.waits_ms.length"):
        page.run(f"(() => {{ const s = structuredClone(explorer.settings); {changes}; explorer.waits_ms.length = 0; explorer.use(s); }})()")
        self.assertTrue(page.wait(until))
