// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/derivative.hpp"

#include "base/units.hpp"
#include "kernels_cl.hpp"

#include <cmath>
#include <complex>
#include <fmt/format.h>

namespace shearwake::pstd::gpu {
namespace {

/// Complex lines that are transformed together: neighbours fill whole sectors of the memory.
constexpr std::ptrdiff_t most_lines = 8;

template <class Real>
void append(std::vector<Real>& values, std::complex<double> value) {
    values.push_back(static_cast<Real>(value.real()));
    values.push_back(static_cast<Real>(value.imag()));
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

template <class Real>
auto Derivative<Real>::bundles_of(const Device& device, const Slabs& slabs, std::size_t axis)
    -> Bundles {
    const std::ptrdiff_t n = slabs.grid.points[axis];
    // Complex lines: pairs of neighbours along z, or pairs of rows.
    const std::ptrdiff_t lines = axis == 2 ? (slabs.rows() + 1) / 2 : slabs.reals() / 2 / n;
    const auto space_B = [&](std::ptrdiff_t width) {
        return static_cast<std::size_t>(2 * n * width) * 2 * sizeof(Real);
    };
    Bundles bundles{.width = most_lines};
    while (bundles.width > 1 && space_B(bundles.width) > device.local_B())
        bundles.width /= 2;
    bundles.space_B = space_B(bundles.width);
    bundles.is_local = bundles.space_B <= device.local_B();
    bundles.count = (lines + bundles.width - 1) / bundles.width;
    while (bundles.group < 256 && 8 * bundles.group < n * bundles.width)
        bundles.group *= 2;
    return bundles;
}

template <class Real>
double Derivative<Real>::memory_B(const Device& device, const Slabs& slabs, std::size_t axis) {
    const Bundles bundles = bundles_of(device, slabs, axis);
    const double tables = 6.0 * static_cast<double>(slabs.grid.points[axis]) * sizeof(Real);
    return tables + (bundles.is_local ? 0.0
                                      : static_cast<double>(bundles.count) *
                                            static_cast<double>(bundles.space_B));
}

template <class Real>
Derivative<Real>::Derivative(const Device& device, const Slabs& slabs, std::size_t axis)
    : device_(device), bundles_(bundles_of(device, slabs, axis)) {
    const std::ptrdiff_t n = slabs.grid.points[axis];
    if (n == 1) return;
    const double d_m = slabs.grid.spacing_m[axis];
    std::vector<Real> forward, back, roots;
    for (std::ptrdiff_t m = 0; m < n; ++m) {
        const auto signed_m = static_cast<double>(2 * m < n ? m : m - n);
        const double points = static_cast<double>(n), k = two_pi * signed_m / (points * d_m);
        const std::complex<double> ik(0.0, k / points);
        const bool nyquist = 2 * m == n; // exactly real there, or the lines of a pair would mix
        for (const double side : {1.0, -1.0}) {
            const std::complex<double> factor = ik * std::polar(1.0, side * 0.5 * k * d_m);
            append(side > 0.0 ? forward : back, nyquist ? factor.real() : factor);
        }
        append(roots, std::polar(1.0, -two_pi * static_cast<double>(m) / points));
    }
    forward_ = device.uploaded(forward);
    back_ = device.uploaded(back);
    roots_ = device.uploaded(roots);
    if (!bundles_.is_local)
        space_ = device.buffer<Real>(static_cast<std::size_t>(bundles_.count) * bundles_.space_B /
                                     sizeof(Real));
    if (axis < 2) columns_ = (axis == 0 ? slabs.ny() : 1) * slabs.pitch / 2;
    plane_ = slabs.ny() * slabs.pitch / 2;
    const std::string options =
        fmt::format("-DN={} -DWIDTH={} -DGROUP={} -DROWS={} -DPITCH={} {}", n, bundles_.width,
                    bundles_.group, axis == 2 ? slabs.rows() : 0, axis == 2 ? slabs.pitch : 0,
                    bundles_.is_local ? "-DSPACE=__local -DFENCE=CLK_LOCAL_MEM_FENCE"
                                      : "-DSPACE=__global -DFENCE=CLK_GLOBAL_MEM_FENCE "
                                        "-DGLOBAL_SPACE");
    const Program program = device.compile(stages_of(n) + transforms_cl, options, sizeof(Real));
    kernel_ = device.kernel(program, "derive");
}

template <class Real>
void Derivative<Real>::derive(fft::HalfCell shift, const Buffer<Real>& from,
                              const Buffer<Real>& to) const {
    const Buffer<Real>& factor = shift == fft::HalfCell::forward ? forward_ : back_;
    const auto group = static_cast<std::size_t>(bundles_.group);
    const Device::Range items{static_cast<std::size_t>(bundles_.count) * group, 1, 1};
    const auto run = [&](const auto& space) {
        device_.run(kernel_, items, {group, 1, 1}, from, to, factor, roots_, columns_, plane_,
                    space);
    };
    if (bundles_.is_local)
        run(LocalMemory{bundles_.space_B});
    else
        run(space_);
}

template class Derivative<double>;
template class Derivative<float>;

} // namespace shearwake::pstd::gpu
