# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's XDMF reader, which is a part of VTK, finds the values of case files at their positions and times."""

import h5py
import numpy
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

from program import SPECTRAL, ProgramTest, case_files, swept, without_reference

# Two depths, and a focus that is not symmetric in x and y, so that exchanged axes would be noticed.
JOB = without_reference(SPECTRAL, swept(500), {
    "load.modulation.path": {"shape": "line", "from_mm": [-14.0, -6.0], "to_mm": [14.0, 9.0]}, "measure.depths_mm": [0.0, 3.0],
    "record.volumes_ms": [2.0, 4.0], "record.volume_fields": ["u", "strain", "stress"]})

TENSOR = ("xx", "yy", "zz", "yz", "xz", "xy")


def grids(data):
    """The grids of a data set without the hierarchy of collections."""
    if not hasattr(data, "GetNumberOfBlocks"):
        return [data]
    return [grid for n in range(data.GetNumberOfBlocks()) for grid in grids(data.GetBlock(n))]


class Xdmf:
    def __init__(self, path):
        self.reader = vtkXdmfReader()
        self.reader.SetFileName(str(path))
        self.reader.UpdateInformation()
        steps = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
        self.times_s = self.reader.GetOutputInformation(0).Get(steps)

    def at(self, time_s):
        self.reader.UpdateTimeStep(time_s)
        return grids(self.reader.GetOutputDataObject(0))


def names(grid):
    return {grid.GetPointData().GetArrayName(n) for n in range(grid.GetPointData().GetNumberOfArrays())}


def values_near(grid, name, points):
    """The values of an array at the nodes nearest to the points, and the positions of these nodes [m]."""
    nodes = [grid.FindPoint(point) for point in points]
    values = vtk_to_numpy(grid.GetPointData().GetArray(name))
    return values[nodes], numpy.array([grid.GetPoint(node) for node in nodes])


class ParaView(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write_job(JOB)
        self.shearwake("run", "job.toml")
        self.path = case_files(self.out)[0]

    def test_surfaces_and_volumes_have_the_same_axes(self):
        surface, volume = Xdmf(self.path.with_suffix(".xdmf")), Xdmf(self.path.with_suffix(".volume.xdmf"))
        with h5py.File(self.path) as file:
            kept = {name: file["surface"][name][()] for name in ("u_z", "x", "y", "depth", "time")}
            deep = {name: file["volume"][name][()] for name in ("u_x", "u_y", "u_z", "strain_xy", "x", "y", "z", "time")}
        numpy.testing.assert_allclose(surface.times_s, kept["time"], rtol=1e-12)  # printed with all digits
        numpy.testing.assert_allclose(volume.times_s, deep["time"], rtol=1e-12)
        at = [(3, 5), (20, 11), (30, 29), (11, 17)]  # x, y
        for step, time_s in list(enumerate(kept["time"]))[9::10]:
            planes = surface.at(time_s)
            self.assertEqual(len(planes), 2)
            for depth, plane in enumerate(planes):
                self.assertEqual(names(plane), {"u_z (m)"})
                points = [(kept["x"][i], kept["y"][j], kept["depth"][depth]) for i, j in at]
                values, positions = values_near(plane, "u_z (m)", points)
                numpy.testing.assert_allclose(positions, points, atol=1e-12)  # printed with 12 digits
                numpy.testing.assert_array_equal(values, [kept["u_z"][step, depth, i, j] for i, j in at])
        for step, time_s in enumerate(deep["time"]):
            [body] = volume.at(time_s)
            self.assertEqual(names(body), {"u (m)", "u_x (m)", "u_y (m)", "u_z (m)", *(f"strain_{c}" for c in TENSOR),
                                           *(f"stress_{c} (Pa)" for c in TENSOR)})
            for k in (0, len(deep["z"]) - 2):
                points = [(deep["x"][i], deep["y"][j], deep["z"][k]) for i, j in at]
                for name, units in (("u_x", " (m)"), ("u_y", " (m)"), ("u_z", " (m)"), ("strain_xy", "")):
                    values, positions = values_near(body, name + units, points)
                    numpy.testing.assert_allclose(positions, points, atol=1e-15)
                    numpy.testing.assert_array_equal(values, [deep[name][step, k, j, i] for i, j in at])
                vectors, _ = values_near(body, "u (m)", points)
                numpy.testing.assert_array_equal(
                    vectors, [[deep[name][step, k, j, i] for name in ("u_x", "u_y", "u_z")] for i, j in at])

    @pytest.mark.extended
    def test_surface_and_top_of_the_volume_show_the_same_field(self):
        surface, volume = Xdmf(self.path.with_suffix(".xdmf")), Xdmf(self.path.with_suffix(".volume.xdmf"))
        plane, [body] = surface.at(4e-3)[0], volume.at(4e-3)
        nodes = [plane.GetPoint(n) for n in range(plane.GetNumberOfPoints())]
        shown, _ = values_near(plane, "u_z (m)", nodes)
        top, _ = values_near(body, "u_z (m)", nodes)
        scale = numpy.abs(shown).max()
        self.assertGreater(scale, 0.0)
        # The surface is interpolated between levels with weights that are exact to rounding.
        self.assertLess(numpy.abs(shown - top).max(), 1e-12 * scale)

    @pytest.mark.extended
    def test_the_files_name_the_units_of_time_and_space(self):
        for suffix in (".xdmf", ".volume.xdmf"):
            text = self.path.with_suffix(suffix).read_text(encoding="utf-8")
            self.contains(text, "(x, y, z in m, time in s)", '<Information Name="unit of time" Value="s"/>')
