// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/progress.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

namespace shearwake::schedule {
namespace {

/// Seconds since the run has recorded its progress.
double age_s(const std::filesystem::path& path) {
    const auto age =
        std::filesystem::file_time_type::clock::now() - std::filesystem::last_write_time(path);
    return std::max(0.0, std::chrono::duration<double>(age).count());
}

bool is_at_work(const OutputFolder& folder, const std::string& part) {
    const auto lock = part.empty() ? folder.run_lock() : folder.part_lock(part);
    return std::filesystem::exists(lock) && storage::is_locked(lock).value_or(true);
}

void add(RecordedProgress& sum, const std::filesystem::path& path, const nlohmann::json& run) {
    const auto left_s = run.at("left_s");
    sum.left +=
        run.at("total").get<long>() - run.at("done").get<long>() - run.at("failed").get<long>();
    sum.partial += run.at("partial").get<double>();
    if (left_s.is_number()) sum.left_s = std::max(sum.left_s, left_s.get<double>() - age_s(path));
}

} // namespace

std::optional<RecordedProgress> recorded_progress(const OutputFolder& folder) {
    std::optional<RecordedProgress> sum;
    std::error_code missing; // a run may end at any time
    for (const auto& entry : std::filesystem::directory_iterator(folder.root, missing)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("progress.") || !name.ends_with(".json")) continue;
        try {
            const auto run = nlohmann::json::parse(storage::read_file(entry.path()));
            if (!is_at_work(folder, run.at("part").get<std::string>())) continue;
            RecordedProgress more = sum.value_or(RecordedProgress{});
            add(more, entry.path(), run);
            sum = more;
        } catch (const std::exception&) { // the file was removed, or is not from a run
        }
    }
    return sum;
}

} // namespace shearwake::schedule
