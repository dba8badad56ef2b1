# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a report, one module each."""
