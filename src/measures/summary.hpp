// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/surface_sums.hpp"
#include "problem/case/case.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::measures {

/// One scalar of the table. NaN is an empty cell, and `note` gives the reason; a note on a number
/// qualifies it.
struct Column {
    std::string name; // with its unit: "peak_um"
    std::string unit; // as in files: "1", "mm2", "um", "mN ms", "Hz", "degree"
    std::string long_name;
    double value = 0.0;
    std::string note;
};

/// The sums of every frame of the case's time axis, at one recorded depth.
struct DepthSeries {
    double depth_m = 0.0;
    std::vector<SurfaceSums> frames;
};

/// u_z at one point, at every frame of the case's time axis.
struct TraceSeries {
    Vec2 at_m;
    std::vector<double> u_m;
};

/// All scalars of the table for one case. The columns depend only on the depths. The surface
/// columns refer to the first depth; further depths add eta_period, focal_rms and peak with their
/// depth in the name (focal_rms_um_z1.5mm). The spectrum is that of the first trace at the origin,
/// or of the first trace. `mean_u2` is the whole surface's time mean of u_z^2 over the period
/// window (x, y row-major), empty where none was kept. Not collective.
std::vector<Column> summarise(const Case& c, const std::vector<DepthSeries>& depths,
                              const std::vector<TraceSeries>& traces,
                              const std::optional<MachFit>& mach,
                              const std::vector<double>& mean_u2 = {});

} // namespace shearwake::measures
