// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/optimise_study.hpp"

#include "parallel/agree.hpp"
#include "schedule/run/run.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"
#include "storage/journal/claims.hpp"
#include "studies/optimise/search/search.hpp"
#include "studies/optimise/study.hpp"

#include <fmt/format.h>
#include <set>

namespace shearwake::optimise {
namespace {

namespace fs = std::filesystem;

constexpr double most_of_knots_B = 2.5e9; // on the disk at the same time

/// Removes a plan with other cases. Not collective.
void prepare_plan(const schedule::OutputFolder& folder, const Plan& plan) {
    storage::make_directory(folder.locks());
    const storage::FolderLock lock(folder.locks(), std::chrono::minutes(1));
    if (fs::exists(folder.plan()) && storage::compare_plan(storage::read_file(folder.plan()),
                                                           plan) != storage::PlanMatch::same) {
        storage::require_no_run(folder.locks());
        fs::remove(folder.plan());
    }
}

/// The files of the knots of a case are no longer needed when its forms are known.
void write_forms(const Study& study, const MovedCase& c) {
    std::vector<fs::path> knots;
    for (std::ptrdiff_t knot = 0; knot < c.knots.count; ++knot)
        knots.push_back(study.basis().case_file(case_id(knot_case(c.physics, c.knots, knot))));
    const Quotient quotient = find_quotient(c.physics, study.options.maximise).value();
    storage::write_file(
        study.files.forms(c.id),
        forms_text(c.id, c.knots,
                   gram_forms(c.physics, quotient, study.options.uniformity > 0.0, knots)));
    for (const fs::path& knot : knots)
        fs::remove(knot);
}

/// The cases in groups whose knots need a limited space on the disk. At least one group: without
/// cases, only those with which the optima are compared are computed.
std::vector<std::vector<MovedCase>> batches_of(const std::vector<MovedCase>& cases) {
    std::vector<std::vector<MovedCase>> batches(1);
    double used_B = 0.0;
    for (const MovedCase& c : cases) {
        const double needed_B = 8.0 * static_cast<double>(c.physics.domain.nx) *
                                static_cast<double>(c.physics.domain.ny) *
                                static_cast<double>(c.physics.time.frames) *
                                static_cast<double>(c.knots.count);
        if (!batches.back().empty() && used_B + needed_B > most_of_knots_B) {
            batches.emplace_back();
            used_B = 0.0;
        }
        batches.back().push_back(c);
        used_B += needed_B;
    }
    return batches;
}

} // namespace

fs::path StudyFiles::stem(const OptimisedCase& c, double strength) const {
    return root / fmt::format("{}.strength-{:g}", c.base.id, strength);
}

ExitCode run_plan(const Study& study, const Plan& plan, const schedule::OutputFolder& folder,
                  const Comm& world) {
    on_root(world, [&] { prepare_plan(folder, plan); });
    config::Job job = study.job;
    job.plan = plan;
    job.diagnostics.clear(); // `run` reports them
    schedule::RunArguments run = study.run;
    run.out = folder.root;
    return schedule::run_job(job, run, world);
}

ExitCode compute_forms(const Study& study, const std::vector<MovedCase>& cases, const Comm& world) {
    std::vector<int> known(cases.size(), 0);
    on_root(world, [&] {
        std::set<std::string> seen;
        for (std::size_t i = 0; i < known.size(); ++i)
            known[i] =
                !seen.insert(cases[i].id).second || fs::exists(study.files.forms(cases[i].id)) ? 1
                                                                                               : 0;
    });
    world.broadcast(known);
    std::vector<MovedCase> needed;
    for (std::size_t i = 0; i < cases.size(); ++i)
        if (known[i] == 0) needed.push_back(cases[i]);
    ExitCode code = ExitCode::done;
    for (const std::vector<MovedCase>& batch : batches_of(needed)) {
        code =
            run_plan(study, basis_plan(study.job.plan, study.cases, batch), study.basis(), world);
        if (code != ExitCode::done) return code;
        together(world, [&] {
            const auto ranks = static_cast<std::size_t>(world.size());
            for (auto i = static_cast<std::size_t>(world.rank()); i < batch.size(); i += ranks)
                write_forms(study, batch[i]);
        });
    }
    return code;
}

Forms known_forms(const Study& study, const MovedCase& c) {
    const auto read = [&](const std::string& id) {
        const fs::path path = study.files.forms(id);
        return read_forms(storage::read_file(path), path.string());
    };
    Forms forms = read(c.id);
    const std::string& base = study.cases[c.of].base.id;
    if (c.id != base) forms.reference = read(base).reference_energy();
    return forms;
}

} // namespace shearwake::optimise
