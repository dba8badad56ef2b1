#pragma once

#include "base/error.hpp"

#include <fftw3.h>
#include <memory>
#include <type_traits>

namespace shearwake {

struct DestroyFftwPlan {
    void operator()(fftw_plan p) const { fftw_destroy_plan(p); }
};

/// Owns one plan of FFTW.
using FftwPlan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, DestroyFftwPlan>;

inline FftwPlan checked_plan(fftw_plan raw) {
    if (!raw) throw Error("FFTW refused to make a plan");
    return FftwPlan(raw);
}

} // namespace shearwake
