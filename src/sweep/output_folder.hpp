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
    /// The states of a case at work: this with .A.h5 and .B.h5.
    std::filesystem::path checkpoints(const std::string& id) const {
        return root / "checkpoints" / id;
    }
};

/// Makes the folder for this job, or finds it again. Throws UsageError when it holds another plan,
/// or cannot be written. Not collective.
void prepare_output(const OutputFolder& folder, const Job& job);

/// Removes what a killed run has left half-written of the cases to be computed, `ids`, but not what
/// a state of this program goes with, and the states of cases that are whole. Other runs may be at
/// work on the other cases. Not collective.
void clear_half_written(const OutputFolder& folder, const Plan& plan,
                        const std::vector<std::string>& ids);

} // namespace shearwake
