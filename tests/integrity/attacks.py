# SPDX-License-Identifier: BSD-3-Clause
"""The number of attacks in the short and in the long form of the tests."""
import os


def times(short, long):
    """The number of repetitions of an attack."""
    return long if os.environ.get("SHEARWAKE_LONG") else short
