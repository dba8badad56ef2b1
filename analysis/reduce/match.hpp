#pragma once

#include "reduce/read_csv.hpp"

#include <cstddef>
#include <vector>

namespace shearwake {

struct RowPair {
    std::size_t now = 0, reference = 0;
};

/// Which row of one table is which of another.
struct Matched {
    std::vector<RowPair> pairs;       // in the order of the reference
    std::vector<std::size_t> extra;   // rows of `now` alone
    std::vector<std::size_t> missing; // rows of `reference` alone
    std::size_t by_settings = 0;      // pairs whose ids differ
};

/// The swept columns: those right behind `id` and `reference` whose names have a dot.
std::vector<std::size_t> swept_columns(const TextTable& table);

/// By id; where that finds none, by the values of the swept keys that both tables have, if they are
/// the only ones of these values on either side.
Matched match_rows(const TextTable& now, const TextTable& reference);

/// "load.peak_Pa=200, load.modulation.speed_m_s=7", "the reference", else the id.
std::string row_name(const TextTable& table, std::size_t row);

} // namespace shearwake
