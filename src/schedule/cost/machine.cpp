// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/machine.hpp"

#include "base/cache.hpp"
#include "base/error.hpp"
#include "pipeline/provenance.hpp"
#include "simd/instruction_set.hpp"
#include "storage/files.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

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

} // namespace shearwake::cost
