# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake compare`: the differences of two tables, cases or sweeps."""
