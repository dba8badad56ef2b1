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
DistributedRows rows_of(const SplitRuns& runs, std::size_t part, const Comm& team) {
    const std::ptrdiff_t length = SplitRuns::line;
    DistributedRows rows{.count = runs.size(part) / length, .row_length = length};
    const std::vector<long> counts = team.all_gather(std::vector<long>{rows.count});
    for (std::size_t r = 0; r < counts.size(); ++r) {
        rows.total += counts[r];
        if (static_cast<int>(r) < team.rank()) rows.start += counts[r];
    }
    return rows;
}

} // namespace

template <class Real>
void Stepper<Real>::save(StateWriter& state) const {
    state.put("step", static_cast<double>(steps_));
    const std::ptrdiff_t nz = slabs_.nz();
    std::vector<double> values;
    for (std::size_t f = 0; f < field_count; ++f) {
        const FieldState<Real>& field = states_[f];
        values.resize(static_cast<std::size_t>(slabs_.rows() * nz));
        for (std::ptrdiff_t row = 0; row < slabs_.rows(); ++row)
            std::copy_n(field.total.data() + row * slabs_.pitch, nz, values.data() + row * nz);
        state.put(names[f], planes_of(slabs_), values.data());
        for (std::size_t p = 0; p + 1 < parts_of(static_cast<Field>(f)).count; ++p) {
            const DistributedRows rows = rows_of(field.runs, p, team_);
            if (rows.total == 0) continue;
            values.assign(field.part[p].begin(), field.part[p].end());
            state.put(std::string(names[f]) + "_part_" + std::to_string(p), rows, values.data());
        }
    }
}

template <class Real>
void Stepper<Real>::restore(const StateReader& state) {
    steps_ = std::lround(state.get("step"));
    const std::ptrdiff_t nz = slabs_.nz();
    const auto to_real = [](double value) { return static_cast<Real>(value); };
    std::vector<double> values;
    for (std::size_t f = 0; f < field_count; ++f) {
        FieldState<Real>& field = states_[f];
        values.resize(static_cast<std::size_t>(slabs_.rows() * nz));
        state.get(names[f], planes_of(slabs_), values.data());
        for (std::ptrdiff_t row = 0; row < slabs_.rows(); ++row)
            std::transform(values.data() + row * nz, values.data() + (row + 1) * nz,
                           field.total.data() + row * slabs_.pitch, to_real);
        for (std::size_t p = 0; p + 1 < parts_of(static_cast<Field>(f)).count; ++p) {
            const DistributedRows rows = rows_of(field.runs, p, team_);
            if (rows.total == 0) continue;
            values.resize(field.part[p].size());
            state.get(std::string(names[f]) + "_part_" + std::to_string(p), rows, values.data());
            std::transform(values.begin(), values.end(), field.part[p].begin(), to_real);
        }
    }
    for (PlacedSource<Real>& source : sources_)
        source.resume(this->state(source.field()));
}

template void Stepper<double>::save(StateWriter&) const;
template void Stepper<double>::restore(const StateReader&);
template void Stepper<float>::save(StateWriter&) const;
template void Stepper<float>::restore(const StateReader&);

} // namespace shearwake::pstd
