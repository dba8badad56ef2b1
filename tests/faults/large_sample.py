#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""4096 samples of uncertain skin with engine layered on the grid of jobs/quickstart.toml, on two ranks.

Usage: PYTHONPATH=analysis:tests/end_to_end large_sample.py [--samples N] [--kills K]     SHEARWAKE: path of the program (default: build/shearwake)

Prints the time of the run and the estimate of `plan`, which can be compared on an idle machine. Kills another run K times; exit
code 1 if its table differs.
"""
import argparse
import json
import sys
import time
import unittest

from faults import FaultTest
from program import ROOT

WANTED = argparse.Namespace(samples=4096, kills=5)
SAMPLE = """[uncertain]
samples = {}
"medium.layer[1].c_s_m_s" = {{ preset = "forearm-skin" }}
"medium.layer[1].viscosity_Pa_s" = {{ distribution = "lognormal", median = 1.0, geometric_sd = 1.5 }}
"""


def sample_job(samples):
    """The quickstart with one frequency and no reference."""
    text = (ROOT / "jobs" / "quickstart.toml").read_text(encoding="utf-8")
    return text[:text.index("[sweep]")] + SAMPLE.format(samples)


class LargeSample(FaultTest):
    def test_kills_do_not_change_the_tables(self):
        self.write_job(sample_job(WANTED.samples))
        self.shearwake("run", "job.toml", "-S", "uncertain.samples=2", "--out", "rate", "--quiet", ranks=2)
        predicted_s = json.loads(self.shearwake("plan", "job.toml", "--json", ranks=2).stdout)["wall_s"]
        print(f"{WANTED.samples} samples: plan predicts {predicted_s:.1f} s", flush=True)
        began = time.monotonic()
        reference = self.undisturbed(1)
        taken_s = time.monotonic() - began
        print(f"the run took {taken_s:.1f} s, {100 * (taken_s / predicted_s - 1):+.0f} %", flush=True)
        kills = self.survive(seed=1, ranks_per_case=1, kills=WANTED.kills, reference=reference,
                             longest_s=max(3.0, 0.5 * predicted_s / WANTED.kills))
        print(f"{len(kills)} kills ({', '.join(kills)}): the tables are the same", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=WANTED.samples)
    parser.add_argument("--kills", type=int, default=WANTED.kills)
    parser.parse_args(namespace=WANTED)
    unittest.main(argv=sys.argv[:1])
