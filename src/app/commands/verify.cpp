// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <unistd.h>

namespace shearwake::app {
namespace {

namespace fs = std::filesystem;

struct VerifyArguments {
    fs::path folder;
    bool json = false;
    bool quiet = false;
};

/// A damaged file; `name` is its path relative to the verified folder.
struct Damage {
    std::string name, id, reason; // id: empty for files that contain no case
};

struct Verified {
    std::vector<Damage> damaged;
    std::vector<std::string> stray;
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

/// Verifies an output folder with the folders of its studies.
class Verification {
public:
    Verification(fs::path top, std::function<void(const storage::VerifyProgress&)> show)
        : top_(std::move(top)), show_(std::move(show)) {
        verify_folder(top_);
        if (!found_)
            throw UsageError(
                fmt::format("{} is not an output folder: it contains no folder named cases",
                            top_.string()),
                ExitCode::environment);
        verified_.seconds = seconds_since(began_);
    }
    const Verified& result() const { return verified_; }

private:
    /// Output folders are inside of others, and those of `evaluate` in a folder without cases.
    void verify_folder(const fs::path& folder) {
        const bool has_cases = is_folder(folder / "cases");
        found_ |= has_cases;
        if (has_cases) verify_output({folder});
        for (const char* name : {"plan.json", "converge.json", "refinements.json",
                                 "uncertainty.json", "tables/plan.json"})
            if (has_cases && exists(folder / name) && folder / name != top_ / "plan.json")
                verify_text(folder / name);
        for (const fs::path& entry : entries(folder))
            if (const std::string name = entry.filename().string();
                has_cases && storage::is_stray(name))
                verified_.stray.push_back(name_of(entry));
            else if (name == "evaluations")
                verify_predictions(entry);
            else if (name == "optimise")
                verify_optima(entry);
            else if (is_folder(entry / "cases") && !fs::is_symlink(entry))
                verify_folder(entry);
    }

    void verify_output(const schedule::OutputFolder& folder) {
        storage::CaseIndex index(folder.root, storage::CaseIndex::Trust::checksum, show_);
        for (const auto& [id, digest] : index.digests()) {
            ++verified_.files;
            if (!digest.is_complete())
                verified_.damaged.push_back({name_of(folder.case_file(id)), id, digest.damage});
        }
        for (const fs::path& entry : entries(folder.cases()))
            if (storage::is_stray(entry) ||
                (entry.extension() == ".h5" && storage::id_of_file(entry).empty()))
                verified_.stray.push_back(name_of(entry));
        if (folder.root == top_) verify_plan(folder, index);
        verified_.journal_lines += storage::read_journals(folder.root).unreadable_lines;
        verified_.index_lines += index.lines_skipped();
        verified_.bytes += index.verified_B();
        index.save(); // so that the next run recomputes the damaged cases
    }

    void verify_plan(const schedule::OutputFolder& folder, storage::CaseIndex& index) {
        try {
            for (const storage::IndexedCase& c : storage::read_plan(folder.plan()).cases)
                if (!index.find(c.id)) verified_.missing.push_back(c.id);
        } catch (const UsageError& error) {
            verified_.plan_damage = error.what();
        }
    }

    void verify_optima(const fs::path& folder) {
        for (const fs::path& entry : entries(folder))
            if (storage::is_stray(entry))
                verified_.stray.push_back(name_of(entry));
            else if (entry.extension() == ".json")
                verify_text(entry);
    }

    void verify_predictions(const fs::path& folder) {
        found_ = true;
        std::vector<fs::path> files;
        for (const fs::path& entry : entries(folder))
            if (storage::is_stray(entry))
                verified_.stray.push_back(name_of(entry));
            else if (!is_part(entry))
                files.push_back(entry);
        const std::vector<storage::VerifiedFile> checks = storage::verify_files(files, show_);
        for (std::size_t i = 0; i < files.size(); ++i) {
            const auto& [check, unreadable] = checks[i];
            const std::string& reason = unreadable.empty() ? check.damage : unreadable;
            if (!reason.empty()) verified_.damaged.push_back({name_of(files[i]), "", reason});
            verified_.bytes += static_cast<double>(check.bytes);
        }
    }

