#include "sweep/job_source.hpp"

#include "base/error.hpp"
#include "io/files.hpp"
#include "io/grid_study_file.hpp"
#include "io/map_file.hpp"
#include "parallel/agree.hpp"
#include "sweep/afferent_result.hpp"

#include <map>
#include <set>

namespace shearwake {
namespace {

/// Maps in files beside the job, each read once for all its cases. Collective: every rank reads the
/// same job and comes to the same file at the same time.
MapLoader maps_beside(const std::filesystem::path& job, const Comm& world) {
    using Known = std::map<std::string, std::shared_ptr<const MaterialMap>>;
    return [folder = job.parent_path(), world,
            known = std::make_shared<Known>()](const std::string& file) {
        auto& map = (*known)[file];
        if (!map) map = std::make_shared<const MaterialMap>(read_map_file(folder / file, world));
        return map;
    };
}

/// Studies likewise.
StudyLoader studies_beside(const std::filesystem::path& job, const Comm& world) {
    using Known = std::map<std::string, std::shared_ptr<const GridStudy>>;
    return [folder = job.parent_path(), world,
            known = std::make_shared<Known>()](const std::string& file) {
        auto& study = (*known)[file];
        if (!study)
            study = std::make_shared<const GridStudy>(read_grid_study(folder / file, world));
        return study;
    };
}

/// Texts in files beside the job, each read once. Collective as the maps are.
TextLoader texts_beside(const std::filesystem::path& job, const Comm& world) {
    using Known = std::map<std::string, std::string>;
    return [folder = job.parent_path(), world,
            known = std::make_shared<Known>()](const std::string& file) {
        const auto held = known->find(file);
        if (held != known->end()) return held->second;
        std::string text;
        on_root(world, [&] { text = read_file(folder / file); });
        return known->emplace(file, world.broadcast(std::move(text))).first->second;
    };
}

/// What only the hand can tell of the pins of each case: once a message. Throws BadJob.
void check_pins(Job& job, const std::string& file) {
    bool is_bad = false;
    std::set<std::string> told;
    const Case* last = nullptr; // cases of a sweep mostly share them
    for (const PlannedCase& planned : job.plan.cases) {
        const auto& afferents = planned.physics.afferents;
        if (!afferents ||
            (last && last->afferents == afferents && last->domain == planned.physics.domain))
            continue;
        last = &planned.physics;
        for (const Remark& remark : check_afferents(planned.physics)) {
            const std::string message = "afferents." + remark.key + ": " + remark.message;
            if (!told.insert(message).second) continue;
            is_bad = is_bad || remark.severity == Severity::error;
            job.findings.push_back({.severity = remark.severity, .file = file, .message = message});
        }
    }
    if (is_bad) throw BadJob(std::move(job.findings));
}

} // namespace

Override parse_override(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UsageError("-S wants key=value, as in -S load.peak_Pa=200; it got \"" + text + "\"");
    return {text.substr(0, equals), text.substr(equals + 1)};
}

Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
             const Comm& world) {
    std::vector<Override> parsed;
    for (const std::string& text : overrides)
        parsed.push_back(parse_override(text));
    std::string text;
    on_root(world, [&] { text = read_file(path); });
    Job job =
        read_job(world.broadcast(std::move(text)), path.string(), parsed, maps_beside(path, world),
                 texts_beside(path, world), studies_beside(path, world));
    check_pins(job, path.string());
    return job;
}

} // namespace shearwake
