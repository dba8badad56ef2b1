// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/run/case_reporter.hpp"
#include "storage/journal/claims.hpp"

#include <optional>
#include <vector>

namespace shearwake::schedule {

/// The cases that are left for a team. It takes portions of them from a counter that all teams
/// share until none is left, the time limit is reached or a stop is requested. Cases that another
/// run computes are deferred: they are left until that run has completed or given up each. On the
/// root of the team; not collective except for the construction.
class CaseQueue {
public:
    /// Collective over the world.
    CaseQueue(const WorkList& list, RunState& state, CaseReporter& reporter, const Comm& world,
              const Comm& team);

    /// Instead of a position in the list of cases.
    static constexpr long no_case = -1, no_case_yet = -2;
    /// The position of the next case, which this team has claimed, or no_case, or no_case_yet while
    /// other runs compute the cases that are left.
    long next();
    /// Whether no other run has taken a claimed case over, as if this one stood still for long.
    bool holds(const PlannedCase& planned) const { return claims_->holds(planned.id); }
    void release(const PlannedCase& planned) { claims_->release(planned.id); }
    void defer(std::size_t place) { deferred_.push_back(place); }
    std::size_t deferred() const { return deferred_.size(); }

private:
    enum class Claim { granted, deferred, ended };
    std::optional<std::size_t> next_in_portions();
    Claim claim(std::size_t place);
    bool count_if_ended_elsewhere(const PlannedCase& planned);
    bool in_time(std::size_t place);

    const WorkList& list_;
    RunState& state_;
    CaseReporter& reporter_;
    std::optional<storage::CaseClaims> claims_;
    std::size_t portion_ = 0, portion_end_ = 0; // the remaining cases of the portion of this team
    std::vector<std::size_t> deferred_;         // positions in the list
};

} // namespace shearwake::schedule
