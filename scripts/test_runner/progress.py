# SPDX-License-Identifier: BSD-3-Clause
"""Reads the progress that the tests of one group report while they run.

Each process appends lines to its own file, STEM or STEM.<rank>:

    total N       the number of test cases that the process will run
    begin NAME    a test case has started
    end NAME      a test case has ended
    alive         a test case is making progress, at most one line per second

tests/catch_main.cpp and unittest_main.py write these lines. A process that waits for another process, or
that spins in a collective operation that never completes, writes nothing, even if it uses CPU time.
"""


class Progress:
    def __init__(self, stem):
        self.stem = stem
        self.read_bytes, self.partial = {}, {}
        self.total, self.ended, self.running = {}, {}, {}

    def clear(self):
        """Removes the files of an earlier run."""
        for path in self.stem.parent.glob(self.stem.name + "*"):
            path.unlink()

    def poll(self):
        """Reads the new lines and returns the set of their first words."""
        kinds = set()
        for path in sorted(self.stem.parent.glob(self.stem.name + "*")):
            with open(path, "rb") as file:
                file.seek(self.read_bytes.get(path, 0))
                new = file.read()
            if not new:
                continue
            self.read_bytes[path] = self.read_bytes.get(path, 0) + len(new)
            *lines, self.partial[path] = (self.partial.get(path, b"") + new).split(b"\n")
            kinds.update(self._take(path, line.decode("utf-8", "replace")) for line in lines)
        return kinds

    def _take(self, path, line):
        kind, _, rest = line.partition(" ")
        if kind == "total":
            self.total[path] = int(rest)
        elif kind == "begin":
            self.running[path] = rest
        elif kind == "end":
            self.ended[path] = self.ended.get(path, 0) + 1
            self.running.pop(path, None)
        return kind

    def __str__(self):
        """The progress of the process that is farthest behind, for example `12/68 name of the test`."""
        if not self.total:
            return "starting"
        last = min(self.total, key=lambda path: self.ended.get(path, 0))
        counts = f"{self.ended.get(last, 0)}/{self.total[last]}"
        return f"{counts} {self.running.get(last, '')}".rstrip()

    def still_running(self):
        """One line per process that is running a test case."""
        return [f"{path.name[len(self.stem.name):] or 'rank 0'}: in \"{name}\"".replace(".", "rank ", 1)
                if path != self.stem else f'in "{name}"' for path, name in sorted(self.running.items())]
