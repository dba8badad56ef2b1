# SPDX-License-Identifier: BSD-3-Clause
"""The figures of afferents on small synthetic cases: hand, rasters, chosen places, curves."""
from unittest import mock

import h5py
import numpy as np
import pytest


from synthetic import AM, Folder, InFolder, fixed

from shearwake.report import load
from shearwake.report.figures import fig_afferents, fig_hand
from shearwake.sweep import case_of_file
import texts


def add_afferents(path, counts, moves=True, felt="pins"):
    """Adds three PC and two RA near two pins; afferent i fires counts[i] times, every 5 ms."""
    with h5py.File(path, "r+") as file:
        case = file.attrs["case"].decode()
        file.attrs.update(fixed({"case": case + "[time]\nframes = 40\ninterval_s = 0.001\n"
                                         f"[afferents]\nwhere = \"palm\"\ninput = \"{felt}\"\n"}))
        group = file.create_group("afferents")
        x = 1e-3 * np.array([0.0, 1.0, 30.0, 0.0, 30.0])
        group["x"], group["y"], group["hand_x"], group["hand_y"] = x, 0 * x, x + 0.12, 0 * x + 0.01
        group["afferent"], group["row"] = np.arange(len(x)), np.zeros(len(x))
        group["class"], group["spike_count"] = [2.0, 2.0, 2.0, 1.0, 1.0], np.array(counts, float)
        group["class"].attrs.update(fixed({"long_name": "0: SA1, 1: RA, 2: PC", "colours": "SA1: #009E73, RA: #0072B2, PC: #D55E00"}))
        group["spike_time"] = np.concatenate(
            [0.005 * np.arange(1, n + 1) for n in counts] or [np.zeros(0)])
        pins = file.create_group("pins")
        pins["x"], pins["y"] = [0.0, 0.03], [0.0, 0.0]
        pins["hand_x"], pins["hand_y"] = [0.12, 0.15], [0.01, 0.01]
        if moves:
            pins["time"] = 1e-3 * np.arange(40)
            pins["u_z"] = 1e-6 * np.ones((2, 40))
        hand = file.create_group("hand")
        hand["hand_x"], hand["hand_y"] = [0.0, 0.2, 0.2], [0.0, -0.05, 0.1]


