// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/read_csv.hpp"

#include <cstddef>
#include <vector>

namespace shearwake::reduce {

struct RowPair {
    std::size_t now = 0, reference = 0;
};

/// The correspondence between the rows of two tables.
struct Matched {
    std::vector<RowPair> pairs;       // in the order of the reference
    std::vector<std::size_t> extra;   // rows that only `now` has
    std::vector<std::size_t> missing; // rows that only `reference` has
    std::size_t by_settings = 0;      // pairs whose ids differ
};

/// The swept columns: those directly after `id` and `reference` whose names contain a dot.
std::vector<std::size_t> swept_columns(const TextTable& table);

/// Matches rows by id, and the remaining ones by the values of the swept keys that both tables
/// have, if these values are unique in both tables.
Matched match_rows(const TextTable& now, const TextTable& reference);

/// "load.peak_Pa=200, load.modulation.speed_m_s=7", "the reference", or otherwise the id.
std::string row_name(const TextTable& table, std::size_t row);

} // namespace shearwake::reduce
