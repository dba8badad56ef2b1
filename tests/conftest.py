# SPDX-License-Identifier: BSD-3-Clause
"""Tests with @pytest.mark.long run if SHEARWAKE_LONG is set, as scripts/test --long does."""
import os

import pytest

LONG = bool(os.environ.get("SHEARWAKE_LONG"))


def pytest_collection_modifyitems(config, items):
    if not LONG:
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("long")])
        items[:] = [item for item in items if not item.get_closest_marker("long")]


def pytest_sessionfinish(session, exitstatus):
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and not LONG:  # all tests of the file are long
        session.exitstatus = pytest.ExitCode.OK
