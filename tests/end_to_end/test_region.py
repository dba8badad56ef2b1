# SPDX-License-Identifier: BSD-3-Clause
"""measure.region_mm with every engine and in both regimes, and what the table says about the steady state."""
import h5py
import numpy as np

from program import NO_FRAMES, ONE_CASE, OPEN, PERIODIC, ProgramTest, case_files, read_csv, small_job

REGION = {"measure.region_mm": [29.3, 20.3], "measure.region_center_mm": [4.0, -3.0]}
ENGINES = {"layered": {}, "spectral": {}, "pstd": {"solver.pstd.c_p_over_c_s": 3.0}}


def participation(u, weights):
    """As an area, for weights in mm2."""
    return (weights * u**2).sum() ** 2 / (weights * u**4).sum()


def inside(at, middle, width):
    """The length in mm of the cell around each coordinate that lies in an interval."""
    half = 0.5 * (at[1] - at[0])
    return np.clip(np.minimum(at + half, middle + width / 2) - np.maximum(at - half, middle - width / 2), 0.0, None)


class RegionTest(ProgramTest):
    def table(self, name="small"):
        return read_csv(self.folder / "out" / name / "tables" / f"{name}.csv")[0]

    def test_every_engine_measures_within_the_stated_region(self):
        for engine, keys in ENGINES.items():
            self.write_job(small_job(REGION, ONE_CASE, {"job.name": engine, "solver.engine": engine}, keys))
            self.reduced(f"out/{engine}")
            row = self.table(engine)
            with h5py.File(case_files(self.folder / "out" / engine)[0]) as file:
                x, y = 1e3 * file["surface/x"][()], 1e3 * file["surface/y"][()]
                u = 1e6 * np.squeeze(file["surface/u_z"][-1])
            weights = np.outer(inside(x, 4.0, 29.3), inside(y, -3.0, 20.3))
            with self.subTest(engine):
                # Frames are stored in single precision.
                np.testing.assert_allclose(float(row["participation_at_mm2"]), participation(u, weights), rtol=1e-5)
                everything = np.full_like(weights, (x[1] - x[0]) ** 2)
                self.assertGreater(abs(participation(u, everything) / participation(u, weights) - 1.0), 0.01)
                self.assertAlmostEqual(float(row["region_mm2"]), 29.3 * 20.3, places=6)
                for column, edge in (("from_x", 4.0 - 14.65), ("to_x", 4.0 + 14.65), ("from_y", -3.0 - 10.15), ("to_y", -3.0 + 10.15)):
                    self.assertAlmostEqual(float(row[f"region_{column}_mm"]), edge, places=9)

    def test_the_steady_state_is_measured_around_the_path_and_states_its_energies(self):
        self.write_job(small_job(PERIODIC, OPEN, ONE_CASE, NO_FRAMES,
                                 {"load.modulation.path.at_end": "back-and-forth", "load.modulation.speed_m_s": 5.6}))
        self.reduced(self.out)
        row = self.table()
        self.assertGreater(float(row["region_mm2"]), 0.0)
        work, absorbed, radiated = (float(row[f"period_{what}_uJ"]) for what in ("work", "absorbed", "radiated"))
        self.assertGreater(work, 0.0)
        self.assertAlmostEqual(radiated / work, 0.0, delta=1e-9)  # the base is rigid
        self.assertAlmostEqual(absorbed / work, 1.0, delta=1e-6)  # the energy balance
        # All measures over the period need every frame, but only the one at the time of reading is written.
        with h5py.File(case_files(self.out)[0]) as file:
            frames, shape = file["time"].size, file["surface/u_z"].shape
            largest = []
            file.visititems(lambda name, item: largest.append(item.size) if isinstance(item, h5py.Dataset) else None)
        self.assertGreater(frames, 20)
        self.assertEqual(shape[0], 1)
        self.assertEqual(max(largest), np.prod(shape))
