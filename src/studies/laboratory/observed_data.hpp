// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "engines/engine.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "studies/laboratory/laboratory.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// The files that shearwake.laboratory.measure_scan writes: <prefix>.json and <prefix>.f64. None
/// of these functions is collective. All throw UsageError (environment) if a file does not have the
/// expected content.
struct ConvertedData {
    std::string data, sha256; // the file of the user
    std::vector<std::string> notes;
    double rate_Hz = 0.0, noise_m_s = 0.0;
    // Of the surface:
    std::size_t repetitions = 0;
    Vec2 covered_from_m, covered_to_m; // bounding box of the nodes with data
    // Of the velocities:
    std::vector<Vec2> points_m;
    std::size_t samples = 0;
    double start_s = 0.0; // of the first sample after the trigger
    double delay_s = 0.0; // of the trigger after the start of the load
    Vec3 direction;
    bool is_line = false;
};

ConvertedData read_surface(const std::filesystem::path& prefix);
ConvertedData read_velocities(const std::filesystem::path& prefix);

/// Reads `values.size()` numbers from position `first` on.
void read_numbers(const std::filesystem::path& prefix, std::size_t first, std::span<double> values);

/// Removes both files.
void remove_converted(const std::filesystem::path& prefix);

/// The members of a request of shearwake.laboratory.measure_scan that follow from the arguments and
/// the vibrometer of a case, if it has one.
nlohmann::ordered_json scan_request(const ScanArguments& arguments, const Case& c);

/// Warns on the standard error of overrides of what the scan replaces. `is_fit`: the motion is
/// computed and filtered as by the vibrometer of the job. Not collective.
void warn_of_overrides(const ScanArguments& arguments, bool is_fit);

/// Converts a file of a user by that script into <prefix>.json and <prefix>.f64. Throws UsageError
/// if it is not a usable scan; the script prints the reason. Not collective.
void convert_scan(const std::filesystem::path& data, const nlohmann::ordered_json& request,
                  const std::filesystem::path& prefix);

/// Predicts what the vibrometer of a case records at the points and times of a scan. Keeps the
/// engine and the last motions between calls: the pressure and the delay need no new ones.
class ObservedModel {
public:
    /// `samples`: number of the first samples of each point that are predicted.
    ObservedModel(const ConvertedData& data, std::size_t samples, const Comm& team);

    /// Velocities without noise, one row of samples per point; on the root, empty elsewhere.
    /// Filters, spot, line of sight, delay and offset are those of the vibrometer of the case or,
    /// without one, of the file. The simulated time is extended as far as the delay requires.
    /// Throws CaseFailure, or UsageError as observed_case(), on all ranks together. Collective.
    std::vector<double> velocities_m_s(const Case& c);

private:
    const ConvertedData& data_;
    std::size_t samples_;
    const Comm& team_;
    std::ptrdiff_t frames_ = 0; // of the transient cases
    /// Displacements for a load of 1 Pa, one row of frames per point.
    struct Motion {
        Case of;
        std::vector<double> displacements_m;
    };
    /// The case until the last sample and somewhat longer. Later cases are never shorter, so that
    /// differences of predictions contain no effect of the end.
    Case continued(Case c);
    /// `c`: a case with a load of 1 Pa. Valid until the next call. Collective.
    const std::vector<double>& motion_m(const Case& c);

    std::unique_ptr<engines::Engine> engine_;
    std::vector<Motion> cached_; // the most recent one first
};

/// The case with the scan of these data and nothing else to record. Throws UsageError if a point is
/// outside of the domain. Not collective.
Case observed_case(Case c, const ConvertedData& data);

/// Number of the first samples of a scan that the case covers; in the periodic regime all. Throws
/// UsageError if a period is not a whole number of samples. Not collective.
std::size_t covered_samples(const Case& observed, const ConvertedData& data);

} // namespace shearwake::laboratory
