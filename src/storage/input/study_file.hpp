// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/study_data.hpp"

#include <filesystem>

namespace shearwake::storage {

/// Reads a study from the HDF5 file that scripts/import-kwave writes. Not collective. Throws
/// UsageError for all errors in the file. All numbers are float64; the root has the attributes
/// schema = "shearwake grid study 1" and sources, the number of sources.
///     grid/      points (3), spacing_m (3); attributes time_step_s, steps
///     layer/     points (3), strength (3), inside the grid; attributes ratio, speed_m_s (0: the
///                largest c_p)
///     medium/    density_kg_m3, c_p_m_s, c_s_m_s, optionally eta_Pa_s and chi_Pa_s: one value, or
///                (x, y, z)
///     source_N/  nodes (n, 3) counted from 0, weights (n), rows (n), series (rows, samples);
///                attributes field, mode
///     sensor/    nodes (n, 3), optionally weights (points, m) of points that are sums of m nodes;
///                attributes fields (names of sensor_records), start
StudyData read_study_file(const std::filesystem::path& path);

/// Reads on rank 0 and broadcasts to all ranks; errors are thrown on all of them. Collective.
StudyData read_study_file(const std::filesystem::path& path, const Comm& comm);

} // namespace shearwake::storage
