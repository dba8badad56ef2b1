// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/optimise.hpp"

#include "base/python_module.hpp"
#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "parallel/session.hpp"
#include "schedule/run/deadline.hpp"
#include "storage/files.hpp"
#include "storage/journal/claims.hpp"
#include "storage/journal/plan_file.hpp"
#include "studies/optimise/study.hpp"
#include "studies/tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace shearwake::optimise {
namespace {

namespace fs = std::filesystem;

constexpr double most_of_knots_B = 2.5e9; // on the disk at the same time

Study read_study(const schedule::RunArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (!job.optimise)
        throw UsageError(
            fmt::format("{} has no table [optimise]; add, for example:\n"
                        "[optimise]\n"
                        "over = [\"envelope\"]\n"
                        "strength_at_least = [0.9] # of the rms of the unmodulated load",
                        arguments.job.string()),
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
            .run = std::move(run)};
}

/// The number of the optimised case and the id of a case without envelope, and its knots.
struct KnotSet {
    std::size_t number = 0;
    Case physics;
    std::string id;
    Knots knots;
};

std::vector<KnotSet> knot_sets(const Study& study, const Json& request) {
    std::vector<KnotSet> sets;
    const Json *forms = request.find("forms"), none = Json::array();
    for (const Json& variant : forms ? *forms : none) {
        const auto number = variant.at("case").get<std::size_t>();
        const Case c = case_of(study, variant).value();
        Knots knots = study.cases.at(number).knots;
        knots.interval_s = variant.at("interval_s").get<double>();
        sets.push_back({number, c, case_id(c), knots});
    }
    return sets;
}

/// In groups whose knots need a limited space on the disk. At least one group: without forms, only
/// the cases of the request are computed.
std::vector<std::vector<KnotSet>> batches_of(std::vector<KnotSet> sets) {
    std::vector<std::vector<KnotSet>> batches(1);
    double used_B = 0.0;
    for (KnotSet& set : sets) {
        const double needed_B = 8.0 * static_cast<double>(set.physics.domain.nx) *
                                static_cast<double>(set.physics.domain.ny) *
                                static_cast<double>(set.physics.time.frames) *
                                static_cast<double>(set.knots.count);
        if (!batches.back().empty() && used_B + needed_B > most_of_knots_B) {
            batches.emplace_back();
            used_B = 0.0;
        }
        batches.back().push_back(std::move(set));
        used_B += needed_B;
    }
    return batches;
}

/// A plan with the keys and the table of a request, to which cases are added once each.
class PlanBuilder {
public:
    PlanBuilder(const Study& study, const Json& request) : study_(study) {
        plan_.name = study.job.plan.name;
        plan_.title = request.at("title").get<std::string>();
        plan_.swept_keys = study.job.plan.swept_keys;
        for (const Json& key : request.at("keys"))
            plan_.swept_keys.push_back(key.get<std::string>());
        if (request.contains("x"))
            plan_.table = {.x = request.at("x").get<std::string>(),
                           .series = request.at("series").get<std::vector<std::string>>()};
    }

    void add(std::size_t number, const Case& physics, const std::string& id,
             std::vector<Setting> more, const std::string& reference_id = "") {
        if (!ids_.insert(id).second) return;
        PlannedCase planned{.id = id,
                            .physics = physics,
                            .settings = study_.cases.at(number).planned.settings,
                            .reference_id = reference_id == id ? "" : reference_id};
        planned.settings.insert(planned.settings.end(), more.begin(), more.end());
        plan_.cases.push_back(std::move(planned));
    }
    const Plan& plan() const { return plan_; }

private:
    const Study& study_;
    Plan plan_;
    std::set<std::string> ids_;
};

std::vector<Setting> settings_of(const Json& entry) {
    std::vector<Setting> settings;
    for (const Json& setting : entry.at("settings")) {
        const Json& value = setting.at(1);
        settings.push_back({setting.at(0).get<std::string>(), ""});
        if (value.is_string())
            settings.back().value = value.get<std::string>();
        else
            settings.back().value = value.get<double>();
    }
    return settings;
}

/// Adds the cases of a request; returns their ids, which are empty for cases that are not valid. A
/// case is compared with the case of number `reference` of the request.
std::vector<std::string> add_cases(PlanBuilder& builder, const Study& study, const Json& request) {
    std::vector<std::string> ids;
    for (const Json& entry : request.at("cases")) {
        const std::optional<Case> c = case_of(study, entry);
        ids.push_back(c ? case_id(*c) : "");
        if (!c) continue;
        const Json* reference = entry.find("reference");
        builder.add(entry.at("case").get<std::size_t>(), *c, ids.back(), settings_of(entry),
                    reference ? ids.at(reference->get<std::size_t>()) : "");
    }
    return ids;
}

/// Runs the cases of a plan in this folder. A plan of the folder with other cases is replaced, and
/// the cases that both have remain. Collective.
ExitCode run_plan(const Study& study, const Plan& plan, const schedule::OutputFolder& folder,
                  const Comm& world) {
    on_root(world, [&] { schedule::remove_other_plan(folder, plan); });
    config::Job job = study.job;
    job.plan = plan;
    job.diagnostics.clear(); // `run` reports them
    schedule::RunArguments run = study.run;
    run.out = folder.root;
    return schedule::run_job(job, run, world);
}

/// The files of the knots of a case are no longer needed when its forms are known.
void write_forms(const Study& study, const KnotSet& set, const schedule::OutputFolder& folder) {
    std::vector<fs::path> files;
    for (std::ptrdiff_t knot = 0; knot < set.knots.count; ++knot)
        files.push_back(folder.case_file(case_id(knot_case(set.physics, set.knots, knot))));
    const Quotient quotient = find_quotient(set.physics, study.options.maximise).value();
    storage::write_file(study.folder.optimise() / (set.id + ".forms.json"),
                        forms_text(set.id, set.knots,
                                   gram_forms(set.physics, quotient,
                                              study.options.uniformity > 0.0 ? PathForms::included
                                                                             : PathForms::omitted,
                                              files)));
    for (const fs::path& file : files)
        fs::remove(file);
}

/// The rows of these cases by id: the maximised measure, the focal rms in um, whether they are
/// valid, and the uniformity.
Json rows_of(const Study& study, const schedule::OutputFolder& folder, const Plan& plan,
             const std::vector<std::string>& ids) {
    const reduce::Table table = studies::table_of(folder);
    const std::size_t eta = table.find(study.options.maximise).value(),
                      rms = table.find("focal_rms_um").value(), valid = table.find("valid").value();
    Json rows = Json::object();
    for (std::size_t n = 0; n < plan.cases.size(); ++n) {
        const PlannedCase& c = plan.cases[n];
        if (std::ranges::find(ids, c.id) == ids.end()) continue;
        const auto& row = table.rows.at(n);
        const fs::path file = folder.case_file(c.id);
        rows[c.id] = {std::get<double>(row.at(eta)), std::get<double>(row.at(rms)),
                      row.at(valid) != reduce::Cell("no"),
                      fs::exists(file) ? uniformity_of(c.physics, file) : not_a_number};
    }
    return rows;
}

} // namespace

