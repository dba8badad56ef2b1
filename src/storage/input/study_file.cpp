// SPDX-License-Identifier: BSD-3-Clause
#include "storage/input/input_files.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "storage/hdf5/h5.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <sstream>

namespace shearwake::storage {
namespace {

constexpr const char* schema = "shearwake grid study 1";
constexpr double most_nodes = 2147483648.0;
constexpr double most_of_a_list = 1e9;

/// A group of the file, with the names of its datasets and attributes in messages.
class Section {
public:
    Section(hid_t file, std::string name)
        : name_(std::move(name)), group_(h5::open_group(file, name_)) {}

    std::vector<double> numbers(const std::string& name) const {
        std::vector<double> values = read_numbers(group_.raw(), name).values;
        for (const double value : values)
            if (!std::isfinite(value)) fail(name, "contains a number that is not finite");
        return values;
    }
    std::vector<hsize_t> shape(const std::string& name) const {
        return h5::shape(h5::open_dataset(group_.raw(), name));
    }
    bool has(const std::string& name) const {
        const auto names = h5::dataset_names(group_.raw());
        return std::find(names.begin(), names.end(), name) != names.end();
    }
    double number(const std::string& name, double least, double most) const {
        const double value = h5::number_attribute(group_.raw(), name);
        if (!(value >= least && value <= most))
            fail(name, fmt::format("is {}, but must be between {:g} and {:g}", value, least, most));
        return value;
    }
    std::ptrdiff_t integer(const std::string& name, double least, double most) const {
        return as_integer(name, number(name, least, most));
    }
    std::string text(const std::string& name) const {
        return h5::text_attribute(group_.raw(), name);
    }
    template <class Number>
    std::array<Number, 3> triple(const std::string& name, double least, double most) const {
        const auto values = numbers(name);
        if (values.size() != 3) fail(name, "must contain three numbers: along x, y, z");
        std::array<Number, 3> result{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!(values[axis] >= least && values[axis] <= most))
                fail(name, fmt::format("contains {}, but must be between {:g} and {:g}",
                                       values[axis], least, most));
            if constexpr (std::is_integral_v<Number>)
                result[axis] = as_integer(name, values[axis]);
            else
                result[axis] = values[axis];
        }
        return result;
    }
    /// Reads indices of nodes, [n][3].
    std::vector<std::array<std::ptrdiff_t, 3>> nodes(const std::string& name,
                                                     const StudyData& study) const {
        const auto extents = shape(name);
        if (extents.size() != 2 || extents[1] != 3) fail(name, "must have the shape (nodes, 3)");
        const auto values = numbers(name);
        std::vector<std::array<std::ptrdiff_t, 3>> result(values.size() / 3);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::size_t axis = i % 3;
            if (!(values[i] >= 0.0 && values[i] < static_cast<double>(study.points[axis])))
                fail(name, fmt::format("contains a node at {} along {}, which has {} points",
                                       values[i], "xyz"[axis], study.points[axis]));
            result[i / 3][axis] = as_integer(name, values[i]);
        }
        return result;
    }
    [[noreturn]] void fail(const std::string& name, const std::string& what) const {
        throw UsageError(fmt::format("{}/{} {}", name_, name, what));
    }

private:
    std::ptrdiff_t as_integer(const std::string& name, double value) const {
        if (value != std::floor(value))
            fail(name, fmt::format("contains {}, which is not a whole number", value));
        return static_cast<std::ptrdiff_t>(value);
    }

    std::string name_;
    h5::Id group_;
};

