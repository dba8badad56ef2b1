#pragma once

#include "engines/pstd/field_state.hpp"
#include "engines/pstd/material.hpp"
#include "engines/pstd/source.hpp"

namespace shearwake::pstd {

/// A source's nodes on this rank.
template <class Real>
class PlacedSource {
public:
    PlacedSource(const Source& source, const Slabs& slabs, const FieldState<Real>& state,
                 const MaterialOfNode& material, double first_node_c_p_m_s);
    Field field() const { return source_.field; }
    /// Puts a sample in, or nothing after the last one. Not collective.
    /// `leaps`: the field's accelerations times the step, or empty.
    void apply(std::ptrdiff_t sample, FieldState<Real>& state, std::span<Real> leaps);

private:
    struct Place {
        std::ptrdiff_t total;
        std::array<std::ptrdiff_t, 2> part; // -1 where none is kept
        bool keeps_own;                     // the first array is the part of the field's own axis
        double scale;
    };
    Source source_;
    std::vector<std::size_t> which_;
    std::vector<Place> places_;
    std::vector<double> values_;
};

} // namespace shearwake::pstd
