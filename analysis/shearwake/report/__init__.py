# SPDX-License-Identifier: BSD-3-Clause
"""Draws the figures of an output folder, its HTML page and movies, and compares cases and sweeps."""
