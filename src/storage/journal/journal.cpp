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
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <unistd.h>

namespace shearwake::storage {
namespace {

using Json = nlohmann::ordered_json;

double unix_time_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

JsonLine event(std::string_view name) {
    JsonLine line;
    line.add("v", 2).add("event", name).add("time", timestamp());
    line.add("unix_s", unix_time_s()).add("host", host_name());
    return line;
}

void add_line(const Json& line, JournalContents& contents) {
    const std::string name = line.at("event");
    if (name == "damaged") return; // the case is recomputed, which other lines record
    if (name == "run_ended") {
        contents.runs.clear();
        return;
    }
    if (name == "run_started") {
        contents.overrides = line.value("overrides", std::vector<std::string>{});
        contents.resumed_by = line.value("resumed_by", std::string());
        contents.unix_time_s = line.at("unix_s");
        contents.teams = line.value("teams", 1);
        contents.runs[line.value("run", "")] = contents.teams;
        return;
    }
    if (!line.contains("id")) return; // of another version of the program
    CaseHistory& history = contents.cases[line.at("id").get<std::string>()];
    history.host = line.at("host");
    history.unix_time_s = line.at("unix_s");
    if (name == "started") {
        history.state = CaseHistory::State::started;
    } else if (name == "finished") {
        history.state = CaseHistory::State::finished;
        history.seconds = line.value("seconds", 0.0);
    } else if (name == "failed") {
        history.state = CaseHistory::State::failed;
        history.reason = line.at("reason");
        history.cause = line.at("blame") == "files" ? Cause::files : Cause::case_itself;
    }
}

} // namespace

Journal::Journal(std::filesystem::path path) : path_(std::move(path)) {}

void Journal::run_started(const RunStart& start) const {
    JsonLine line = event("run_started");
    line.add("run", start.run);
    line.add("ranks", start.ranks);
    line.add("teams", start.teams);
    line.add("cases_left", start.cases_left);
    line.add("git_id", start.git_id);
    line.add("kernels", start.kernels);
    if (start.allow_mixed) line.add("allow_mixed", true);
    if (!start.overrides.empty()) line.add("overrides", start.overrides);
    if (!start.resumed_by.empty()) line.add("resumed_by", start.resumed_by);
    append_line(path_, seal(line.text()));
}

void Journal::run_ended(const std::string& how) const {
    JsonLine line = event("run_ended");
    line.add("how", how);
    append_line(path_, seal(line.text()));
}

void Journal::started(const std::string& id, int ranks) const {
    JsonLine line = event("started");
    line.add("id", id);
    line.add("ranks", ranks);
    append_line(path_, seal(line.text()), Flush::later);
}

void Journal::checkpointed(const std::string& id, long step) const {
    JsonLine line = event("checkpointed");
    line.add("id", id);
    line.add("step", step);
    append_line(path_, seal(line.text()));
}

void Journal::resumed(const std::string& id, long step) const {
    JsonLine line = event("resumed");
    line.add("id", id);
    line.add("step", step);
    append_line(path_, seal(line.text()));
}

void Journal::finished(const std::string& id, double seconds, const std::string& engine,
                       const std::string& checksum) const {
    JsonLine line = event("finished");
    line.add("id", id);
    line.add("seconds", seconds);
    line.add("engine", engine);
    if (!checksum.empty()) line.add(recorded_checksum, checksum);
    append_line(path_, seal(line.text()), Flush::later);
}

void Journal::failed(const std::string& id, const std::string& reason, Cause cause) const {
    JsonLine line = event("failed");
    line.add("id", id);
    line.add("blame", cause == Cause::files ? "files" : "case");
    line.add("reason", reason);
    append_line(path_, seal(line.text()));
}

void Journal::damaged(const std::string& id, const std::string& reason) const {
    JsonLine line = event("damaged");
    line.add("id", id);
    line.add("reason", reason);
    append_line(path_, seal(line.text()));
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
        } catch (const nlohmann::json::exception&) {
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
