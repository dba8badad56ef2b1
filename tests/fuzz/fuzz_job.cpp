// SPDX-License-Identifier: BSD-3-Clause
// For arbitrary bytes, the reader of job files must return a job or throw BadJob. The demand of a
// job for memory and disk must then be finite, as `check` needs it.
#include "config/job.hpp"
#include "schedule/cost/case_costs.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const shearwake::config::Job job = shearwake::config::read_job(text, "fuzz.toml");
        std::vector<const shearwake::PlannedCase*> cases;
        for (const shearwake::PlannedCase& planned : job.plan.cases)
            cases.push_back(&planned);
        const auto demand = shearwake::schedule::least_demand(cases, 1);
        if (!std::isfinite(demand.memory_per_rank_B) || !std::isfinite(demand.disk_B)) std::abort();
    } catch (const shearwake::UsageError&) {
    }
    return 0;
}
