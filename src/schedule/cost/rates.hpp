// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::cost {

/// On what an estimated time is based, from the best to the worst.
enum class Origin {
    measured, // a case with parts of the same kind, size and number of ranks
    probed,   // a few steps of such a case
    similar,  // measurements of other sizes, numbers of ranks or bodies
    unknown,
};

/// The measured rate of a kind of work at one size on teams of one size.
struct Rate {
    std::string kind;
    double size = 0.0;   // Work::size
    int ranks = 1;       // of the team
    double core_s = 0.0; // seconds times ranks per unit
    bool is_probed = false;
    bool operator==(const Rate&) const = default;
};

/// What the machine has measured. It contains one rate per kind, size (within a factor of 1.2) and
/// number of ranks, the newest last.
class Rates {
public:
    /// Adds the rate of a part that a team has computed. The mean with the previous rate, unless
    /// one of them was probed: a rate of a complete case replaces it and is not replaced by it.
    void add(const engines::TimedWork& part, int ranks, bool is_probed);
    void add(Rate rate);

    struct Found {
        double core_s = 0.0;
        Origin origin = Origin::unknown;
    };
    /// The rate of the part: of the same kind, at the nearest size and number of ranks. Without
    /// any, that of the same kind with other bodies. Without any, an arbitrary one, with which
    /// times are only relative.
    Found of(const engines::Work& part, int ranks) const;

    const std::vector<Rate>& all() const { return all_; }

private:
    std::vector<Rate> all_;
};

/// rates-<processor>-<instruction set>-<ranks>.json in the cache folder, see cache_file(); nothing
/// without a cache. `ranks`: of the run, whose teams share the memory bandwidth.
std::optional<std::filesystem::path> rates_file(int ranks);

/// Returns no rates if the file is absent, damaged, or was written for another processor or by
/// another version of this program.
Rates read_rates(const std::filesystem::path& file);
/// Adds these rates to the file. The file is replaced atomically. Returns whether this succeeded.
bool save_rates(const Rates& rates, const std::filesystem::path& file);

/// The same rates on all ranks: those of rank 0. Collective.
Rates rates_of_root(const Rates& rates, const Comm& world);

/// Rank 0 reads the rates for `ranks` ranks or, if there are none, those for the ranks of `world`.
/// Collective.
Rates known_rates(int ranks, const Comm& world);

} // namespace shearwake::cost