    void verify_text(const fs::path& file) {
        try {
            if (storage::unseal(storage::read_file(file))) return;
            verified_.damaged.push_back(
                {name_of(file), "", "it is truncated or does not match its checksum"});
        } catch (const UsageError& error) {
            verified_.damaged.push_back({name_of(file), "", error.what()});
        }
    }

    static bool is_part(const fs::path& file) {
        return file.filename().string().find(".part") != std::string::npos;
    }
    static bool is_folder(const fs::path& path) {
        std::error_code unknown;
        return fs::is_directory(path, unknown);
    }
    static bool exists(const fs::path& path) {
        std::error_code unknown;
        return fs::exists(path, unknown) || unknown; // verify_text() states the error
    }
    static std::vector<fs::path> entries(const fs::path& folder) {
        std::vector<fs::path> paths;
        std::error_code missing;
        for (const auto& entry : fs::directory_iterator(folder, missing))
            paths.push_back(entry.path());
        std::ranges::sort(paths);
        return paths;
    }
    std::string name_of(const fs::path& file) const {
        return file.lexically_relative(top_).string();
    }

    fs::path top_;
    std::function<void(const storage::VerifyProgress&)> show_;
    Verified verified_;
    bool found_ = false;
    Clock::time_point began_ = Clock::now();
};

std::string json_of(const fs::path& folder, const Verified& v) {
    Json root;
    root["folder"] = folder.string();
    root["sound"] = v.is_sound();
    root["files"] = v.files;
    root["bytes"] = v.bytes;
    root["seconds"] = v.seconds;
    root["damaged_files"] = Json::array();
    root["damaged"] = Json::array();
    for (const Damage& d : v.damaged) {
        if (!d.id.empty()) root["damaged"].push_back({{"id", d.id}, {"reason", d.reason}});
        root["damaged_files"].push_back({{"file", d.name}, {"reason", d.reason}});
    }
    root["stray_files"] = v.stray;
    root["not_computed"] = v.missing;
    root["plan"] = v.plan_damage.empty() ? "sound" : v.plan_damage;
    root["journal_lines_passed_over"] = v.journal_lines;
    root["index_lines_passed_over"] = v.index_lines;
    return json_document("verify", root);
}

void print(const Verified& v) {
    bool has_damaged_cases = false, is_study_damaged = false;
    for (const Damage& d : v.damaged) {
        fmt::print("damaged {}: {}\n", d.id.empty() ? d.name : fmt::format("{} ({})", d.id, d.name),
                   d.reason);
        (d.id.empty() ? is_study_damaged : has_damaged_cases) = true;
    }
    if (!v.plan_damage.empty()) fmt::print("damaged: {}\n", v.plan_damage);
    for (const std::string& name : v.stray)
        fmt::print("stray {}: shearwake does not give files such names, and ignores it\n",
                   printable(name));
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
    if (has_damaged_cases)
        fmt::print("next: rerun the command that wrote the cases; it moves damaged files to "
                   "failed/ and computes their cases again\n");
    if (is_study_damaged)
        fmt::print("next: remove the damaged files of the study, and rerun its command\n");
}

ExitCode verify_command(const VerifyArguments& arguments, const Comm& world) {
    bool is_sound = true;
    on_root(world, [&] {
        const fs::path folder = schedule::folder_of_results(arguments.folder).root;
        std::optional<VerifyLine> line(arguments.quiet);
        const Verified verified =
            Verification(folder, [&](const storage::VerifyProgress& progress) {
                line->show(progress);
            }).result();
        line.reset();
        if (arguments.json)
            fmt::print("{}", json_of(folder, verified));
        else if (!arguments.quiet || !verified.is_sound())
            print(verified);
        is_sound = verified.is_sound();
    });
    return world.broadcast(is_sound) ? ExitCode::done : ExitCode::some_cases_failed;
}

} // namespace

void add_verify(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<VerifyArguments>(
        app, action, "verify",
        "check the files of a run and of its studies against their checksums; exit 4 if any of "
        "them is damaged",
        verify_command);
    command.add_option("DIR", arguments.folder, "output folder of a run")->required();
    add_json(command, arguments.json);
    command.add_flag("--quiet", arguments.quiet, "print only errors");
}

} // namespace shearwake::app
