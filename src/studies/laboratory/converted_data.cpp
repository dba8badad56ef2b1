// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/converted_data.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace shearwake::laboratory {
namespace {

using Json = nlohmann::ordered_json;

std::filesystem::path description_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".json";
}

std::filesystem::path numbers_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".f64";
}

template <class Read>
ConvertedData read_description(const std::filesystem::path& prefix, const Read& read) {
    const std::filesystem::path file = description_file(prefix);
    try {
        const Json root = Json::parse(storage::read_file(file));
        ConvertedData data;
        data.data = root.at("data").get<std::string>();
        data.sha256 = root.at("sha256").get<std::string>();
        data.notes = root.at("notes").get<std::vector<std::string>>();
        data.rate_Hz = root.at("rate_Hz").get<double>();
        data.noise_m_s = root.at("noise_m_s").get<double>();
        read(root, data);
        return data;
    } catch (const Json::exception& error) {
        throw UsageError(fmt::format("{} is not a converted scan: {}", file.string(), error.what()),
                         ExitCode::environment);
    }
}

Vec2 vec2(const Json& pair) {
    return {pair.at(0).get<double>(), pair.at(1).get<double>()};
}

} // namespace

ConvertedData read_surface(const std::filesystem::path& prefix) {
    return read_description(prefix, [](const Json& root, ConvertedData& data) {
        data.repetitions = root.at("repetitions").get<std::size_t>();
        data.covered_from_m = vec2(root.at("covered_from_m"));
        data.covered_to_m = vec2(root.at("covered_to_m"));
    });
}

ConvertedData read_velocities(const std::filesystem::path& prefix) {
    return read_description(prefix, [](const Json& root, ConvertedData& data) {
        const auto x = root.at("x_m").get<std::vector<double>>(),
                   y = root.at("y_m").get<std::vector<double>>();
        for (std::size_t n = 0; n < x.size(); ++n)
            data.points_m.push_back({x[n], y.at(n)});
        data.samples = root.at("samples").get<std::size_t>();
        data.start_s = root.at("start_s").get<double>();
        data.delay_s = root.at("delay_s").get<double>();
        const Json& along = root.at("direction");
        data.direction = {along.at(0).get<double>(), along.at(1).get<double>(),
                          along.at(2).get<double>()};
        data.is_line = root.at("is_line").get<bool>();
    });
}

void read_numbers(const std::filesystem::path& prefix, std::size_t first,
                  std::span<double> values) {
    const std::filesystem::path path = numbers_file(prefix);
    std::ifstream file(path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(first * sizeof(double)));
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size_bytes()));
    if (!file)
        throw UsageError(fmt::format("{} is shorter than its description states", path.string()),
                         ExitCode::environment);
}

void remove_converted(const std::filesystem::path& prefix) {
    std::error_code ignored;
    std::filesystem::remove(description_file(prefix), ignored);
    std::filesystem::remove(numbers_file(prefix), ignored);
}

} // namespace shearwake::laboratory
