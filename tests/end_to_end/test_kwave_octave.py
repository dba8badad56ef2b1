# SPDX-License-Identifier: BSD-3-Clause
"""pstdElastic2Dshearwake.m and pstdElastic3Dshearwake.m in Octave without k-Wave, and the command line of k-Wave's own function."""
import os
import shutil
import unittest
from pathlib import Path

import h5py
import numpy
import pytest
import scipy.io

from program import PROGRAM, ROOT, ProgramTest
from test_kwave_functions import DATA, ROUNDED, FunctionsTest

pytestmark = pytest.mark.extended


@unittest.skipUnless(shutil.which("octave-cli"), "octave-cli is not installed")
class Octave(FunctionsTest):
    def octave(self, runs, script=""):
        """The results of these functions for runs (case, group of the reference, further arguments) agree with k-Wave, in one
        process of Octave. Returns what the script stores in the struct `more`."""
        folder = self.folder / "it's a $HOME of \"\u00fc\" & more"  # marks that a shell would interpret
        folder.mkdir()
        (folder / "h5py.py").write_text("raise SystemExit('modules of the working folder are imported')")
        (folder / "program").symlink_to(PROGRAM)
        sensors = numpy.empty(len(runs), dtype=object)
        for number, (case, group, *_) in enumerate(runs):
            with h5py.File(DATA / f"{case}_reference.h5") as file:
                one = file[group]
                sensors[number] = {"record": numpy.array(one.attrs["record"].split(), dtype=object), **{
                    "mask": one[name][()].T.astype(float) for name in ("sensor_mask_corners", "sensor_mask_positions") if name in one}}
        scipy.io.savemat(folder / "sensors.mat", {"sensors": sensors})
        lines = [f"addpath('{ROOT}/analysis/matlab'); load('sensors.mat'); more = struct(); found = struct();",
                 "own = {'Program', fullfile(pwd, 'program'), 'Python', "
                 f"'{shutil.which('python3', path='/usr/bin:' + os.environ['PATH'])}'}};"]
        for number, (case, _, *arguments) in enumerate(runs, 1):
            lines += [f"load('{DATA}/{case}_study.mat'); one = sensors{{{number}}}; sensor.record = one.record;",
                      "if isfield(one, 'mask'), sensor.mask = one.mask; end",
                      f"found.run{number} = pstdElastic{2 if case.endswith('_2d') else 3}Dshearwake({', '.join(['kgrid, medium, source, sensor, options{:}, own{:}', *arguments])});"]
        (folder / "all_runs.m").write_text("\n".join([*lines, script, "save('-v7', 'out.mat', 'found', 'more');"]), encoding="utf-8")
        self.call("octave-cli", "--quiet", "--eval", "all_runs", cwd=folder, variables={"TMPDIR": str(folder)})
        out = scipy.io.loadmat(folder / "out.mat", simplify_cells=True)
        for (case, group, *_), found in zip(runs, out["found"].values(), strict=True):
            with h5py.File(DATA / f"{case}_reference.h5") as file:
                self.compare([found] if group == "corners" and isinstance(found, dict) else found, file[group])
        self.assertEqual([path.name for path in folder.glob("oct-*")], [])
        return out["more"]

    @unittest.skipUnless(list(Path("/etc/OpenCL/vendors").glob("*.icd")), "OpenCL has no driver")
    def test_a_gpu_agrees_with_kwave(self):
        self.octave([("homogeneous", "binary", "'Device', 'gpu'")])

    def test_records_and_types_agree_without_kwave(self):
        """Values of all types in which Octave stores masks and times, and the options of k-Wave's three-dimensional example."""
        (self.folder / "PlainGrid.m").write_text("""\
classdef PlainGrid < handle % as kWaveGrid
    properties
        Nx; Ny; Nz; dx; dy; dz; dt = 'auto'; Nt = 'auto';
    end
    properties (Dependent)
        t_array
    end
    methods
        function times = get.t_array(grid)
            times = (0:grid.Nt - 1) * grid.dt;
        end
    end
end
""")
        more = self.octave([("ewp_3d", "corners", "'PlotScale', [-2, 2, -0.1, 0.1], 'DisplayMask', source.u_mask, 'HDFCompressionLevel', 9"),
                            ("homogeneous", "binary", "'PlotSim', false, 'Ranks', 2")], f"""
addpath('{self.folder}');
sensor = rmfield(sensor, 'record');
run = @(varargin) pstdElastic3Dshearwake(varargin{{:}}, options{{:}}, own{{:}});
more.p = run(kgrid, medium, source, sensor, 'DataCast', 'single');
p = run(kgrid, medium, source, sensor);
grid = PlainGrid();
for name = fieldnames(kgrid).'
    grid.(name{{1}}) = kgrid.(name{{1}});
end
other = sensor;
other.mask = sensor.mask > 0;
changed = source;
changed.u_mask = uint8(source.u_mask);
times = rmfield(kgrid, {{'dt', 'Nt'}});
times.t_array = (0:kgrid.Nt - 1) * kgrid.dt;
more.same = [isequal(run(grid, medium, changed, other), p), max(max(abs(run(times, medium, source, sensor) - p))) < 1e-12 * max(p(:))];
final = run(kgrid, medium, source, struct('mask', [], 'record', {{{{'u_final'}}}}));
more.final = size(final.ux_final);
sensor.mask = [8 9 10 12 12 13; 10 11 12 10 11 12; 1 13 12 28 13 12].';
boxes = run(kgrid, medium, source, sensor);
nothing = run(kgrid, medium, source, []);
try
    pstdElastic3Dshearwake(kgrid, medium, source, sensor, 'PMLSize', 20, own{{:}});
catch err
    more.message = err.message;
end
more.kinds = {{class(more.p), class(boxes(1).p), class(nothing)}};
more.sizes = {{size(boxes), size(boxes(1).p), size(boxes(2).p), size(nothing)}};
more.box = boxes(1).p;
""")
        with h5py.File(DATA / "homogeneous_reference.h5") as file:
            corners = file["corners/p/1"][()]
        self.assertEqual(list(more["same"]), [1, 1])
        self.assertEqual(list(more["final"]), [28, 25, 24])
        self.assertEqual(list(more["kinds"]), ["single", "double", "double"])
        self.assertEqual([list(size) for size in more["sizes"]], [[1, 3], [5, 4, 4, 116], [1, 1, 1, 116], [0, 0]])
        self.assertEqual(more["p"].shape, (12, 116))
        numpy.testing.assert_allclose(more["box"].T, corners, rtol=0, atol=ROUNDED * numpy.abs(corners).max())
        self.assertIn("options.PMLSize is 20", more["message"])

    def test_planes_agree_without_kwave(self):
        """Also a grid whose Nz and dz are 0, as those of kWaveGrid, the arguments of k-Wave's three examples, and as many nodes along x as
        corners have numbers."""
        more = self.octave([("layered_2d", "binary"), ("solids_2d", "corners"), ("p0_2d", "binary"),
                            ("p0_2d", "cartesian_nearest", "'CartInterp', 'nearest'")], """
kgrid.Nz = 0; kgrid.dz = 0;
sensor = struct('mask', ones(51, 45));
more.p = size(pstdElastic2Dshearwake(kgrid, medium, source, sensor, options{:}, own{:}));
simple = struct('sound_speed_compression', 1800, 'sound_speed_shear', 1200, 'density', 1000);
run = @(source, sensor, varargin) pstdElastic2Dshearwake(kgrid, simple, source, sensor, varargin{:}, own{:});
marked = false(51, 45);
marked(20, :) = 1;
more.layered = class(run(source, sensor, 'PlotScale', [-0.75, 0.75, -0.15, 0.15], 'PlotPML', false, 'DisplayMask', marked, 'DataCast', 'single'));
every = struct('u_mask', ones(51, 45), 'ux', 1e-6 * reshape(double(marked), [], 1));
places = struct('mask', zeros(51, 45), 'record', {{'u'}});
places.mask([25, 30], 22) = 1;
waves = run(every, places, 'PlotScale', 'auto', 'PMLSize', [20, 2], 'PMLAlpha', 0, 'PlotPML', false);
more.waves = size(waves.ux);
burst = struct('s_mask', double(marked), 'sxx', -1e6 * sin(1:20), 'syy', -1e6 * sin(1:20));
most = run(burst, struct('record', {{'u_max_all'}}), 'PMLSize', 10, 'PMLAlpha', 2, 'PlotPML', false, 'PMLInside', false, ...
    'PlotScale', [-1, 1] * 1e6, 'DisplayMask', 'off', 'DataCast', 'single');
more.most = [size(most.ux_max_all), numel(fieldnames(most))];
kgrid.Nx = 4;
medium = struct('sound_speed_compression', 1600, 'sound_speed_shear', 700, 'density', 1000);
more.small = size(pstdElastic2Dshearwake(kgrid, medium, struct('p0', ones(4, 45)), struct('mask', ones(4, 45)), 'PMLSize', 1, own{:}));
try
    pstdElastic3Dshearwake(kgrid, medium, source, sensor, own{:});
catch err
    more.message = err.message;
end
""")
        self.assertEqual([list(more["p"]), list(more["small"])], [[51 * 45, 200], [180, 200]])
        self.assertEqual([more["layered"], list(more["waves"]), list(more["most"])], ["single", [2, 200], [51, 45, 2]])
        self.assertIn("kgrid is not three-dimensional", more["message"])

    @pytest.mark.long
    def test_all_cases_agree_without_kwave(self):
        self.octave([("homogeneous", "binary"), ("homogeneous", "corners"), ("homogeneous", "cartesian_linear"),
                     ("homogeneous", "cartesian_nearest", "'CartInterp', 'nearest'"), ("ewp_3d", "corners"), ("p0_pml_outside", "binary"),
                     ("p0_pml_outside", "raw", "'Smooth', false"), ("stress_lossy", "binary", "'PMLRange', [2, 9]"), ("dirichlet", "binary"),
                     ("plane_wave", "binary")])


