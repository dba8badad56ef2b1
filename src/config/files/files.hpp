// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/vectors.hpp"
#include "config/document/reader.hpp"
#include "problem/case/afferents.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/load/footprint.hpp"
#include "problem/medium/material_map.hpp"

#include <fmt/format.h>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// Returns the map in the file that medium.map names; throws UsageError on all ranks. The reader of
/// a job uses it, since it does not access files itself. The same file gives the same map.
using MapLoader = std::function<std::shared_ptr<const MaterialMap>(const std::string& file)>;

/// Returns the text of a file that a path names; throws UsageError on all ranks.
using TextLoader = std::function<std::string(const std::string& file)>;

/// The arrays of a job.
struct JobArrays {
    double expected_1 = 1.0; // how many different ones its sweep can have at most
    std::vector<ArrayFootprint> known;
};

/// A picture that a job names, or the reason why it was rejected.
struct JobImage {
    std::shared_ptr<const TargetImage> image;
    std::string problem;
};

/// Loaders of the files that a job names, the lenses that it has designed, its arrays, and its
/// pictures by the names of their files. Without a loader, such files are rejected.
struct FileLoaders {
    MapLoader load_map;
    TextLoader load_text;
    std::shared_ptr<LensDesigns> lenses = std::make_shared<LensDesigns>();
    std::shared_ptr<JobArrays> arrays = std::make_shared<JobArrays>();
    std::shared_ptr<std::map<std::string, JobImage>> images =
        std::make_shared<std::map<std::string, JobImage>>();
};

/// What `load` returns for the file that the key names, after a prefix. Nothing if the key is
/// absent, or if the file cannot be read, which is then an error of the key.
template <class Loader>
auto load_named(Reader& reader, std::string_view key, const Loader& load,
                const std::string& prefix = {}) -> std::optional<decltype(load(std::string()))> {
    const auto name = reader.find_word(key);
    if (!name) return std::nullopt;
    try {
        if (load) return load(prefix + *name);
        reader.error(key, "names a file, but this job is read without access to files");
    } catch (const UsageError& problem) {
        reader.error(key, fmt::format("cannot be used: {}", problem.what()));
    }
    return std::nullopt;
}

/// Reads the rows of a CSV text until `problem_of` states why one of them is rejected. Returns that
/// reason, or what is wrong with the text, with the number of the line; empty if there is none.
std::string first_problem(std::string_view csv,
                          const std::function<std::string(const CsvReader& row)>& problem_of);

/// The afferents of a CSV file, or the reason why it was rejected.
struct AfferentsFile {
    std::vector<ListedAfferent> afferents;
    std::string problem;
};

/// The first line is "x_mm,y_mm,class,row", followed by one afferent per line: the class is SA1, RA
/// or PC, and the row is the index, from 0, of one of the 4, 9 or 4 neurons of the class. Empty
/// lines and lines that begin with # are ignored. At least one afferent and at most 100 000.
AfferentsFile read_listed_afferents(std::string_view csv);

/// The points of a CSV file, or the reason why it was rejected.
struct PointsFile {
    std::vector<Vec2> points_m;
    std::vector<double> rests_s; // at each point; empty: the file states none
    std::vector<double> levels;  // at each point, 0 to 1; empty: the file states none
    std::string problem;
};

/// The first line names the columns with their unit, such as "x_mm,y_mm", followed by one point per
/// line; empty lines and lines that begin with # are ignored. At least 2 points and at most 100
/// 000, all finite and each different from the previous one. With `Columns::rests`, it may have a
/// column dwell_ms with the rest at each point, or t_ms with the time at which each rest begins,
/// from 0 on, and level; the last rest then lasts as long as the one before it, and points may be
/// equal.
enum class Columns { places, rests };
PointsFile read_points(std::string_view csv, Columns columns = Columns::places);

} // namespace shearwake::config
