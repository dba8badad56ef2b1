// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "config/job.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"
#include "studies/optimise/study.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The command `optimise`: computes the best envelope of each case of a job with [optimise], an
/// upper bound with its certificate, and the cases of the result. Arguments of `run`, of which
/// `out` is the folder of the optima (default: out/<job name>.optimise). Collective.
ExitCode optimise_job(const schedule::RunArguments& arguments, const Comm& world);

/// The files of a study, in the folder `optimise`.
struct StudyFiles {
    std::filesystem::path root;
    std::filesystem::path identity() const { return root / "study.txt"; }
    std::filesystem::path forms(const std::string& id) const { return root / (id + ".forms.json"); }
    /// Without extension.
    std::filesystem::path stem(const OptimisedCase& c, double strength) const;
    std::filesystem::path optimum(const OptimisedCase& c, double strength) const {
        return stem(c, strength).string() + ".json";
    }
};

/// A study: its job, options and folders, the same on every rank.
struct Study {
    config::Job job;
    OptimiseOptions options;
    std::vector<OptimisedCase> cases;
    schedule::OutputFolder folder;
    StudyFiles files;
    schedule::RunArguments run; // of the cases; `out` is not used

    schedule::OutputFolder basis() const { return schedule::OutputFolder{folder.basis()}; }
};

/// Runs the cases of a plan in this folder. A plan of the folder with other cases is replaced, and
/// the cases that both have remain. Collective.
ExitCode run_plan(const Study& study, const Plan& plan, const schedule::OutputFolder& folder,
                  const Comm& world);

/// Computes the forms of these cases that are not known, and all cases with which the optima are
/// compared. Collective.
ExitCode compute_forms(const Study& study, const std::vector<MovedCase>& cases, const Comm& world);

/// The forms of a case that are known. Their strength refers to the motion of the job. Not
/// collective.
Forms known_forms(const Study& study, const MovedCase& c);

/// Searches for the best SM-STM of each case and strength, and adds the SM-STM that it computes to
/// the cases of the study. Collective.
ExitCode search_sm(Study& study, const Comm& world);

/// The best motion for each case and strength, [case][strength]. Computes forms; the code is that
/// of the last run. Collective.
ExitCode find_motions(const Study& study, std::vector<std::vector<MotionChange>>& best,
                      const Comm& world);

/// The maximised measure and the focal rms of a computed case; NaN: none.
struct Reading {
    double eta = 0.0, focal_rms_um = 0.0;
    bool is_valid = true; // false: a stored warning rules the readings out
};
/// By id.
using Readings = std::map<std::string, Reading>;
Readings readings_of(const schedule::OutputFolder& folder, const std::string& maximised);

/// The best SM-STM of each case and strength by the results of the basis, on every rank:
/// [case][strength]. Collective.
std::vector<std::vector<BestSm>> agreed_sm(const Study& study, const Comm& world);

/// A job file whose only case has the motion of an optimum and this envelope: the job of the study
/// with its overrides and the swept values of the case, without [sweep], [table], [uncertain] and
/// [optimise]. Not collective.
std::string job_of_optimum(const Study& study, const OptimisedCase& of, const MovedCase& moved,
                           const SampledGain& envelope);

/// Writes the table of the study as CSV and Markdown and the exported waveforms to the folder
/// `optimise`, and returns the Markdown. Throws UsageError (environment). Not collective.
std::string write_optima(const Study& study, const Optima& results, const Readings& basis);

/// Writes the table of the optima in other tissues and at other speeds in the same way.
std::string write_robustness(const Study& study, const Optima& results,
                             const std::vector<RobustCase>& cases);

} // namespace shearwake::optimise
