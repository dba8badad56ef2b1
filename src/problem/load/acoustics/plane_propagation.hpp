// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace shearwake {

/// Absorption of sound in air by ISO 9613-1 [dB/m] at this frequency, absolute temperature and
/// relative humidity (0 to 1), at 101.325 kPa.
double air_absorption_dB_m(double frequency_Hz, double temperature_K, double humidity);

/// Sound of one frequency in air.
struct Sound {
    double wavenumber_rad_m = 0.0;
    double attenuation_Np_m = 0.0; // of the pressure
};

/// Two parallel planes with the same square lattice of side x side points.
struct PlanePair {
    std::ptrdiff_t side = 0;
    double spacing_m = 0.0; // at most a quarter of the wavelength and half the distance
    double distance_m = 0.0;
};

/// The pressure e^{-i w t} of square cells of uniform pressure, at the points of another plane: the
/// Rayleigh-Sommerfeld integral of the first kind, (1 / 2 pi) integral of p z / r^2 (1 / r - i k)
/// e^{i k r}, over each cell. The sum over the cells is a periodic convolution by FFT. It is that
/// of the open plane where the offset between a cell and a point is at most half a side along each
/// axis. Not collective.
class PlanePropagation {
public:
    PlanePropagation(const Sound& sound, const PlanePair& planes);
    ~PlanePropagation();
    PlanePropagation(PlanePropagation&&) noexcept;
    PlanePropagation& operator=(PlanePropagation&&) noexcept;

    /// The pressure on the other plane, in place; y fastest.
    void forward(std::span<std::complex<double>> pressure);
    /// The adjoint of `forward`: propagation back, without amplification of what was absorbed.
    void adjoint(std::span<std::complex<double>> pressure);

private:
    struct Transforms;
    enum class Direction { forward, backward };
    void apply(std::span<std::complex<double>> pressure, Direction direction);

    std::ptrdiff_t side_;
    std::unique_ptr<Transforms> transforms_;
    std::vector<std::complex<double>> factors_; // (kx, ky), symmetric
};

/// The band-limited samples on a lattice that is `factor` times as fine. Not collective.
std::vector<double> refined(std::span<const double> samples, std::ptrdiff_t side,
                            std::ptrdiff_t factor);

} // namespace shearwake
