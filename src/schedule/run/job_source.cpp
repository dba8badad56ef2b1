// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/run.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "measures/measure_table.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/memory.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/input/input_files.hpp"

#include <fmt/format.h>
#include <map>
#include <set>

namespace shearwake::schedule {
namespace {

/// Loads maps from files relative to the job, each only once. Collective: every rank parses the
/// same job and so requests the same file at the same time.
config::MapLoader maps_beside(const std::filesystem::path& job, const Comm& world) {
    using Known = std::map<std::string, std::shared_ptr<const MaterialMap>>;
    return [folder = job.parent_path(), world,
            known = std::make_shared<Known>()](const std::string& file) {
        auto& map = (*known)[file];
        if (!map)
            map = std::make_shared<const MaterialMap>(storage::read_map_file(folder / file, world));
        return map;
    };
}

/// Loads texts from files relative to the job, each only once. Collective.
config::TextLoader texts_beside(const std::filesystem::path& job, const Comm& world) {
    using Known = std::map<std::string, std::string>;
    return [folder = job.parent_path(), world,
            known = std::make_shared<Known>()](const std::string& file) {
        const auto found = known->find(file);
        if (found != known->end()) return found->second;
        std::string text;
        on_root(world, [&] { text = storage::read_user_text(folder, file); });
        return known->emplace(file, world.broadcast(std::move(text))).first->second;
    };
}

/// Checks the pins of each case with the model of the hand. Each distinct message is added once.
/// Throws BadJob.
void check_pins(config::Job& job, const std::string& file) {
    bool is_bad = false;
    std::set<std::string> known;
    const Case* last = nullptr; // cases of a sweep mostly share them
    for (const PlannedCase& planned : job.plan.cases) {
        const auto& afferents = planned.physics.afferents;
        if (!afferents ||
            (last && last->afferents == afferents && last->domain == planned.physics.domain))
            continue;
        last = &planned.physics;
        for (const Remark& remark : pipeline::check_afferents(planned.physics)) {
            const std::string message = "afferents." + remark.key + ": " + remark.message;
            if (!known.insert(message).second) continue;
            is_bad = is_bad || remark.severity == Severity::error;
            job.diagnostics.push_back(
                {.severity = remark.severity, .file = file, .message = message});
        }
    }
    if (is_bad) throw config::BadJob(std::move(job.diagnostics));
}

/// Rejects what pipeline::size_error() does, before memory of such a size is allocated.
void check_sizes(const config::Job& job, const std::string& file) {
    std::vector<config::Diagnostic> diagnostics;
    const auto refuse = [&](const std::string& message) {
        diagnostics.push_back({.severity = Severity::error, .file = file, .message = message});
    };
    std::set<std::string> known;
    for (const PlannedCase& planned : job.plan.cases) {
        const std::string message = pipeline::size_error(job.text, planned.physics);
        if (!message.empty() && known.insert(message).second && known.size() < 10) refuse(message);
    }
    if (!diagnostics.empty()) throw config::BadJob(std::move(diagnostics));
}

/// Rejects columns that no table has, before any case is computed.
void check_columns(const config::Job& job, const std::string& file) {
    std::vector<std::string> names;
    for (const measures::Measure& measure : measures::all_measures())
        names.emplace_back(measure.name);
    std::vector<config::Diagnostic> diagnostics;
    const auto check = [&](const std::string& key, const std::string& column) {
        if (measures::find_measure(column)) return;
        const auto meant = column.size() < 100 ? nearest(column, names) : std::nullopt;
        diagnostics.push_back(
            {.severity = Severity::error,
             .file = file,
             .message =
                 fmt::format("{}: tables have no column \"{}\"{}", key, config::excerpt(column),
                             meant ? fmt::format("; did you mean \"{}\"?", *meant) : "")});
    };
    if (!job.plan.answer.empty()) check("job.answer", job.plan.answer);
    for (const AdaptiveAxis& axis : job.plan.adaptive)
        check(fmt::format("sweep.\"{}\".column", axis.key), axis.column);
    if (job.plan.uncertain)
        for (const Threshold& threshold : job.plan.uncertain->exceedance)
            check("uncertain.exceedance", threshold.column);
    if (!diagnostics.empty()) throw config::BadJob(std::move(diagnostics));
}

/// Throws UsageError for a folder, with the job file of an output folder. Not collective.
void refuse_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored)) return;
    const OutputFolder folder{path};
    if (!std::filesystem::exists(folder.job(), ignored))
        throw UsageError(fmt::format("{} is a folder; give a job file (TOML)", path.string()));
    throw UsageError(fmt::format("{} is an output folder; give a job file, such as the job of this "
                                 "folder: {}",
                                 path.string(), run_command_line(folder.job(), {}, path)));
}

} // namespace

std::vector<config::Override> parse_overrides(const std::vector<std::string>& texts) {
    std::vector<config::Override> overrides;
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            throw UsageError("-S \"" + text +
                             "\": must be KEY=VALUE, for example -S load.peak_Pa=200");
        overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }
    return overrides;
}

config::Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                     const Comm& world, const config::AxisPoints& points) {
    const std::vector<config::Override> parsed = parse_overrides(overrides);
    std::string text;
    on_root(world, [&] {
        refuse_folder(path);
        text = storage::read_file(path, storage::largest_user_text_B);
    });
    std::set<std::string> files;
    const auto noted = [&files](const auto& load) {
        return [&files, load](const std::string& file) {
            files.insert(file.substr(file.starts_with(played_file) ? played_file.size() : 0));
            return load(file);
        };
    };
    config::Job job =
        config::read_job(world.broadcast(std::move(text)), path.string(), parsed,
                         noted(maps_beside(path, world)), noted(texts_beside(path, world)), points);
    job.files.assign(files.begin(), files.end());
    check_columns(job, path.string());
    check_sizes(job, path.string());
    check_pins(job, path.string());
    return job;
}

} // namespace shearwake::schedule
