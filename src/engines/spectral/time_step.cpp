#include "engines/spectral/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

constexpr double default_step_s = 25e-6;

} // namespace

TimeStep choose_time_step(const Case& c, const SpectralOptions& options) {
    const double wanted_s = options.time_step_s.value_or(default_step_s);
    const double ratio = c.time.interval_s / wanted_s;
    const auto per_frame =
        std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9)));
    const double step_s = c.time.interval_s / static_cast<double>(per_frame);
    return {step_s, per_frame,
            fmt::format("time step {:.4g} us, {}", 1e6 * step_s,
                        options.time_step_s ? "as the job gives it" : "the default")};
}

} // namespace shearwake
