# SPDX-License-Identifier: BSD-3-Clause
"""k-Wave's elastic simulations: the function pstd_elastic_3d, and the import of files (scripts/import-kwave)."""
from .elastic import pstd_elastic_3d

__all__ = ["pstd_elastic_3d"]
