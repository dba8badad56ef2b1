// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>
#include <new>
#include <string>

namespace shearwake::pipeline {

/// Called by a rank of a team for an error that only it has encountered; must not return.
using EndAlone = std::function<void(const std::string& reason)>;

/// Engines, recorder and files throw CaseFailure and UsageError on all ranks of a team together.
/// Any other exception affects one rank, and the other ranks cannot detect it. Unless the rank
/// forms a team by itself, the program ends here. A file that the team has open must be owned
/// outside `work`, since closing it during unwinding would wait for the other ranks forever. Not
/// collective itself.
template <class Work>
void or_end_alone(const Comm& team, const EndAlone& end_alone, const Work& work) {
    try {
        work();
    } catch (const CaseFailure&) {
        throw;
    } catch (const UsageError&) {
        throw;
    } catch (const std::exception& error) {
        const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
        const std::string reason = memory ? "out of memory" : error.what();
        if (team.size() == 1) throw CaseFailure(reason);
        end_alone(reason);
    }
}

} // namespace shearwake::pipeline
