#include "fft/line_transform.hpp"

#include "fft/aligned.hpp"
#include "fft/wisdom.hpp"

namespace shearwake {

// FFTW_ESTIMATE throughout: a plan that depends on nothing but the length, so that the same job
// gives the same bits every time. Measured plans are no faster here for lengths of 2^a 3^b 5^c 7^d.
LineTransform::LineTransform(std::ptrdiff_t length, Direction direction) : length_(length) {
    AlignedVector<std::complex<double>> scratch(static_cast<std::size_t>(length));
    auto* data = reinterpret_cast<fftw_complex*>(scratch.data());
    const int sign = direction == Direction::forward ? FFTW_FORWARD : FFTW_BACKWARD;
    plan_estimated([&](unsigned flags) {
        plan_.reset(fftw_plan_dft_1d(static_cast<int>(length), data, data, sign, flags));
        return plan_ != nullptr;
    });
}

void LineTransform::execute(std::complex<double>* line) const {
    auto* data = reinterpret_cast<fftw_complex*>(line);
    fftw_execute_dft(plan_.get(), data, data);
}

std::string fftw_library_version() {
    return fftw_version;
}

} // namespace shearwake
