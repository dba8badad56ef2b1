// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/journal.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <unistd.h>

namespace shearwake::storage {
namespace {

double unix_time_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::string event(std::string_view name, const Json& members) {
    Json line = {{"v", 2},
                 {"event", name},
                 {"time", timestamp()},
                 {"unix_s", unix_time_s()},
                 {"host", host_name()}};
    line.update(members);
    return seal(line.text());
}

void add_line(const Json& line, JournalContents& contents) {
    const auto name = line.at("event").get<std::string>();
    if (name == "damaged") return; // the case is recomputed, which other lines record
    if (name == "run_ended") {
        contents.runs.clear();
        return;
    }
    if (name == "run_started") {
        contents.overrides = line.value("overrides", std::vector<std::string>{});
        contents.resumed_by = line.value("resumed_by", std::string());
        contents.unix_time_s = line.at("unix_s").get<double>();
        contents.teams = line.value("teams", 1);
        contents.runs[line.value("run", std::string())] = contents.teams;
        return;
    }
    if (!line.contains("id")) return; // of another version of the program
    CaseHistory& history = contents.cases[line.at("id").get<std::string>()];
    history.host = line.at("host").get<std::string>();
    history.unix_time_s = line.at("unix_s").get<double>();
    if (name == "started") {
        history.state = CaseHistory::State::started;
    } else if (name == "finished") {
        history.state = CaseHistory::State::finished;
        history.seconds = line.value("seconds", 0.0);
    } else if (name == "failed") {
        history.state = CaseHistory::State::failed;
        history.reason = line.at("reason").get<std::string>();
        history.cause = line.at("blame") == "files" ? Cause::files : Cause::case_itself;
    }
}

} // namespace

Journal::Journal(std::filesystem::path path) : path_(std::move(path)) {}

void Journal::run_started(const RunStart& start) const {
    Json line = {{"run", start.run},       {"ranks", start.ranks},
                 {"teams", start.teams},   {"cases_left", start.cases_left},
                 {"git_id", start.git_id}, {"kernels", start.kernels}};
    if (start.allow_mixed) line["allow_mixed"] = true;
    if (!start.overrides.empty()) line["overrides"] = start.overrides;
    if (!start.resumed_by.empty()) line["resumed_by"] = start.resumed_by;
    append_line(path_, event("run_started", line));
}

void Journal::run_ended(const std::string& how) const {
    append_line(path_, event("run_ended", {{"how", how}}));
}

void Journal::started(const std::string& id, int ranks) const {
    append_line(path_, event("started", {{"id", id}, {"ranks", ranks}}), Flush::later);
}

void Journal::checkpointed(const std::string& id, long step) const {
    append_line(path_, event("checkpointed", {{"id", id}, {"step", step}}));
}

void Journal::resumed(const std::string& id, long step) const {
    append_line(path_, event("resumed", {{"id", id}, {"step", step}}));
}

void Journal::finished(const std::string& id, double seconds, const std::string& engine,
                       const std::string& checksum) const {
    Json line = {{"id", id}, {"seconds", seconds}, {"engine", engine}};
    if (!checksum.empty()) line[recorded_checksum] = checksum;
    append_line(path_, event("finished", line), Flush::later);
}

void Journal::failed(const std::string& id, const std::string& reason, Cause cause) const {
    const char* origin = cause == Cause::files ? "files" : "case";
    append_line(path_, event("failed", {{"id", id}, {"blame", origin}, {"reason", reason}}));
}

void Journal::damaged(const std::string& id, const std::string& reason) const {
    append_line(path_, event("damaged", {{"id", id}, {"reason", reason}}));
}

JournalContents read_journal(const std::filesystem::path& path) {
    JournalContents contents;
    if (!std::filesystem::exists(path)) return contents;
    std::istringstream lines(read_file(path));
    for (std::string text; next_line(lines, text);) {
        if (text.empty()) continue;
        const std::optional<std::string> line = unseal(text);
        try {
            if (line)
                add_line(Json::parse(*line), contents);
            else
                ++contents.unreadable_lines;
        } catch (const JsonError&) {
            ++contents.unreadable_lines;
        }
    }
    return contents;
}

std::string journal_name(const std::string& run, const std::string& host) {
    return fmt::format("journal.{}{}{}.jsonl", run, host.empty() ? "" : "@", host);
}

JournalContents read_journals(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& name : names_in(folder)) // a missing folder has none
        if (name.starts_with("journal") && name.ends_with(".jsonl") && !is_stray(name))
            paths.push_back(folder / name);
    std::ranges::sort(paths); // gives a deterministic order
    JournalContents all;
    for (const auto& path : paths) {
        JournalContents one = read_journal(path);
        for (auto& [id, history] : one.cases) {
            const auto known = all.cases.find(id);
            if (known == all.cases.end() || known->second.unix_time_s <= history.unix_time_s)
                all.cases[id] = std::move(history);
        }
        all.runs.merge(one.runs);
        all.unreadable_lines += one.unreadable_lines;
        if (one.unix_time_s >= all.unix_time_s) {
            all.overrides = std::move(one.overrides);
            all.resumed_by = std::move(one.resumed_by);
            all.unix_time_s = one.unix_time_s;
            all.teams = one.teams;
        }
    }
    return all;
}

std::string host_name() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string timestamp() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&now, &utc);
    char buffer[32];
    std::strftime(buffer, sizeof buffer, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return buffer;
}

} // namespace shearwake::storage
