# SPDX-License-Identifier: BSD-3-Clause
"""Bodies and maps in job files, with maps that scripts/make-map writes."""

from program import AM, NO_REFERENCE, ROOT, SPECTRAL, ProgramTest, changed, changed_job

MAP = ('base = "rigid"', 'base = "rigid"\nmap = "maps/soft.h5"')
BONE = ("[load]", """[[medium.body]]
preset = "cortical-bone"
shape = "cylinder"
axis = "x"
radius_mm = 4.0
center_mm = [0.0, 0.0]
depth_mm = 12.0

[load]""")


def make_map(test, *options, name="soft.h5"):
    """Writes a map for the job of a test and returns the output of scripts/make-map."""
    (test.folder / "maps").mkdir(exist_ok=True)
    return test.call(ROOT / "scripts" / "make-map", test.folder / "maps" / name, "--extent_mm", "72", "48", *options).stdout


class Variation(ProgramTest):
    def test_a_job_accepts_a_map_of_make_map(self):
        self.contains(make_map(self), "97 x 65 x 28 points, c_s from 5 to 1", "m/s")
        self.write_job(changed_job(changed(MAP), SPECTRAL))
        self.contains(self.shearwake("check", "job.toml", ranks=2).output, "medium.map maps/soft.h5", "0 warnings")

    def test_the_path_of_a_map_is_relative_to_the_job(self):
        make_map(self)
        (self.folder / "elsewhere").mkdir()
        self.write_job(changed_job(changed(MAP), SPECTRAL), name="elsewhere/job.toml")
        output = self.shearwake("check", "elsewhere/job.toml", ranks=2, expect=3).output
        self.contains(output, "elsewhere/job.toml:9:7: error: medium.map cannot be used", "elsewhere/maps/soft.h5 does not exist")

    def test_the_error_of_engine_layered_names_a_suitable_engine(self):
        make_map(self)
        self.write_job(changed_job(changed(MAP, BONE), NO_REFERENCE))
        output = self.shearwake("check", "job.toml", expect=3).output
        self.contains(output, "medium.map: the engine", "medium.body: the engine", 'solver.engine = "spectral"')

    def test_each_depth_of_a_bone_is_a_case(self):
        axes = {"medium.body[1].depth_mm": [10, 12, 14], AM: [400, 500, 1000]}
        self.write_job(changed_job(changed(BONE), NO_REFERENCE, SPECTRAL, {"sweep": axes}))
        self.contains(self.shearwake("plan", "job.toml").output, "depth, body 1 = 14 mm; AM frequency = 1000 Hz", "9 cases")
