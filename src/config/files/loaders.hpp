// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "config/document/reader.hpp"
#include "problem/case/study_data.hpp"
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

/// Returns the study in the file that solver.pstd.study names; throws UsageError on all ranks. The
/// same file gives the same study.
using StudyLoader = std::function<std::shared_ptr<const StudyData>(const std::string& file)>;

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
    StudyLoader load_study;
    std::shared_ptr<LensDesigns> lenses = std::make_shared<LensDesigns>();
    std::shared_ptr<JobArrays> arrays = std::make_shared<JobArrays>();
    std::shared_ptr<std::map<std::string, JobImage>> images =
        std::make_shared<std::map<std::string, JobImage>>();
};

/// What `load` returns for the file that the key names. Nothing if the key is absent, or if the
/// file cannot be read, which is then an error of the key.
template <class Loader>
auto load_named(Reader& reader, std::string_view key, const Loader& load)
    -> std::optional<decltype(load(std::string()))> {
    const auto name = reader.find_word(key);
    if (!name) return std::nullopt;
    try {
        if (load) return load(*name);
        reader.error(key, "names a file, but this job is read without access to files");
    } catch (const UsageError& problem) {
        reader.error(key, fmt::format("cannot be used: {}", problem.what()));
    }
    return std::nullopt;
}

} // namespace shearwake::config