class AfferentsTest(InFolder):
    def setUp(self):
        super().setUp()
        self.folder = Folder(self.root)

    def add(self, f, counts, **options):
        scalars = {"PC_spikes_1": sum(counts[:3]), "PC_rate_Hz": 10.0 + f, "RA_spikes_1": 0.0, "PC_total_rate_Hz": 10.0 * f, "RA_total_rate_Hz": 0.0}
        identity = self.folder.add({AM: f}, scalars=scalars)
        add_afferents(self.folder.file(identity), counts, **options)
        return identity

    def names(self, module):
        return set(self.drawn(self.folder, module)[1])

    def test_spikes_are_assigned_to_their_afferents(self):
        identity = self.add(100.0, [3, 0, 2, 0, 1])
        held = fig_hand.Afferents(case_of_file(self.folder.file(identity)))
        self.assertEqual([len(s) for s in held.spikes], [3, 0, 2, 0, 1])
        np.testing.assert_allclose(held.spikes[2], [5.0, 10.0])
        self.assertEqual(list(held.of("RA")), [3, 4])

    def test_each_case_has_a_hand_a_raster_and_places(self):
        self.add(100.0, [3, 0, 2, 0, 1])
        self.assertEqual(self.names(fig_hand), {"hand_1", "raster_1", "places_1"})

    def test_the_hands_of_all_cases_have_the_same_colour_scale(self):
        self.add(100.0, [3, 0, 2, 0, 1])
        self.add(200.0, [9, 0, 2, 0, 1])
        with mock.patch.object(fig_hand, "hand_figure", return_value=None) as drawn:
            self.names(fig_hand)
        self.assertEqual([call.args[-1] for call in drawn.call_args_list], [9 / 0.04] * 2)  # spikes in 40 ms

    def test_a_prescribed_motion_has_no_places_and_silence_no_raster(self):
        self.add(100.0, [3, 0, 2, 0, 1], moves=False)
        self.add(200.0, [0, 0, 0, 0, 0])
        self.assertEqual(self.names(fig_hand), {"hand_1", "raster_1", "hand_2", "places_2"})

    def test_pins_are_not_drawn_if_the_input_is_stress(self):
        for f, felt in ((100.0, "pins"), (200.0, "stress")):
            self.add(f, [3, 0, 2, 0, 1], moves=felt == "pins", felt=felt)
        figures = self.drawn(self.folder, fig_hand)[1]
        self.assertEqual(["Red crosses" in figures[name].caption for name in ("hand_1", "hand_2")], [True, False])

    def test_rates_of_an_endless_loop_refer_to_all_counted_periods(self):
        self.add(100.0, [3, 0, 2, 0, 1])
        endless = self.folder.add({AM: 200.0}, scalars={"receptor_periods_1": 12.0})
        add_afferents(self.folder.file(endless), [3, 0, 2, 0, 1])
        once, loop = load.load(self.folder.save()).cases
        self.assertAlmostEqual(once.counted_s, 0.04)
        self.assertAlmostEqual(loop.counted_s, 0.48)
        for case in (once, loop):  # three spikes of the first afferent
            self.assertAlmostEqual(case.afferents["rate_Hz"][0], 3.0 / case.counted_s)

    def test_a_raster_starts_with_the_nearest_afferent(self):
        identity = self.add(100.0, [3, 1, 2, 0, 1])
        held = fig_hand.Afferents(case_of_file(self.folder.file(identity)))
        self.assertEqual(list(fig_hand.raster_rows(held, "PC")), [0, 2, 1])

    def test_classes_that_fire_have_curves_against_the_swept_key(self):
        self.add(100.0, [3, 0, 2, 0, 0])
        self.assertEqual(self.names(fig_afferents), set())  # one point is not drawn as a curve
        self.add(200.0, [3, 0, 2, 0, 0])
        self.assertEqual(self.names(fig_afferents), {"afferents_PC"})

    def test_vector_strengths_of_few_spikes_are_not_drawn(self):
        for f, spikes in ((100.0, 4.0), (200.0, 10.0), (300.0, 12.0)):
            self.folder.add({AM: f}, scalars={"PC_spikes_1": spikes, "PC_total_rate_Hz": spikes, "PC_active_1": 2.0, "PC_vector_strength_1": 0.9})
        sweep, figures, _ = self.drawn(self.folder, fig_afferents)
        shown, few = fig_afferents.with_enough_spikes(sweep, "PC")
        self.assertEqual([c.value("PC_vector_strength_1") == 0.9 for c in shown.cases], [False, True, True])
        self.assertEqual([c.value("PC_spikes_1") for c in shown.cases], [4.0, 10.0, 12.0])
        self.assertEqual([c.id for c in few], [sweep.cases[0].id])
        self.assertIn("The vector strength of 1 case with fewer than 5 spikes per firing afferent is not drawn", figures["afferents_PC"].caption)

    def test_the_label_of_a_single_place_is_not_clipped(self):
        identity = self.add(100.0, [3, 0, 2, 0, 1])
        with h5py.File(self.folder.file(identity), "r+") as file:
            for name in ("x", "y", "hand_x", "hand_y", "u_z"):
                values = file["pins"][name][:1]
                del file["pins"][name]
                file["pins"][name] = values
        self.assertEqual(texts.problems(self.drawn(self.folder, fig_hand)[2]["places_1"]), [])

    def test_coordinates_of_pins_are_rounded_and_single_spikes_are_singular(self):
        identity = self.add(100.0, [1, 0, 0, 0, 0])
        with h5py.File(self.folder.file(identity), "r+") as file:
            file["pins"]["x"][...] = [6.123e-19, -6.123e-19]
            file["pins"]["y"][...] = [0.0123456, -0.0]
        titles = {axes.get_title(loc=where) for figure in self.drawn(self.folder, fig_hand)[2].values()
                  for axes in figure.axes for where in ("left", "center")}
        self.assertLessEqual({"(0, 12.35) mm", "(0, 0) mm", "1 spike", "PC: 1 of 3 fires"}, titles)

    def test_a_case_without_afferents_has_no_such_figures(self):
        self.folder.add({AM: 100.0})
        self.folder.add({AM: 200.0})
        self.assertEqual(self.names(fig_hand) | self.names(fig_afferents), set())

    @pytest.mark.extended
    def test_the_page_contains_the_figures(self):
        self.add(100.0, [3, 0, 2, 0, 1])
        self.add(200.0, [3, 0, 2, 0, 1])
        page = self.folder.report()
        self.assertIn("Firing afferents on the hand: AM frequency 200", page)
        self.assertIn("PC afferents against AM frequency", page)
