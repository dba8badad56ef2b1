// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <unistd.h>

namespace shearwake::app {
namespace {

struct VerifyArguments {
    std::filesystem::path folder;
    bool json = false;
    bool quiet = false;
};

struct Verified {
    std::vector<const storage::CaseDigest*> damaged;
    std::vector<std::string> missing; // ids of planned cases without a file
    std::size_t files = 0;
    double bytes = 0.0, seconds = 0.0;
    std::string plan_damage;                 // empty: intact
    long journal_lines = 0, index_lines = 0; // that are ignored

    bool is_sound() const { return damaged.empty() && plan_damage.empty(); }
};

/// Shows the progress: one line that is redrawn on a terminal, elsewhere a line every ten seconds.
class VerifyLine {
public:
    explicit VerifyLine(bool quiet) : quiet_(quiet), live_(::isatty(STDERR_FILENO) != 0) {}
    ~VerifyLine() {
        if (drawn_ && live_) fmt::print(stderr, "\r\x1b[K");
    }
    VerifyLine(const VerifyLine&) = delete;
    VerifyLine& operator=(const VerifyLine&) = delete;

    void show(const storage::VerifyProgress& p) {
        const double since = seconds_since(last_);
        if (quiet_ || since < (live_ ? 0.25 : 10.0)) return;
        last_ = Clock::now();
        drawn_ = true;
        const double passed_s = seconds_since(began_);
        fmt::print(stderr, "{}{}/{} files, {:.2f}/{:.2f} GB, {:.2f} GB/s, {:.0f} s remaining{}",
                   live_ ? "\r\x1b[K" : "", p.files, p.all_files, p.bytes / 1e9, p.all_bytes / 1e9,
                   p.bytes / passed_s / 1e9,
                   schedule::time_left_s(passed_s, p.bytes, p.all_bytes).value_or(0.0),
                   live_ ? "" : "\n");
        std::fflush(stderr);
    }

private:
    bool quiet_, live_, drawn_ = false;
    Clock::time_point began_ = Clock::now(), last_ = began_;
};

Verified verify(const schedule::OutputFolder& folder, storage::CaseIndex& index) {
    const auto began = Clock::now();
    Verified v;
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder.cases(), ignored))
        throw UsageError(
            fmt::format("{} is not an output folder: it contains no folder named cases",
                        folder.root.string()),
            ExitCode::environment);
    std::vector<std::string> planned;
    try {
        for (storage::IndexedCase& c : storage::read_plan(folder.plan()).cases)
            planned.push_back(std::move(c.id));
    } catch (const UsageError& error) {
        v.plan_damage = error.what();
    }
    for (const auto& [id, digest] : index.all()) {
        ++v.files;
        if (!digest.is_complete()) v.damaged.push_back(&digest);
    }
    for (const std::string& id : planned)
        if (!index.find(id)) v.missing.push_back(id);
    v.journal_lines = storage::read_journals(folder.root).unreadable_lines;
    v.index_lines = index.lines_skipped();
    v.bytes = index.verified_B();
    v.seconds = seconds_since(began);
    return v;
}

std::string json_of(const schedule::OutputFolder& folder, const Verified& v) {
    nlohmann::ordered_json root;
    root["folder"] = folder.root.string();
    root["sound"] = v.is_sound();
    root["files"] = v.files;
    root["bytes"] = v.bytes;
    root["seconds"] = v.seconds;
    root["damaged"] = nlohmann::ordered_json::array();
    for (const storage::CaseDigest* digest : v.damaged)
        root["damaged"].push_back({{"id", digest->id}, {"reason", digest->damage}});
    root["not_computed"] = v.missing;
    root["plan"] = v.plan_damage.empty() ? "sound" : v.plan_damage;
    root["journal_lines_passed_over"] = v.journal_lines;
    root["index_lines_passed_over"] = v.index_lines;
    return json_document("verify", root);
}

void print(const Verified& v) {
    for (const storage::CaseDigest* digest : v.damaged)
        fmt::print("damaged {}: {}\n", digest->id, digest->damage);
    if (!v.plan_damage.empty()) fmt::print("damaged: {}\n", v.plan_damage);
    if (v.journal_lines > 0)
        fmt::print("{} lines of the journals are damaged or truncated, for example by a killed "
                   "run: they are ignored\n",
                   v.journal_lines);
    if (v.index_lines > 0)
        fmt::print("{} lines of the index do not match their checksums: the case files are read "
                   "instead\n",
                   v.index_lines);
    fmt::print("{} case files, {:.3f} GB in {:.2f} s ({:.2f} GB/s): {} damaged, {} of the plan not "
               "computed\n",
               v.files, v.bytes / 1e9, v.seconds, v.bytes / 1e9 / std::max(v.seconds, 1e-9),
               v.damaged.size(), v.missing.size());
    if (!v.damaged.empty())
        fmt::print("next: rerun the job; it moves damaged files to failed/ and computes their "
                   "cases again\n");
}

ExitCode verify_command(const VerifyArguments& arguments, const Comm& world) {
    bool is_sound = true;
    on_root(world, [&] {
        const schedule::OutputFolder folder = schedule::folder_of_results(arguments.folder);
        Verified verified;
        std::optional<VerifyLine> line(arguments.quiet);
        storage::CaseIndex index(
            folder.root, storage::CaseIndex::Trust::checksum,
            [&](const storage::VerifyProgress& progress) { line->show(progress); });
        verified = verify(folder, index);
        line.reset();
        if (arguments.json)
            fmt::print("{}", json_of(folder, verified));
        else if (!arguments.quiet || !verified.is_sound())
            print(verified);
        is_sound = verified.is_sound();
        index.save(); // so that the next run recomputes the damaged cases
    });
    return world.broadcast(is_sound) ? ExitCode::done : ExitCode::some_cases_failed;
}

} // namespace

void add_verify(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<VerifyArguments>(
        app, action, "verify",
        "check case files, plan, journals and index against their checksums; exit 4 "
        "if any of them is damaged",
        verify_command);
    command.add_option("DIR", arguments.folder, "output folder of a run")->required();
    add_json(command, arguments.json);
    command.add_flag("--quiet", arguments.quiet, "print only errors");
}

} // namespace shearwake::app
