#include "fft/staggered_derivative.hpp"

#include "fft/wisdom.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake {

template <class Real>
StaggeredDerivative<Real>::StaggeredDerivative(std::ptrdiff_t points, double spacing_m,
                                               const Comm& team)
    : points_(points), block_(static_cast<std::size_t>(points * width)), lines_(block_.size()),
      spectra_(block_.size()), forward_factor_(static_cast<std::size_t>(points)),
      back_factor_(static_cast<std::size_t>(points)) {
    const MakePlans make = [this](unsigned flags) { return plan(flags); };
    const bool single = precision_of<Real> == Precision::in_single;
    plan_measured(team, fmt::format("staggered{}-{}-{}", single ? "-single" : "", points, width),
                  make, precision_of<Real>);
    std::fill(block_.begin(), block_.end(), Complex(0)); // planning has written into them
    std::fill(lines_.begin(), lines_.end(), Complex(0));
    const double n = static_cast<double>(points);
    for (std::ptrdiff_t m = 0; m < points; ++m) {
        const auto signed_m = static_cast<double>(2 * m < points ? m : m - points);
        const double k = 2.0 * std::numbers::pi * signed_m / (n * spacing_m);
        const std::complex<double> ik(0.0, k / n); // with the 1/n of the transforms
        const auto at = static_cast<std::size_t>(m);
        const bool nyquist = 2 * m == points;
        const auto forward = ik * std::polar(1.0, 0.5 * k * spacing_m);
        // Exactly real there, or the two lines of a pair would mix by a rounding error.
        forward_factor_[at] = Complex(nyquist ? std::complex<double>(forward.real()) : forward);
        const auto back = ik * std::polar(1.0, -0.5 * k * spacing_m);
        back_factor_[at] = Complex(nyquist ? std::complex<double>(back.real()) : back);
    }
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
    const auto& factor = shift == HalfCell::forward ? forward_factor_ : back_factor_;
    const Real* f = reinterpret_cast<const Real*>(factor.data());
    for (std::ptrdiff_t l = 0; l < width; ++l) {
        Real* s = reinterpret_cast<Real*>(spectra_.data() + l * points_);
        for (std::ptrdiff_t m = 0; m < points_; ++m) {
            const Real re = s[2 * m], im = s[2 * m + 1];
            s[2 * m] = re * f[2 * m] - im * f[2 * m + 1];
            s[2 * m + 1] = re * f[2 * m + 1] + im * f[2 * m];
        }
    }
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
void StaggeredDerivative<Real>::along_columns(HalfCell shift, const Real* from,
                                              std::ptrdiff_t from_pitch, Real* to,
                                              std::ptrdiff_t to_pitch, std::ptrdiff_t columns) {
    Real* block = reinterpret_cast<Real*>(block_.data());
    for (std::ptrdiff_t c = 0; c < columns; c += 2 * width) {
        const std::ptrdiff_t count = std::min(2 * width, columns - c);
        for (std::ptrdiff_t i = 0; i < points_; ++i)
            copy_row(from + i * from_pitch + c, count, block + i * 2 * width);
        differentiate_block(shift);
        for (std::ptrdiff_t i = 0; i < points_; ++i)
            copy_row(block + i * 2 * width, count, to + i * to_pitch + c);
    }
}

template <class Real>
void StaggeredDerivative<Real>::along_rows(HalfCell shift, const Real* from, Real* to,
                                           std::ptrdiff_t pitch, std::ptrdiff_t rows) {
    for (std::ptrdiff_t r = 0; r < rows; r += 2 * width) {
        const std::ptrdiff_t pairs = (std::min(2 * width, rows - r) + 1) / 2;
        const auto second = [&](std::ptrdiff_t l) { // an odd last row is paired with itself
            return (r + 2 * l + 1 < rows ? r + 2 * l + 1 : r + 2 * l) * pitch;
        };
        for (std::ptrdiff_t l = 0; l < pairs; ++l) {
            const Real *a = from + (r + 2 * l) * pitch, *b = from + second(l);
            Real* line = reinterpret_cast<Real*>(lines_.data() + l * points_);
            for (std::ptrdiff_t i = 0; i < points_; ++i) {
                line[2 * i] = a[i];
                line[2 * i + 1] = b[i];
            }
        }
        Fftw::execute(lines_to_spectra_);
        multiply(shift);
        Fftw::execute(spectra_to_lines_);
        for (std::ptrdiff_t l = 0; l < pairs; ++l) {
            const Real* line = reinterpret_cast<const Real*>(lines_.data() + l * points_);
            Real *a = to + (r + 2 * l) * pitch, *b = to + second(l);
            for (std::ptrdiff_t i = 0; i < points_; ++i)
                a[i] = line[2 * i];
            for (std::ptrdiff_t i = 0; i < points_; ++i)
                b[i] = line[2 * i + 1];
        }
    }
}

template class StaggeredDerivative<double>;
template class StaggeredDerivative<float>;

} // namespace shearwake
