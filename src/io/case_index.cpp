#include "io/case_index.hpp"

#include "base/error.hpp"
#include "io/case_file_reader.hpp"
#include "io/files.hpp"
#include "io/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <sys/stat.h>

namespace shearwake {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

using Stamp = CaseStamp;

std::optional<Stamp> stamp_of(const fs::path& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
    return Stamp{static_cast<std::uintmax_t>(info.st_size),
                 std::int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + info.st_mtim.tv_nsec};
}

CaseDigest damaged(const std::string& id, const std::string& why) {
    return {.id = id, .status = "damaged", .damage = why, .wall_s = nothing};
}

CaseDigest read_digest(const fs::path& path, const std::string& id) {
    CaseDigest digest{.id = id, .wall_s = nothing};
    try {
        const CaseSummary summary = read_summary_unguarded(path);
        if (summary.texts.at("case_id") != id) throw Error("it holds another case");
        if (summary.texts.at("status") != "complete") throw Error("it is not complete");
        digest.status = summary.texts.at("status");
        if (summary.texts.contains("git_id")) digest.git_id = summary.texts.at("git_id");
        if (summary.numbers.contains("wall_s")) digest.wall_s = summary.numbers.at("wall_s");
        for (const Variable& v : summary.scalars)
            digest.scalars.push_back({v.name, v.values.at(0), v.note});
    } catch (const std::exception& error) { // sizes that nobody can allocate, too
        return damaged(id, error.what());
    }
    return digest;
}

/// JSON knows no NaN.
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
double number_in(const Json& value) {
    return value.is_null() ? nothing : value.get<double>();
}

std::string line_of(const Stamp& stamp, const CaseDigest& digest) {
    Json line;
    line["id"] = digest.id;
    line["size"] = stamp.size;
    line["changed_ns"] = stamp.changed_ns;
    line["git_id"] = digest.git_id;
    line["wall_s"] = number(digest.wall_s);
    line["scalars"] = Json::array();
    for (const IndexedScalar& s : digest.scalars) {
        Json entry = Json::array({s.name, number(s.value)});
        // Of a value that is there no reason is ever shown.
        if (!std::isfinite(s.value)) entry.push_back(s.note);
        line["scalars"].push_back(std::move(entry));
    }
    return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// An infinite number would come back as none: such cases are read anew.
bool can_be_kept(const CaseDigest& digest) {
    bool fine = digest.whole();
    for (const IndexedScalar& s : digest.scalars)
        fine = fine && !std::isinf(s.value);
    return fine;
}

} // namespace

CaseIndex::CaseIndex(fs::path folder) : folder_(std::move(folder)) {
    std::error_code missing;
    for (const auto& file : fs::directory_iterator(folder_, missing)) {
        const std::string name = file.path().filename().string();
        if (!name.starts_with("index") || !name.ends_with(".jsonl")) continue;
        std::istringstream lines(read_file(file.path()));
        for (std::string text; std::getline(lines, text);) {
            try {
                const Json line = Json::parse(text);
                Entry entry{line.at("size"),
                            line.at("changed_ns"),
                            {.id = line.at("id"),
                             .status = "complete",
                             .damage = {},
                             .git_id = line.at("git_id"),
                             .wall_s = number_in(line.at("wall_s"))}};
                for (const Json& s : line.at("scalars"))
                    entry.digest.scalars.push_back(
                        {s.at(0), number_in(s.at(1)), s.size() > 2 ? s.at(2) : Json("")});
                known_[entry.digest.id] = std::move(entry);
            } catch (const nlohmann::json::exception&) {
                continue; // cut short
            }
        }
    }
}

const CaseDigest* CaseIndex::find(const std::string& id) {
    const auto checked = checked_.find(id);
    if (checked != checked_.end()) return &checked->second;
    const auto stamp = stamp_of(case_file(id));
    if (!stamp) return nullptr;
    if (take_known(id, *stamp)) return &checked_[id];
    read_missing();
    const auto read = checked_.find(id);
    return read == checked_.end() ? nullptr : &read->second; // another has removed it
}

fs::path CaseIndex::case_file(const std::string& id) const {
    return folder_ / "cases" / (id + ".h5");
}

bool CaseIndex::take_known(const std::string& id, const Stamp& stamp) {
    const auto known = known_.find(id);
    if (known == known_.end() || known->second.stamp != stamp) return false;
    checked_[id] = std::move(known->second.digest);
    known_.erase(known);
    return true;
}

/// Reads all files that the index does not know of, so that they are tried out together first; one
/// by one if that does not end well.
void CaseIndex::read_missing() {
    std::vector<std::pair<std::string, Stamp>> missing;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator(folder_ / "cases", gone)) {
        if (entry.path().extension() != ".h5") continue;
        const std::string id = entry.path().stem().string();
        const auto stamp = stamp_of(entry.path());
        if (stamp && !checked_.contains(id) && !take_known(id, *stamp))
            missing.emplace_back(id, *stamp);
    }
    std::ranges::sort(missing, {}, &std::pair<std::string, Stamp>::first);
    const double seconds = 30.0 + 0.1 * static_cast<double>(missing.size());
    const bool all = survives(
        [&] {
            for (const auto& [id, stamp] : missing)
                read_digest(case_file(id), id);
        },
        seconds);
    for (const auto& [id, stamp] : missing) {
        const fs::path file = case_file(id);
        const bool fine = all || survives([&, &name = id] { read_digest(file, name); });
        CaseDigest& digest = checked_[id] =
            fine ? read_digest(file, id) : damaged(id, "the HDF5 library breaks down on it");
        if (can_be_kept(digest)) news_ += line_of(stamp, digest) + "\n";
    }
}

void CaseIndex::save() {
    if (news_.empty()) return;
    news_.pop_back(); // append_line ends it
    try {
        append_line(folder_ / "index.jsonl", news_, Flush::later);
    } catch (const UsageError&) { // read-only, or full
    }
    news_.clear();
}

void add_to_index(const fs::path& index, const fs::path& case_file) {
    const auto stamp = stamp_of(case_file);
    if (!stamp) return;
    const CaseDigest digest = read_digest(case_file, case_file.stem().string());
    if (!can_be_kept(digest)) return;
    try {
        append_line(index, line_of(*stamp, digest), Flush::later);
    } catch (const UsageError&) { // it is read from the file
    }
}

std::string index_name(const std::string& journal_name) {
    return "index" + journal_name.substr(std::string_view("journal").size());
}

} // namespace shearwake
