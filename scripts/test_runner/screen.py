# SPDX-License-Identifier: BSD-3-Clause
"""Prints results as they arrive and, between them, the running groups."""
import shutil
import sys
import threading
import time


class Screen:
    """Redraws the last line on a terminal; elsewhere prints one line per minute. Thread-safe."""

    def __init__(self, out=sys.stdout, every_s=60.0):
        self.out, self.every_s = out, every_s
        self.live = out.isatty()
        self.lock = threading.Lock()
        self.running = {}  # name of a group: its progress
        self.began = self.shown = time.monotonic()

    def started(self, name, progress):
        with self.lock:
            self.running[name] = progress

    def ended(self, name, text):
        with self.lock:
            self.running.pop(name, None)
            self._erase()
            print(text, file=self.out, flush=True)

    def refresh(self):
        """Updates the display; must be called often."""
        with self.lock:
            now = time.monotonic()
            if now - self.shown < (0.5 if self.live else self.every_s):
                return
            self.shown = now
            states = " | ".join(f"{name} {progress}" for name, progress in self.running.items())
            line = f"   {now - self.began:.0f} s: {states}"
            if self.live:
                self._erase()
                self.out.write(line[:shutil.get_terminal_size().columns - 1])
                self.out.flush()
            elif states:
                print(line, file=self.out, flush=True)

    def _erase(self):
        if self.live:
            self.out.write("\r\033[K")
