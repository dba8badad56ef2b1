// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "optimise/study.hpp"
#include "schedule/output_folder.hpp"

#include <map>
#include <string>
#include <vector>

namespace shearwake::app {

/// The optima of all cases and strengths, [case][strength], and the SM-STM with which they are
/// compared.
struct Optima {
    std::vector<optimise::OptimisedCase> cases;
    std::vector<std::vector<optimise::Optimum>> optima;
    std::vector<std::vector<optimise::BestSm>> sm;
};

/// eta_period_1 and the focal rms of a computed case; NaN: none.
struct Reading {
    double eta = 0.0, focal_rms_um = 0.0;
};
std::map<std::string, Reading> readings_of(const schedule::OutputFolder& folder);

/// The best SM-STM of each case and strength by the results of the basis.
std::vector<std::vector<optimise::BestSm>>
best_sm(const std::vector<optimise::OptimisedCase>& cases, const std::vector<double>& strengths,
        const std::map<std::string, Reading>& basis);

/// Writes the table of the study as CSV, Markdown and JSON and the exported waveforms to the folder
/// `optimise`, and returns the Markdown. Throws UsageError (environment). Not collective.
std::string write_optima(const schedule::OutputFolder& folder, const Optima& results,
                         const OptimiseOptions& options,
                         const std::map<std::string, Reading>& basis);

} // namespace shearwake::app
