// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/kernels/update.hpp"
#include "engines/pstd/scheme/coefficients.hpp"
#include "engines/pstd/scheme/field_state.hpp"
#include "engines/pstd/scheme/placed_source.hpp"
#include "engines/pstd/scheme/scheme.hpp"
#include "engines/pstd/scheme/split_axis.hpp"
#include "fft/staggered_derivative.hpp"
#include "parallel/comm.hpp"

#include <optional>

namespace shearwake::pstd {

/// The staggered-grid pseudospectral velocity-stress scheme with split-field multi-axial PML that
/// the k-Wave toolbox calls pstdElastic3D. From rest, each step: velocities from the gradients of
/// the stresses, velocity sources, stresses from the gradients of the velocities (Kelvin-Voigt:
/// and of the accelerations that the old stresses made), stress sources. After step n velocities
/// belong to (n - 1/2) dt and stresses to n dt.
///
/// Work goes plane by plane of x: derivatives along y and z and the update of a plane stay in the
/// cache; those along x come from SplitAxis before.
template <class Real>
class Stepper : public Scheme {
public:
    /// Collective.
    Stepper(const Setup& setup, const Comm& team);

    void step() override;
    /// This rank's slab of totals: [x][y][z], rows `slabs().pitch` apart.
    std::span<const Real> total(Field field) const { return state(field).total; }
    std::vector<double> dense(const Quantity& quantity) const override;
    std::unique_ptr<Tally> tally(const Tally::Of& tally) const override;
    std::unique_ptr<Sensor> sensor(const SensorNodes& nodes) const override;

    double kinetic_J() const override;
    /// Without the deviatoric stresses of fluids, which never change. Not collective.
    double elastic_J() const;
    double work_J() const override;

    void save(StateWriter& state) const override;
    void restore(const StateReader& state) override;

private:
    FieldState<Real>& state(Field field) { return states_[index_of(field)]; }
    const FieldState<Real>& state(Field field) const { return states_[index_of(field)]; }
    double volume_m3() const {
        const auto& d_m = slabs_.grid.spacing_m;
        return d_m[0] * d_m[1] * d_m[2];
    }
    void derive_velocities(std::ptrdiff_t x);
    enum class SourcesOf { velocities, stresses };
    void put_in_sources(SourcesOf fields);
    void along_y(fft::HalfCell shift, const Real* plane, std::size_t to);
    void along_z(fft::HalfCell shift, const Real* plane, std::size_t to);
    Real* scratch(std::size_t number) {
        return scratch_.data() + static_cast<std::ptrdiff_t>(number) * slabs_.ny() * slabs_.pitch;
    }
    void velocity_plane(std::ptrdiff_t x);
    void stress_plane(std::ptrdiff_t x);

    const UpdateKernels<Real>* kernels_;
    Comm team_;
    Absorption absorption_;
    std::vector<FieldState<Real>> states_;
    std::array<fft::AlignedVector<Real>, 3> acceleration_; // times dt; Kelvin-Voigt
    std::optional<Coefficients<Real>> coefficients_;
    SplitAxis<Real> split_axis_;
    fft::StaggeredDerivative<Real> derivative_y_, derivative_z_;
    fft::AlignedVector<Real> scratch_; // planes of derivatives
    std::vector<PlacedSource<Real>> sources_;
    std::ptrdiff_t top_ = 0; // the highest plane of z with nodes that are not empty
};

} // namespace shearwake::pstd
