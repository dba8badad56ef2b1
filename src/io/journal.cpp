#include "io/journal.hpp"

#include "io/files.hpp"

#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unistd.h>

namespace shearwake {
namespace {

using Json = nlohmann::ordered_json;

double unix_time_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

Json event(const std::string& name) {
    Json line;
    line["event"] = name;
    line["time"] = timestamp();
    line["unix_s"] = unix_time_s();
    line["host"] = host_name();
    return line;
}

/// Bytes that are no UTF-8 (a path, a system message) are replaced, never an exception.
std::string text(const Json& line) {
    return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void take(const Json& line, JournalContents& contents) {
    const std::string name = line.at("event");
    if (name == "run_started" || name == "run_ended") {
        contents.running = name == "run_started";
        if (name == "run_ended") contents.last_run_ended = line.at("how");
        if (name == "run_started")
            contents.overrides = line.value("overrides", std::vector<std::string>{});
        return;
    }
    CaseHistory& history = contents.cases[line.at("id").get<std::string>()];
    history.host = line.at("host");
    history.unix_time_s = line.at("unix_s");
    if (name == "started") {
        history.state = CaseHistory::State::started;
    } else if (name == "finished") {
        history.state = CaseHistory::State::finished;
        history.seconds = line.at("seconds");
    } else if (name == "failed") {
        history.state = CaseHistory::State::failed;
        history.reason = line.at("reason");
    }
}

} // namespace

Journal::Journal(std::filesystem::path path) : path_(std::move(path)) {}

void Journal::run_started(int ranks, int teams, std::size_t cases_left,
                          const std::vector<std::string>& overrides) const {
    Json line = event("run_started");
    line["ranks"] = ranks;
    line["teams"] = teams;
    line["cases_left"] = cases_left;
    if (!overrides.empty()) line["overrides"] = overrides;
    append_line(path_, text(line));
}

void Journal::run_ended(const std::string& how) const {
    Json line = event("run_ended");
    line["how"] = how;
    append_line(path_, text(line));
}

void Journal::started(const std::string& id, int ranks) const {
    Json line = event("started");
    line["id"] = id;
    line["ranks"] = ranks;
    append_line(path_, text(line));
}

void Journal::checkpointed(const std::string& id, long step) const {
    Json line = event("checkpointed");
    line["id"] = id;
    line["step"] = step;
    append_line(path_, text(line));
}

void Journal::resumed(const std::string& id, long step) const {
    Json line = event("resumed");
    line["id"] = id;
    line["step"] = step;
    append_line(path_, text(line));
}

void Journal::finished(const std::string& id, double seconds) const {
    Json line = event("finished");
    line["id"] = id;
    line["seconds"] = seconds;
    append_line(path_, text(line));
}

void Journal::failed(const std::string& id, const std::string& reason) const {
    Json line = event("failed");
    line["id"] = id;
    line["reason"] = reason;
    append_line(path_, text(line));
}

JournalContents read_journal(const std::filesystem::path& path) {
    JournalContents contents;
    if (!std::filesystem::exists(path)) return contents;
    std::istringstream lines(read_file(path));
    for (std::string line; std::getline(lines, line);) {
        try {
            take(Json::parse(line), contents);
        } catch (const nlohmann::json::exception&) {
            continue; // cut short
        }
    }
    return contents;
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

} // namespace shearwake
