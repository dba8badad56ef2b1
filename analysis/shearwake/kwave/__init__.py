# SPDX-License-Identifier: BSD-3-Clause
"""k-Wave's elastic simulations: the functions pstd_elastic_2d and pstd_elastic_3d, and the import of files (scripts/import-kwave)."""
from .elastic import pstd_elastic_2d, pstd_elastic_3d

__all__ = ["pstd_elastic_2d", "pstd_elastic_3d"]
