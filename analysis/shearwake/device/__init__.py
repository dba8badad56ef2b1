# SPDX-License-Identifier: BSD-3-Clause
"""Files of ultrasonic devices: what they play, and loads for them (docs/how-to/devices.md)."""
