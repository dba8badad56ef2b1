# SPDX-License-Identifier: BSD-3-Clause
"""The number of attacks in the short and in the long form of the tests, and commands with limits."""
import os
import signal
import subprocess
import threading

from program import environment

MOST_B = 300e6
PATIENCE_s = 120.0  # of a busy machine


def times(short, long):
    """The number of repetitions of an attack."""
    return long if os.environ.get("SHEARWAKE_LONG") else short


def accepted_or_refused(test, call, codes, most_s, about):
    """Runs a command. It must end with one of the exit codes, without an internal error, and within most_s of CPU time and MOST_B
    of memory. Returns the output and the exit code."""
    process = subprocess.Popen(call, cwd=test.folder, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT)
    timer = threading.Timer(PATIENCE_s, process.kill)
    timer.start()
    said = process.stdout.read().decode("utf-8", "replace")
    _, status, used = os.wait4(process.pid, 0)
    timer.cancel()
    process.stdout.close()
    process.returncode = code = os.waitstatus_to_exitcode(status)
    about += f", exit code {code}: {said}"
    test.assertIn(code, codes, f"killed after {PATIENCE_s} s: {about}" if code == -signal.SIGKILL else about)
    for words in ("internal error", "Traceback"):
        test.assertNotIn(words, said, about)
    test.assertLess(used.ru_utime + used.ru_stime, most_s, about)
    test.assertLess(1024.0 * used.ru_maxrss, MOST_B, about)
    return said, code
