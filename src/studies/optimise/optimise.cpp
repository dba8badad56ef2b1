// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/optimise_study.hpp"

#include "parallel/agree.hpp"
#include "schedule/run/run.hpp"
#include "storage/files.hpp"
#include "studies/optimise/study.hpp"

#include <chrono>
#include <fmt/format.h>

namespace shearwake::optimise {
namespace {

namespace fs = std::filesystem;

Study read_study(const schedule::RunArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (!job.optimise)
        throw UsageError(fmt::format("{} has no table [optimise]", arguments.job.string()),
                         ExitCode::bad_job);
    const OptimiseOptions options = *job.optimise;
    std::vector<OptimisedCase> cases = optimised_cases(job.plan, options);
    const schedule::OutputFolder folder =
        schedule::output_folder(arguments.out, job.plan.name + ".optimise");
    schedule::RunArguments run{arguments};
    run.resumed_by = schedule::command_line("optimise", arguments);
    return {.job = std::move(job),
            .options = options,
            .cases = std::move(cases),
            .folder = folder,
            .files = {folder.optimise()},
            .run = std::move(run)};
}

/// Creates the folder of the study or checks that an existing one belongs to this study. Not
/// collective.
void prepare(const Study& study) {
    const std::string identity = study_text(study.job.plan, study.options);
    const fs::path path = study.files.identity();
    if (fs::exists(path)) {
        if (storage::read_file(path) == identity) return;
        throw UsageError(
            fmt::format("{} contains the optima of another job or of other options of [optimise]; "
                        "choose another folder with --out, or remove this one",
                        study.files.root.string()));
    }
    storage::make_directory(study.files.root);
    storage::write_file(path, identity);
}

/// Each rank computes the optima of some cases and strengths that are not known. Collective.
void compute_optima(const Study& study, const std::vector<std::vector<MotionChange>>& motions,
                    const Comm& world) {
    const std::size_t count = study.cases.size() * study.options.strengths.size();
    const auto start = std::chrono::steady_clock::now();
    std::size_t done = 0; // by this rank; the turns of all ranks are equal
    together(world, [&] {
        std::size_t turn = 0;
        for (std::size_t i = 0; i < study.cases.size(); ++i)
            for (std::size_t s = 0; s < study.options.strengths.size(); ++s) {
                const double strength = study.options.strengths[s];
                const bool is_mine = turn++ % static_cast<std::size_t>(world.size()) ==
                                     static_cast<std::size_t>(world.rank());
                const fs::path path = study.files.optimum(study.cases[i], strength);
                if (!is_mine || fs::exists(path)) continue;
                const MovedCase base = moved_case(study.cases, i, {}).value();
                const MovedCase moved = moved_case(study.cases, i, motions[i][s]).value();
                storage::write_file(
                    path,
                    optimum_text(base.id, moved.id,
                                 optimum(study.cases[i], known_forms(study, base), motions[i][s],
                                         known_forms(study, moved), strength, study.options)));
                ++done;
                const double elapsed_s =
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
                if (world.is_root() && !study.run.quiet && turn < count)
                    fmt::print(stderr, "optimum {} of {}, about {:.0f} s remain\n", turn, count,
                               elapsed_s * static_cast<double>(count - turn) /
                                   (static_cast<double>(done) * static_cast<double>(world.size())));
            }
    });
}

/// Whether the optima of all cases and strengths are known, so that no motion needs to be searched.
/// Collective.
bool has_optima(const Study& study, const Comm& world) {
    bool is_missing = false;
    on_root(world, [&] {
        for (const OptimisedCase& c : study.cases)
            for (const double strength : study.options.strengths)
                is_missing = is_missing || !fs::exists(study.files.optimum(c, strength));
    });
    return !world.broadcast(is_missing);
}

/// The optima of all cases and strengths on every rank. Collective.
Optima read_optima(const Study& study, const Comm& world) {
    Optima results{.cases = study.cases, .optima = {}, .moved = {}, .sm = {}};
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
        results.optima.emplace_back();
        results.moved.emplace_back();
        for (const double strength : study.options.strengths) {
            const fs::path path = study.files.optimum(study.cases[i], strength);
            std::string text;
            on_root(world, [&] { text = storage::read_file(path); });
            text = world.broadcast(std::move(text));
            results.optima.back().push_back(read_optimum(text, path.string()));
            results.moved.back().push_back(
                moved_case(study.cases, i, results.optima.back().back().change).value());
        }
    }
    return results;
}

/// Finds the optima, unless they are known. Collective.
ExitCode search(const Study& study, const Comm& world) {
    std::vector<std::vector<MotionChange>> motions;
    if (has_optima(study, world)) return ExitCode::done;
    const ExitCode code = find_motions(study, motions, world);
    if (code == ExitCode::done) compute_optima(study, motions, world);
    return code;
}

} // namespace

ExitCode optimise_job(const schedule::RunArguments& arguments, const Comm& world) {
    Study study = read_study(arguments, world);
    on_root(world, [&] { prepare(study); });
    if (const ExitCode code = search_sm(study, world); code != ExitCode::done) return code;
    if (const ExitCode code = search(study, world); code != ExitCode::done) return code;

    Optima results = read_optima(study, world);
    Readings basis;
    on_root(world, [&] { basis = readings_of(study.basis(), study.options.maximise); });
    results.sm = agreed_sm(study, world);
    const std::vector<RobustCase> robust = robust_cases(results, study.options);
    const schedule::OutputFolder robustness{study.folder.robustness()};
    if (!robust.empty())
        if (const ExitCode code =
                run_plan(study, robust_plan(study.job.plan, results, robust), robustness, world);
            code != ExitCode::done)
            return code;
    const ExitCode code =
        run_plan(study, final_plan(study.job.plan, results, study.options), study.folder, world);
    if (code != ExitCode::done) return code;
    on_root(world, [&] {
        std::string text = write_optima(study, results, basis);
        if (!robust.empty()) text += "\n" + write_robustness(study, results, robust);
        if (!arguments.quiet)
            fmt::print("\n{}\noptima: {}\nnext: {}\n", text,
                       (study.files.root / "table.csv").string(),
                       schedule::reduce_command_line(study.folder));
    });
    return code;
}

} // namespace shearwake::optimise
