// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/machine.hpp"

#include "base/cache.hpp"
#include "base/error.hpp"
#include "base/work_clock.hpp"
#include "pipeline/provenance.hpp"
#include "simd/instruction_set.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace shearwake::cost {

namespace {

using Json = nlohmann::ordered_json;

/// Rejects values that an edited file could contain and that would make estimates meaningless.
double positive(const Json& value) {
    const double number = value;
    if (!std::isfinite(number) || number <= 0.0) throw Error("not positive");
    return number;
}

/// Determined once, since it queries the version of HDF5, which must not be called from several
/// threads.
const std::string& program() {
    static const std::string text = pipeline::version_text();
    return text;
}

std::string text_of(const Machine& machine) {
    Json json;
    json["processor"] = processor_key();
    json["program"] = program();
    json["measured"] = machine.measured;
    json["message_s"] = machine.message_s;
    json["transposed_B_s"] = machine.transposed_B_s;
    json["file_s"] = machine.file_s;
    json["written_B_s"] = machine.written_B_s;
    json["rates_s"] = machine.rates;
    return json.dump(1) + "\n";
}

/// The inverse of text_of(). Throws if the text is malformed or was written for another processor
/// or by another version of the program.
Machine machine_in(const std::string& text) {
    const Json json = Json::parse(text);
    if (json.at("processor") != processor_key() || json.at("program") != program())
        throw Error("written for another processor or by another version of the program");
    Machine machine{.rates = {},
                    .message_s = positive(json.at("message_s")),
                    .transposed_B_s = positive(json.at("transposed_B_s")),
                    .file_s = positive(json.at("file_s")),
                    .written_B_s = positive(json.at("written_B_s")),
                    .measured = json.at("measured")};
    for (const auto& [kind, rate_s] : json.at("rates_s").items())
        machine.rates[kind] = positive(rate_s);
    return machine;
}

} // namespace

std::optional<std::filesystem::path> machine_file(int ranks) {
    return cache_file(fmt::format("machine-{}-{}-{}.json", processor_key(),
                                  simd::name_of(simd::instruction_set()), ranks));
}

Machine read_machine(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return {};
    try {
        return machine_in(storage::read_file(file));
    } catch (const std::exception&) {
        return {};
    }
}

bool keep_machine(const Machine& machine, const std::filesystem::path& file) {
    Machine all = machine;
    all.rates.merge(read_machine(file).rates); // that other processes have added meanwhile
    return replace_cached(file, text_of(all));
}

Machine known_machine(int ranks, const Comm& world) {
    const auto file = machine_file(ranks);
    return machine_of_root(world.is_root() && file ? read_machine(*file) : Machine{}, world);
}

Machine machine_of_root(const Machine& machine, const Comm& world) {
    const std::string text = world.broadcast(world.is_root() ? text_of(machine) : "");
    // Processors may differ between hosts, so the processor is not compared: rank 0 decides.
    const Json json = Json::parse(text);
    return {.rates = json.at("rates_s"),
            .message_s = json.at("message_s"),
            .transposed_B_s = json.at("transposed_B_s"),
            .file_s = json.at("file_s"),
            .written_B_s = json.at("written_B_s"),
            .measured = json.at("measured")};
}

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
