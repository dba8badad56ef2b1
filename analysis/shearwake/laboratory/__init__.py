# SPDX-License-Identifier: BSD-3-Clause
"""Reads, converts and writes scans of laser vibrometers."""
