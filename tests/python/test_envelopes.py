# SPDX-License-Identifier: BSD-3-Clause
"""The best envelope and its upper bound, for quadratic forms with known optima."""
import itertools
from dataclasses import replace

import numpy as np
import pytest

from shearwake.checksum import sealed
from shearwake.studies.bounds import ceiling
from shearwake.studies.envelopes import Forms, Required, best_am, best_envelope, feasible, forms_in, measured, search_from, starts
from shearwake.studies.optimum import (MotionChange, OptimisedCase, Options, StudyError, changes_around, differences_by, find_optimum,
                                       read_forms, read_optimum)
from shearwake.studies.optimum_files import waveform_of

OPTIONS = Options("eta_period_1", ["envelope"], 250e-6, [0.8], 0.0, 4, 1.44, 6, [], [], [], 0.0, [], 0.0, 8)


def forms_of(numerator, denominator, focal, path=()):
    count = len(numerator)
    return Forms(*(np.array(form, dtype=float) for form in (numerator, denominator, focal)), float(np.sum(focal)),
                 np.array(path, dtype=float).reshape(-1, count, count))


def forms_with_memory(knots, memory):
    """Forms like those of a focus with a wake: N is a band, and D adds a decaying memory."""
    lag = np.abs(np.subtract.outer(np.arange(knots), np.arange(knots))).astype(float)
    numerator = 1e-9 * np.exp(-2.0 * lag**2)
    return forms_of(numerator, numerator + 4e-9 * np.exp(-lag / memory) * np.cos(0.8 * lag), numerator)


@pytest.mark.parametrize("strength", [0.6, 0.8, 1.0])
@pytest.mark.parametrize("memory", [3.0, 12.0])
def test_the_best_envelope_meets_its_constraints_and_stays_below_the_bound(strength, memory):
    forms = forms_with_memory(24, memory)
    best, bound = best_envelope(forms, Required(strength), 8), ceiling(forms, strength)
    assert 0.0 <= best.values.min() and best.values.max() <= 1.0
    assert best.strength >= strength * (1.0 - 1e-14)  # rounding
    assert best.eta == forms.eta(best.values)
    for start in starts(24, 8):
        if forms.squared_strength(start) >= strength**2:
            assert best.eta >= forms.eta(start) * (1.0 - 1e-12)  # rounding
    assert bound.is_valid(forms) and bound.eta > best.eta
    for values in np.sqrt(np.random.default_rng(3).random((2000, 24))):
        if forms.squared_strength(values) >= strength**2:
            assert forms.eta(values) < bound.eta


@pytest.mark.parametrize("s", [0.8, 0.9, 1.0])
def test_the_bound_of_commuting_forms_is_their_known_optimum(s):
    # F = N = 1 and D = diag(d): only the squares of the values matter. For d = 1 in the first half and 4 in the second, the optimum
    # with e <= 1 has e = 1 where d = 1 and e^2 = 2 s^2 - 1 elsewhere: eta = 2 s^2 / (1 + 4 (2 s^2 - 1)), and the relaxation is exact.
    forms = forms_of(np.eye(10), np.diag([1.0] * 5 + [4.0] * 5), np.eye(10))
    known, bound = 2.0 * s * s / (1.0 + 4.0 * (2.0 * s * s - 1.0)), ceiling(forms, s)
    assert known <= bound.eta < known * (1.0 + 3e-4)  # the accuracy of the bisection, 1e-4, and a margin
    assert best_envelope(forms, Required(s), 6).eta == pytest.approx(known, rel=1e-6)  # 1e-9 a step of the search


@pytest.mark.parametrize("s", [0.5, 0.7, 0.9])
def test_the_bound_of_few_knots_excludes_what_only_negative_values_reach(s):
    forms = forms_with_memory(3, 4.0)
    grid = [np.array(e) / 20.0 for e in itertools.product(range(-20, 21), repeat=3)]
    strong = [e for e in grid if forms.squared_strength(e) >= s * s]
    best = max(forms.eta(e) for e in strong if e.min() >= 0.0)
    bound, found = ceiling(forms, s), best_envelope(forms, Required(s), 8)
    assert best <= bound.eta < max(forms.eta(e) for e in strong)
    assert best * (1.0 - 1e-9) <= found.eta <= bound.eta  # the grid is coarser than the search


