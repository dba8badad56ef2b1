# SPDX-License-Identifier: BSD-3-Clause
"""Units and types of datasets, as other packages read them."""
import re
import shutil
import subprocess

import numpy as np
import pytest

from shearwake.keys import UNITS
from study import InFolder, job

NOISE, EXTENT = "afferents.noise", "domain.extent_mm"
CHANGES = {"load.peak_Pa": 5000.0, "measure.sensation": True, "table.x": NOISE,
           "afferents": {"where": "palm", "classes": ["PC"], "noise": True, "pins_mm": [[0.0, 0.0]]},
           "sweep": {NOISE: [True, False], EXTENT: [[64.0, 48.0], [96.0, 48.0]]}}
NOT_OF_UDUNITS = {"dB"}  # decibels, which it reads as "0.1 lg(re 1)" only, and pint as "dB" only


class Datasets(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep = job(CHANGES).run()

    def test_swept_booleans_and_lists_keep_their_type(self):
        data = self.sweep.dataset("peak_um")
        self.assertEqual(data["peak_um"].dims, ("noise", "extent_mm"))
        self.assertEqual((data["noise"].dtype, data["noise"].values.tolist()), (np.dtype(bool), [True, False]))
        self.assertEqual(data["extent_mm"].values.tolist(), [(64.0, 48.0), (96.0, 48.0)])
        for noise in (True, False):
            for n, extent in enumerate([[64.0, 48.0], [96.0, 48.0]]):
                case = self.sweep.case({NOISE: noise, EXTENT: extent})
                self.assertEqual(case.setting("afferents", "noise"), noise)
                # An extent is rounded up to a grid whose transforms are fast, here to 72 and 96 mm.
                self.assertAlmostEqual(1e3 * case.setting("domain", "nx") * case.setting("domain", "spacing_m"), (72.0, 96.0)[n], delta=1e-9)
                self.assertEqual(float(data["peak_um"].sel(noise=noise).isel(extent_mm=n)), case.value("peak_um"))

    def test_pint_and_udunits_agree_on_the_units_of_all_variables(self):
        registry = pytest.importorskip("pint").UnitRegistry()
        if not shutil.which("udunits2"):
            pytest.skip("udunits2 is not installed")
        case = self.sweep.cases[0]
        self.assertGreaterEqual(set(case.groups), {"afferents", "mean", "surface", "traces"})
        found = [*(case.dataset(group) for group in ("/", *case.groups)), self.sweep.dataset(*(c.name for c in self.sweep.columns))]
        units = {variable.attrs["units"] for data in found for variable in data.variables.values() if "units" in variable.attrs}
        units |= {cf for _, cf in UNITS.values()}
        self.assertGreaterEqual(units, {"m^2", "mm^2", "mN ms", "dB", "1"})
        for unit in sorted(units - NOT_OF_UDUNITS):
            base = registry.Quantity(1.0, registry.parse_units(unit)).to_base_units()
            text = re.sub(r"\*", ".", f"{base.units:~C}".replace("**", "^")) or "1"
            done = subprocess.run(["udunits2", "-H", unit, "-W", text], capture_output=True, encoding="utf-8", check=False)
            self.assertIn("=", done.stdout, f"{unit}: {done.stderr}")
            # udunits2 prints six digits.
            self.assertAlmostEqual(float(done.stdout.split("=")[1].split()[0]) / base.magnitude, 1.0, delta=1e-5, msg=unit)
        for unit in NOT_OF_UDUNITS & units:
            self.assertIn("decibel", str(registry.parse_units(unit)))
