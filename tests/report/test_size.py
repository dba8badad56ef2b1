# SPDX-License-Identifier: BSD-3-Clause
"""Tests the size of pages: 20 cases with frames, a sweep of 504 cases, and one of which the page lists some cases only."""
import math
from unittest import mock

import h5py
import numpy as np
import pytest

from shearwake.report import thinning
from synthetic import AM, FWHM, Folder, InFolder, Page, case_id

LARGEST_B = 3_000_000
KIND = "load.modulation.kind"


class Size(InFolder):
    @pytest.mark.long
    def test_20_cases_with_frames_of_noise_fit_in_3_MB(self):
        folder, random = Folder(self.root), np.random.default_rng(1)
        x, y = 1e-3 * np.arange(-60, 60), 1e-3 * np.arange(-45, 45)
        for n in range(20):
            identity = folder.add({AM: 50.0 * (n + 1)}, frames=True)
            with h5py.File(folder.file(identity), "r+") as file:
                surface = file["surface"]
                frames = len(surface["time"])
                for name in ("x", "y", "u_z"):
                    del surface[name]
                surface["x"], surface["y"] = x, y
                surface["u_z"] = 1e-6 * random.standard_normal((frames, 1, len(x), len(y))).astype("f4")
        self.assertLess(len(folder.report().encode()), LARGEST_B)

    @pytest.mark.long
    def test_504_cases_fit_in_3_MB_and_all_are_in_the_table_and_the_maps(self):
        folder = Folder(self.root, x=AM, series=[FWHM, KIND], swept=(AM, FWHM, KIND))
        for n in range(14):
            for width in range(9):
                for kind in ("AM-STM", "SM-STM", "DTP", "STP"):
                    folder.add({AM: 50.0 * (n + 1), FWHM: 2.0 + width, KIND: kind}, kind=kind,
                               scalars={"eta_period_1": 0.1 + 0.01 * n + 0.005 * width})
        text = folder.report()
        self.assertLess(len(text.encode()), LARGEST_B)
        page = Page(text)
        ids = [cell["text"].strip() for cell in page.column("id")]
        self.assertEqual(ids, [case_id(n) for n in range(1, 505)])
        self.assertIn("504 cases: 504 complete.", page.data)
        self.assertIn('id="maps-heat_eta_period_1"', text)
        shown = text.partition('id="maps-heat_eta_period_1"')[2].partition("</script>")[0]
        self.assertEqual(shown.count('"shape":[9,14]'), 4)  # one map per kind with every case
        self.assertNotIn("null", shown.replace('"x_names":null', "").replace('"y_names":null', ""))

    @pytest.mark.extended
    def test_a_large_sweep_lists_the_best_cases_failed_ones_and_some_others(self):
        folder = Folder(self.root, x=AM, series=[FWHM], swept=(AM, FWHM))
        for n in range(12):
            for width in range(8):
                known = n > 7  # of a third of the cases
                folder.add({AM: 50.0 * (n + 1), FWHM: 2.0 + width}, written=(n, width) != (3, 3),
                           scalars={"eta_period_1": 0.1 + 0.01 * n + 0.02 * (width == 5) if known else math.nan})
        folder.fail(case_id(3 * 8 + 4), "the field is not finite")
        with mock.patch.object(thinning, "MOST", 40):
            text = folder.report()
        page = Page(text)
        ids = [cell["text"].strip() for cell in page.column("id")]
        self.assertLessEqual(20, len(ids))
        self.assertLessEqual(len(ids), 40)
        self.assertIn(case_id(11 * 8 + 6), ids)  # the best case
        self.assertIn(case_id(3 * 8 + 4), ids)
        self.assertIn(f"{len(ids)} of 96 cases are listed", page.data)
        self.assertIn("96 cases: 95 complete, 1 failed.", page.data)
        self.assertIn('<h2 id="table">Cases</h2>', text)
        shown = text.partition('id="maps-heat_eta_period_1"')[2].partition("</script>")[0]
        self.assertIn('"shape":[8,12]', shown)  # the map has all cases
        self.assertIn("They are spread evenly over the 95 cases of the sweep, with the best one", text)
