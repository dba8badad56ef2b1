#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>
#include <new>
#include <string>

namespace shearwake {

/// Called by one rank of several for what it alone has met; must not return.
using EndAlone = std::function<void(const std::string& reason)>;

/// Engines, recorder and files throw CaseFailure and UsageError on all ranks of a team together.
/// Anything else has struck one rank alone, which the others do not know of: unless it is a team of
/// its own it ends here. A file that the team has open must be held outside of `work`: while it is
/// unwound, closing it would wait for the others for ever. Not collective of itself.
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

} // namespace shearwake
