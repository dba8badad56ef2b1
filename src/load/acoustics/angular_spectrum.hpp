// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace shearwake {

/// Sound of one frequency in air.
struct Sound {
    double wavenumber_rad_m = 0.0;
    double attenuation_Np_m = 0.0; // of the pressure
};

/// Propagation between two parallel planes of side x side points, which represent a part of an
/// infinite plane.
struct PlanePair {
    std::ptrdiff_t side = 0;
    double spacing_m = 0.0;
    double distance_m = 0.0;
    /// Largest lateral offset between a source and a point of interest. Waves that travel further
    /// sideways are faded out, since they would return through the periodic edges: with cos^2 from
    /// `offset_m` to side * spacing - offset_m.
    double offset_m = 0.0;
};

/// Propagates the complex pressure e^{-i w t} of a plane by its angular spectrum: each plane wave
/// is multiplied by e^{i kz z}, with kz^2 = (k + i a)^2 - kx^2 - ky^2. Not collective.
class AngularSpectrum {
public:
    AngularSpectrum(const Sound& sound, const PlanePair& planes);
    ~AngularSpectrum();
    AngularSpectrum(AngularSpectrum&&) noexcept;
    AngularSpectrum& operator=(AngularSpectrum&&) noexcept;

    /// The pressure on the other plane, in place; y fastest.
    void forward(std::span<std::complex<double>> pressure);
    /// The adjoint of `forward`: propagation back, without amplification of what was absorbed.
    void adjoint(std::span<std::complex<double>> pressure);

private:
    struct Transforms;
    enum class Way { there, back };
    void apply(std::span<std::complex<double>> pressure, Way way);

    std::ptrdiff_t side_;
    std::unique_ptr<Transforms> transforms_;
    std::vector<std::complex<double>> factors_; // (kx, ky), symmetric
};

/// The band-limited samples on a lattice that is `factor` times as fine. Not collective.
std::vector<std::complex<double>> refined(std::span<const std::complex<double>> samples,
                                          std::ptrdiff_t side, std::ptrdiff_t factor);

} // namespace shearwake
