// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/json.hpp"
#include "config/job.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"
#include "studies/optimise/forms.hpp"

#include <optional>
#include <vector>

namespace shearwake::optimise {

/// A case of a job whose envelope is optimised.
struct OptimisedCase {
    PlannedCase planned; // without envelope
    Knots knots;
};

/// The cases of a plan, without references. Throws UsageError (bad_job) for a case that cannot be
/// optimised. Not collective.
std::vector<OptimisedCase> optimised_cases(const Plan& plan, const OptimiseOptions& options);

/// A study: its job, options and folders, the same on every rank.
struct Study {
    config::Job job;
    OptimiseOptions options;
    std::vector<OptimisedCase> cases;
    schedule::OutputFolder folder;
    schedule::RunArguments run; // of the cases; `out` is not used
};

/// What the module must know about the study: names, options and cases. Not collective.
Json description(const Study& study, int ranks);

/// The case that the object `variant` describes: `case` is the number of the optimised case,
/// `readings_only` omits the record, and `motion`, `sm`, `envelope` and `difference` change its
/// load and its tissue. None if it is not a valid case. Not collective.
std::optional<Case> case_of(const Study& study, const Json& variant);

/// The id and the motion of such a case; null if it is not a valid case. Not collective.
Json describe(const Study& study, const Json& variant);

/// Where the focus of such a case is at the times of the request, [[x, y], ...] in m.
Json positions(const Study& study, const Json& request);

/// Computes the cases of a request and the forms of those in `forms`, whose files of knots are
/// removed afterwards. `answer`, on rank 0, receives the ids of the cases and their rows by id: the
/// maximised measure, the focal rms in um, whether they are valid, and the uniformity. Collective.
ExitCode compute(const Study& study, const Json& request, Json& answer, const Comm& world);

} // namespace shearwake::optimise
