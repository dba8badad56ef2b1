#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The effect of a stiff elastic cube on the surface compared with that of a rigid one.

Usage: rigid_limit.py [--program build/shearwake] [--ranks 2] [--contrast 1e5]

A cube of 5.4 mm in 9 mm of tissue, steps of 10 us, and grids of 0.9 and 0.3 mm whose cells end at the faces of
the cube. Between the cells an elastic body is stiff up to a part of a spacing beyond its face. This error is of
first order, and three halves of the finer minus half of the coarser effect do not contain it. Prints the
differences from the rigid cube; exit code 1 if the extrapolated one exceeds 3 %. Takes some minutes. The test
"a rigid body is the limit of a stiff elastic one" is the same for a bar, in seconds.
"""
import argparse
import glob
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

JOB = """
schema = 1
[job]
name = "cube"
[medium]
base = "rigid"
[[medium.layer]]
name = "tissue"
thickness_mm = 9.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 0.5
{body}
[load]
peak_Pa = 1.0
footprint = {{ shape = "gaussian", fwhm_mm = 3.0 }}
[load.modulation]
kind = "STM"
path = {{ shape = "line", from_mm = [-5.0, 0.0], to_mm = [7.0, 0.0] }}
speed_m_s = 7.0
[domain]
extent_mm = [21.6, 21.6]
spacing_mm = {spacing}
[time]
duration_ms = 0.6
output_interval_us = 100.0
[solver]
engine = "spectral"
[solver.spectral]
time_step_us = 10.0
longest_element_mm = 1.8
contrast_cap = {contrast}
rigid_above = 1e9
[measure]
at_ms = 0.6
settled_after_ms = 0.1
focal_radius_mm = 1.0
[record]
snapshots_ms = [0.6]
"""
CUBE = """
[[medium.body]]
shape = "box"
size_mm = [5.4, 5.4, 5.4]
center_mm = [-4.05, 0.45, 4.5]
density_kg_m3 = 1900.0
"""


def surface(options, folder, spacing, body):
    """u_z of the surface at 0.6 ms at the points of the coarse grid."""
    job = Path(folder) / "cube.toml"
    job.write_text(JOB.format(spacing=spacing, body=body, contrast=options.contrast))
    out = tempfile.mkdtemp(dir=folder)
    subprocess.run(["mpirun", "-n", str(options.ranks), options.program, "run", str(job), "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    with h5py.File(glob.glob(out + "/cases/*.h5")[0], "r") as case:
        every = round(0.9 / spacing)
        return case["surface/u_z"][-1, 0, ::every, ::every]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/shearwake")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--contrast", type=float, default=1e5)
    options = parser.parse_args()
    elastic = CUBE + f"c_s_m_s = {5.0 * (options.contrast / 1.9) ** 0.5:.6g}\nc_p_m_s = 3517.0\n"
    with tempfile.TemporaryDirectory() as folder:
        without = {h: surface(options, folder, h, "") for h in (0.9, 0.3)}
        effect = {h: surface(options, folder, h, elastic) - without[h] for h in (0.9, 0.3)}
        rigid = surface(options, folder, 0.3, CUBE + "rigid = true\n") - without[0.3]

    def difference(found):
        return numpy.linalg.norm(found - rigid) / numpy.linalg.norm(rigid)

    limit = difference(1.5 * effect[0.3] - 0.5 * effect[0.9])
    print(f"effect of the rigid cube: {numpy.linalg.norm(rigid) / numpy.linalg.norm(without[0.3]):.3g} of the field")
    print(f"elastic cube at 0.9 mm: {difference(effect[0.9]):.2%}, at 0.3 mm: {difference(effect[0.3]):.2%}, "
          f"extrapolated: {limit:.2%}")
    return 0 if limit < 0.03 else 1


if __name__ == "__main__":
    sys.exit(main())
