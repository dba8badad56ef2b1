// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/case_index.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>
#include <sys/stat.h>

namespace shearwake::storage {

namespace {

namespace fs = std::filesystem;

using Stamp = CaseStamp;

std::optional<Stamp> stamp_of(const fs::path& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
    return Stamp{static_cast<std::uintmax_t>(info.st_size),
                 std::int64_t{info.st_ctim.tv_sec} * 1'000'000'000 + info.st_ctim.tv_nsec};
}

CaseDigest damaged(const std::string& id, const std::string& why) {
    return {.id = id, .status = "damaged", .damage = why, .wall_s = not_a_number};
}

CaseDigest lost(const std::string& id, const std::string& why) {
    CaseDigest digest = damaged(id, why);
    digest.is_lost = true;
    return digest;
}

/// The disk failed, perhaps temporarily: the file may be intact.
bool is_of_the_system(const FileFailure& error) {
    const std::string_view words = error.what();
    return error.persistence() == Persistence::lasting ||
           std::ranges::any_of(passing_errors,
                               [&](int e) { return words.ends_with(std::strerror(e)); });
}

CaseDigest read_digest(const fs::path& path, const std::string& id) {
    CaseDigest digest{.id = id, .wall_s = not_a_number};
    try {
        const CaseSummary summary = read_unverified_summary(path);
        if (summary.texts.at("case_id") != id) throw Error("it contains another case");
        if (summary.texts.at("status") != "complete") throw Error("it is not complete");
        digest.status = summary.texts.at("status");
        if (summary.texts.contains("warnings"))
            digest.warnings = warnings_in(summary.texts.at("warnings"));
        if (summary.texts.contains("git_id")) digest.git_id = summary.texts.at("git_id");
        if (summary.numbers.contains("wall_s")) digest.wall_s = summary.numbers.at("wall_s");
        for (const Variable& v : summary.scalars)
            digest.scalars.push_back({v.name, v.values.at(0), v.note});
    } catch (const FileFailure& error) {
        return is_of_the_system(error) ? damaged(id, error.what()) : lost(id, error.what());
    } catch (const std::exception& error) { // including sizes that cannot be allocated
        return lost(id, error.what());
    }
    return digest;
}

double number_in(const Json& value) {
    return value.is_null() ? not_a_number : value.get<double>();
}

std::string line_of(const Stamp& stamp, const CaseDigest& digest) {
    Json line = {{"id", digest.id}, {"size", stamp.size}, {"changed_ns", stamp.changed_ns}};
    if (digest.is_lost) {
        line["damage"] = digest.damage;
        return seal(line.text());
    }
    line["git_id"] = digest.git_id;
    line["wall_s"] = digest.wall_s;
    line["warnings"] = warnings_text(digest.warnings);
    Json& scalars = line["scalars"] = Json::array();
    for (const IndexedScalar& s : digest.scalars) {
        Json entry = Json::array({s.name.text(), s.value});
        if (!s.note.empty()) entry.push_back(s.note.text());
        scalars.push_back(std::move(entry));
    }
    return seal(line.text());
}

std::pair<Stamp, CaseDigest> entry_of(const Json& line) {
    const Stamp stamp{line.at("size").get<std::size_t>(), line.at("changed_ns").get<long>()};
    const auto text = [&](const char* key) { return line.at(key).get<std::string>(); };
    if (line.contains("damage")) return {stamp, lost(text("id"), text("damage"))};
    CaseDigest digest{.id = text("id"), .status = "complete"};
    digest.git_id = text("git_id");
    digest.wall_s = number_in(line.at("wall_s"));
    digest.warnings = warnings_in(text("warnings"));
    for (const Json& s : line.at("scalars"))
        digest.scalars.push_back({s.at(0).get<std::string>(), number_in(s.at(1)),
                                  s.size() > 2 ? s.at(2).get<std::string>() : ""});
    return {stamp, digest};
}

/// JSON cannot represent infinity: such cases are read from their files again.
bool is_storable(const CaseDigest& digest) {
    bool fine = digest.is_complete() || digest.is_lost;
    for (const IndexedScalar& s : digest.scalars)
        fine = fine && !std::isinf(s.value);
    return fine;
}

} // namespace

std::string id_of_file(const fs::path& file) {
    std::string stem = file.stem().string();
    const bool is_id = stem.find_first_not_of("0123456789abcdef") == std::string::npos;
    return is_id && file.extension() == ".h5" ? stem : "";
}

CaseIndex::CaseIndex(fs::path folder, Trust trust,
                     std::function<void(const VerifyProgress&)> report)
    : folder_(std::move(folder)), trust_(trust), report_(std::move(report)) {
    for (const std::string& name : names_in(folder_)) {
        if (!name.starts_with("index") || !name.ends_with(".jsonl") || is_stray(name)) continue;
        std::istringstream lines(read_file(folder_ / name));
        for (std::string text; next_line(lines, text);) {
            const std::optional<std::string> line = unseal(text);
            if (!line) {
                ++lines_skipped_;
                continue;
            }
            try {
                auto [stamp, digest] = entry_of(Json::parse(*line));
                const std::string id = digest.id;
                known_[id] = {stamp, std::move(digest)};
            } catch (const JsonError&) {
                ++lines_skipped_;
            }
        }
    }
}

const CaseDigest* CaseIndex::find(const std::string& id) {
    const auto checked = checked_.find(id);
    if (checked != checked_.end()) return &checked->second;
    const auto stamp = stamp_of(case_file(id));
    if (!stamp) return nullptr;
    if (trust_ == Trust::size_and_time && accept_known(id, *stamp)) return &checked_[id];
    read_missing();
    const auto read = checked_.find(id);
    return read == checked_.end() ? nullptr : &read->second; // another process has removed it
}

const std::map<std::string, CaseDigest>& CaseIndex::digests() {
    read_missing();
    return checked_;
}

fs::path CaseIndex::case_file(const std::string& id) const {
    return folder_ / "cases" / (id + ".h5");
}

bool CaseIndex::accept_known(const std::string& id, const Stamp& stamp) {
    const auto known = known_.find(id);
    if (known == known_.end() || known->second.stamp != stamp) return false;
    checked_[id] = std::move(known->second.digest);
    known_.erase(known);
    return true;
}

void CaseIndex::put(const std::string& id, const CaseStamp& stamp, CaseDigest digest) {
    const CaseDigest& checked = checked_[id] = std::move(digest);
    if (is_storable(checked)) news_ += line_of(stamp, checked) + "\n";
}

/// Reads all files that are not checked yet and match their checksum.
void CaseIndex::read_missing() {
    std::vector<std::pair<std::string, Stamp>> missing;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_ / "cases", ignored)) {
        const std::string id = id_of_file(entry.path());
        const auto stamp = id.empty() ? std::nullopt : stamp_of(entry.path());
        if (!stamp || checked_.contains(id)) continue;
        if (trust_ == Trust::checksum || !accept_known(id, *stamp))
            missing.emplace_back(id, *stamp);
    }
    std::ranges::sort(missing, {}, &std::pair<std::string, Stamp>::first);
    std::vector<fs::path> files;
    for (const auto& [id, stamp] : missing)
        files.push_back(case_file(id));
    const std::vector<VerifiedFile> verified = verify_files(files, report_);
    for (std::size_t i = 0; i < missing.size(); ++i) {
        const auto& [id, stamp] = missing[i];
        const auto& [check, unreadable] = verified[i];
        verified_B_ += static_cast<double>(check.bytes);
        const auto known = known_.find(id);
        const bool in_index = known != known_.end() && known->second.stamp == stamp;
        if (!unreadable.empty()) {
            if (fs::exists(files[i], ignored)) put(id, stamp, damaged(id, unreadable));
        } else if (!check.damage.empty()) {
            put(id, stamp, lost(id, check.damage));
        } else if (in_index && known->second.digest.is_complete()) {
            accept_known(id, stamp);
        } else {
            put(id, stamp, read_digest(files[i], id));
        }
    }
}

