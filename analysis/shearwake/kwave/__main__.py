# SPDX-License-Identifier: BSD-3-Clause
"""Runs a saved simulation for the functions in analysis/matlab: python -m shearwake.kwave FILE FOLDER.

FILE has the structures that scripts/import-kwave reads. FOLDER receives NUMBER.bin, numbers of 64 bits with the first index
fastest, and index.txt with a line for each of them: name, number of the cuboid (1 without cuboids), size along each axis."""
import argparse
import sys
from pathlib import Path

import numpy as np

from ..errors import ShearwakeError
from .elastic import REFUSED, device_of, solve
from .files import structures
from .structures import BadInput, Structure


def main() -> int:
    parser = argparse.ArgumentParser(prog="shearwake.kwave")
    parser.add_argument("file", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--dimensions", type=int, choices=[2, 3], default=3)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--precision", choices=["double", "single"], default="double")
    parser.add_argument("--device", choices=["cpu", "gpu"], default="cpu")
    parser.add_argument("--device-num", type=int)
    chosen = parser.parse_args()
    try:
        parts, notes = structures(chosen.file)
        for field in REFUSED:
            if "sensor" in parts and field in parts["sensor"]:
                raise BadInput(f"sensor.{field} is not supported")
        options = parts.pop("options", None) or Structure({}, "options")
        parts["options"] = Structure({name: value for name, value in options.values.items() if name not in ("UsekSpace", "UseSG")},
                                     "options")
        if options.number("UseSG", 1.0) == 0.0:
            raise BadInput("options.UseSG must be true: the grid is staggered")
        device = device_of({"device": chosen.device, "device_num": chosen.device_num})
        found = solve(parts, notes, "F", chosen.ranks, None, chosen.precision, quiet=False, dimensions=chosen.dimensions, device=device)
    except (BadInput, ShearwakeError, OSError) as error:
        print(error, file=sys.stderr)
        return 1
    lines: list[str] = []
    for cuboid, values in enumerate(found if isinstance(found, list) else [found], 1):
        for name, array in values.items():
            np.asarray(array, dtype="<f8").ravel(order="F").tofile(chosen.folder / f"{len(lines) + 1}.bin")
            lines.append(f"{name} {cuboid} {' '.join(map(str, array.shape))}\n")
    (chosen.folder / "index.txt").write_text("".join(lines), encoding="utf-8")
    return 0


sys.exit(main())
