// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"

#include <fftw3.h>
#include <memory>
#include <type_traits>

namespace shearwake::fft {

struct DestroyFftwPlan {
    void operator()(fftw_plan p) const { fftw_destroy_plan(p); }
};

/// Owns one FFTW plan.
using FftwPlan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, DestroyFftwPlan>;

/// Takes ownership of the plan. Throws Error if FFTW returned none.
inline FftwPlan checked_plan(fftw_plan raw) {
    if (!raw) throw Error("FFTW could not create a plan");
    return FftwPlan(raw);
}

} // namespace shearwake::fft
