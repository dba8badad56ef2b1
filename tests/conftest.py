# SPDX-License-Identifier: BSD-3-Clause
"""Tests with @pytest.mark.long run if SHEARWAKE_LONG is set, as scripts/test --long does, and tests with
@pytest.mark.extended unless SHEARWAKE_SMALL is set, as scripts/test does. Lists the tests that needed most processor time."""
import os
import resource

import pytest

LEFT_OUT = {"long"} if not os.environ.get("SHEARWAKE_LONG") else set()
if os.environ.get("SHEARWAKE_SMALL"):
    LEFT_OUT.add("extended")
times_s = {}  # of tests with their processes


def processor_time_s():
    usages = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def pytest_collection_modifyitems(config, items):
    left_out = [item for item in items if any(map(item.get_closest_marker, LEFT_OUT))]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in left_out]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item):
    began_s = processor_time_s()
    yield
    times_s[item.nodeid] = processor_time_s() - began_s


def pytest_terminal_summary(terminalreporter):
    terminalreporter.section(f"processor time: {processor_time_s():.1f} s")
    for name, time_s in sorted(times_s.items(), key=lambda item: -item[1])[:int(os.environ.get("SHEARWAKE_SLOWEST", 10))]:
        terminalreporter.write_line(f"{time_s:6.2f} s {name}")


def pytest_sessionfinish(session, exitstatus):
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and LEFT_OUT:  # all tests are left out
        session.exitstatus = pytest.ExitCode.OK
