# SPDX-License-Identifier: BSD-3-Clause
"""`shearwake compare`: two cases or sweeps side by side."""
