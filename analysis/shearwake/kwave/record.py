# SPDX-License-Identifier: BSD-3-Clause
"""What the sensor records, from the names in k-Wave's sensor.record."""
from .structures import BadInput

FIELDS = ["ux", "uy", "uz", "sxx", "syy", "szz", "sxy", "sxz", "syz"]
GRID = ("max_all", "min_all", "final")  # suffixes of records of the entire grid
SENSOR = ("max", "min", "rms")          # and of records at the sensor
SERIES = ("p", "u", "u_non_staggered", "u_split_field", "I")
KWAVE = [*SERIES, "I_avg", *(f"{quantity}_{suffix}" for quantity in "pu" for suffix in SENSOR + GRID)]
NAMES = [*FIELDS, *KWAVE]  # of the program


def recorded_fields(record):
    """The names of the program for those of sensor.record, in a fixed order. The fields are an extension of k-Wave's record; p is
    recorded with the normal stresses of which it is the negative mean."""
    names = set()
    for name in record:
        if name not in NAMES:
            raise BadInput(f"sensor.record {name!r} is unknown; known are {', '.join(NAMES)}")
        names.update(["p", "sxx", "syy", "szz"] if name == "p" else [name])
    return [name for name in NAMES if name in names]
