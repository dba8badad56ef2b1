// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/placed_source.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::pstd {

template <class Real>
double PlacedSource<Real>::work_factor(const Slabs& slabs, const MaterialOfNode& material,
                                       const Node& node) const {
    const auto& d_m = slabs.grid.spacing_m;
    if (is_velocity(source_.field))
        return d_m[0] * d_m[1] * d_m[2] *
               density_between(slabs.grid, material, node, index_of(source_.field));
    if (source_.field != Field::szz || !material(node).empty || node[2] + 1 == slabs.nz() ||
        material({node[0], node[1], node[2] + 1}).empty)
        return 0.0;
    return -d_m[0] * d_m[1] * slabs.grid.dt_s;
}

template <class Real>
PlacedSource<Real>::PlacedSource(const Source& source, const Slabs& slabs, const SplitRuns& runs,
                                 const MaterialOfNode& material, double first_node_c_p_m_s)
    : source_(source), is_in_plane_(slabs.grid.is_plane) {
    const Grid& grid = slabs.grid;
    // As in k-Wave, stresses are scaled with dx along every axis.
    const double d_m = grid.spacing_m[is_velocity(source.field) ? index_of(source.field) : 0];
    const auto mine = static_cast<std::size_t>(
        std::ranges::count_if(source.nodes, [&](const Node& node) { return slabs.has(node[0]); }));
    which_.reserve(mine);
    places_.reserve(mine);
    for (std::size_t n = 0; n < source.nodes.size(); ++n) {
        const Node& node = source.nodes[n];
        if (!slabs.has(node[0])) continue;
        const double c_p_m_s = source.scaling == SourceScaling::kwave_of_first_node
                                   ? first_node_c_p_m_s
                                   : material(node).c_p_m_s;
        const bool scaled =
            source.mode == SourceMode::additive && source.scaling != SourceScaling::none;
        const std::ptrdiff_t row = (node[0] - slabs.x_start()) * slabs.ny() + node[1];
        which_.push_back(n);
        Place place{.total = slabs.offset(node),
                    .part = {-1, -1},
                    .has_own_part = false,
                    .scale = scaled ? 2.0 * c_p_m_s * grid.dt_s / d_m : 1.0,
                    .per_work = work_factor(slabs, material, node),
                    .before = 0.0};
        if (const SplitRun* run = runs.run_at(row, node[2])) {
            const Parts parts = parts_of(source.field);
            const auto is_stored = [&](std::size_t p) {
                return run->face < 0 || parts.axes[p] == static_cast<std::size_t>(run->face);
            };
            if (is_stored(0) || is_stored(1) || is_stored(2))
                place.part[0] = run->offset + node[2] - run->begin;
            if (is_in_plane_ && !is_velocity(source.field) && parts.count == 3 && run->face < 0 &&
                parts.axes[1] == 0)
                place.part[0] = -1; // of d/dx
            if (run->face < 0 && parts.count == 3)
                place.part[1] = run->second + node[2] - run->begin;
            place.has_own_part = run->face >= 0 && is_stored(0);
        }
        places_.push_back(place);
    }
    values_.resize(which_.size());
    source_.nodes = std::vector<Node>();
}

template <class Real>
void PlacedSource<Real>::resume(const FieldState<Real>& state) {
    for (Place& place : places_)
        place.before = static_cast<double>(state.total[static_cast<std::size_t>(place.total)]);
}

template <class Real>
void PlacedSource<Real>::apply(std::ptrdiff_t sample, FieldState<Real>& state,
                               std::span<const Real> uz, std::span<Real> leaps) {
    if (sample >= source_.samples || which_.empty()) return;
    values_of(sample);
    const Parts parts = parts_of(source_.field);
    const bool velocity = is_velocity(source_.field);
    for (std::size_t i = 0; i < places_.size(); ++i) {
        Place& place = places_[i];
        auto& total = state.total[static_cast<std::size_t>(place.total)];
        if (std::isnan(values_[i])) {
            place.before = static_cast<double>(total);
            continue;
        }
        const double value = values_[i] * place.scale, share = value / (is_in_plane_ ? 2.0 : 3.0);
        const Real was = total;
        const double into_total =
            velocity || is_in_plane_ ? value : share * static_cast<double>(parts.count);
        double others = 0.0; // sum of the other parts of a prescribed velocity
        for (std::size_t p = 0; p < place.part.size(); ++p) {
            if (place.part[p] < 0) continue;
            auto& part = state.part[p][static_cast<std::size_t>(place.part[p])];
            if (velocity && source_.mode == SourceMode::additive)
                part += static_cast<Real>(place.has_own_part ? value : 0.0);
            else if (velocity)
                others += static_cast<double>(part);
            else if (source_.mode == SourceMode::additive)
                part += static_cast<Real>(share);
            else
                part = static_cast<Real>(share);
        }
        // A prescribed velocity keeps its other parts (the stepper stores all of them there); its
        // own part is the difference.
        if (source_.mode == SourceMode::additive)
            total += static_cast<Real>(into_total);
        else
            total =
                static_cast<Real>(source_.mode == SourceMode::total ? value : others + into_total);
        if (source_.in_rates && !leaps.empty())
            leaps[static_cast<std::size_t>(place.total)] += total - was;
        // Both times the mean over the step: of the velocity, or of the stress.
        const double mean = 0.5 * (place.before + static_cast<double>(total));
        place.before = static_cast<double>(total);
        work_J_ +=
            place.per_work * mean *
            static_cast<double>(velocity ? total - was : uz[static_cast<std::size_t>(place.total)]);
    }
}

template class PlacedSource<double>;
template class PlacedSource<float>;

} // namespace shearwake::pstd
