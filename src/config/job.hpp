#pragma once

#include "base/error.hpp"
#include "config/finding.hpp"
#include "config/override.hpp"
#include "config/text_loader.hpp"
#include "model/plan.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// A job file, read and expanded.
struct Job {
    std::string text; // verbatim
    Plan plan;
    std::vector<Finding> findings; // warnings
};

/// A job with mistakes. `what` is all findings, one a line.
class BadJob : public UsageError {
public:
    explicit BadJob(std::vector<Finding> findings);
    const std::vector<Finding>& findings() const { return findings_; }

private:
    std::vector<Finding> findings_;
};

/// Reads, expands and checks. Throws BadJob with every mistake (and the warnings) at once. Touches
/// no files: `file_name` is for messages, maps, paths and studies come from the loaders;
/// without them a job that names one is bad. Collective if they are; the same text and files give
/// the same job.
Job read_job(std::string_view text, const std::string& file_name,
             std::span<const Override> overrides = {}, const MapLoader& load_map = nullptr,
             const TextLoader& load_text = nullptr, const StudyLoader& load_study = nullptr);

} // namespace shearwake
