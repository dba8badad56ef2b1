// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/optimise_options.hpp"
#include "case/plan.hpp"
#include "optimise/ceiling.hpp"
#include "optimise/families.hpp"
#include "optimise/waveform.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// A case of a job whose envelope is optimised, and the cases from which its forms are computed and
/// with which its optimum is compared.
struct OptimisedCase {
    PlannedCase base; // without envelope
    Knots knots;
    Case plain; // as the cases of the knots, but with the unmodulated load, and without frames
    std::vector<SmCase> sm; // without frames
};

/// The cases of a plan, without references. Throws UsageError for a case whose envelope cannot be
/// optimised.
std::vector<OptimisedCase> optimised_cases(const Plan& plan, const OptimiseOptions& options);

/// The text that identifies a study: its cases and options.
std::string study_text(const Plan& plan, const OptimiseOptions& options);

/// The plan of all cases that must be known before the optimisation. `has_forms`: whether the forms
/// of each case are known, so that those of its knots are not needed.
Plan basis_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<bool>& has_forms);

/// The results for one case and strength.
struct Optimum {
    double strength = 0.0; // required
    Envelope found;
    Certificate ceiling;
    AmEnvelope am;
    double eta_unmodulated = 0.0;
};

/// Searches for the best envelope, proves the ceiling, and finds the best AM-STM. Not collective.
Optimum optimum(const OptimisedCase& c, const Forms& forms, double strength,
                const OptimiseOptions& options);

/// The position in OptimisedCase::sm of the best SM-STM; none if none reaches the strength.
using BestSm = std::optional<std::size_t>;

/// An exported waveform of an optimum; none without update_rate_Hz.
std::optional<Waveform> exported(const OptimisedCase& c, const Optimum& optimum,
                                 const OptimiseOptions& options);

/// The cases of one optimum, as they are in the final plan.
struct ResultCases {
    Case unmodulated, found, am;
    std::optional<Case> sm, exported;
};
ResultCases result_cases(const OptimisedCase& c, const Optimum& optimum, const BestSm& sm,
                         const OptimiseOptions& options);

/// The plan of the output folder: for each case and strength the optimum, the unmodulated load, the
/// best AM-STM and SM-STM, and the exported waveform. `optima` and `sm`: [case][strength].
Plan final_plan(const Plan& plan, const std::vector<OptimisedCase>& cases,
                const std::vector<std::vector<Optimum>>& optima,
                const std::vector<std::vector<BestSm>>& sm, const OptimiseOptions& options);

} // namespace shearwake::optimise
