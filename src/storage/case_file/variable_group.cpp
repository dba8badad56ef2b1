// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/variable_group.hpp"

#include "base/error.hpp"

#include <map>

namespace shearwake::storage {
namespace {

void put_words(hid_t object, const Variable& variable) {
    h5::put_attribute(object, "units", variable.units);
    h5::put_attribute(object, "long_name", variable.long_name);
    if (!variable.note.empty()) h5::put_attribute(object, "note", variable.note);
}

} // namespace

void write_group(hid_t group, const std::vector<Variable>& variables) {
    std::map<std::string, h5::Id> coordinates;
    for (const Variable& v : variables) {
        if (v.dimensions != std::vector{v.name}) continue;
        const hsize_t extent = v.values.size();
        h5::Id dataset = h5::create_dataset(group, v.name, std::span(&extent, 1));
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        h5::make_scale(dataset, v.name);
        coordinates.emplace(v.name, std::move(dataset));
    }
    for (const Variable& v : variables) {
        if (v.dimensions == std::vector{v.name}) continue;
        std::vector<hsize_t> shape;
        hsize_t count = 1;
        for (const std::string& dimension : v.dimensions) {
            shape.push_back(h5::shape(coordinates.at(dimension)).at(0));
            count *= shape.back();
        }
        if (count != v.values.size())
            throw Error("variable " + v.name + " does not have the expected shape");
        const h5::Id dataset = h5::create_dataset(group, v.name, shape);
        h5::write_all(dataset, v.values);
        put_words(dataset.raw(), v);
        for (std::size_t d = 0; d < v.dimensions.size(); ++d)
            h5::attach_scale(dataset, coordinates.at(v.dimensions[d]), static_cast<unsigned>(d));
    }
}

void create_field(hid_t group, const Variable& words, const std::vector<hsize_t>& shape) {
    const h5::Id field = h5::create_dataset(group, words.name, shape);
    put_words(field.raw(), words);
    for (unsigned i = 0; i < words.dimensions.size(); ++i)
        h5::attach_scale(field, h5::open_dataset(group, words.dimensions[i]), i);
}

} // namespace shearwake::storage