@pytest.mark.parametrize("s", [0.72, 0.75, 0.9])
@pytest.mark.parametrize("u", [0.0, 0.3, 0.8, 1.0])
def test_a_required_uniformity_limits_how_weak_a_knot_may_be(s, u):
    # Two knots with F = N = 1, D = diag(1, 4), and a point of the path at each: the rms there is the value of the knot. The optimum is
    # (1, b) with the least b that the strength, 1 + b^2 >= 2 s^2, and the uniformity, 2 b >= u (1 + b), permit.
    forms = forms_of(np.eye(2), np.diag([1.0, 4.0]), np.eye(2), [np.diag([1.0, 0.0]), np.diag([0.0, 1.0])])
    b = max(np.sqrt(2.0 * s * s - 1.0), u / (2.0 - u))
    best = best_envelope(forms, Required(s, u), 6)
    assert Required(s, u).is_met_by(forms, best.values)
    # The accuracy of the search, 1e-9, times the number of its steps, and the margin of rounding.
    assert best.eta == pytest.approx((1.0 + b * b) / (1.0 + 4.0 * b * b), rel=1e-7)


def test_a_uniformity_that_the_unmodulated_load_misses_is_reached_if_an_envelope_reaches_it():
    forms = forms_of(np.eye(2), np.eye(2), np.eye(2), [np.diag([4.0, 0.0]), np.diag([0.0, 1.0])])
    assert forms.uniformity(np.ones(2)) == pytest.approx(2.0 / 3.0)
    found = best_envelope(forms, Required(0.5, 0.9), 6)
    assert found.eta == pytest.approx(1.0) and Required(0.5, 0.9).is_met_by(forms, found.values)
    # At full strength only the unmodulated load is left; so is a search for AM that has no frequencies.
    assert best_envelope(forms, Required(1.0, 0.9), 6).eta == 0.0
    assert best_am(forms, 1e-3, Required(0.5, 0.9), []).envelope.eta == 0.0
    assert best_am(forms, 1e-3, Required(0.5, 0.6), []).envelope.eta == pytest.approx(1.0)
    assert feasible(forms, Required(1.0, 0.9), np.array([1.0, 0.2])) is None


def test_the_best_am_is_the_best_of_all_depths_and_phases():
    forms, interval_s = forms_with_memory(12, 4.0), 1e-3
    best = best_am(forms, interval_s, Required(0.7), [100.0, 150.0])
    times = interval_s * np.arange(12)
    every = [measured(forms, 1.0 - 0.5 * depth * (1.0 + np.cos(2.0 * np.pi * (frequency * times + phase))))
             for frequency in (100.0, 150.0) for depth in np.arange(1, 21) / 20 for phase in np.arange(24) / 24]
    met = [am.eta for am in every if am.strength >= 0.7]
    assert best.envelope.eta == pytest.approx(max([*met, forms.eta(np.ones(12))]), rel=1e-12)  # rounding
    assert best.envelope.strength >= 0.7


def test_a_search_improves_its_start():
    forms, start = forms_with_memory(17, 4.0), np.full(17, 0.9)
    assert forms.eta(search_from(forms, Required(0.7), start)) > forms.eta(start)


@pytest.mark.parametrize("change", [{"eta": 0.9}, {"weights": 1.1}, {"tau": 1.001}, {"strength": 0.9}, {"mu": -1.0}])
def test_a_certificate_with_a_changed_number_is_not_valid(change):
    forms = forms_with_memory(12, 6.0)
    bound = ceiling(forms, 0.7)
    assert bound.is_valid(forms)
    [(name, factor)] = change.items()
    assert not replace(bound, **{name: factor * getattr(bound, name)}).is_valid(forms)


