# SPDX-License-Identifier: BSD-3-Clause
"""The opening of the page: the question of the job, the answer, and three numbers."""
from __future__ import annotations

import math
import re

from ...case import Case
from ...tables import read_statistics
from .. import layout, optima, sample, summary
from ..load import Selection
from ..numerical_error import valid
from ..words import number

LONGEST = 340  # characters of the question; the job file on the page has the rest of the comment
SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z0-9])")
Number = tuple[str, str, str]  # value, meaning, comparison


def question(selection: Selection) -> str:
    """The first sentences of the comment at the beginning of the job file, to the first question; '' without a comment."""
    lines = []
    for line in selection.sweep.job_text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("#").strip())
    words = " ".join(line for line in lines if not line.startswith(("SPDX-", ":schema")))
    text = ""
    for part in SENTENCE.split(words):
        if text and len(text) + len(part) >= LONGEST:
            break
        text += (" " if text else "") + part
        if part.endswith("?"):
            break
    text = text.replace("`", "")
    return text if len(text) <= LONGEST or text.endswith("?") else text[:LONGEST].rpartition(" ")[0] + " …"


def answer(text: str) -> tuple[str, str]:
    """The first sentence of a summary, and the others."""
    first, *others = SENTENCE.split(text, maxsplit=1)
    return first, "".join(others)


def amount(value: float) -> str:
    return number(value, 3)


def factor(value: float, other: float, name: str) -> str:
    """'0.56 times that of plain STM'; '' without a reference. `name` is 'of plain STM'."""
    return f"{number(value / other, 3)} times that {name}" if other and math.isfinite(value / other) else ""


def of_case(selection: Selection, case: Case) -> list[Number]:
    """Efficiency, strength and spread of a case, compared with its reference."""
    own = summary.reference_for(selection, case)
    name = summary.of_reference(selection, case) if own else ""
    found: list[Number] = []
    eta = case.value("eta_period_1", math.nan)
    if not math.isnan(eta):
        other = own.value("eta_period_1", math.nan) if own else math.nan
        versus = [f"{number(100 * other, 3)} % {re.sub('^of ', 'with ', name)}"] if math.isfinite(other) else []
        if own and not selection.reference_of(case) and (place := summary.place_of(selection, case)):
            versus.append(f"at {place}")
        found.append((f"{number(100 * eta, 3)} %", "of the energy is at the focus (η)", ", ".join(versus)))
    for column, unit, meaning in (("focal_rms_um", "µm", "rms of the displacement at the focus (strength)"),
                                  ("participation_period_mm2", "mm²", "area that vibrates (spread)")):
        value = case.value(column, math.nan)
        if not math.isnan(value):
            found.append((f"{amount(value)}\u00a0{unit}", meaning, factor(value, own.value(column, math.nan), name) if own else ""))
    return found


def of_receptors(selection: Selection) -> list[Number]:
    """The largest number of spikes of each class, and where."""
    found: list[Number] = []
    for kind, spikes in summary.spikes_of(selection).items():
        most = max(count for _, count in spikes)
        place = summary.places(selection, [case for case, count in spikes if count == most]) if most else "silent in each case"
        found.append((f"{most}", f"spikes of the {kind} afferents", place if len(spikes) > 1 else ""))
    return found


def of_samples(selection: Selection) -> list[Number]:
    """Probabilities, median and range of a job with [uncertain]."""
    best = sample.best(selection)
    if best is None:
        return []
    column, place, rows = best
    name = sample.column_words(selection, column)
    low, high = (amount(rows[q]["value"]) for q in ("q05", "q95"))
    highest = f"{sample.label(selection, place)}, the highest median" if sample.swept(selection) else ""
    found: list[Number] = []
    statistics = read_statistics(selection.sweep.folder, selection.sweep.name)
    for threshold, value in selection.sweep.uncertain["exceedance"].items():
        if likely := sample.likeliest(selection, statistics, threshold, value):
            where, row = likely
            doubt = f" ({row['note']})" if row["note"] else ""
            least, most = (number(100 * row[end], 2) for end in ("low_95", "high_95"))
            found.append((f"{least} to {most} %", f"probability that {sample.column_words(selection, threshold)} exceeds {number(value)} "
                          "(95 % confidence interval)", sample.label(selection, where) + doubt))
    return [*found, (amount(rows["q50"]["value"]), f"median of {name}", highest),
            (f"{low} to {high}", f"{name} in 90 % of the samples", highest)]


def of_optima(selection: Selection) -> list[Number]:
    """Efficiency, upper bound and strength of the optimum that the answer names."""
    rows = next(iter(optima.by_case(selection).values()))
    row = next(r for r in rows if r["strength_at_least_1"] == optima.middle(rows))
    name = optima.words(optima.optima(selection).maximised)

    def plain(value: str) -> str:
        return "" if "unmodulated" in optima.invalid(selection) else f"{value} without modulation"
    uniformity, drawn = (row.get(f"uniformity_{name}_1", math.nan) for name in ("optimum", "unmodulated"))
    last = ((number(uniformity, 2), "uniformity: smallest rms along the path relative to its mean",
             plain(number(drawn, 2)) if math.isfinite(drawn) else "") if math.isfinite(uniformity) else  # nan: the focus rests
            (amount(row["strength_at_least_1"]), "strength at least, relative to the load without modulation", ""))
    return [(amount(row["eta_optimum_1"]), f"{name} of the optimum", plain(amount(row["eta_unmodulated_1"]))),
            (amount(row["eta_ceiling_1"]), "proven upper bound for its path", f"{amount(row['ceiling_over_optimum_1'])} times the optimum"),
            last]


def numbers(selection: Selection) -> list[Number]:
    """At most three numbers that state the result: of the best case, of receptors, or of both. Receptors come first if no
    efficiency is valid."""
    if not layout.ordinary(selection):
        return []
    if selection.sweep.uncertain:
        return of_samples(selection)[:3]
    if optima.is_study(selection):
        return of_optima(selection) if "optimum" not in optima.invalid(selection) else []
    names_none = summary.is_incomplete(selection) or summary.sweeps_numbers_only(selection)
    best = None if names_none else summary.best_case(selection)
    receptors, of_best = of_receptors(selection), of_case(selection, best) if best else []
    return ([*of_best[:1], *receptors, *of_best[1:]] if valid(selection, "eta_period_1") else [*receptors, *of_best])[:3]
