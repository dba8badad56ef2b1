# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of modulations."""

from program import ROOT, ProgramTest


class ShowModulation(ProgramTest):
    def test_a_job_is_drawn(self):
        self.write_job()
        self.contains(self.shearwake("show", "--modulation", "job.toml").output, "picture: job.modulation.png")
        picture = (self.folder / "job.modulation.png").read_bytes()
        self.assertTrue(picture.startswith(b"\x89PNG"))
        self.assertLess(len(picture), 60_000)  # small enough for the documentation
        self.assertEqual(list(self.folder.glob("*.json")), [])

    def test_the_extension_determines_the_format_of_a_picture(self):
        self.write_job()
        self.shearwake("show", "--modulation", "job.toml", "--picture", "m.svg", "-S", "load.modulation.speed_m_s=3", ranks=2)
        self.assertIn("<svg", (self.folder / "m.svg").read_text(encoding="utf-8"))

    def test_an_override_that_has_no_effect_is_reported(self):
        self.write_job()
        output = self.shearwake("show", "--modulation", "job.toml", "-S", "load.modulation.am_frequency_Hz=730").output
        self.contains(output, "load.modulation.am_frequency_Hz is swept, so this override has no effect")

    def test_moving_and_drawing_pointers_can_be_drawn(self):
        for job in ("fig2.4.toml", "pointers.toml"):
            self.shearwake("show", "--modulation", ROOT / "jobs" / job, "--picture", "m.png")
            (self.folder / "m.png").unlink()  # it was there

    def test_errors_are_reported(self):
        self.write_job()
        output = self.shearwake("show", "--modulation", "job.toml", "--picture", "no/such/m.png", expect=6).output
        self.contains(output, "was not drawn", "--picture sets another folder or format")
        self.contains(self.shearwake("show", expect=2).output, "--modulation")