def test_a_stored_optimum_is_read_back_exactly_and_refused_after_any_change(tmp_path):
    forms = forms_with_memory(6, 3.0)
    case = OptimisedCase("id", [], 6, 1e-3, True, 6e-3, None, [])
    optimum, path = find_optimum(case, forms, MotionChange(), forms, 0.8, OPTIONS), tmp_path / "optimum.json"
    path.write_text(optimum.text("id", "id"))
    again = read_optimum(path, case, 0.8, forms, forms)
    assert again.text("id", "id") == optimum.text("id", "id")
    text = path.read_bytes()
    for place in range(0, len(text) - 1, 7):
        path.write_bytes(text[:place] + bytes([text[place] ^ 1]) + text[place + 1:])
        with pytest.raises(StudyError, match="optimum.json is damaged: .*; remove it"):
            read_optimum(path, case, 0.8, forms, forms)
    path.write_text(replace(optimum, found=replace(optimum.found, eta=optimum.found.eta * 1.001)).text("id", "id"))
    assert read_optimum(path, case, 0.8, forms, forms).found.eta == optimum.found.eta  # follows from the values and the forms
    for changed in (replace(optimum, found=replace(optimum.found, values=optimum.found.values[:-1])),
                    replace(optimum, ceiling=replace(optimum.ceiling, eta=optimum.ceiling.eta * 0.98)), replace(optimum, strength=0.7)):
        path.write_text(changed.text("id", "id"))
        with pytest.raises(StudyError, match="is damaged"):
            read_optimum(path, case, 0.8, forms, forms)


def test_forms_of_another_size_are_refused():
    square = np.eye(3).tolist()
    document = {"numerator": square, "denominator": square, "focal": square, "path": [square]}
    assert forms_in(document, 3).path.shape == (1, 3, 3)
    for wrong in ([[1.0, 0.0], [0.0, 1.0]], square[:2], [[1.0], [1.0, 2.0], [3.0]], [1.0, 2.0, 3.0]):
        for name in document:
            with pytest.raises(ValueError):
                forms_in({**document, name: [wrong] if name == "path" else wrong}, 3)


def test_forms_with_a_changed_byte_are_refused_by_name(tmp_path):
    path, square = tmp_path / "id.forms.json", np.eye(2).tolist()
    text = sealed({"numerator": square, "denominator": square, "focal": square, "path": []})
    path.write_text(text)
    assert read_forms(path, 2).knots == 2
    path.write_text(text.replace("1.0", "1.1", 1))
    with pytest.raises(StudyError, match="id.forms.json is damaged: it does not match its checksum; remove it"):
        read_forms(path, 2)


def test_a_round_of_the_search_changes_each_varied_quantity_in_both_directions():
    options = replace(OPTIONS, over=["envelope", "speed", "size"])
    changes = changes_around(MotionChange(), 0.5, options)
    assert [(c.speed, c.size) for c in changes] == pytest.approx([(1.2, 1.0), (1.0 / 1.2, 1.0), (1.0, 1.2), (1.0, 1.0 / 1.2)])
    # At the limit, a quantity can change in one direction only.
    assert len(changes_around(MotionChange(size=1.44), 0.5, options)) == 3
    options = replace(OPTIONS, over=["envelope", "speed-profile"])
    assert len(changes_around(MotionChange(), 0.5, options)) == 12  # three frequencies
    assert len(changes_around(MotionChange(periods=2, sine=0.1), 0.5, options)) == 4


def test_an_optimum_is_computed_in_eight_other_tissues_and_at_two_other_speeds():
    found = differences_by(0.2)
    assert len(found) == 10 and list(found)[0] == "c_s -20 %, viscosity -20 %" and list(found)[-1] == "speed +20 %"
    assert len({tuple(factors.values()) for factors in found.values()}) == 10
    assert all(set(factors.values()) <= {0.8, 1.0, 1.2} for factors in found.values())


def test_a_waveform_is_rounded_in_the_sound_pressure_and_covers_the_period():
    force = np.array([0.0, 1.0, 0.25, 0.5])
    waveform = waveform_of(force, 1e-3, True, 2000.0, 4)
    assert waveform.levels == [0, 11, 15, 12, 8, 9, 11, 8]
    assert waveform.envelope["values"][4] == pytest.approx(64.0 / 225.0, rel=1e-14)
    assert waveform.csv_text([(0.01, -0.002)] * 8).startswith("t_us,x_mm,y_mm,level,pressure_1,force_1\n0,10,-2,0,0,0\n500,10,-2,11,")
    single = waveform_of(force, 1e-3, False, 2100.0, 4)  # ends at 3 ms, after 6.3 updates
    assert single.interval_s == 1.0 / 2100.0 and len(single.levels) == 8
