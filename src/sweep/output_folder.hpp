#pragma once

#include "config/job.hpp"
#include "io/case_index.hpp"
#include "io/run_lock.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// The places of one sweep: see ARCHITECTURE, Files.
struct OutputFolder {
    std::filesystem::path root;

    std::filesystem::path job() const { return root / "job.toml"; }
    std::filesystem::path plan() const { return root / "plan.json"; }
    /// Of a part of the sweep, on a further host: see journal_name().
    std::filesystem::path journal(const std::string& part = "", const std::string& host = "") const;
    /// Beside the journal of the same part and host.
    std::filesystem::path index(const std::string& part = "", const std::string& host = "") const;
    /// Held by every run, and by a run of a part beside it.
    std::filesystem::path run_lock() const { return root / "locks" / "run"; }
    std::filesystem::path part_lock(const std::string& part) const { return root / "locks" / part; }
    std::filesystem::path claims() const { return root / "locks" / "cases"; }
    /// A user who makes this file stops the runs; they start again when it is gone.
    std::filesystem::path stop_file() const { return root / "STOP"; }
    /// Whether somebody has removed it: there is a plan from the first run on. A file system that
    /// cannot say has lost nothing. Not collective.
    bool has_lost_plan() const;
    /// What is kept of a case that failed.
    std::filesystem::path failure(const std::string& id) const {
        return root / "failed" / (id + ".txt");
    }
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

/// Removes what a killed run has left half-written of the cases to be computed, `work` (places in
/// the plan), but not what a state of this program goes with, nor what another run is at work on,
/// and the states of cases that are whole. Not collective.
void clear_half_written(const OutputFolder& folder, const Plan& plan,
                        const std::vector<std::size_t>& work, CaseIndex& index,
                        RunLock::Sharing beside);

} // namespace shearwake
