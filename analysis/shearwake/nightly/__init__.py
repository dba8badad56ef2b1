# SPDX-License-Identifier: BSD-3-Clause
"""Runs jobs every night and compares their tables with baselines and with earlier nights."""
