// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/json.hpp"
#include "config/job.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"
#include "schedule/run/select_cases.hpp"
#include "schedule/run/worker.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace shearwake::schedule {

enum class Ending { regular, stopped };

/// The cases among `numbers` (positions in the plan) that no other run computes and that resume
/// from checkpoints in the folder, with the time that the checkpoints contain: "case ID (12 s
/// computed)"; empty if there are none. Not collective.
std::string resumable_cases(const OutputFolder& folder, const Plan& plan,
                            const std::vector<std::size_t>& numbers);

/// The last lines of a run: counts, what was left and why, and the next command. Reads the folder.
/// Not collective.
std::string closing_message(const OutputFolder& folder, const Plan& plan,
                            const Selection& selection, const WorkResult& result, Ending ending,
                            const RunArguments& arguments);

/// The same as the members of a JSON document. Reads the folder. Not collective.
Json closing_document(const OutputFolder& folder, const config::Job& job,
                      const Selection& selection, const WorkResult& result, Ending ending,
                      const RunArguments& arguments);

} // namespace shearwake::schedule
