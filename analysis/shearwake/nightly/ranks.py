# SPDX-License-Identifier: BSD-3-Clause
"""How the tests and the nightly run start several ranks next to other programs."""
import os

from .. import program

# Settings of Open MPI 4 (OMPI) and 5 (PRTE), where mpirun otherwise refuses more ranks than cores and binds ranks to
# cores that other programs may use. MPICH does neither and ignores them.
SHARED_CORES = {
    "OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_MCA_hwloc_base_binding_policy": "none", "PRTE_MCA_hwloc_default_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # in a container


def environment() -> dict[str, str]:
    return {**program.environment(), **SHARED_CORES, **(AS_ROOT if os.geteuid() == 0 else {})}


def launch(ranks: int) -> list[str]:
    """The words before the path of a program that start it on `ranks` ranks."""
    return ["mpirun", "-n", str(ranks)] if ranks > 1 else []
