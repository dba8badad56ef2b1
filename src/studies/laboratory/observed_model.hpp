// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "studies/laboratory/converted_data.hpp"

#include <memory>
#include <vector>

namespace shearwake::laboratory {

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
