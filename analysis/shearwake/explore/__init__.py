# SPDX-License-Identifier: BSD-3-Clause
"""A page in the browser that computes while settings are changed."""
