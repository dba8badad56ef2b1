// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "problem/medium/material_map.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace shearwake::storage {

/// Reads a map of properties from an HDF5 file: uniform ascending coordinates x_m, y_m and z_m, and
/// one or more of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s of shape (x, y, z), in any
/// number type, compressed or not. Arrays that MATLAB wrote, recognised by their attributes or
/// their shape, have their indices in reverse. With one point along an axis, properties do not vary
/// along it. Not collective. Throws UsageError for all errors in the file.
MaterialMap read_map_file(const std::filesystem::path& path);

/// Reads on rank 0 and broadcasts to all ranks; errors are thrown on all of them. Collective.
MaterialMap read_map_file(const std::filesystem::path& path, const Comm& comm);

/// The motion of points of the skin from a user file. None of these functions is collective. They
/// throw UsageError with the reason. Values that are not finite are accepted here and reported by
/// the caller with their position.

/// Reads CSV if the name ends in .csv, otherwise HDF5 from `group`: either, as in /traces and /pins
/// of case files, u_z (point, time) [m], time [s], x and y [m] (rest is prepended if the first time
/// is one step), or trace_mm (point, sample), pin_xy_mm (point, 2), and the attributes fs_hz and
/// optionally pin_radius_mm. Without `group`: /traces, or the root.
PointMotion read_motion(const std::filesystem::path& path, const std::string& group);

/// The first line names the time with its unit and one column per point with a unit of length, as
/// in "t_ms,u_um,u_um". The lines x_mm,... and y_mm,... below it give the positions of the points
/// (default for one point: the origin), followed by one line per time, uniformly spaced. Empty
/// lines and lines that begin with # are ignored.
PointMotion motion_of_csv(std::string_view csv);

/// The compression at receptors: in the format of a motion, but with units of pressure
/// ("t_ms,p_Pa,p_Pa") and without positions, or compression_Pa (receptor, sample) and the attribute
/// fs_hz.
PointStress read_stress(const std::filesystem::path& path, const std::string& group);
PointStress stress_of_csv(std::string_view csv);

} // namespace shearwake::storage