std::size_t index_of(const Section& section, const std::string& attribute, const std::string& name,
                     std::span<const std::string> names) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        section.fail(attribute, fmt::format("refers to the field \"{:.20}\"; the fields are {}",
                                            name, fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
}

void read_grid(hid_t file, StudyData& study) {
    const Section grid(file, "grid");
    study.points = grid.triple<std::ptrdiff_t>("points", 2, 1e6);
    const double points = static_cast<double>(study.points[0]) *
                          static_cast<double>(study.points[1]) *
                          static_cast<double>(study.points[2]);
    if (points > most_nodes)
        grid.fail("points", fmt::format("result in {:.3g} nodes; at most {:.3g} are supported",
                                        points, most_nodes));
    study.spacing_m = grid.triple<double>("spacing_m", 1e-9, 1e3);
    study.time_step_s = grid.number("time_step_s", 1e-15, 1e3);
    study.steps = grid.integer("steps", 1, 1e9);
    const Section layer(file, "layer");
    study.layer_points = layer.triple<std::ptrdiff_t>("points", 0, 1e6);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (2 * study.layer_points[axis] > study.points[axis])
            layer.fail("points",
                       fmt::format("an absorbing layer of {} points on both sides does not fit "
                                   "into {} points along {}",
                                   study.layer_points[axis], study.points[axis], "xyz"[axis]));
    study.layer_strength = layer.triple<double>("strength", 0.0, 1e3);
    study.layer_ratio = layer.number("ratio", 0.0, 10.0);
    study.layer_speed_m_s = layer.number("speed_m_s", 0.0, 1e6);
}

/// A property of the medium: its dataset, its field in k-Wave and its range.
struct Dataset {
    const char *name, *kwave_field;
    double least;
};

std::vector<double> read_property(const Section& medium, const Dataset& property,
                                  std::size_t nodes) {
    auto values = medium.numbers(property.name);
    if (values.size() != 1 && values.size() != nodes)
        medium.fail(property.name, fmt::format("contains {} values, but must contain one, or one "
                                               "for each of {} nodes",
                                               values.size(), nodes));
    for (const double value : values)
        if (value < property.least)
            medium.fail(property.name, fmt::format("is {} somewhere, but must be at least {:g} (in "
                                                   "k-Wave: medium.{})",
                                                   value, property.least, property.kwave_field));
    return values;
}

double at_node(const std::vector<double>& values, std::size_t node) {
    return values[values.size() == 1 ? 0 : node];
}

/// Shear waves must not be faster than compressional waves, and losses must not amplify them.
void check_medium(const Section& medium, const StudyData& study) {
    const std::size_t nodes = std::max(
        {study.c_p_m_s.size(), study.c_s_m_s.size(), study.eta_Pa_s.size(), study.chi_Pa_s.size()});
    for (std::size_t n = 0; n < nodes; ++n) {
        const double c_p_m_s = at_node(study.c_p_m_s, n), c_s_m_s = at_node(study.c_s_m_s, n);
        if (c_s_m_s > c_p_m_s)
            medium.fail("c_s_m_s",
                        fmt::format("is {} where c_p is {}: shear waves must be slower than "
                                    "compressional waves (in k-Wave: medium.sound_speed_shear and "
                                    "medium.sound_speed_compression)",
                                    c_s_m_s, c_p_m_s));
        if (!study.lossy()) continue;
        const double eta_Pa_s = at_node(study.eta_Pa_s, n), chi_Pa_s = at_node(study.chi_Pa_s, n);
        if (chi_Pa_s + 2.0 * eta_Pa_s < -1e-9 * eta_Pa_s)
            medium.fail("chi_Pa_s", fmt::format("is {} where eta is {}: compressional waves would "
                                                "be amplified (in k-Wave: "
                                                "medium.alpha_coeff_compression)",
                                                chi_Pa_s, eta_Pa_s));
    }
}

void read_medium(hid_t file, StudyData& study) {
    const Section medium(file, "medium");
    const auto read = [&](const Dataset& property) {
        return read_property(medium, property, study.size());
    };
    study.density_kg_m3 = read({"density_kg_m3", "density", 1e-9});
    study.c_p_m_s = read({"c_p_m_s", "sound_speed_compression", 0.0});
    study.c_s_m_s = read({"c_s_m_s", "sound_speed_shear", 0.0});
    if (medium.has("eta_Pa_s") || medium.has("chi_Pa_s")) {
        study.eta_Pa_s = read({"eta_Pa_s", "alpha_coeff_shear", 0.0});
        study.chi_Pa_s = read({"chi_Pa_s", "alpha_coeff_compression", -1e300});
    }
    check_medium(medium, study);
}

NodeSource read_source(hid_t file, const std::string& name, const StudyData& study) {
    const Section section(file, name);
    NodeSource source;
    const std::vector<std::string> fields(grid_fields.begin(), grid_fields.end());
    source.field = index_of(section, "field", section.text("field"), fields);
    const std::string mode = section.text("mode");
    if (mode != "additive" && mode != "dirichlet")
        section.fail("mode", fmt::format("is \"{:.20}\", but must be additive or dirichlet", mode));
    source.dirichlet = mode == "dirichlet";
    source.nodes = section.nodes("nodes", study);
    std::set<std::array<std::ptrdiff_t, 3>> seen(source.nodes.begin(), source.nodes.end());
    if (seen.size() != source.nodes.size()) section.fail("nodes", "contains a node twice");
    const auto shape = section.shape("series");
    if (shape.size() != 2) section.fail("series", "must have the shape (rows, samples)");
    source.samples = static_cast<std::ptrdiff_t>(shape[1]);
    source.series = section.numbers("series");
    source.weights = section.numbers("weights");
    for (const double row : section.numbers("rows")) {
        if (!(row >= 0.0 && row < static_cast<double>(shape[0])))
            section.fail("rows", fmt::format("contains {}, but there are {} rows", row, shape[0]));
        source.rows.push_back(static_cast<std::size_t>(row));
    }
    for (const std::size_t count : {source.weights.size(), source.rows.size()})
        if (count != source.nodes.size())
            section.fail("nodes",
                         fmt::format("has {} nodes, but weights and rows have {} and {} values",
                                     source.nodes.size(), source.weights.size(),
                                     source.rows.size()));
    return source;
}

void read_sensor(hid_t file, StudyData& study) {
    const Section sensor(file, "sensor");
    study.sensor.nodes = sensor.nodes("nodes", study);
    if (sensor.has("weights")) {
        const auto shape = sensor.shape("weights");
        study.sensor.weights = sensor.numbers("weights");
        if (shape.size() != 2 || shape[1] == 0 ||
            study.sensor.weights.size() != study.sensor.nodes.size())
            sensor.fail("weights", "must have the shape (points, nodes of a point), with a weight "
                                   "for each of the nodes");
        study.sensor.nodes_of_a_point = shape[1];
    }
    std::vector<std::string> names;
    for (const SensorRecordName& record : sensor_records)
        names.emplace_back(record.name);
    std::istringstream fields(sensor.text("fields"));
    double series = 0.0;
    for (std::string name; fields >> name;) {
        study.sensor_fields.push_back(index_of(sensor, "fields", name, names));
        series += sensor_records[study.sensor_fields.back()].series;
    }
    study.sensor_start = sensor.integer("start", 1, static_cast<double>(study.steps));
    const double values =
        static_cast<double>(study.sensor.size()) * static_cast<double>(study.steps) * series;
    if (values > most_of_a_list)
        sensor.fail("nodes", fmt::format("require {:.3g} values in memory, but at most {:.3g} are "
                                         "supported: use fewer nodes, or record frames and volumes "
                                         "of the job instead of a sensor",
                                         values, most_of_a_list));
}

StudyData read_study(hid_t file) {
    if (!h5::has_attribute(file, "schema") || h5::text_attribute(file, "schema") != schema)
        throw UsageError(
            fmt::format("it is not a \"{}\"; create one with scripts/import-kwave", schema));
    StudyData study;
    read_grid(file, study);
    read_medium(file, study);
    const double sources = h5::number_attribute(file, "sources");
    if (!(sources >= 0.0 && sources <= 1000.0))
        throw UsageError("sources must be between 0 and 1000");
    for (int n = 0; n < static_cast<int>(sources); ++n)
        study.sources.push_back(read_source(file, fmt::format("source_{}", n), study));
    read_sensor(file, study);
    return study;
}

} // namespace

StudyData read_study_file(const std::filesystem::path& path) {
    StudyData study = read_user_file(path, read_study);
    study.file = path.string();
    study.content_hash = hash_of(study);
    return study;
}

StudyData read_study_file(const std::filesystem::path& path, const Comm& comm) {
    std::vector<double> numbers;
    on_root(comm, [&] { numbers = packed(read_study_file(path)); });
    comm.broadcast(numbers);
    StudyData study = unpacked(numbers);
    study.file = path.string();
    return study;
}

} // namespace shearwake::storage