ExitCode compute(const Study& study, const Json& request, Json& answer, const Comm& world) {
    const schedule::OutputFolder folder{study.folder.root /
                                        request.at("folder").get<std::string>()};
    for (const std::vector<KnotSet>& batch : batches_of(knot_sets(study, request))) {
        PlanBuilder builder(study, request);
        const std::vector<std::string> ids = add_cases(builder, study, request);
        for (const KnotSet& set : batch)
            for (std::ptrdiff_t knot = 0; knot < set.knots.count; ++knot) {
                const Case c = knot_case(set.physics, set.knots, knot);
                builder.add(set.number, c, case_id(c),
                            {{"optimise.part", fmt::format("knot {} of {}", knot, set.id)}});
            }
        const ExitCode code = run_plan(study, builder.plan(), folder, world);
        if (code != ExitCode::done) return code;
        together(world, [&] {
            const auto ranks = static_cast<std::size_t>(world.size());
            for (auto i = static_cast<std::size_t>(world.rank()); i < batch.size(); i += ranks)
                write_forms(study, batch[i], folder);
        });
        on_root(world, [&] {
            answer = {{"ids", ids}, {"rows", rows_of(study, folder, builder.plan(), ids)}};
        });
    }
    return ExitCode::done;
}

namespace {

/// The answer to a request that computes no case. Not collective.
Json answer_to(const Study& study, const Json& request) {
    if (request.at("type") == "positions") return positions(study, request);
    Json cases = Json::array();
    for (const Json& variant : request.at("cases"))
        cases.push_back(describe(study, variant));
    return cases;
}

/// Answers the requests of the module until it ends. Collective.
ExitCode serve(const Study& study, std::optional<PythonClient>& module, const Comm& world) {
    for (;;) {
        std::optional<std::string> line;
        if (module) line = module->request(schedule::stop_requested);
        sleeping_barrier(world); // the module may search for minutes
        if (!world.broadcast(line.has_value())) return ExitCode::done;
        const Json request = Json::parse(world.broadcast(line.value_or("")));
        const std::string type = request.at("type").get<std::string>();
        if (type == "error")
            throw UsageError(request.at("message").get<std::string>(),
                             static_cast<ExitCode>(request.at("code").get<int>()));
        Json answer;
        if (type == "compute")
            if (const ExitCode code = compute(study, request, answer, world);
                code != ExitCode::done)
                return code;
        on_root(world, [&] {
            if (type != "compute") answer = answer_to(study, request);
            module->answer(answer.dump());
        });
    }
}

} // namespace

void require_optimisable(const Plan& plan, const OptimiseOptions& options) {
    optimised_cases(plan, options);
}

ExitCode optimise_job(const schedule::RunArguments& arguments, const Comm& world) {
    const Study study = read_study(arguments, world);
    std::optional<storage::FileLock> lock;
    std::optional<PythonClient> module;
    const int ranks = world.split_by_machine().size();
    schedule::watch_for_stop_signals(world);
    on_root(world, [&] {
        require_python(study_packages);
        const fs::path locks = study.folder.optimise() / "locks";
        storage::make_directory(locks);
        if (lock.emplace(storage::folder_lock(locks)).is_refused())
            throw UsageError(fmt::format("another optimise is active in {}; wait until it has "
                                         "ended, or choose another folder with --out",
                                         study.folder.root.string()));
        module.emplace("shearwake.studies.optimising", std::vector<std::string>{}, study_packages);
        module->answer(description(study, ranks).dump());
    });
    const ExitCode code = serve(study, module, world);
    if (code != ExitCode::done) return code;
    const bool is_stopped = world.broadcast(schedule::stop_requested());
    on_root(world, [&] {
        if (is_stopped)
            fmt::print(stderr, "the search was stopped; resume it with\n  {}\n",
                       study.run.resumed_by);
        else if (const int status = module->exit_code(); status != 0)
            throw UsageError(fmt::format("the search failed (exit {})", status),
                             ExitCode::environment);
    });
    return is_stopped ? ExitCode::stopped_early : ExitCode::done;
}

} // namespace shearwake::optimise
