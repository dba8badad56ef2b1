// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/json.hpp"
#include "config/job.hpp"
#include "engines/engine.hpp"
#include "pipeline/memory.hpp"
#include "problem/case/volume.hpp"
#include "serve/streams.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::serve {

/// A request about the first case of a job.
struct Request {
    long id = 0;
    bool describes = false; // the job, without computing
    std::string job;        // TOML
    std::vector<config::Override> overrides;
    std::optional<std::vector<std::string>> arrays; // names of those that are sent; none: all

    bool wants(const std::string& array) const {
        return !arrays || std::ranges::find(*arrays, array) != arrays->end();
    }
    bool wants_receptors() const {
        return !arrays || std::ranges::any_of(*arrays, [](const std::string& name) {
            return name.starts_with("afferents/");
        });
    }
};

/// Reads the texts to which jobs refer from this folder; null without a folder.
config::TextLoader texts_in(const std::filesystem::path& files);

/// The first case of a job, without its sweep. Throws BadJob. Not collective.
config::Job read_request(const Request& request, const std::filesystem::path& files);

/// The members of the answer `description`: times and vibrometer of the case, and the distributions
/// of [uncertain]. Throws BadJob. Not collective.
Json describe(const Request& request, const std::filesystem::path& files);

/// Limits of a request.
struct Limits {
    double memory_per_rank_B = 2e9;
    double time_s = 60.0;
    double values = 6.4e7;               // points of the surface times frames
    double receptor_operations = 3.2e10; // pipeline::receptors_work(), about a minute
};

/// The result of a request, on rank 0; empty elsewhere. The frames are valid until the next
/// request.
struct Answer {
    Json members;
    std::vector<VariableGroup> groups;
    Frames frames;
};

/// Computes cases one after the other and keeps what they can share: the engine with its transfer
/// functions and transforms, and the memory of the frames.
class Solver {
public:
    /// Not collective.
    Solver(const Limits& limits, std::filesystem::path files, const Comm& world);
    const std::filesystem::path& files() const { return files_; }
    /// Computes the first case of a job. Returns false if it was interrupted. Throws on all ranks
    /// together: BadJob for a job with errors, UsageError for one that exceeds the limits, and
    /// CaseFailure. Collective.
    bool compute(const Request& request, Interrupt& interrupt, Answer& answer);

private:
    /// The plan of the case. Throws UsageError if the case exceeds the limits. Not collective; all
    /// ranks come to the same result.
    pipeline::CasePlan suitable_plan(const Case& c, const Request& request) const;

    Limits limits_;
    std::filesystem::path files_;
    const Comm& world_;
    std::unique_ptr<engines::Engine> engine_;
    std::vector<float> frames_; // of the last request; its memory is kept
};

} // namespace shearwake::serve
