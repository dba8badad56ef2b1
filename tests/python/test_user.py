# SPDX-License-Identifier: BSD-3-Clause
"""A study as a user of xarray and SciPy would write it, and the engine as a process of a script."""
import multiprocessing
import pickle
import signal
import threading

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import minimize_scalar

import shearwake
from shearwake.keys import cf_unit
from study import AM, InFolder, job

from serving import extent, one


def mean_of(data):
    """In a process of a pool: the mean of a variable that is read there."""
    return float(data["eta_t"].isel(depth=0).mean())


class User(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep = job().run()

    def test_a_study_from_the_first_to_the_last_line(self):
        data = self.sweep.dataset("eta_period_1", "eta_t")
        selected = data["eta_period_1"].sel(am_frequency_Hz=float(data["am_frequency_Hz"][1]))
        self.assertEqual(float(selected), self.sweep.cases[1].value("eta_period_1"))
        self.assertEqual(len(data["eta_period_1"].plot()), 1)
        with shearwake.Engine() as engine:
            found = minimize_scalar(lambda f: -engine.evaluate(one({AM: f})).value("eta_at_1"),
                                    bounds=(200.0, 1000.0), method="bounded", options={"maxiter": 8})
            middle = engine.evaluate(one({AM: 600.0})).value("eta_at_1")
        self.assertGreaterEqual(-found.fun, middle)
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.map(mean_of, [data])[0], mean_of(data))

    def test_datasets_have_cf_attributes_a_quality_flag_and_integer_labels(self):
        data = self.sweep.dataset("eta_period_1", "traces")
        self.assertEqual(data["am_frequency_Hz"].attrs["units"], "Hz")
        self.assertEqual(data["am_frequency_Hz"].attrs["long_name"], "AM frequency")
        self.assertEqual(data["am_frequency_Hz"].attrs["key"], AM)
        self.assertEqual(data["eta_period_1"].attrs["long_name"], "efficiency η")
        self.assertIn("inside the focal disc", data["eta_period_1"].attrs["description"])
        self.assertEqual(self.sweep.dataset("mean")["mean"].attrs["units"], "m^2")
        self.assertEqual(data["valid"].attrs["standard_name"], "quality_flag")
        self.assertIn("valid", data.data_vars)
        self.assertEqual([cf_unit(unit) for unit in ("m_s", "kg_m3", "Pa_s", "m/s", "mm2", "m2", "deg", "1")],
                         ["m/s", "kg/m^3", "Pa s", "m/s", "mm^2", "m^2", "degree", "1"])
        for found in (data, self.sweep.cases[0].dataset("traces")):
            self.assertEqual(found["trace"].dtype.kind, "i")

    def test_equal_data_have_equal_tokens_and_pickle(self):
        one_, other = (self.sweep.dataset("eta_period_1", "eta_t") for _ in range(2))
        arrays = [innermost(data["eta_t"].variable._data) for data in (one_, other)]
        self.assertEqual(arrays[0].__dask_tokenize__(), arrays[1].__dask_tokenize__())
        xr.testing.assert_identical(pickle.loads(pickle.dumps(one_)).load(), other.load())

    def test_notebooks_show_tables(self):
        self.assertIn("<table", self.sweep._repr_html_())
        self.assertIn("efficiency η", self.sweep.cases[0]._repr_html_())
        self.assertIn("am_frequency_Hz", job()._repr_html_())
        self.assertIn("<table", job().plan()._repr_html_())

    @pytest.mark.extended
    def test_commands_are_methods(self):
        page = self.sweep.report()
        self.assertTrue(page.is_file())
        self.assertEqual(self.sweep.compare(self.sweep)["command"], "compare")
        better = self.sweep.converge(cases=1)
        self.assertIn("eta_period_1_error", better.table.columns)
        self.assertIn("quickstart", shearwake.jobs())
        self.assertEqual(shearwake.Job(shearwake.jobs()["quickstart"]).name, "quickstart")

    def test_an_engine_survives_errors_and_ends_with_its_block(self):
        with shearwake.Engine() as engine:
            result = engine.evaluate(one())
            self.assertEqual(result.dataset()["u_z"].dims, ("time", "x", "y"))
            with self.assertRaisesRegex(shearwake.JobError, "peek_Pa is unknown; did you mean peak_Pa"):
                engine.evaluate(one().replace("peak_Pa", "peek_Pa"))
            with self.assertRaisesRegex(KeyError, "did you mean eta_at_1"):
                result.value("eta_att_1")
            engine._process.send_signal(signal.SIGKILL)
            engine._process.wait()
            self.assertEqual(engine.evaluate(one()).value("eta_at_1"), result.value("eta_at_1"))
            found = []
            threads = [threading.Thread(target=lambda peak=peak: found.append(engine.evaluate(one(peak=peak)).value("peak_um")))
                       for peak in (100.0, 200.0)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(result.dataset().attrs, {"case": result.case_id, "valid": 1})
            with pytest.warns(shearwake.NotValid, match=" is not valid: .* the readings of this case are not valid"):
                returned = engine.evaluate(one(extent(36.0, 24.0)))
            self.assertEqual(returned.dataset().attrs["valid"], 0)
            np.testing.assert_allclose(max(found), 2.0 * min(found), rtol=1e-5)  # float32 planes; the load is linear
        self.assertIsNotNone(engine._process.poll())


def innermost(data):
    """The array of shearwake below the wrappers of xarray."""
    while hasattr(data, "array"):
        data = data.array
    return data
