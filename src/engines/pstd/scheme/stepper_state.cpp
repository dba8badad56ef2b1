// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace shearwake::pstd {
namespace {

constexpr std::array<const char*, field_count> names = {"ux",  "uy",  "uz",  "sxx", "syy",
                                                        "szz", "sxy", "sxz", "syz"};

/// One row per plane of x, without the padding between the rows of the slab.
DistributedRows planes_of(const Slabs& slabs) {
    return {.total = slabs.nx(),
            .start = slabs.x_start(),
            .count = slabs.x_count(),
            .row_length = slabs.ny() * slabs.nz()};
}

/// Stored parts are ordered along x, y, z independent of the distribution, in complete runs. A row
/// has the size of which all runs are multiples. Collective.
DistributedRows rows_of(std::size_t values, const Comm& team) {
    const std::ptrdiff_t length = SplitRuns::line;
    DistributedRows rows{.count = static_cast<std::ptrdiff_t>(values) / length,
                         .row_length = length};
    const std::vector<long> counts = team.all_gather(std::vector<long>{rows.count});
    for (std::size_t r = 0; r < counts.size(); ++r) {
        rows.total += counts[r];
        if (static_cast<int>(r) < team.rank()) rows.start += counts[r];
    }
    return rows;
}

std::string name_of_part(std::size_t field, std::size_t part) {
    return std::string(names[field]) + "_part_" + std::to_string(part);
}

} // namespace

template <class Real>
void save_field(StateWriter& state, Field field, const Slabs& slabs, const Comm& team,
                std::span<const Real> total, const std::array<std::span<const Real>, 2>& parts) {
    const std::ptrdiff_t nz = slabs.nz();
    std::vector<double> values(static_cast<std::size_t>(slabs.rows() * nz));
    for (std::ptrdiff_t row = 0; row < slabs.rows(); ++row)
        std::copy_n(total.data() + row * slabs.pitch, nz, values.data() + row * nz);
    state.put(names[index_of(field)], planes_of(slabs), values.data());
    for (std::size_t p = 0; p + 1 < parts_of(field).count; ++p) {
        const DistributedRows rows = rows_of(parts[p].size(), team);
        if (rows.total == 0) continue;
        values.assign(parts[p].begin(), parts[p].end());
        state.put(name_of_part(index_of(field), p), rows, values.data());
    }
}

template <class Real>
void restore_field(const StateReader& state, Field field, const Slabs& slabs, const Comm& team,
                   std::span<Real> total, const std::array<std::span<Real>, 2>& parts) {
    const std::ptrdiff_t nz = slabs.nz();
    const auto to_real = [](double value) { return static_cast<Real>(value); };
    std::vector<double> values(static_cast<std::size_t>(slabs.rows() * nz));
    state.get(names[index_of(field)], planes_of(slabs), values.data());
    for (std::ptrdiff_t row = 0; row < slabs.rows(); ++row)
        std::transform(values.data() + row * nz, values.data() + (row + 1) * nz,
                       total.data() + row * slabs.pitch, to_real);
    for (std::size_t p = 0; p + 1 < parts_of(field).count; ++p) {
        const DistributedRows rows = rows_of(parts[p].size(), team);
        if (rows.total == 0) continue;
        values.resize(parts[p].size());
        state.get(name_of_part(index_of(field), p), rows, values.data());
        std::transform(values.begin(), values.end(), parts[p].begin(), to_real);
    }
}

template <class Real>
void Stepper<Real>::save(StateWriter& state) const {
    state.put("step", static_cast<double>(steps_));
    for (std::size_t f = 0; f < field_count; ++f)
        save_field<Real>(state, static_cast<Field>(f), slabs_, team_, states_[f].total,
                         {states_[f].part[0], states_[f].part[1]});
}

template <class Real>
void Stepper<Real>::restore(const StateReader& state) {
    steps_ = std::lround(state.get("step"));
    for (std::size_t f = 0; f < field_count; ++f)
        restore_field<Real>(state, static_cast<Field>(f), slabs_, team_, states_[f].total,
                            {states_[f].part[0], states_[f].part[1]});
    for (PlacedSource<Real>& source : sources_)
        source.resume(this->state(source.field()));
}

template void save_field(StateWriter&, Field, const Slabs&, const Comm&, std::span<const double>,
                         const std::array<std::span<const double>, 2>&);
template void save_field(StateWriter&, Field, const Slabs&, const Comm&, std::span<const float>,
                         const std::array<std::span<const float>, 2>&);
template void restore_field(const StateReader&, Field, const Slabs&, const Comm&, std::span<double>,
                            const std::array<std::span<double>, 2>&);
template void restore_field(const StateReader&, Field, const Slabs&, const Comm&, std::span<float>,
                            const std::array<std::span<float>, 2>&);
template void Stepper<double>::save(StateWriter&) const;
template void Stepper<double>::restore(const StateReader&);
template void Stepper<float>::save(StateWriter&) const;
template void Stepper<float>::restore(const StateReader&);

} // namespace shearwake::pstd
