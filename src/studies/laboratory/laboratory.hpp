// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// A scan of a user, the job that describes it, and the output folder, which is by default
/// out/<job name>.measure.
struct MeasureArguments : schedule::JobArguments {
    std::filesystem::path data, out;
    double least_quality = 0.0;
    bool outwards = false;            // z and positive velocities of the scan point out of the skin
    std::filesystem::path fit;        // fit.json, whose estimates override the job; empty: none
    double high_pass_Hz = 0.0;        // 0: none
    std::string gaps = "interpolate"; // interpolate, mask
    std::size_t repetitions = 8;      // for the uncertainty
};

/// What a measurement has left in its folder; on rank 0.
struct Measurement {
    schedule::OutputFolder folder;
    std::string id;
    std::vector<std::string> notes;
    std::map<std::string, double> errors; // of the columns; NaN: unknown
    std::string warning;                  // of a measured area that the scan does not cover
};

/// Writes the case file of a measured scan, with the same measures as a simulation, and their
/// uncertainty. Collective over the world.
Measurement measure(const MeasureArguments& arguments, const Comm& world);

} // namespace shearwake::laboratory
