# SPDX-License-Identifier: BSD-3-Clause
"""The last periods of long runs."""
from __future__ import annotations

from typing import Any

from ...case import Case

LONG = 12  # periods per run, from which on the last ones are drawn in addition
LAST = 5   # periods that are drawn


def frequencies_Hz(node: Any) -> list[float]:
    """All frequencies within the description of a modulation."""
    if isinstance(node, list):
        return [f for item in node for f in frequencies_Hz(item)]
    if not isinstance(node, dict):
        return []
    own = [v for k, v in node.items() if k.endswith("frequency_Hz") and isinstance(v, (int, float)) and v > 0]
    return own + [f for v in node.values() for f in frequencies_Hz(v)]


def period_ms(case: Case) -> float | None:
    """The longest period of the modulation; None for plain STM."""
    found = frequencies_Hz(case.setting("load", "modulation", default={}))
    return 1e3 / min(found) if found else None


def last_span_ms(cases: list[Case]) -> tuple[float, float] | None:
    """Start and end of the last periods of the cases; None if a run has few periods or no modulation."""
    periods = [period for case in cases if (period := period_ms(case))]
    end = max(1e3 * case.over_time["time"][-1] for case in cases)
    if not periods or end < LONG * max(periods):
        return None
    return end - LAST * max(periods), end
