# SPDX-License-Identifier: BSD-3-Clause
"""Commands with limits of time and memory, and the number of repetitions in the short and in the long form of the tests."""
import functools
import os
import signal
import struct
import subprocess
import threading
import zlib

from program import PATIENCE_s, ROOT, command, environment

MOST_B = 300e6
# Processor time relative to that of a reference run. The commands of the tests need up to 4 times as much; the rest is for
# caches that other programs use, and for the seconds of processor time that `plan` grants itself on fast processors.
MOST_WORK = 50


def times(short, long):
    """The number of repetitions of a test."""
    return long if os.environ.get("SHEARWAKE_LONG") else short


def ended(call, folder):
    """Runs a command to its end; returns its output, its exit code, and its use of CPU time and memory."""
    process = subprocess.Popen(call, cwd=folder, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT)
    timer = threading.Timer(PATIENCE_s, process.kill)
    timer.start()
    output = process.stdout.read().decode("utf-8", "replace")
    _, status, used = os.wait4(process.pid, 0)
    timer.cancel()
    process.stdout.close()
    process.returncode = os.waitstatus_to_exitcode(status)
    return output, process.returncode, used.ru_utime + used.ru_stime, 1024.0 * used.ru_maxrss


@functools.cache
def reference_s():
    """CPU time of a check that computes a lens, which measures the speed of this processor."""
    return ended(command("check", ROOT / "jobs" / "lens-letter.toml", "--elsewhere"), ROOT)[2]


def accepted_or_refused(test, call, codes, about):
    """Runs a command. It must end with one of the exit codes, without an internal error, and with at most MOST_WORK and MOST_B of memory.
    Returns the output and the exit code."""
    output, code, used_s, used_B = ended(call, test.folder)
    about += f", exit code {code}: {output}"
    test.assertIn(code, codes, f"killed after {PATIENCE_s} s: {about}" if code == -signal.SIGKILL else about)
    for words in ("internal error", "Traceback"):
        test.assertNotIn(words, output, about)
    test.assertLess(used_s / reference_s(), MOST_WORK, about)
    test.assertLess(used_B, MOST_B, about)
    return output, code


def png(header, data):
    """A PNG file with valid checksums of the given contents of its chunks: IHDR, and IDAT, which is compressed."""
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part))
        for name, part in ((b"IHDR", header), (b"IDAT", data), (b"IEND", b"")))


def grey_header(side):
    """The IHDR of a square picture of 8-bit grey values."""
    return struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
