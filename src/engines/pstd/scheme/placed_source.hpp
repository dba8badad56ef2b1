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
    PlacedSource(const Source& source, const Slabs& slabs, const FieldState<Real>& state,
                 const MaterialOfNode& material, double first_node_c_p_m_s);
    Field field() const { return source_.field; }
    /// Applies a sample, or nothing after the last one. `leaps` are the accelerations of the field
    /// times the time step, or empty.
    void apply(std::ptrdiff_t sample, FieldState<Real>& state, std::span<Real> leaps);

private:
    struct Place {
        std::ptrdiff_t total;
        std::array<std::ptrdiff_t, 2> part; // -1 for a part that is not stored
        bool keeps_own;                     // the first array is the part of the field's own axis
        double scale;
    };
    Source source_;
    std::vector<std::size_t> which_;
    std::vector<Place> places_;
    std::vector<double> values_;
};

} // namespace shearwake::pstd
