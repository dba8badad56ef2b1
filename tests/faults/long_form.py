#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A hundred kills during a sweep of forty cases with both engines; the table must not change.

Usage: long_form.py [--kills N] [--seed S]     SHEARWAKE: path of the program (default: build/shearwake)

Sweeps are started and killed (all processes, one rank, the launcher, or a rank during a write) until the number
of kills is reached; every second sweep computes each case on both ranks. Takes some minutes and prints the
counts; exit code 1 if a table differs.
"""
import argparse
import collections
import sys
import time
import unittest

from faults import FaultTest, both_engines

WANTED = argparse.Namespace(kills=100, seed=1)


class HundredKills(FaultTest):
    def test_the_table_is_the_same_after_a_hundred_kills(self):
        self.write_job(both_engines(20))
        began = time.monotonic()
        references = {ranks: self.undisturbed(ranks) for ranks in (1, 2)}
        undisturbed_s = time.monotonic() - began
        counts, sweeps = collections.Counter(), 0
        while sum(counts.values()) < WANTED.kills:
            ranks = 1 + sweeps % 2
            done = self.survive(seed=WANTED.seed + sweeps, ranks_per_case=ranks,
                                kills=min(30, WANTED.kills - sum(counts.values())),
                                reference=references[ranks], longest_s=2.0)
            counts.update(done)
            sweeps += 1
            print(f"sweep {sweeps}: {len(done)} kills, the table is the same", flush=True)
        print(f"{sum(counts.values())} kills ({dict(counts)}) over {sweeps} sweeps of 40 cases in "
              f"{time.monotonic() - began:.0f} s; two undisturbed ones take {undisturbed_s:.0f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=WANTED.kills)
    parser.add_argument("--seed", type=int, default=WANTED.seed)
    parser.parse_args(namespace=WANTED)
    unittest.main(argv=sys.argv[:1])
