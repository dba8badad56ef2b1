// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/job.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/claims.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// The paths of an output folder.
struct OutputFolder {
    std::filesystem::path root;

    std::filesystem::path job() const { return root / "job.toml"; }
    std::filesystem::path plan() const { return root / "plan.json"; }
    /// The journal of a run, see journal_name().
    std::filesystem::path journal(const std::string& run, const std::string& host = "") const;
    /// The index that belongs to the journal.
    std::filesystem::path index(const std::string& run, const std::string& host = "") const;
    /// The progress of an active run; removed when it ends. A killed run leaves it.
    std::filesystem::path progress(const std::string& run) const {
        return root / ("progress." + run + ".json");
    }
    /// The runs with such a file.
    std::vector<std::string> recorded_runs() const;
    /// The files of active runs and of the cases that they compute.
    std::filesystem::path locks() const { return root / "locks"; }
    /// Runs stop if the user creates this file, and can be resumed after it has been removed.
    std::filesystem::path stop_file() const { return root / "STOP"; }
    /// Used if the usual cache cannot be written, see fall_back_to_cache().
    std::filesystem::path cache() const { return root / "cache"; }
    /// Whether the folder has been removed: from the first run on it contains a plan. Returns false
    /// if the file system reports an error. Not collective.
    bool has_lost_plan() const;
    /// The reason of the failure of a case.
    std::filesystem::path failure(const std::string& id) const {
        return root / "failed" / (id + ".txt");
    }
    /// The path to which a damaged case file is moved.
    std::filesystem::path damaged_file(const std::string& id) const {
        return root / "failed" / (id + ".damaged.h5");
    }
    std::filesystem::path cases() const { return root / "cases"; }
    std::filesystem::path tables() const { return root / "tables"; }
    /// The folder of `shearwake converge`, which is an output folder itself.
    std::filesystem::path converge() const { return root / "converge"; }
    /// The result of `shearwake converge`.
    std::filesystem::path errors() const { return converge() / "converge.json"; }
    /// The uncertainty of the columns of a measurement, in the format of errors().
    std::filesystem::path uncertainty() const { return root / "uncertainty.json"; }
    /// The folder of the cases of the knots of `shearwake optimise`, which is an output folder
    /// itself, and the folder of its forms, optima and tables.
    std::filesystem::path basis() const { return root / "basis"; }
    std::filesystem::path optimise() const { return root / "optimise"; }
    /// The cases of the optima in other tissues, an output folder itself.
    std::filesystem::path robustness() const { return root / "robustness"; }
    std::filesystem::path report() const { return root / "report"; }
    std::filesystem::path case_file(const std::string& id) const { return cases() / (id + ".h5"); }
    /// The checkpoints of a running case are this path with .A.h5 and .B.h5 appended.
    std::filesystem::path checkpoints(const std::string& id) const {
        return root / "checkpoints" / id;
    }
};

/// The folder `out`, or out/<name> if `out` is empty.
inline OutputFolder output_folder(const std::filesystem::path& out, const std::string& name) {
    return {out.empty() ? std::filesystem::path("out") / name : out};
}

/// The output folder that a user names. Throws UsageError if the path is a file, for a job file
/// with the default folder of its runs. Not collective.
OutputFolder folder_of_results(const std::filesystem::path& path);

/// What becomes of another plan of the same name in an output folder.
enum class OtherPlan { refused, replaced };

/// Creates the folder for this job, or checks an existing one; it contains locks(). A damaged
/// plan.json is rewritten if all case files belong to this job; a warning is returned in this case.
/// A plan that is replaced leaves all case files; a warning states how
/// many are not in this job. Throws UsageError if the folder contains another plan or is not
/// writable. Not collective.
std::string prepare_output(const OutputFolder& folder, const config::Job& job,
                           OtherPlan other = OtherPlan::refused);

/// Removes another plan, since another selection of cases replaces it; the cases that both have
/// remain. Throws UsageError if a run is active. Not collective.
void remove_other_plan(const OutputFolder& folder, const Plan& plan);

/// Removes what ended runs have left: their locks and progress, partial files unless a checkpoint
/// needs them, and checkpoints of complete cases. Not collective.
void remove_left_over(const OutputFolder& folder, storage::CaseClaims& claims,
                      storage::CaseIndex& index);

/// A damaged case file and the path to which it was moved.
struct SetAside {
    std::string id, reason;
    std::filesystem::path place;
};

/// Moves the damaged files of the cases to be computed, `work`, to failed/, where they can be
/// inspected. Throws UsageError (environment). Not collective.
std::vector<SetAside> set_damaged_aside(const OutputFolder& folder, const Plan& plan,
                                        const std::vector<std::size_t>& work,
                                        storage::CaseClaims& claims, storage::CaseIndex& index);

} // namespace shearwake::schedule
