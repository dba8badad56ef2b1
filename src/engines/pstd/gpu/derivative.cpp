// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/derivative.hpp"

#include "base/units.hpp"
#include "kernels_cl.hpp"

#include <cmath>
#include <complex>
#include <fmt/format.h>

namespace shearwake::pstd::gpu {
namespace {

void append(std::vector<double>& values, std::complex<double> value) {
    values.push_back(value.real());
    values.push_back(value.imag());
}

/// The radices of an FFT of n points: 8, 4, 2, 3, 5 and other primes.
std::vector<std::ptrdiff_t> radices_of(std::ptrdiff_t n) {
    std::vector<std::ptrdiff_t> radices;
    for (const std::ptrdiff_t radix : {8, 4, 2, 3, 5})
        for (; n % radix == 0; n /= radix)
            radices.push_back(radix);
    for (std::ptrdiff_t prime = 7; n > 1; prime += 2)
        for (; n % prime == 0; n /= prime)
            radices.push_back(prime);
    return radices;
}

/// The calls of the stages of a transform, from array a to array a.
std::string stages_of(std::ptrdiff_t n) {
    std::string text = "#define TRANSFORM(has_factor)";
    std::ptrdiff_t before = 1;
    for (const std::ptrdiff_t radix : radices_of(n)) {
        const std::string name = radix == 8 || radix <= 5 ? fmt::format("stage_{}(", radix)
                                                          : fmt::format("stage_any({}, ", radix);
        text += fmt::format(" {}{}, a, b, roots, {}, factor);"
                            " {{ SPACE Real2* other = a; a = b; b = other; }}",
                            name, before, before == 1 ? "has_factor" : "0");
        before *= radix;
    }
    return text + "\n";
}

} // namespace

Derivative::Derivative(const Device& device, const Slabs& slabs, std::size_t axis)
    : device_(device), plane_(slabs.ny() * slabs.pitch / 2) {
    const std::ptrdiff_t n = slabs.grid.points[axis];
    const double d_m = slabs.grid.spacing_m[axis], points = static_cast<double>(n);
    std::vector<double> forward, back, roots;
    for (std::ptrdiff_t m = 0; m < n; ++m) {
        const double k = two_pi * static_cast<double>(2 * m < n ? m : m - n) / (points * d_m);
        const std::complex<double> ik(0.0, k / points);
        const bool nyquist = 2 * m == n; // exactly real there, or the lines of a pair would mix
        for (const double side : {1.0, -1.0}) {
            const std::complex<double> factor = ik * std::polar(1.0, side * 0.5 * k * d_m);
            append(side > 0.0 ? forward : back, nyquist ? factor.real() : factor);
        }
        append(roots, std::polar(1.0, -two_pi * static_cast<double>(m) / points));
    }
    const std::size_t real_B = device.facts().real_B;
    forward_ = device.numbers(forward, real_B);
    back_ = device.numbers(back, real_B);
    roots_ = device.numbers(roots, real_B);
    // Neighbouring lines fill whole sectors of the memory.
    const auto length = static_cast<std::size_t>(n);
    while (width_ > 1 && 4 * length * width_ * real_B > device.facts().local_B)
        width_ /= 2;
    while (group_ < 256 && 8 * group_ < length * width_)
        group_ *= 2;
    // Complex lines are pairs of neighbours along z, or pairs of rows.
    const std::ptrdiff_t lines = axis == 2 ? (slabs.rows() + 1) / 2 : slabs.reals() / 2 / n;
    bundles_ = (static_cast<std::size_t>(lines) + width_ - 1) / width_;
    space_ = {.size = 4 * length * width_, .value_B = real_B};
    const bool is_local = space_.bytes() <= device.facts().local_B;
    if (!is_local) space_ = device.zeros(bundles_ * space_.size, real_B);
    if (axis < 2) columns_ = (axis == 0 ? slabs.ny() : 1) * slabs.pitch / 2;
    const std::string options =
        fmt::format("-DN={} -DWIDTH={} -DGROUP={} -DROWS={} -DPITCH={} {}", n, width_, group_,
                    axis == 2 ? slabs.rows() : 0, axis == 2 ? slabs.pitch : 0,
                    is_local ? "-DSPACE=__local -DFENCE=CLK_LOCAL_MEM_FENCE"
                             : "-DSPACE=__global -DFENCE=CLK_GLOBAL_MEM_FENCE -DGLOBAL_SPACE");
    kernels_ = device.compile(stages_of(n) + transforms_cl, options, {"derive"});
}

void Derivative::derive(fft::HalfCell shift, const Buffer& from, const Buffer& to) const {
    device_.run(kernels_.at("derive"), {bundles_ * group_, 1, 1}, {group_, 1, 1}, from, to,
                shift == fft::HalfCell::forward ? forward_ : back_, roots_, columns_, plane_,
                space_);
}

} // namespace shearwake::pstd::gpu
