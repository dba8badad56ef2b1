#include "io/map_file.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "io/guard.hpp"
#include "io/h5.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <new>

namespace shearwake {
namespace {

/// Every rank holds the whole map: 268 MB a property at most.
constexpr hsize_t most_points = hsize_t{1} << 25;
/// Of a spacing, within which coordinates must be regular: single precision passes.
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

void check_number_type(const h5::Id& dataset, const std::string& name) {
    const h5::Id type(H5Dget_type(dataset.raw()), H5Tclose, "look at the type of " + name);
    const H5T_class_t kind = H5Tget_class(type.raw());
    if (kind != H5T_FLOAT && kind != H5T_INTEGER) throw UsageError(name + " holds no numbers");
}

std::vector<double> read_numbers(const h5::Id& dataset, const std::string& name, hsize_t count) {
    check_number_type(dataset, name);
    std::vector<double> values(count);
    h5::check(
        H5Dread(dataset.raw(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "read " + name);
    return values;
}

struct Axis {
    std::ptrdiff_t count;
    double first_m;
    double spacing_m;
};

Axis read_axis(hid_t file, const std::string& name) {
    const h5::Id dataset = h5::open_dataset(file, name);
    const auto shape = h5::shape(dataset);
    if (shape.size() != 1 || shape[0] == 0 || shape[0] > most_points)
        throw UsageError(fmt::format("{} must be a list of 1 to {} coordinates, and has the shape "
                                     "{}",
                                     name, most_points, words(shape)));
    const auto at_m = read_numbers(dataset, name, shape[0]);
    const auto last = at_m.size() - 1;
    for (const double x_m : at_m)
        if (!std::isfinite(x_m)) throw UsageError(name + " holds a number that is not finite");
    if (last == 0) return {1, at_m[0], 0.0};
    const double spacing_m = (at_m[last] - at_m[0]) / static_cast<double>(last);
    if (!(spacing_m > 0.0) || !std::isfinite(spacing_m))
        throw UsageError(
            fmt::format("{} must ascend, and goes from {} to {}", name, at_m[0], at_m[last]));
    for (std::size_t i = 0; i <= last; ++i) {
        const double regular_m = at_m[0] + static_cast<double>(i) * spacing_m;
        if (!(std::abs(at_m[i] - regular_m) <= forgiven * spacing_m))
            throw UsageError(fmt::format("{} must be regular: number {} is {}, and {} follows from "
                                         "the first and the last one",
                                         name, i, at_m[i], regular_m));
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
                                           : "; a map holds " + quoted_list(known, "and")));
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
        throw UsageError(fmt::format("{} must be {} everywhere, and is {} at [{}, {}, {}]",
                                     property.name, property.may_be_zero ? "0 or more" : "above 0",
                                     values[n], at / (ny * nz), at / nz % ny, at % nz));
    }
}

void read_property(hid_t file, const Property& property, MaterialMap& map) {
    const h5::Id dataset = h5::open_dataset(file, property.name);
    const auto shape = h5::shape(dataset);
    const bool fits =
        shape.size() == 3 &&
        std::equal(shape.begin(), shape.end(), map.counts.begin(),
                   [](hsize_t a, std::ptrdiff_t b) { return a == static_cast<hsize_t>(b); });
    if (!fits)
        throw UsageError(fmt::format("{} has the shape {}, and x_m, y_m and z_m have {}, {} and {} "
                                     "coordinates",
                                     property.name, words(shape), map.counts[0], map.counts[1],
                                     map.counts[2]));
    auto& values = map.*property.values;
    values = read_numbers(dataset, property.name, shape[0] * shape[1] * shape[2]);
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
    // As numbers: three counts of 2^25 each would overflow no double.
    const double points =
        static_cast<double>(x.count) * static_cast<double>(y.count) * static_cast<double>(z.count);
    if (points > static_cast<double>(most_points))
        throw UsageError(fmt::format("it has {:.4g} points, and every rank holds them all: at most "
                                     "{} are possible",
                                     points, most_points));
    for (const Property& property : properties)
        if (std::find(names.begin(), names.end(), property.name) != names.end())
            read_property(file, property, map);
    if (names.size() == axes.size())
        throw UsageError("it holds none of c_s_m_s, c_p_m_s, density_kg_m3 and viscosity_Pa_s");
    return map;
}

} // namespace

MaterialMap read_map_file(const std::filesystem::path& path) {
    const std::string file = path.string();
    if (!std::filesystem::is_regular_file(path)) {
        const bool is_there = std::filesystem::exists(path);
        throw UsageError(file + (is_there ? " is no file" : " is not there"));
    }
    try {
        const auto read = [&] {
            const h5::Id owner = h5::open_file(path, h5::Access::read);
            return read_from(owner.raw());
        };
        must_survive(path, read);
        MaterialMap map = read();
        map.file = file;
        map.content_hash = hash_of(map);
        return map;
    } catch (const std::bad_alloc&) {
        throw UsageError(file + ": the memory of this machine does not hold it");
    } catch (const Error& problem) {
        throw UsageError(fmt::format("{}: {}", file, problem.what()));
    }
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

} // namespace shearwake
