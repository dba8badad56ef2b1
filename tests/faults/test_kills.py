# SPDX-License-Identifier: BSD-3-Clause
"""Kills (of all processes, one rank, the launcher, or a rank during a write) during small sweeps of both engines."""

import pytest

from faults import FaultTest, both_engines


class Kills(FaultTest):
    @pytest.mark.long
    def test_a_hundred_kills_do_not_change_the_table_of_forty_cases(self):
        self.write_job(both_engines(20))
        references = {ranks: self.undisturbed(ranks) for ranks in (1, 2)}
        kills, sweeps = 0, 0
        while kills < 100:
            ranks = 1 + sweeps % 2  # every second sweep computes each case on both ranks
            kills += len(self.survive(seed=1 + sweeps, ranks_per_case=ranks, kills=min(30, 100 - kills),
                                      reference=references[ranks], longest_s=2.0))
            sweeps += 1
