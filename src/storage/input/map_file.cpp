// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/map_file.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <hdf5.h>
#include <utility>

namespace shearwake::storage {
namespace {

/// Every rank stores the whole map: at most 268 MB per property.
constexpr std::size_t most_points = std::size_t{1} << 25;
/// Tolerance of uniform coordinates, relative to the spacing: single precision is accepted.
constexpr double forgiven = 1e-3;

struct Property {
    const char* name;
    std::vector<double> MaterialMap::*values;
    bool may_be_zero;
};
constexpr std::array properties = {
    Property{"c_s_m_s", &MaterialMap::c_s_m_s, false},
    Property{"c_p_m_s", &MaterialMap::c_p_m_s, false},
    Property{"density_kg_m3", &MaterialMap::density_kg_m3, false},
    Property{"viscosity_Pa_s", &MaterialMap::viscosity_Pa_s, true},
};
constexpr std::array<const char*, 3> axes = {"x_m", "y_m", "z_m"};

std::string words(const std::vector<hsize_t>& shape) {
    return fmt::format("({})", fmt::join(shape, ", "));
}

struct Axis {
    std::ptrdiff_t count;
    double first_m;
    double spacing_m;
};

Axis read_axis(hid_t file, const std::string& name) {
    const auto shape = h5::shape(h5::open_dataset(file, name));
    if (shape.size() != 1 || shape[0] == 0 || shape[0] > most_points)
        throw UsageError(
            fmt::format("{} must be a list of 1 to {} coordinates, but has the shape {}", name,
                        most_points, words(shape)));
    const std::vector<double> at_m = read_numbers(file, name).values;
    const auto last = at_m.size() - 1;
    for (const double x_m : at_m)
        if (!std::isfinite(x_m)) throw UsageError(name + " contains a number that is not finite");
    if (last == 0) return {1, at_m[0], 0.0};
    const double spacing_m = (at_m[last] - at_m[0]) / static_cast<double>(last);
    if (!(spacing_m > 0.0) || !std::isfinite(spacing_m))
        throw UsageError(fmt::format("{} must be in ascending order, but goes from {} to {}", name,
                                     at_m[0], at_m[last]));
    for (std::size_t i = 0; i <= last; ++i) {
        const double regular_m = at_m[0] + static_cast<double>(i) * spacing_m;
        if (!(std::abs(at_m[i] - regular_m) <= forgiven * spacing_m))
            throw UsageError(
                fmt::format("{} must be uniformly spaced: number {} is {}, expected {}", name, i,
                            at_m[i], regular_m));
    }
    return {static_cast<std::ptrdiff_t>(shape[0]), at_m[0], spacing_m};
}

void check_names(const std::vector<std::string>& names) {
    std::vector<std::string> known(axes.begin(), axes.end());
    for (const Property& property : properties)
        known.emplace_back(property.name);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        const auto meant = name.size() < 60 ? nearest(name, known) : std::nullopt;
        throw UsageError(fmt::format("the dataset \"{:.60}\" is unknown{}", name,
                                     meant ? fmt::format("; did you mean {}?", *meant)
                                           : "; a map contains " + quoted_list(known, "and")));
    }
    for (const char* axis : axes)
        if (std::find(names.begin(), names.end(), axis) == names.end())
            throw UsageError(fmt::format("the coordinates {} are missing", axis));
}

void check_values(const std::vector<double>& values, const Property& property,
                  const MaterialMap& map) {
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (std::isfinite(values[n]) &&
            (values[n] > 0.0 || (property.may_be_zero && values[n] == 0.0)))
            continue;
        const auto at = static_cast<std::ptrdiff_t>(n), nz = map.counts[2], ny = map.counts[1];
        throw UsageError(fmt::format("{} must be {} everywhere, but is {} at [{}, {}, {}]",
                                     property.name, property.may_be_zero ? "0 or more" : "above 0",
                                     values[n], at / (ny * nz), at / nz % ny, at % nz));
    }
}

void read_property(hid_t file, const Property& property, MaterialMap& map) {
    const auto shape = h5::shape(h5::open_dataset(file, property.name));
    const bool fits = shape.size() == 3 &&
                      std::equal(shape.begin(), shape.end(), map.counts.begin(),
                                 [](hsize_t a, std::ptrdiff_t b) { return std::cmp_equal(a, b); });
    if (!fits)
        throw UsageError(
            fmt::format("{} has the shape {}, but x_m, y_m and z_m have {}, {} and {} coordinates",
                        property.name, words(shape), map.counts[0], map.counts[1], map.counts[2]));
    auto& values = map.*property.values;
    values = read_numbers(file, property.name).values;
    check_values(values, property, map);
}

MaterialMap read_from(hid_t file) {
    const std::vector<std::string> names = h5::dataset_names(file);
    check_names(names);
    MaterialMap map;
    const Axis x = read_axis(file, axes[0]), y = read_axis(file, axes[1]),
               z = read_axis(file, axes[2]);
    map.counts = {x.count, y.count, z.count};
    map.origin_m = {x.first_m, y.first_m, z.first_m};
    map.spacing_m = {x.spacing_m, y.spacing_m, z.spacing_m};
    // Computed in floating point: three counts of up to 2^25 do not overflow a double.
    const double points =
        static_cast<double>(x.count) * static_cast<double>(y.count) * static_cast<double>(z.count);
    if (points > static_cast<double>(most_points))
        throw UsageError(fmt::format("it has {:.4g} points, but at most {} are supported, since "
                                     "every rank stores all of them",
                                     points, most_points));
    for (const Property& property : properties)
        if (std::find(names.begin(), names.end(), property.name) != names.end())
            read_property(file, property, map);
    if (names.size() == axes.size())
        throw UsageError("it contains none of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s");
    return map;
}

} // namespace

MaterialMap read_map_file(const std::filesystem::path& path) {
    MaterialMap map = read_user_file(path, read_from);
    map.file = path.string();
    map.content_hash = hash_of(map);
    return map;
}

MaterialMap read_map_file(const std::filesystem::path& path, const Comm& comm) {
    MaterialMap map;
    on_root(comm, [&] { map = read_map_file(path); });
    map.file = path.string();
    std::vector<double> frame = {map.origin_m.x,  map.origin_m.y,  map.origin_m.z,
                                 map.spacing_m.x, map.spacing_m.y, map.spacing_m.z};
    comm.broadcast(frame);
    map.origin_m = {frame[0], frame[1], frame[2]};
    map.spacing_m = {frame[3], frame[4], frame[5]};
    for (std::ptrdiff_t& count : map.counts)
        count = comm.broadcast(static_cast<long>(count));
    for (const Property& property : properties)
        comm.broadcast(map.*property.values);
    map.content_hash = comm.broadcast(std::move(map.content_hash));
    return map;
}

} // namespace shearwake::storage
