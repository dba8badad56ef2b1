// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"
#include "app/optimise_table.hpp"
#include "optimise/gram.hpp"
#include "optimise/study_file.hpp"
#include "parallel/agree.hpp"
#include "schedule/job_source.hpp"
#include "schedule/next_command.hpp"
#include "schedule/run.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

namespace fs = std::filesystem;
using optimise::OptimisedCase;
using optimise::Optimum;

/// The files of a study, in the folder `optimise`.
struct StudyFiles {
    fs::path root;
    fs::path identity() const { return root / "study.txt"; }
    fs::path forms(const OptimisedCase& c) const { return root / (c.base.id + ".forms.json"); }
    fs::path optimum(const OptimisedCase& c, double strength) const {
        return root / fmt::format("{}.strength-{:g}.json", c.base.id, strength);
    }
};

/// Creates the folder of the study or checks that an existing one belongs to this study. Not
/// collective.
void prepare_study(const StudyFiles& files, const std::string& identity) {
    if (fs::exists(files.identity())) {
        if (storage::read_file(files.identity()) == identity) return;
        throw UsageError(
            fmt::format("{} contains the optima of another job or of other options of [optimise]; "
                        "choose another folder with --out, or remove this one",
                        files.root.string()));
    }
    storage::make_directory(files.root);
    storage::write_file(files.identity(), identity);
}

/// Replaces the plan of the basis if some of its cases are no longer needed. Not collective.
void prepare_basis(const schedule::OutputFolder& basis, const Plan& plan) {
    storage::make_directory(basis.run_lock().parent_path());
    const storage::RunLock lock(basis.run_lock(), storage::RunLock::Sharing::alone);
    if (fs::exists(basis.plan()) &&
        storage::compare_plan(storage::read_file(basis.plan()), plan) != storage::PlanMatch::same)
        fs::remove(basis.plan());
}

std::vector<fs::path> knot_files(const OptimisedCase& c, const schedule::OutputFolder& basis) {
    std::vector<fs::path> files;
    for (std::ptrdiff_t knot = 0; knot < c.knots.count; ++knot)
        files.push_back(
            basis.case_file(case_id(optimise::knot_case(c.base.physics, c.knots, knot))));
    return files;
}

/// Each rank computes the forms of some cases. Removes the fields of the knots, which are no longer
/// needed then. Collective.
void compute_forms(const std::vector<OptimisedCase>& cases, const std::vector<bool>& known,
                   const StudyFiles& files, const schedule::OutputFolder& basis,
                   const Comm& world) {
    together(world, [&] {
        for (std::size_t i = 0, turn = 0; i < cases.size(); ++i) {
            if (known[i]) continue;
            if (turn++ % static_cast<std::size_t>(world.size()) !=
                static_cast<std::size_t>(world.rank()))
                continue;
            const std::vector<fs::path> knots = knot_files(cases[i], basis);
            storage::write_file(
                files.forms(cases[i]),
                optimise::forms_text(cases[i].base.id, cases[i].knots,
                                     optimise::gram_forms(cases[i].base.physics, knots)));
            for (const fs::path& knot : knots)
                fs::remove(knot);
        }
    });
}

/// Each rank computes the optima of some cases and strengths that are not known. Collective.
void compute_optima(const std::vector<OptimisedCase>& cases, const OptimiseOptions& options,
                    const StudyFiles& files, const Comm& world) {
    together(world, [&] {
        std::size_t turn = 0;
        for (const OptimisedCase& c : cases)
            for (const double strength : options.strengths) {
                const bool is_mine = turn++ % static_cast<std::size_t>(world.size()) ==
                                     static_cast<std::size_t>(world.rank());
                const fs::path path = files.optimum(c, strength);
                if (!is_mine || fs::exists(path)) continue;
                const optimise::Forms forms = optimise::read_forms(
                    storage::read_file(files.forms(c)), files.forms(c).string());
                storage::write_file(
                    path, optimise::optimum_text(c.base.id,
                                                 optimise::optimum(c, forms, strength, options)));
            }
    });
}

