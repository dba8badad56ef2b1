#include "sweep/machine.hpp"

#include "base/error.hpp"
#include "fft/wisdom.hpp"
#include "io/files.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace shearwake {
namespace {

using Json = nlohmann::ordered_json;

/// Whoever edits the file must not make plans of nonsense.
double positive(const Json& json, const char* key) {
    const double value = json.at(key);
    if (!std::isfinite(value) || value <= 0.0) throw Error("not positive");
    return value;
}

} // namespace

std::optional<std::filesystem::path> machine_file() {
    const auto wisdom = wisdom_file("");
    if (!wisdom) return std::nullopt;
    return wisdom->parent_path() / "machine.json";
}

Machine known_machine() {
    const auto file = machine_file();
    std::error_code ignored;
    if (!file || !std::filesystem::exists(*file, ignored)) return {};
    try {
        const Json json = Json::parse(read_file(*file));
        return {.layered_factor = positive(json, "layered_factor"),
                .spectral_factor = positive(json, "spectral_factor"),
                .message_s = positive(json, "message_s"),
                .transposed_B_s = positive(json, "transposed_B_s"),
                .file_s = positive(json, "file_s"),
                .written_B_s = positive(json, "written_B_s"),
                .measured = json.at("measured")};
    } catch (const std::exception&) {
        return {};
    }
}

Machine machine_of_root(const Comm& world) {
    const Machine mine = world.is_root() ? known_machine() : Machine{};
    std::array<double, 6> values = {mine.layered_factor, mine.spectral_factor, mine.message_s,
                                    mine.transposed_B_s, mine.file_s,          mine.written_B_s};
    for (double& value : values)
        value = world.max(world.is_root() ? value : 0.0);
    return {values[0],
            values[1],
            values[2],
            values[3],
            values[4],
            values[5],
            world.broadcast(mine.measured)};
}

void write_machine(const Machine& machine, const std::filesystem::path& file) {
    make_directory(file.parent_path());
    Json json;
    json["measured"] = machine.measured;
    json["layered_factor"] = machine.layered_factor;
    json["spectral_factor"] = machine.spectral_factor;
    json["message_s"] = machine.message_s;
    json["transposed_B_s"] = machine.transposed_B_s;
    json["file_s"] = machine.file_s;
    json["written_B_s"] = machine.written_B_s;
    write_file(file, json.dump(1) + "\n");
}

} // namespace shearwake
