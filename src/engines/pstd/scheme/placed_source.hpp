// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/field_state.hpp"
#include "engines/pstd/scheme/material.hpp"
#include "engines/pstd/scheme/source.hpp"

namespace shearwake::pstd {

/// The nodes of a source that belong to this rank. Not collective.
template <class Real>
class PlacedSource {
public:
    PlacedSource(const Source& source, const Slabs& slabs, const SplitRuns& runs,
                 const MaterialOfNode& material, double first_node_c_p_m_s);
    Field field() const { return source_.field; }
    /// Applies a sample, or nothing after the last one. `uz` is the total of that velocity; `leaps`
    /// are the accelerations of the field times the time step, or empty.
    void apply(std::ptrdiff_t sample, FieldState<Real>& state, std::span<const Real> uz,
               std::span<Real> leaps);
    /// Continues from a field that was restored.
    void resume(const FieldState<Real>& state);

    /// Work so far at the nodes of this rank: m v dv for a velocity, exact for the energy that the
    /// scheme preserves; -s_zz u_z dA dt for a stress s_zz in the empty nodes next to a medium
    /// below them, an estimate, because the Fourier derivative distributes the force over several
    /// planes.
    double work_J() const { return work_J_; }

    struct Place {
        std::ptrdiff_t total;
        std::array<std::ptrdiff_t, 2> part; // -1 for a part that is not stored
        bool has_own_part;                  // the first array is the part of the field's own axis
        double scale;
        double per_work; // mass in kg for a velocity, -dA dt for the stress above a medium, or 0
        double before;   // total after the previous sample
    };
    const std::vector<Place>& places() const { return places_; }
    const Source& source() const { return source_; } // without its nodes
    /// The unscaled values of a sample at these places.
    std::span<const double> values_of(std::ptrdiff_t sample) {
        source_.values(sample, which_, values_);
        return values_;
    }

private:
    double work_factor(const Slabs& slabs, const MaterialOfNode& material, const Node& node) const;
    Source source_; // without its nodes
    bool is_in_plane_;
    std::vector<std::size_t> which_;
    std::vector<Place> places_;
    std::vector<double> values_;
    double work_J_ = 0.0;

public:
    /// Memory of a node of this rank.
    static constexpr double node_B = sizeof(std::size_t) + sizeof(Place) + sizeof(double);
};

} // namespace shearwake::pstd