/// The optima of all cases and strengths on every rank. Collective.
std::vector<std::vector<Optimum>> read_optima(const std::vector<OptimisedCase>& cases,
                                              const OptimiseOptions& options,
                                              const StudyFiles& files, const Comm& world) {
    std::vector<std::vector<Optimum>> optima;
    for (const OptimisedCase& c : cases) {
        optima.emplace_back();
        for (const double strength : options.strengths) {
            const fs::path path = files.optimum(c, strength);
            std::string text;
            on_root(world, [&] { text = storage::read_file(path); });
            text = world.broadcast(std::move(text));
            optima.back().push_back(optimise::read_optimum(text, path.string()));
        }
    }
    return optima;
}

/// The best SM-STM on every rank. Collective.
void agree_on_sm(Optima& results, const OptimiseOptions& options,
                 const std::map<std::string, Reading>& basis, const Comm& world) {
    std::vector<int> chosen; // -1: none
    on_root(world, [&] {
        for (const auto& of_case : best_sm(results.cases, options.strengths, basis))
            for (const optimise::BestSm& sm : of_case)
                chosen.push_back(sm ? static_cast<int>(*sm) : -1);
    });
    world.broadcast(chosen);
    const std::size_t strengths = options.strengths.size();
    for (std::size_t i = 0; i < results.cases.size(); ++i) {
        results.sm.emplace_back();
        for (std::size_t s = 0; s < strengths; ++s) {
            const int number = chosen[i * strengths + s];
            results.sm.back().push_back(
                number < 0 ? std::nullopt : optimise::BestSm(static_cast<std::size_t>(number)));
        }
    }
}

} // namespace

ExitCode optimise_command(const OptimiseArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (!job.optimise)
        throw UsageError(fmt::format("{} has no table [optimise]", arguments.job.string()),
                         ExitCode::bad_job);
    const OptimiseOptions options = *job.optimise;
    const Plan plan = job.plan;
    Optima results{.cases = optimise::optimised_cases(plan, options), .optima = {}, .sm = {}};
    const schedule::OutputFolder folder{
        arguments.out.empty() ? fs::path("out") / (plan.name + ".optimise") : arguments.out};
    const schedule::OutputFolder basis{folder.basis()};
    const StudyFiles files{folder.optimise()};

    std::vector<int> known(results.cases.size(), 0);
    on_root(world, [&] {
        prepare_study(files, optimise::study_text(plan, options));
        for (std::size_t i = 0; i < known.size(); ++i)
            known[i] = fs::exists(files.forms(results.cases[i])) ? 1 : 0;
    });
    world.broadcast(known);
    const std::vector<bool> has_forms(known.begin(), known.end());
    job.plan = optimise::basis_plan(plan, results.cases, has_forms);
    job.diagnostics.clear(); // `run` reports them
    on_root(world, [&] { prepare_basis(basis, job.plan); });
    schedule::RunArguments run{arguments};
    run.resumed_by = schedule::command_line("optimise", arguments);
    run.out = basis.root;
    if (const ExitCode code = schedule::run_job(job, run, world); code != ExitCode::done)
        return code;

    compute_forms(results.cases, has_forms, files, basis, world);
    compute_optima(results.cases, options, files, world);
    results.optima = read_optima(results.cases, options, files, world);
    std::map<std::string, Reading> readings;
    on_root(world, [&] { readings = readings_of(basis); });
    agree_on_sm(results, options, readings, world);
    job.plan = optimise::final_plan(plan, results.cases, results.optima, results.sm, options);
    run.out = folder.root;
    const ExitCode code = schedule::run_job(job, run, world);
    if (code != ExitCode::done) return code;
    on_root(world, [&] {
        const std::string text = write_optima(folder, results, options, readings);
        if (!arguments.quiet)
            fmt::print("\n{}\noptima: {}\n", text, (files.root / "table.csv").string());
    });
    return code;
}

} // namespace shearwake::app
