# SPDX-License-Identifier: BSD-3-Clause
"""Common parts of the attacks: their number in the short and in the long form, and a ledger of the outcomes, which
long_form.py prints."""
import collections
import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "end_to_end"), str(HERE.parent / "faults"),
                str(HERE.parent.parent / "analysis" / "report")]

LONG_FORM = os.environ.get("SHEARWAKE_ATTACKS") == "long"


def times(short, long):
    """The number of repetitions of an attack."""
    return long if LONG_FORM else short


class Ledger:
    """Counts by attack and outcome."""

    def __init__(self):
        self.counts = collections.OrderedDict()

    def add(self, attack, outcome, number=1):
        outcomes = self.counts.setdefault(attack, collections.Counter())
        outcomes[outcome] += number

    def rows(self):
        return [(attack, outcome, number) for attack, outcomes in self.counts.items()
                for outcome, number in outcomes.items()]

    def markdown(self):
        lines = ["| attack | number | outcomes |", "|---|---|---|"]
        for attack, outcomes in sorted(self.counts.items()):
            listed = ", ".join(f"{number} × {outcome}" for outcome, number in outcomes.items())
            lines.append(f"| {attack} | {sum(outcomes.values())} | {listed} |")
        return "\n".join(lines) + "\n"


LEDGER = Ledger()