class Shell(ProgramTest):
    def test_command_of_kspacefirstorder3dc(self):
        """The shell line and the options of that function, with spaces in BinaryPath masked as there. It does not mask the names of the
        files, which lie in tempdir."""
        binaries = self.folder / "k wave"
        binaries.mkdir()
        (binaries / "kspaceFirstOrder-elastic").symlink_to(ROOT / "scripts" / "kspaceFirstOrder-elastic")
        masked = str(binaries).replace(" ", "\\ ") + "/"
        done = self.call("sh", "-c", f"export LD_LIBRARY_PATH=;  OMP_PLACES=cores;  OMP_PROC_BIND=SPREAD;  cd {masked}; ./kspaceFirstOrder-elastic "
                              f"-i {DATA}/ewp_3d_input.h5 -o {self.folder}/out.h5 -g 0 -t 2 --verbose 0 --p_raw --p_max --p_final --u_max "
                              "--u_non_staggered_raw -s 5", variables={"SHEARWAKE": str(PROGRAM)})
        self.contains(done.stdout, "2 ranks")
        with h5py.File(self.folder / "out.h5") as out, h5py.File(DATA / "ewp_3d_input.h5") as given:
            self.assertEqual(out["p_max/1"].shape, (1, 20, 24))
            self.assertEqual(out["p/1"].shape, (int(given["Nt"][0, 0, 0]) - 4, 1, 20, 24))
            self.assertEqual(out["ux_non_staggered/1"].shape, out["p/1"].shape)
            # what that function reads besides
            for name in ("Nx", "Ny", "Nz", "pml_x_size", "pml_y_size", "pml_z_size"):
                self.assertEqual(out[name][0, 0, 0], given[name][0, 0, 0])
