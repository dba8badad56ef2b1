# SPDX-License-Identifier: BSD-3-Clause
"""The fields that the sensor records, from the names in k-Wave's sensor.record."""
from .structures import BadInput

FIELDS = ["ux", "uy", "uz", "sxx", "syy", "szz", "sxy", "sxz", "syz"]
SERIES = {"p": ["sxx", "syy", "szz"], "u": ["ux", "uy", "uz"]}  # p is minus the mean of the normal stresses
# Values that follow from time series, which are recorded instead.
DERIVED = {"max": "the maximum", "min": "the minimum", "rms": "the root mean square"}
HINT = "; shearwake kwave -i STUDY.h5 records it"
# Values on the entire grid and parts of the fields. They are not available.
ABSENT = {"p_final", "p_max_all", "p_min_all", "u_final", "u_max_all", "u_min_all", "u_split_field"}


def recorded_fields(record, notes):
    """The subset of FIELDS that is recorded. Adds a note for each name that the program treats otherwise than k-Wave."""
    fields = set()
    for name in record:
        quantity, _, suffix = name.partition("_")
        if name in FIELDS:  # an extension of k-Wave's record
            fields.add(name)
        elif name in SERIES:
            fields.update(SERIES[name])
        elif quantity in SERIES and suffix in DERIVED:
            fields.update(SERIES[quantity])
            notes.append(f"sensor.record '{name}' is not computed: the time series of {quantity} is recorded, of which "
                         f"it is {DERIVED[suffix]}{HINT}")
        elif name == "u_non_staggered":
            fields.update(SERIES["u"])
            notes.append("sensor.record 'u_non_staggered' is not computed: u is recorded at its staggered positions" + HINT)
        elif name in ("I", "I_avg"):
            fields.update(SERIES["p"] + SERIES["u"])
            notes.append(f"sensor.record '{name}' is not computed: the stresses and velocities are recorded, of which it "
                         f"is {'a product' if name == 'I' else 'an averaged product'}")
        elif name in ABSENT:
            notes.append(f"sensor.record '{name}' is not recorded: only time series at the nodes of sensor.mask are "
                         f"available{HINT}")
        else:
            raise BadInput(f"sensor.record '{name}' is unknown; known are p, u, {', '.join(FIELDS)} and the other names "
                           "of k-Wave")
    return [field for field in FIELDS if field in fields]
