#pragma once

#include "config/job.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// The places of one sweep: see ARCHITECTURE, Files.
struct OutputFolder {
    std::filesystem::path root;

    std::filesystem::path job() const { return root / "job.toml"; }
    std::filesystem::path plan() const { return root / "plan.json"; }
    std::filesystem::path journal() const { return root / "journal.jsonl"; }
    std::filesystem::path cases() const { return root / "cases"; }
    std::filesystem::path tables() const { return root / "tables"; }
    std::filesystem::path report() const { return root / "report"; }
    std::filesystem::path case_file(const std::string& id) const { return cases() / (id + ".h5"); }
};

/// Makes the folder for this job, or finds it again. Throws UsageError when it holds another plan,
/// or cannot be written. Not collective.
void prepare_output(const OutputFolder& folder, const Job& job);

/// Removes what a killed run has left half-written of these cases; other runs may be at work on the
/// others. Not collective.
void clear_half_written(const OutputFolder& folder, const std::vector<std::string>& ids);

} // namespace shearwake
