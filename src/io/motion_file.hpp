#pragma once

#include "model/point_motion.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace shearwake {

/// How points of the skin move, from a file that others wrote; none of these is collective. They
/// throw UsageError with what is wrong. Values that are not finite are kept: who uses them says
/// where they are.

/// CSV by the ending .csv, else HDF5, from `group` if one is named.
PointMotion read_motion(const std::filesystem::path& path, const std::string& group);

/// The first line names the time and its unit and a length unit a point, as in "t_ms,u_um,u_um";
/// lines x_mm,... and y_mm,... below it give the points' places (one point without them: the
/// origin); then a line a time, at regular steps. Empty lines and those that begin with # are
/// passed over.
PointMotion motion_of_csv(std::string_view csv);

/// The compression at receptors: as a motion, but with units of pressure ("t_ms,p_Pa,p_Pa") and
/// without places, or compression_Pa (receptor, sample) and the attribute fs_hz.
PointStress read_stress(const std::filesystem::path& path, const std::string& group);
PointStress stress_of_csv(std::string_view csv);
PointStress stress_of_hdf5(const std::filesystem::path& path, const std::string& group);

/// Either, as case files have in /traces and /pins: u_z (point, time) [m], time [s], x and y [m]
/// (a first time of one step is preceded by rest); or trace_mm (point, sample), pin_xy_mm (point,
/// 2), attributes fs_hz and perhaps pin_radius_mm. Without `group`: /traces, or the root.
PointMotion motion_of_hdf5(const std::filesystem::path& path, std::string group);

} // namespace shearwake
