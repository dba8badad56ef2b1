# SPDX-License-Identifier: BSD-3-Clause
"""Converts the structures of a k-Wave simulation to the input file of pstdElastic3D, which `shearwake kwave` runs. docs/how-to/kwave.md
has an example."""
from __future__ import annotations

import argparse
import contextlib
import difflib
import errno
import os
import shlex
import sys
from pathlib import Path
from typing import Iterator

from .checks import check_layer_nodes
from .describe import lines_of, summary_of
from .files import structures
from .layout import write_input
from .plane import in_space, is_plane
from .record import flags_of
from .structures import BadInput
from .study import Study

DESCRIPTION = """\
Converts a simulation of k-Wave (pstdElastic3D, pstdElastic2D) to the input file that k-Wave itself writes with
'SaveToDisk' in three dimensions, with numbers of 64 bits, and prints the command that runs it. A plane has Nz = 1.
Errors name the field of k-Wave to change."""

EPILOG = """\
structures in FILE (all fields: docs/how-to/kwave.md):
  kgrid    Nx, Ny, Nz, dx, dy, dz, dt, Nt (a struct, not the object kWaveGrid); without Nz and dz a plane
  medium   sound_speed_compression, sound_speed_shear, density; optionally absorption
  source   u_mask with ux, uy, uz; s_mask with sxx ... syz; p0
  sensor   mask, record (optional)
  options  PMLSize, PMLAlpha, PMLInside, MultiAxialPMLRatio, ScaleSourceTerms, Smooth (optional); a struct, or a
           cell array of names and values, which may also be named input_args

example:
  scripts/import-kwave study.mat        writes study.h5
  mpirun -n 2 shearwake kwave -i study.h5 -o study-output.h5 --p_raw

The output lists the ranges of indices of sources and sensor, counted from 1 along x, y and z. Compare them
with k-Wave: an array that was stored with reversed indices (h5py without array.T) appears with x and z swapped.

exit codes: 0 done, 2 wrong arguments, 3 the simulation cannot be imported, 6 a file cannot be read or written
"""


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="import-kwave", description=DESCRIPTION, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, metavar="FILE",
                        help=".mat file of MATLAB, Octave or SciPy, or an HDF5 file with the structures below")
    parser.add_argument("--out", type=Path, metavar="NAME", help="output file without extension (default: the "
                        "name of the input file, in the working directory)")
    return parser.parse_args()


@contextlib.contextmanager
def complete(path: Path) -> Iterator[Path]:
    """A temporary name for the file, which is renamed when it is complete."""
    part = path.with_name(path.name + ".part")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def missing_file(path: Path) -> str:
    near = difflib.get_close_matches(path.name, [entry.name for entry in path.parent.iterdir() if entry.is_file()]
                                     if path.parent.is_dir() else [], n=1)
    return (f"{path}: no such file" + (f"; did you mean {path.with_name(near[0])}?" if near else
            f"; the working directory is {Path.cwd()}"))


def output_of(chosen: argparse.Namespace) -> Path:
    """The path of the output file. Raises BadInput and NotADirectoryError."""
    out = chosen.out or Path(chosen.file.stem)
    out = out.with_name(out.name.removesuffix(".h5") + ".h5")
    if not out.parent.is_dir():
        raise NotADirectoryError(errno.ENOENT, "the folder of the output file does not exist", str(out.parent))
    if out.resolve() == chosen.file.resolve():
        raise BadInput(f"{out} would replace the input file; choose another name with --out")
    return out


def main() -> int:
    chosen = options()
    try:
        parts, notes = structures(chosen.file)
        study = Study(in_space(parts) if is_plane(parts["kgrid"]) else parts, notes)
        check_layer_nodes(study)
        out = output_of(chosen)
        with complete(out) as part:
            write_input(part, study)
    except BadInput as problem:
        print(f"import-kwave: {problem}", file=sys.stderr)
        return 3
    except FileNotFoundError as problem:
        print(f"import-kwave: {missing_file(Path(problem.filename))}", file=sys.stderr)
        return 6
    except OSError as problem:
        print(f"import-kwave: {problem.filename or chosen.file}: {problem.strerror or problem}", file=sys.stderr)
        return 6
    except MemoryError:
        print(f"import-kwave: {chosen.file} needs more memory than there is", file=sys.stderr)
        return 6
    except Exception as problem:  # users cannot do anything with a traceback
        print(f"import-kwave: {chosen.file} cannot be converted: {type(problem).__name__}: {problem}",
              file=sys.stderr)
        return 3
    for warning in study.warnings:
        print(f"warning: {warning}")
    for note in study.notes:
        print(f"note: {note}")
    print(summary_of(out, study))
    for line in lines_of(study):
        print(f"  {line}")
    result = out.with_name(out.name.removesuffix(".h5") + "-output.h5")
    print(f"next: shearwake kwave -i {shlex.quote(str(out))} -o {shlex.quote(str(result))} {' '.join(flags_of(study.sensor_fields))} "
          f"-s {study.sensor_start}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
