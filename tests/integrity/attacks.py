# SPDX-License-Identifier: BSD-3-Clause
"""The number of attacks in the short and in the long form of the tests, attacks on HDF5 files, and commands with limits."""
import functools
import os
import random
import signal
import struct
import subprocess
import threading
import zlib

import h5py
import numpy

from program import PATIENCE_s, ROOT, command, environment

MOST_B = 300e6
# Processor time relative to that of a reference run. The commands of the tests need up to 4 times as much; the rest is for
# caches that other programs use, and for the seconds of processor time that `plan` grants itself on fast processors.
MOST_WORK = 50


def times(short, long):
    """The number of repetitions of an attack."""
    return long if os.environ.get("SHEARWAKE_LONG") else short


def ended(call, folder):
    """Runs a command to its end; returns its output, its exit code, and its use of CPU time and memory."""
    process = subprocess.Popen(call, cwd=folder, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT)
    timer = threading.Timer(PATIENCE_s, process.kill)
    timer.start()
    said = process.stdout.read().decode("utf-8", "replace")
    _, status, used = os.wait4(process.pid, 0)
    timer.cancel()
    process.stdout.close()
    process.returncode = os.waitstatus_to_exitcode(status)
    return said, process.returncode, used.ru_utime + used.ru_stime, 1024.0 * used.ru_maxrss


@functools.cache
def reference_s():
    """CPU time of a check that computes a lens, which measures the speed of this processor."""
    return ended(command("check", ROOT / "jobs" / "lens-letter.toml", "--elsewhere"), ROOT)[2]


def accepted_or_refused(test, call, codes, about):
    """Runs a command. It must end with one of the exit codes, without an internal error, and with at most MOST_WORK and MOST_B of memory.
    Returns the output and the exit code."""
    said, code, used_s, used_B = ended(call, test.folder)
    about += f", exit code {code}: {said}"
    test.assertIn(code, codes, f"killed after {PATIENCE_s} s: {about}" if code == -signal.SIGKILL else about)
    for words in ("internal error", "Traceback"):
        test.assertNotIn(words, said, about)
    test.assertLess(used_s / reference_s(), MOST_WORK, about)
    test.assertLess(used_B, MOST_B, about)
    return said, code


def png(header, data):
    """A PNG file with valid checksums of the given contents of its chunks: IHDR, and IDAT, which is compressed."""
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part))
        for name, part in ((b"IHDR", header), (b"IDAT", data), (b"IEND", b"")))


def grey_header(side):
    """The IHDR of a square picture of 8-bit grey values."""
    return struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)


ELSEWHERE = {"external link", "link over a link", "external storage", "virtual dataset"}  # the values are in other files


def sampled(attacks, seed, short=3):
    """Some of the attacks, with one of ELSEWHERE; all of them in the long form."""
    rng = random.Random(seed)
    order = [rng.choice(sorted(ELSEWHERE)), *rng.sample(sorted(attacks), len(attacks))]
    return [(kind, attacks[kind]) for kind in list(dict.fromkeys(order))[:times(short, len(attacks))]]


def attacks_on_hdf5(folder):
    """Changes of an HDF5 file that replace one of its datasets, by name: functions of the file, the name, and the shape. The files
    that some refer to are in the folder."""
    other = folder / "secret.h5"
    with h5py.File(other, "w") as file:
        file["d"] = numpy.full(5, 12345.6875)
    if not (folder / "pipe.h5").exists():
        os.mkfifo(folder / "pipe.h5")  # opening it would block

    def linked(file, name, shape):
        file["away"], file[name] = h5py.ExternalLink("pipe.h5", "/"), h5py.SoftLink("/away/d")

    def virtual(file, name, shape):
        layout = h5py.VirtualLayout((5,), "f8")
        layout[...] = h5py.VirtualSource(str(other), "d", (5,))
        file.create_virtual_dataset(name, layout)

    def loop(file, name, shape):
        file[name], file["there"] = h5py.SoftLink("/there"), h5py.SoftLink(f"/{name}")

    def own_parent(file, name, shape):
        group = file.create_group(name)
        group["itself"] = group

    def made(shape=None, dtype="f8", **more):
        return lambda file, name, own: file.create_dataset(name, own if shape is None else shape, dtype, **more)

    return {
        "external link": lambda file, name, shape: file.__setitem__(name, h5py.ExternalLink(other, "/d")),
        "link over a link": linked, "virtual dataset": virtual,
        "external storage": lambda file, name, shape: file.create_dataset(  # which h5py ignores for a number without dimensions
            name, shape or (1,), "f8", external=[(other, 0, h5py.h5s.UNLIMITED)]),
        "loop of links": loop, "group in itself": own_parent,
        "huge chunk": made((10,), chunks=(400_000_000,), maxshape=(None,), compression="gzip"),
        "huge claim": made((4_000_000_000,), chunks=(100_000,), compression="gzip"),
        "huge extent": made((1 << 60,), chunks=(1000,)), "committed type": lambda file, name, shape: file.__setitem__(name, numpy.dtype("f8")),
        "references": made(dtype=h5py.ref_dtype), "records": made(dtype=[("a", "f8"), ("b", "i4")]),
        "lists": made(dtype=h5py.vlen_dtype("f8")), "texts": made(dtype=h5py.string_dtype()), "opaque": made(dtype="V7"),
        "no values": made((0,)), "no space": lambda file, name, shape: file.__setitem__(name, h5py.Empty("f8")),
        "many dimensions": made((1,) * 32), "a number": made(()), "nothing": lambda file, name, shape: None,
        "name of control characters": lambda file, name, shape: file.__setitem__("\x1b[31m\n", h5py.ExternalLink(other, "/d")),
    }
