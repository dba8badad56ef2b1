#include "engines/pstd/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace shearwake::pstd {
namespace {

constexpr std::array<const char*, field_count> names = {"ux",  "uy",  "uz",  "sxx", "syy",
                                                        "szz", "sxy", "sxz", "syz"};

/// A plane of x each, without what lies between the rows of the slab.
StateRows planes_of(const Slabs& slabs) {
    return {.total = slabs.nx(),
            .start = slabs.x_start(),
            .count = slabs.x_count(),
            .row_length = slabs.ny() * slabs.nz()};
}

/// Kept parts follow each other along x, y, z whoever has them, in whole runs: a row is what all
/// runs are multiples of. Collective.
StateRows rows_of(const SplitRuns& runs, std::size_t part, const Comm& team) {
    const std::ptrdiff_t length = SplitRuns::line;
    const double mine = static_cast<double>(runs.size(part) / length);
    const std::vector<double> counts = team.all_gather(std::span<const double>(&mine, 1));
    StateRows rows{.count = runs.size(part) / length, .row_length = length};
    for (std::size_t r = 0; r < counts.size(); ++r) {
        rows.total += std::lround(counts[r]);
        if (static_cast<int>(r) < team.rank()) rows.start += std::lround(counts[r]);
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
            const StateRows rows = rows_of(field.runs, p, team_);
            if (rows.total == 0) continue;
            values.assign(field.part[p].begin(), field.part[p].end());
            state.put(std::string(names[f]) + "_part_" + std::to_string(p), rows, values.data());
        }
    }
}

template <class Real>
void Stepper<Real>::restore(StateReader& state) {
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
            const StateRows rows = rows_of(field.runs, p, team_);
            if (rows.total == 0) continue;
            values.resize(field.part[p].size());
            state.get(std::string(names[f]) + "_part_" + std::to_string(p), rows, values.data());
            std::transform(values.begin(), values.end(), field.part[p].begin(), to_real);
        }
    }
}

template void Stepper<double>::save(StateWriter&) const;
template void Stepper<double>::restore(StateReader&);
template void Stepper<float>::save(StateWriter&) const;
template void Stepper<float>::restore(StateReader&);

} // namespace shearwake::pstd
