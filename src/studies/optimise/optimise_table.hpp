// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/optimise/optimise_study.hpp"

#include <map>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The maximised measure and the focal rms of a computed case; NaN: none.
struct Reading {
    double eta = 0.0, focal_rms_um = 0.0;
    bool is_valid = true; // false: a stored warning rules the readings out
};
/// By id.
using Readings = std::map<std::string, Reading>;
Readings readings_of(const schedule::OutputFolder& folder, const std::string& maximised);

/// The best SM-STM of each case and strength by the results of the basis, on every rank:
/// [case][strength]. Collective.
std::vector<std::vector<BestSm>> agreed_sm(const Study& study, const Comm& world);

/// A job file whose only case has the motion of an optimum and this envelope: the job of the study
/// with its overrides and the swept values of the case, without [sweep], [table], [uncertain] and
/// [optimise]. Not collective.
std::string job_of_optimum(const Study& study, const OptimisedCase& of, const MovedCase& moved,
                           const SampledGain& envelope);

/// Writes the table of the study as CSV and Markdown and the exported waveforms to the folder
/// `optimise`, and returns the Markdown. Throws UsageError (environment). Not collective.
std::string write_optima(const Study& study, const Optima& results, const Readings& basis);

/// Writes the table of the optima in other tissues and at other speeds in the same way.
std::string write_robustness(const Study& study, const Optima& results,
                             const std::vector<RobustCase>& cases);

} // namespace shearwake::optimise
