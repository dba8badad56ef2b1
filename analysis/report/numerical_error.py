# SPDX-License-Identifier: BSD-3-Clause
"""The numerical error of results, and the keys that affect only this error."""
import math
from dataclasses import replace

import layout
from words import number


def known(sweep, column):
    """The complete cases with a value in this column, without references."""
    return [c for c in layout.ordinary(sweep) if not math.isnan(c.value(column))]


def is_numerical(key):
    """Whether the key is a choice of the simulation, not of a display or of a user of one."""
    return key.startswith(("solver.", "domain.", "time.", "measure.", "record."))


def choices(sweep):
    """The sweep with only those keys in its labels that can be chosen for a display."""
    keys = [k for k in [sweep.x, *layout.group_keys(sweep)] if k and not is_numerical(k)]
    return replace(sweep, x=keys[0] if keys else "", label_keys=keys[1:])


def relative_error(sweep, column):
    """The largest estimated relative error of a column in the sweep; NaN if `shearwake converge` has studied no
    case."""
    ratios = [abs(c.value(column + "_error") / c.value(column)) for c in sweep.cases if c.value(column)]
    return max((r for r in ratios if not math.isnan(r)), default=math.nan)


def error(sweep, case, column):
    """The estimated error of a value: that of the case, or else the largest relative error of the sweep."""
    own = case.value(column + "_error")
    return relative_error(sweep, column) * abs(case.value(column)) if math.isnan(own) else own


def with_error(sweep, case, column, digits=3):
    """'0.4120 ± 0.0031', or the value alone if its error has not been estimated."""
    value, half = case.value(column), error(sweep, case, column)
    if math.isnan(half):
        return number(value, digits)
    places = min(6, max(0, 1 - math.floor(math.log10(half)))) if half > 0 else 6
    return f"{value:.{places}f} ± {half:.{places}f}"


def numerical_variants(sweep, case):
    """The valid cases that differ from a case only in numerical parameters, itself included."""
    own = {k: v for k, v in case.settings.items() if not is_numerical(k)}
    return [c for c in known(sweep, "eta_period_1") if c.is_valid
            and {k: v for k, v in c.settings.items() if not is_numerical(k)} == own]


def spread_of(cases):
    """Half of the range of eta, relative to its mean."""
    values = [c.value("eta_period_1") for c in cases]
    return 0.5 * (max(values) - min(values)) / (sum(values) / len(values))


def uncertainty(sweep, case, column):
    """The relative error of eta or of its ratio to the reference: from numerical variants of the case or from
    `shearwake converge`, the larger of both; NaN if neither exists."""
    found = [spread_of(cases)] if len(cases := numerical_variants(sweep, case)) > 1 else []
    estimated = error(sweep, case, column) / case.value(column)
    return max([*found, *([] if math.isnan(estimated) else [estimated])], default=math.nan)
