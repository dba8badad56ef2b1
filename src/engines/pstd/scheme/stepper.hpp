// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/pstd/kernels/update.hpp"
#include "engines/pstd/scheme/field_state.hpp"
#include "engines/pstd/scheme/material.hpp"
#include "engines/pstd/scheme/placed_source.hpp"
#include "engines/pstd/scheme/source.hpp"
#include "engines/pstd/scheme/split_axis.hpp"
#include "fft/staggered_derivative.hpp"
#include "parallel/comm.hpp"

#include <optional>

namespace shearwake::pstd {

enum class Absorption { none, kelvin_voigt };

struct Setup {
    Grid grid;
    PmlOptions pml;
    MaterialOfNode material; // asked on every rank for its nodes and the next plane of them
    Absorption absorption = Absorption::none;
    std::vector<Source> sources; // put in in this order
    /// In place of the averages of the material of the nodes.
    std::optional<StaggeredMaterial> staggered = std::nullopt;
};

/// The staggered-grid pseudospectral velocity-stress scheme with split-field multi-axial PML that
/// the k-Wave toolbox calls pstdElastic3D. From rest, each step: velocities from the gradients of
/// the stresses, velocity sources, stresses from the gradients of the velocities (Kelvin-Voigt:
/// and of the accelerations that the old stresses made), stress sources. After step n velocities
/// belong to (n - 1/2) dt and stresses to n dt.
///
/// Work goes plane by plane of x: derivatives along y and z and the update of a plane stay in the
/// cache; those along x come from SplitAxis before.
template <class Real>
class Stepper {
public:
    /// Collective.
    Stepper(const Setup& setup, const Comm& team);

    void step();                                    // collective
    std::ptrdiff_t steps() const { return steps_; } // done so far
    const Slabs& slabs() const { return slabs_; }
    /// This rank's slab of totals: [x][y][z], rows `slabs().pitch` apart.
    std::span<const Real> total(Field field) const { return state(field).total; }

    /// This rank's part of the kinetic energy of the medium, of the elastic energy (deviatoric
    /// stresses of fluids, which never change, are omitted), and of the work of the sources. Empty
    /// nodes do not contribute. Not collective.
    double kinetic_J() const;
    double elastic_J() const;
    double work_J() const;

    /// Totals, kept parts and the count of steps ("step"), for a stepper of the same setup on any
    /// number of ranks; the work of the sources is not saved. Names: "step", "ux", "ux_part_0" and
    /// the like. Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

private:
    FieldState<Real>& state(Field field) { return states_[index_of(field)]; }
    const FieldState<Real>& state(Field field) const { return states_[index_of(field)]; }
    void make_coefficients(const Setup& setup, const MaterialOfNode& material);
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
    Slabs slabs_;
    Comm team_;
    Absorption absorption_;
    std::ptrdiff_t steps_ = 0;
    std::vector<FieldState<Real>> states_;
    std::array<fft::AlignedVector<Real>, 3> acceleration_; // times dt; Kelvin-Voigt
    // dt/rho at ux, uy, uz; dt lambda, dt (lambda + 2 mu) at the nodes; dt mu at sxy, sxz, syz; chi
    // and chi + 2 eta at the nodes; eta at sxy, sxz, syz.
    std::array<Coefficient<Real>, 3> dt_over_rho_, dt_mu_, eta_;
    Coefficient<Real> dt_lambda_, dt_p_modulus_, chi_, chi_2eta_;
    SplitAxis<Real> split_axis_;
    fft::StaggeredDerivative<Real> derivative_y_, derivative_z_;
    fft::AlignedVector<Real> scratch_; // planes of derivatives
    std::vector<PlacedSource<Real>> sources_;
    std::ptrdiff_t top_ = 0; // the highest plane of z with nodes that are not empty
};

} // namespace shearwake::pstd
