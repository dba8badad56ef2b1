# SPDX-License-Identifier: BSD-3-Clause
"""The choices of an engine and their reasons, before and after the run."""

import pytest
import xarray

from program import OPEN, PSTD, SPECTRAL, ProgramTest, case_files, read_by, small_job, swept, without_reference

ELASTIC = {**SPECTRAL, "solver.spectral.rigid_above": 1e9}
SHORT = {**read_by(1.2), **swept(500, 1000)}
BONE = {"medium.body": [{"preset": "cortical-bone", "shape": "cylinder", "axis": "x", "radius_mm": 2.0, "depth_mm": 9.0,
                         "center_mm": [0.0, 0.0]}]}


class SolverNotes(ProgramTest):
    def attributes(self, path):
        with xarray.open_dataset(path, decode_timedelta=False) as case:
            return dict(case.attrs)

    @pytest.mark.long
    def test_notes_of_a_bone_state_its_capped_stiffness_and_iterations(self):
        self.write_job(without_reference(ELASTIC, BONE, SHORT))
        output = self.shearwake("plan", "job.toml").output
        capped = "medium.body[1]: shear stiffness 1.99e+05 times that of the surrounding layer is capped at 1000 " \
                 "times (contrast_cap): it reflects 0."
        self.contains(output, "time step 33.33 us for an accuracy of 0.001", "limited by the scan (",
                      "limited by the modulation (")
        for line in (capped, "conjugate gradients on complete planes; the density varies"):
            self.assertEqual(output.count(line), 1, output)  # of two cases

        output = self.shearwake("run", "job.toml", "--verbose").output
        self.assertEqual(output.count("is capped at 1000 times (contrast_cap): it reflects 0.9"), 2, output)  # and a warning
        self.assertEqual(output.count("iterations"), 2, output)  # each case has its own
        for path in case_files(self.out):
            found = self.attributes(path)
            notes = found["solver_notes"].split("\n")
            self.assertTrue(any("is capped at 1000 times" in note for note in notes), notes)
            self.assertTrue(any("the density varies" in note for note in notes), notes)
            self.assertEqual(found["solver_steps"] % 12, 0)  # frames
            self.assertGreaterEqual(found["solver_steps"], 12)
            self.assertGreaterEqual(found["solver_iterations"], found["solver_most_iterations"])
            self.assertGreater(found["solver_most_iterations"], 1)
        shown = self.shearwake("show", path).output
        self.contains(shown, f"solver:   {found['solver_steps']} steps, {found['solver_iterations']} iterations, "
                         f"at most {found['solver_most_iterations']} per step", *notes)

    def test_a_bone_is_rigid_by_default_and_the_notes_state_why(self):
        self.write_job(without_reference(SPECTRAL, BONE, SHORT))
        note = "medium.body[1] is rigid because it is 1.99e+05 times stiffer than its surroundings (rigid_above = 400) " \
               "and moves with its mass: one additional background solve per step, no cap on its stiffness"
        planned = self.shearwake("plan", "job.toml").output
        self.contains(planned, note)
        self.assertNotIn("contrast_cap", planned)
        self.shearwake("run", "job.toml")
        automatic = case_files(self.out)
        for path in automatic:
            found = self.attributes(path)
            self.assertIn(note, found["solver_notes"])
            self.assertEqual(found["solver_iterations"], 0)
        self.write_job(without_reference(SPECTRAL, BONE, {"medium.body[1].rigid": True}, SHORT), name="marked.toml")
        self.shearwake("run", "marked.toml", "--out", "marked")
        energies = [sorted(self.attributes(path)["solver_energy_J"] for path in paths)
                    for paths in (automatic, case_files(self.folder / "marked"))]
        self.assertEqual(*energies)

    def test_plan_prints_the_decisions_that_the_case_file_states(self):
        soft = {**BONE["medium.body"][0], "preset": None, "c_s_m_s": 9.0, "density_kg_m3": 1100.0, "rigid": False}
        for name, words, changes in (
                ("open", ("infinite plane on", "does not move along y"), OPEN),
                ("soft", ("conjugate gradients", "the density varies", "acts every"),
                 {**SPECTRAL, "medium.body": [soft], "domain.sponge_mm": 12.0}),
                ("pstd", ("points in double precision", "steps of"), PSTD)):
            with self.subTest(name):
                self.write_job(without_reference(changes, SHORT, swept(1000)), name=f"{name}.toml")
                planned = self.shearwake("plan", f"{name}.toml").output
                self.contains(planned, *words)
                self.shearwake("run", f"{name}.toml", "--out", name)
                path, = case_files(self.folder / name)
                decided = [note for note in self.attributes(path)["solver_notes"].split("\n")
                           if not note.startswith("memory per rank")]
                self.contains(planned, *decided)

    def test_notes_of_layers_state_only_the_time_step(self):
        self.write_job(without_reference(SPECTRAL, {"solver.spectral.time_step_us": 50.0}, SHORT))
        output = self.shearwake("run", "job.toml", "--verbose").output
        self.assertEqual(output.count("time step"), 1, output)  # a message is printed only once
        self.assertNotIn("iterations", output)
        self.assertNotIn("time step", self.shearwake("run", "job.toml", "--out", "short").output)
        self.assertEqual(self.shearwake("run", "job.toml", "--out", "other", "--quiet").stderr, "")
        for path in case_files(self.out):
            found = self.attributes(path)
            self.assertEqual(found["solver_iterations"], 0)
            self.assertIn("time step", found["solver_notes"])
            self.assertGreater(found["solver_energy_J"], 0.0)
            self.assertLess(found["solver_energy_J"], found["solver_work_J"])  # it is viscous

    def test_engine_layered_states_its_time_step_and_warns_of_a_long_one(self):
        self.write_job(small_job(SHORT))
        self.assertNotIn("over depth", self.shearwake("plan", "job.toml").output)
        self.shearwake("run", "job.toml")
        for path in case_files(self.out):
            attributes = self.attributes(path)
            self.assertEqual([name for name in attributes if name.startswith("solver")], ["solver_notes"])
            self.assertRegex(str(attributes["solver_notes"]), "time step .* us, estimated error below 2e-05 of the maximum of the field")
        self.assertNotIn("does not resolve the load", self.shearwake("show", path).output)
        self.shearwake("run", "job.toml", "-S", "solver.layered.time_step_us=300", "-S", "time.output_interval_us=300",
                       "--out", "coarse")
        for path in case_files(self.folder / "coarse"):
            self.assertIn("does not resolve the load", self.shearwake("show", path).output)

    def test_steps_chosen_for_short_edges_cause_no_warning(self):
        self.write_job(small_job(SHORT))
        for edge_us in (50, 70, 100):
            output = self.shearwake("run", "job.toml", "-S", "load.modulation.am_wave=square", "-S", f"load.modulation.am_edge_us={edge_us}",
                                  "--out", f"{edge_us}", "--verbose").output
            self.contains(output, "estimated error below 2e-05 of the maximum of the field")
            self.assertNotIn("time_step_us", output)
