// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/file_speed.hpp"

#include "base/clock.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <fmt/format.h>
#include <limits>
#include <unistd.h>

namespace shearwake::cost {
namespace {

namespace fs = std::filesystem;

constexpr int cases = 5;
constexpr std::size_t block_B = std::size_t{1} << 25;

/// The shorter of two measurements.
double best_s(const auto& task) {
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2; ++i) {
        const auto began = Clock::now();
        task();
        best = std::min(best, seconds_since(began));
    }
    return best;
}

/// A folder that is removed on destruction.
struct TemporaryFolder {
    fs::path path;
    explicit TemporaryFolder(fs::path folder) : path(std::move(folder)) {
        storage::make_directory(path);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

/// Writes journal, file and index of a case without solving it.
void write_case(const fs::path& folder, const storage::Journal& journal, const std::string& id,
                const Comm& alone) {
    const fs::path file = folder / (id + ".h5");
    std::vector<Variable> scalars;
    for (int v = 0; v < 40; ++v)
        scalars.push_back({.name = fmt::format("scalar_{}", v),
                           .dimensions = {},
                           .values = {1.0},
                           .units = "1",
                           .long_name = "a scalar",
                           .note = ""});
    journal.started(id, 1);
    storage::CaseFileWriter(file, alone, {})
        .commit({{"", scalars}},
                {{"case_id", id}, {"title", id}, {"status", std::string("complete")}});
    journal.finished(id, {});
    storage::add_to_index(folder / storage::index_name(storage::journal_name("")), file);
}

} // namespace

void measure_files(const fs::path& where, const Comm& alone, Machine& machine) {
    const TemporaryFolder folder(where / fmt::format("shearwake-bench-{}", ::getpid()));
    const storage::Journal journal(folder.path / storage::journal_name(""));
    int number = 0;
    const double cases_s = best_s([&] {
        for (int i = 0; i < cases; ++i)
            write_case(folder.path, journal, std::to_string(number++), alone);
    });
    const std::string block(block_B, 'x');
    const double block_s = best_s([&] { storage::write_file(folder.path / "block", block); });
    machine.file_s = cases_s / cases;
    machine.written_B_s = static_cast<double>(block_B) / block_s;
}

} // namespace shearwake::cost
