// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/groups.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "storage/checksum/checksum.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <map>

namespace shearwake::storage {

namespace {

void put_words(hid_t object, const Variable& variable) {
    h5::put_attribute(object, "units", variable.units);
    h5::put_attribute(object, "long_name", variable.long_name);
    if (!variable.note.empty()) h5::put_attribute(object, "note", variable.note);
    for (const Attribute& more : variable.attributes)
        std::visit([&](const auto& value) { h5::put_attribute(object, more.name, value); },
                   more.value);
}

Json json_of(const Remark& warning) {
    return {{"severity", warning.severity == Severity::error ? "error" : "warning"},
            {"key", warning.key},
            {"message", warning.message}};
}

} // namespace

void write_group(hid_t group, const std::vector<Variable>& variables) {
    std::map<std::string, h5::Scale> coordinates;
    for (const Variable& v : variables) {
        if (v.dimensions != std::vector{v.name}) continue;
        const hsize_t extent = v.values.size();
        h5::Id dataset = h5::create_dataset(group, v.name, std::span(&extent, 1));
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        coordinates.emplace(v.name, h5::Scale(std::move(dataset), v.name));
    }
    for (const Variable& v : variables) {
        if (v.dimensions == std::vector{v.name}) continue;
        std::vector<hsize_t> shape;
        hsize_t count = 1;
        for (const std::string& dimension : v.dimensions) {
            shape.push_back(h5::shape(coordinates.at(dimension).dataset()).at(0));
            count *= shape.back();
        }
        if (count != v.values.size())
            throw Error("variable " + v.name + " does not have the expected shape");
        const h5::Id dataset = h5::create_dataset(group, v.name, shape);
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        std::vector<h5::Scale*> scales;
        for (const std::string& dimension : v.dimensions)
            scales.push_back(&coordinates.at(dimension));
        h5::attach_scales(dataset, scales);
    }
    for (auto& [name, scale] : coordinates)
        scale.write_uses();
}

void write_groups(hid_t file, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes) {
    for (const VariableGroup& group : groups) {
        if (group.name.empty())
            write_group(file, group.variables);
        else
            write_group(h5::create_group(file, group.name).raw(), group.variables);
    }
    for (const Attribute& attribute : attributes)
        std::visit([&](const auto& value) { h5::put_attribute(file, attribute.name, value); },
                   attribute.value);
    h5::put_attribute(file, checksum_attribute, std::string(checksum_promise));
}

void create_field(hid_t group, const Variable& words, const std::vector<hsize_t>& shape) {
    const h5::Id field = h5::create_dataset(group, words.name, shape);
    put_words(field.raw(), words);
    for (unsigned i = 0; i < words.dimensions.size(); ++i)
        h5::attach_scale(field, h5::open_dataset(group, words.dimensions[i]), i);
}

std::string warning_text(const Remark& warning) {
    return json_of(warning).text();
}

std::string warnings_text(const std::vector<Remark>& warnings) {
    Json list = Json::array();
    for (const Remark& warning : warnings)
        list.push_back(json_of(warning));
    return list.text();
}

std::vector<Remark> warnings_in(const std::string& text) {
    std::vector<Remark> warnings;
    try {
        for (const auto& entry : Json::parse(text))
            warnings.push_back(
                {entry.at("severity") == "error" ? Severity::error : Severity::warning,
                 entry.at("key").get<std::string>(), entry.at("message").get<std::string>()});
    } catch (const JsonError&) {
        return {};
    }
    return warnings;
}

namespace {

std::string words_of(VolumeField field, const std::string& component) {
    switch (field) {
    case VolumeField::u:
        return fmt::format("displacement along {}{}", component,
                           component == "z" ? ", positive into the tissue" : "");
    case VolumeField::strain:
        return "component " + component + " of the strain tensor";
    case VolumeField::stress:
        return fmt::format("component {} of the stress tensor, tension positive", component);
    }
    return {};
}

} // namespace

std::vector<Variable> VolumeLayout::variables() const {
    std::vector<Variable> variables;
    for (const VolumeField field : fields)
        for (const std::string& component : components_of(field))
            variables.push_back({.name = name_of(field) + "_" + component,
                                 .dimensions = {"time", "z", "y", "x"},
                                 .units = units_of(field),
                                 .long_name = words_of(field, component)});
    return variables;
}

std::vector<hsize_t> VolumeLayout::shape() const {
    return {times_s.size(), z_m.size(), static_cast<hsize_t>(domain.ny),
            static_cast<hsize_t>(domain.nx)};
}

double VolumeLayout::bytes() const {
    double bytes = sizeof(double) * static_cast<double>(variables().size());
    for (const hsize_t extent : shape())
        bytes *= static_cast<double>(extent);
    return bytes;
}

std::size_t VolumeLayout::variable(std::size_t field, std::size_t component) const {
    std::size_t before = 0;
    for (std::size_t i = 0; i < field; ++i)
        before += components_of(fields[i]).size();
    return before + component;
}

Variable x_coordinate(const Domain& domain) {
    const auto x_m = [&](auto i) { return domain.x_m(i); };
    return {"x", {"x"}, coordinate(domain.nx, x_m), "m", "position along x, the scan direction",
            ""};
}

Variable y_coordinate(const Domain& domain) {
    const auto y_m = [&](auto j) { return domain.y_m(j); };
    return {"y", {"y"}, coordinate(domain.ny, y_m), "m", "position along y", ""};
}

void create_volume_group(hid_t file, const VolumeLayout& layout) {
    const h5::Id group = h5::create_group(file, "volume");
    write_group(group.raw(),
                {{"time", {"time"}, layout.times_s, "s", "time since the load began", ""},
                 {"z", {"z"}, layout.z_m, "m", "depth below the skin surface", ""},
                 y_coordinate(layout.domain),
                 x_coordinate(layout.domain)});
    for (const Variable& variable : layout.variables())
        create_field(group.raw(), variable, layout.shape());
}

bool has_volume_group(hid_t file, const VolumeLayout& layout) {
    if (H5Lexists(file, "volume", H5P_DEFAULT) <= 0) return false;
    try {
        const h5::Id group = h5::open_group(file, "volume");
        for (const Variable& variable : layout.variables())
            if (h5::shape(h5::open_dataset(group.raw(), variable.name)) != layout.shape())
                return false;
        return true;
    } catch (const Error&) {
        return false;
    }
}

} // namespace shearwake::storage
