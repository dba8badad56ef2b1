# SPDX-License-Identifier: BSD-3-Clause
"""Finds and runs the program `shearwake`."""
from __future__ import annotations

import ctypes
import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, Sequence

from .errors import BY_EXIT_CODE, Diagnostic, ProgramError, ProgramNotFound

# Variables of Open MPI, PRRTE, PMIx, MPICH and Intel MPI; among them those that users set, and of these those of a launcher.
OF_LAUNCHERS = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDI_", "HYDRA_", "MPI_LOCAL")
OF_USERS = ("OMPI_MCA_", "OMPI_ALLOW_RUN_AS_ROOT", "PMIX_MCA_", "PRTE_MCA_", "PRTE_ALLOW_RUN_AS_ROOT", "HYDRA_LAUNCHER",
            "HYDRA_HOST_FILE")
OF_RANKS = ("OMPI_MCA_orte_", "OMPI_MCA_ess", "OMPI_MCA_pmix", "OMPI_MCA_initial_wdir")
# For ranks that share cores with other programs, and for root in a container: Open MPI 4 (OMPI) and 5 (PRTE) otherwise refuse more
# ranks than cores, bind them to cores and refuse root. MPICH does not and ignores these variables.
SHARED_CORES = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
                "OMPI_MCA_hwloc_base_binding_policy": "none", "PRTE_MCA_hwloc_default_binding_policy": "none",
                "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def find() -> str:
    """The path of the program: the environment variable SHEARWAKE, next to the package in a source tree or an installation,
    or on the PATH. Raises ProgramNotFound."""
    here = Path(__file__).resolve().parents[2]
    candidates = [os.environ.get("SHEARWAKE", ""), str(here / "build" / "shearwake"),
                  str(here.parent.parent / "bin" / "shearwake"),
                  *(str(Path(folder) / "shearwake") for folder in os.get_exec_path())]
    for candidate in candidates:
        found = shutil.which(candidate) if candidate else None
        if found and not is_entry_point(found):
            return found
    raise ProgramNotFound("the program shearwake is not on the PATH; install it with cmake --install, or set the environment "
                          "variable SHEARWAKE to its path. Reading results does not need it")


def is_entry_point(path: str) -> bool:
    """Whether a file is the script that pip makes of command(), and not the program."""
    with open(path, "rb") as file:
        return b"shearwake.program" in file.read(1000)


def command() -> None:
    """Replaces this process by the program: the command `shearwake` in an environment of pip."""
    try:
        path = find()
    except ProgramNotFound as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(6)
    os.execv(path, ["shearwake", *sys.argv[1:]])


def jobs() -> dict[str, Path]:
    """The jobs that are installed with the program, by name: Job(jobs()["quickstart"]). Raises ProgramNotFound if there are none."""
    folders = [Path(__file__).resolve().parents[2] / "jobs"]
    if not folders[0].is_dir():
        program = Path(find()).resolve()
        folders = [program.parents[1] / "jobs", program.parents[1] / "share" / "shearwake" / "jobs"]
    found = {path.stem: path for folder in folders for path in sorted(folder.glob("*.toml"))}
    if not found:
        raise ProgramNotFound(f"{' and '.join(map(str, folders))} contain no jobs; install the program with cmake --install")
    return found


def environment() -> dict[str, str]:
    """The environment without the variables by which a process joins the MPI program that has started this one: the program would
    otherwise become one of its ranks. Without hwloc's OpenCL component, mpirun forwards SIGUSR1 (docs/how-to/cluster.md)."""
    inherited = {name: value for name, value in os.environ.items()
                 if not name.startswith(OF_LAUNCHERS) or (name.startswith(OF_USERS) and not name.startswith(OF_RANKS))}
    return {"HWLOC_COMPONENTS": "-opencl", **inherited}


def launched(arguments: Sequence[str], ranks: int = 1, launch: Sequence[str] | None = None) -> list[str]:
    """The command that starts the program on `ranks` ranks, with mpirun or with the words of `launch`."""
    prefix = list(launch) if launch is not None else ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    if prefix and not shutil.which(prefix[0]):
        raise ProgramNotFound(f"{prefix[0]} is not on the PATH; several ranks need it (Debian: openmpi-bin)")
    return [*prefix, find(), *arguments]


LIBRARY = ctypes.CDLL(None)
PR_SET_PDEATHSIG = 1  # of prctl(2)


def stop_with_caller() -> None:
    """For `preexec_fn`: the kernel requests an orderly stop of the program when the thread that has started it ends, also by a signal."""
    LIBRARY.prctl(PR_SET_PDEATHSIG, signal.SIGUSR1)


def start(arguments: Sequence[str], ranks: int = 1, launch: Sequence[str] | None = None, stdin: int = subprocess.DEVNULL,
          **options: Any) -> subprocess.Popen[Any]:
    """Starts a command. `options` are those of subprocess.Popen."""
    return subprocess.Popen(launched(arguments, ranks, launch), env=environment(), stdin=stdin, **options)


def call(arguments: Sequence[str], accept: Sequence[int] = (0,), ranks: int = 1,
         launch: Sequence[str] | None = None) -> subprocess.CompletedProcess[str]:
    """Runs a command to its end. Raises the ProgramError of any exit code that is not accepted."""
    done = subprocess.run(launched(arguments, ranks, launch), env=environment(), stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8",
                          errors="replace", check=False)
    if done.returncode not in accept:
        raise error_of(done.returncode, done.stderr or done.stdout)
    return done


def call_json(arguments: Sequence[str], accept: Sequence[int] = (0,)) -> dict[str, Any]:
    """The JSON document of a command. Raises ProgramError."""
    done = call([*arguments, "--json"], accept)
    try:
        return json.loads(done.stdout)
    except ValueError:
        raise error_of(done.returncode, done.stderr or done.stdout) from None


def error_of(exit_code: int, text: str, diagnostics: Sequence[Diagnostic] = ()) -> ProgramError:
    """The exception of an exit code with the text of the program."""
    kind = BY_EXIT_CODE.get(exit_code, ProgramError)
    return kind(text.strip() or f"shearwake ended with exit code {exit_code}", exit_code, diagnostics)


def diagnostics_of(document: dict[str, Any]) -> list[Diagnostic]:
    """The errors and warnings of a JSON document."""
    return [Diagnostic(d["severity"], d["file"], d["line"], d["column"], d["message"]) for d in document["diagnostics"]]
