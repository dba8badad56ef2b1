// SPDX-License-Identifier: BSD-3-Clause
#include "fft/staggered_derivative.hpp"

#include "base/units.hpp"
#include "fft/wisdom.hpp"
#include "simd/kernels.hpp"

#include <fmt/format.h>

namespace shearwake::fft {

template <class Real>
StaggeredDerivative<Real>::StaggeredDerivative(std::ptrdiff_t points, double spacing_m,
                                               const Comm& team)
    : kernels_(&simd::kernels<StaggeredKernels<Real>>()), points_(points),
      block_(static_cast<std::size_t>(points * width)), lines_(block_.size()),
      spectra_(block_.size()) {
    const MakePlans make = [this](unsigned flags) { return plan(flags); };
    const bool single = precision_of<Real> == Precision::in_single;
    plan_measured(team, fmt::format("staggered{}-{}-{}", single ? "-single" : "", points, width),
                  make, precision_of<Real>);
    std::fill(block_.begin(), block_.end(), Complex(0)); // planning overwrites it
    std::fill(lines_.begin(), lines_.end(), Complex(0));
    for (Factor* factor : {&forward_factor_, &back_factor_}) {
        factor->real.resize(static_cast<std::size_t>(2 * points));
        factor->imaginary.resize(static_cast<std::size_t>(2 * points));
    }
    const double n = static_cast<double>(points);
    for (std::ptrdiff_t m = 0; m < points; ++m) {
        const auto signed_m = static_cast<double>(2 * m < points ? m : m - points);
        const double k = two_pi * signed_m / (n * spacing_m);
        const std::complex<double> ik(0.0, k / n); // with the 1/n of the transforms
        const bool nyquist = 2 * m == points;
        const auto forward = ik * std::polar(1.0, 0.5 * k * spacing_m);
        const auto back = ik * std::polar(1.0, -0.5 * k * spacing_m);
        // Exactly real there, or the two lines of a pair would mix by a rounding error.
        set(forward_factor_, m, nyquist ? std::complex<double>(forward.real()) : forward);
        set(back_factor_, m, nyquist ? std::complex<double>(back.real()) : back);
    }
}

template <class Real>
void StaggeredDerivative<Real>::set(Factor& factor, std::ptrdiff_t mode,
                                    std::complex<double> value) {
    const auto at = static_cast<std::size_t>(2 * mode);
    factor.real[at] = factor.real[at + 1] = static_cast<Real>(value.real());
    factor.imaginary[at] = static_cast<Real>(-value.imag());
    factor.imaginary[at + 1] = static_cast<Real>(value.imag());
}

template <class Real>
bool StaggeredDerivative<Real>::plan(unsigned flags) {
    const int n = static_cast<int>(points_), w = static_cast<int>(width);
    const LineFamily columns{w, 1}, lines{1, n};
    const unsigned keep = flags | FFTW_PRESERVE_INPUT;
    columns_to_spectra_ =
        Fftw::plan(n, w, block_.data(), columns, spectra_.data(), lines, FFTW_FORWARD, keep);
    spectra_to_columns_ =
        Fftw::plan(n, w, spectra_.data(), lines, block_.data(), columns, FFTW_BACKWARD, keep);
    lines_to_spectra_ =
        Fftw::plan(n, w, lines_.data(), lines, spectra_.data(), lines, FFTW_FORWARD, keep);
    spectra_to_lines_ =
        Fftw::plan(n, w, spectra_.data(), lines, lines_.data(), lines, FFTW_BACKWARD, keep);
    return columns_to_spectra_ && spectra_to_columns_ && lines_to_spectra_ && spectra_to_lines_;
}

template <class Real>
void StaggeredDerivative<Real>::multiply(HalfCell shift) {
    const Factor& factor = shift == HalfCell::forward ? forward_factor_ : back_factor_;
    kernels_->multiply(reals(spectra_.data()), factor.real.data(), factor.imaginary.data(), points_,
                       width);
}

template <class Real>
void StaggeredDerivative<Real>::differentiate_block(HalfCell shift) {
    Fftw::execute(columns_to_spectra_);
    multiply(shift);
    Fftw::execute(spectra_to_columns_);
}

template <class Real>
void StaggeredDerivative<Real>::transform_block() {
    Fftw::execute(lines_to_spectra_);
    Fftw::execute(spectra_to_lines_);
}

template <class Real>
void StaggeredDerivative<Real>::copy_rows(const Real* from, std::ptrdiff_t from_pitch,
                                          std::ptrdiff_t rows, std::ptrdiff_t count, Real* to,
                                          std::ptrdiff_t to_pitch) const {
    if (count == 2 * width) return kernels_->copy_rows(from, from_pitch, rows, to, to_pitch);
    for (std::ptrdiff_t r = 0; r < rows; ++r)
        std::copy_n(from + r * from_pitch, count, to + r * to_pitch);
}

template <class Real>
void StaggeredDerivative<Real>::stream_rows(const Real* from, std::ptrdiff_t from_pitch,
                                            std::ptrdiff_t rows, std::ptrdiff_t count, Real* to,
                                            std::ptrdiff_t to_pitch) const {
    if (count == 2 * width) return kernels_->stream_rows(from, from_pitch, rows, to, to_pitch);
    copy_rows(from, from_pitch, rows, count, to, to_pitch);
}

template <class Real>
void StaggeredDerivative<Real>::along_columns(HalfCell shift, const Real* from,
                                              std::ptrdiff_t from_pitch, Real* to,
                                              std::ptrdiff_t to_pitch, std::ptrdiff_t columns) {
    Real* block = reals(block_.data());
    for (std::ptrdiff_t c = 0; c < columns; c += 2 * width) {
        const std::ptrdiff_t count = std::min(2 * width, columns - c);
        copy_rows(from + c, from_pitch, points_, count, block, 2 * width);
        differentiate_block(shift);
        copy_rows(block, 2 * width, points_, count, to + c, to_pitch);
    }
}

template <class Real>
void StaggeredDerivative<Real>::along_rows(HalfCell shift, const Real* from, Real* to,
                                           std::ptrdiff_t pitch, std::ptrdiff_t rows) {
    for (std::ptrdiff_t r = 0; r < rows; r += 2 * width) {
        const std::ptrdiff_t pairs = (std::min(2 * width, rows - r) + 1) / 2;
        const auto first = [&](std::ptrdiff_t l) { return (r + 2 * l) * pitch; };
        const auto second = [&](std::ptrdiff_t l) { // an odd last row is paired with itself
            return (r + 2 * l + 1 < rows ? r + 2 * l + 1 : r + 2 * l) * pitch;
        };
        const auto line = [&](std::ptrdiff_t l) { return reals(lines_.data() + l * points_); };
        for (std::ptrdiff_t l = 0; l < pairs; ++l)
            kernels_->join(from + first(l), from + second(l), points_, line(l));
        Fftw::execute(lines_to_spectra_);
        multiply(shift);
        Fftw::execute(spectra_to_lines_);
        for (std::ptrdiff_t l = 0; l < pairs; ++l)
            kernels_->part(line(l), points_, to + first(l), to + second(l));
    }
}

template class StaggeredDerivative<double>;
template class StaggeredDerivative<float>;

} // namespace shearwake::fft