void CaseIndex::save() {
    if (news_.empty()) return;
    news_.pop_back(); // append_line adds the end of the line
    try {
        append_line(folder_ / "index.jsonl", news_, Flush::later);
    } catch (const UsageError&) { // the folder is read-only or full
    }
    news_.clear();
}

CaseDigest digest_of(const std::vector<VariableGroup>& groups,
                     const std::vector<Attribute>& attributes) {
    CaseDigest digest{.wall_s = not_a_number};
    for (const Attribute& attribute : attributes) {
        if (const auto* number = std::get_if<double>(&attribute.value)) {
            if (attribute.name == "wall_s") digest.wall_s = *number;
        } else if (const auto* text = std::get_if<std::string>(&attribute.value)) {
            if (attribute.name == "case_id") digest.id = *text;
            if (attribute.name == "status") digest.status = *text;
            if (attribute.name == "git_id") digest.git_id = *text;
            if (attribute.name == "warnings") digest.warnings = warnings_in(*text);
        }
    }
    for (const Variable& v : groups.front().variables)
        if (v.dimensions.empty()) digest.scalars.push_back({v.name, v.values.at(0), v.note});
    return digest;
}

void add_to_index(const fs::path& index, const fs::path& case_file, const CaseDigest& digest) {
    const auto stamp = stamp_of(case_file);
    if (!stamp || !digest.is_complete() || !is_storable(digest)) return;
    try {
        append_line(index, line_of(*stamp, digest), Flush::later);
    } catch (const UsageError&) { // it will be read from the file
    }
}

std::string index_name(const std::string& journal_name) {
    return "index" + journal_name.substr(std::string_view("journal").size());
}

void write_record(const std::filesystem::path& path, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes) {
    const h5::Id file = h5::open_file(path, h5::Access::in_memory);
    write_groups(file.raw(), groups, attributes);
    std::string bytes = h5::image_of(file);
    append_checksum(bytes);
    write_file(path, bytes);
}

} // namespace shearwake::storage
