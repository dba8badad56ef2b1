# SPDX-License-Identifier: BSD-3-Clause
"""Readers of files in a process of their own."""
import importlib
import os
import pickle
import resource
import signal
from collections.abc import Callable
from pathlib import Path

from ..inputs import ALLOWED_B
from .scan import BadScan, Scan

SLOWEST_B_S = 20_000_000  # libraries that need longer are caught in a loop
BUFFERS_B = 50_000_000  # address space of the buffers of a library


def limit_child(seconds: int, more_B: int) -> None:
    """Limits the CPU time of this process, its time, and the memory that it may allocate from now on."""
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(10 * seconds)  # busy machines and network file systems
    used_B = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    most_B = used_B + more_B
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (most_B if hard == resource.RLIM_INFINITY else min(most_B, hard), hard))


def in_child(read: Callable[[Path], Scan], path: Path, library: str = "h5py") -> Scan:
    """read(path) in a forked process with limits of time and memory: a damaged file can crash the library that reads it,
    or keep it busy."""
    size_B = path.stat().st_size
    seconds = 8 + size_B // SLOWEST_B_S
    most_B = 3 * ALLOWED_B + BUFFERS_B + 20 * size_B  # three copies of the values, and a compression to a seventh
    source, sink = os.pipe()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            importlib.import_module(library)  # what it allocates for itself is not limited
            limit_child(seconds, most_B)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # messages of the C library about damaged memory
            answer: Scan | BadScan
            try:
                answer = read(path)
            except BadScan as error:
                answer = error
            except MemoryError:
                answer = BadScan(f"the file is damaged, or does not fit into memory: its {size_B} bytes need more than "
                                 f"{most_B / 1e6:.0f} MB, the limit for a file of this size")
            with os.fdopen(sink, "wb") as out:
                pickle.dump(answer, out, protocol=5)
            code = 0
        finally:
            os._exit(code)
    os.close(sink)
    with os.fdopen(source, "rb") as file:
        content = file.read()
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGALRM):
        raise BadScan(f"it takes more than {seconds} s to read, more than its size explains; it is damaged")
    if status != 0:
        raise BadScan("the library that reads such files fails at it; the file is damaged, or does not fit into memory")
    answer = pickle.loads(content)
    if isinstance(answer, BadScan):
        raise answer
    return answer
