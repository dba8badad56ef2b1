// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
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

/// The number of values, in floating point, where the claims of a file do not overflow.
double size_of(const std::vector<hsize_t>& shape) {
    double size = 1.0;
    for (const hsize_t extent : shape)
        size *= static_cast<double>(extent);
    return size;
}

struct Axis {
    std::ptrdiff_t count;
    double first_m;
    double spacing_m;
};

Axis read_axis(hid_t file, const std::string& name) {
    const h5::Id dataset = h5::open_dataset(file, name);
    const auto shape = h5::shape(dataset);
    const double count = size_of(shape);
    const bool is_list = shape.size() == 1 || h5::has_attribute(dataset.raw(), "MATLAB_class");
    if (!is_list || shape.empty() || count == 0.0 || count > static_cast<double>(most_points) ||
        count != static_cast<double>(*std::max_element(shape.begin(), shape.end())))
        throw UsageError(
            fmt::format("{} must be a list of 1 to {} coordinates, but has the shape {}", name,
                        most_points, words(shape)));
    const std::vector<double> at_m = read_numbers(file, name, "_m").values;
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
    return {std::ssize(at_m), at_m[0], spacing_m};
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

/// The order in which a block has the axes x, y and z, and how this is known, for the user; no text
/// if the file states it or no other order fits.
struct Order {
    std::vector<std::size_t> indices;
    std::string note;
};

Order order_of(const NumberBlock& block, const std::vector<std::size_t>& expected) {
    Order order{{0, 1, 2}, ""};
    if (block.is_of_matlab) return order;
    if (std::is_permutation(block.scales.begin(), block.scales.end(), axes.begin(), axes.end())) {
        for (std::size_t axis = 0; axis < axes.size(); ++axis)
            order.indices[axis] = static_cast<std::size_t>(
                std::ranges::find(block.scales, axes[axis]) - block.scales.begin());
        return order;
    }
    const std::vector<std::size_t> reversed(expected.rbegin(), expected.rend());
    if (block.shape != expected && block.shape == reversed)
        return {{2, 1, 0},
                "its arrays have the order (z, y, x), as h5write of MATLAB stores (x, y, z)"};
    if (expected == reversed && expected[0] > 1)
        order.note = "the order (x, y, z) of its indices is assumed, since x and z have the same "
                     "number of points; h5write of MATLAB would store (z, y, x)";
    return order;
}

void read_property(hid_t file, const Property& property, MaterialMap& map, std::string& note) {
    const auto shape = h5::shape(h5::open_dataset(file, property.name));
    const std::vector<std::size_t> expected(map.counts.begin(), map.counts.end());
    const auto refuse = [&] {
        throw UsageError(
            fmt::format("{} has the shape {}, but x_m, y_m and z_m have {}, {} and {} coordinates",
                        property.name, words(shape), map.counts[0], map.counts[1], map.counts[2]));
    };
    if (shape.size() != 3 || size_of(shape) != size_of({expected.begin(), expected.end()}))
        refuse();
    NumberBlock block = read_numbers(file, property.name, unit_of(property.name)->suffix);
    const Order order = order_of(block, expected);
    if (note.empty()) note = order.note;
    if (!std::ranges::is_sorted(order.indices)) block = with_indices(block, order.indices);
    if (block.shape != expected) refuse();
    map.*property.values = std::move(block.values);
    check_values(map.*property.values, property, map);
}

/// The points and extents of a map, and the range of each property with its mean at up to five
/// depths.
std::string contents_text(const MaterialMap& map) {
    constexpr std::ptrdiff_t most_depths = 5;
    const std::array first_m = {map.origin_m.x, map.origin_m.y, map.origin_m.z},
                     spacing_m = {map.spacing_m.x, map.spacing_m.y, map.spacing_m.z};
    std::string text = fmt::format("{} points", fmt::join(map.counts, " x "));
    for (std::size_t axis = 0; axis < 3; ++axis)
        text += fmt::format(
            ", {} {:.6g} to {:.6g} mm", "xyz"[axis], milli(first_m[axis]),
            milli(first_m[axis] + static_cast<double>(map.counts[axis] - 1) * spacing_m[axis]));
    for (const Property& property : properties) {
        const std::vector<double>& values = map.*property.values;
        if (values.empty()) continue;
        const auto [low, high] = std::ranges::minmax(values);
        text += fmt::format("; {} {:.6g} to {:.6g}, mean by depth:", property.name, low, high);
        const std::ptrdiff_t last = map.counts[2] - 1, shown = std::min(last, most_depths - 1);
        for (std::ptrdiff_t n = 0; n <= shown; ++n) {
            const std::ptrdiff_t k = shown == 0 ? 0 : n * last / shown;
            double sum = 0.0, count = 0.0;
            for (auto at = k; at < std::ssize(values); at += map.counts[2], ++count)
                sum += values[static_cast<std::size_t>(at)];
            text += fmt::format("{} {:.6g} at {:.6g} mm", n == 0 ? "" : ",", sum / count,
                                milli(first_m[2] + static_cast<double>(k) * spacing_m[2]));
        }
    }
    return text;
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
    std::string note;
    for (const Property& property : properties)
        if (std::find(names.begin(), names.end(), property.name) != names.end())
            read_property(file, property, map, note);
    if (names.size() == axes.size())
        throw UsageError("it contains none of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s");
    map.contents = contents_text(map) + (note.empty() ? "" : "; " + note);
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
    map.contents = comm.broadcast(std::move(map.contents));
    return map;
}

} // namespace shearwake::storage
