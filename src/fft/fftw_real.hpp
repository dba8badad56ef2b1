// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"

#include <complex>
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

/// Layout of lines of complex numbers: line l begins at index l * distance, consecutive points are
/// `stride` apart.
struct LineFamily {
    int stride = 1, distance = 1;
};

/// FFTW in one precision: unnormalised out-of-place complex transforms of many lines that preserve
/// their input.
template <class Real>
struct FftwOf;

template <>
struct FftwOf<double> {
    using Complex = std::complex<double>;
    using Plan = FftwPlan;
    static fftw_complex* raw(Complex* values) { return reinterpret_cast<fftw_complex*>(values); }
    /// The plan is empty if FFTW cannot create it (FFTW_WISDOM_ONLY without wisdom).
    static Plan plan(int length, int lines, Complex* from, LineFamily from_lines, Complex* to,
                     LineFamily to_lines, int sign, unsigned flags) {
        return Plan(fftw_plan_many_dft(1, &length, lines, raw(from), nullptr, from_lines.stride,
                                       from_lines.distance, raw(to), nullptr, to_lines.stride,
                                       to_lines.distance, sign, flags));
    }
    static void execute(const Plan& plan) { fftw_execute(plan.get()); }
};

struct DestroySinglePlan {
    void operator()(fftwf_plan p) const { fftwf_destroy_plan(p); }
};

template <>
struct FftwOf<float> {
    using Complex = std::complex<float>;
    using Plan = std::unique_ptr<std::remove_pointer_t<fftwf_plan>, DestroySinglePlan>;
    static fftwf_complex* raw(Complex* values) { return reinterpret_cast<fftwf_complex*>(values); }
    static Plan plan(int length, int lines, Complex* from, LineFamily from_lines, Complex* to,
                     LineFamily to_lines, int sign, unsigned flags) {
        return Plan(fftwf_plan_many_dft(1, &length, lines, raw(from), nullptr, from_lines.stride,
                                        from_lines.distance, raw(to), nullptr, to_lines.stride,
                                        to_lines.distance, sign, flags));
    }
    static void execute(const Plan& plan) { fftwf_execute(plan.get()); }
};

} // namespace shearwake::fft
