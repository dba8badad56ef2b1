// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/study_data.hpp"

#include "base/text.hpp"

namespace shearwake {
namespace {

/// Walks over all members of a study, in the same order for packing and unpacking.
template <class Study, class Archive>
void walk(Study& study, Archive& archive) {
    for (auto* triple : {&study.points, &study.layer_points})
        for (auto& value : *triple)
            archive.number(value);
    for (auto* triple : {&study.spacing_m, &study.layer_strength})
        for (auto& value : *triple)
            archive.number(value);
    archive.number(study.time_step_s);
    archive.number(study.steps);
    archive.number(study.layer_ratio);
    archive.number(study.layer_speed_m_s);
    archive.number(study.sensor_start);
    for (auto* values :
         {&study.density_kg_m3, &study.c_p_m_s, &study.c_s_m_s, &study.chi_Pa_s, &study.eta_Pa_s})
        archive.list(*values, [&](auto& value) { archive.number(value); });
    const auto node = [&](auto& at) {
        for (auto& index : at)
            archive.number(index);
    };
    archive.list(study.sensor.nodes, node);
    archive.list(study.sensor.weights, [&](auto& value) { archive.number(value); });
    archive.number(study.sensor.nodes_of_a_point);
    archive.list(study.sensor_fields, [&](auto& field) { archive.number(field); });
    archive.list(study.sources, [&](auto& source) {
        archive.number(source.field);
        archive.number(source.dirichlet);
        archive.number(source.samples);
        archive.list(source.nodes, node);
        archive.list(source.weights, [&](auto& value) { archive.number(value); });
        archive.list(source.rows, [&](auto& row) { archive.number(row); });
        archive.list(source.series, [&](auto& value) { archive.number(value); });
    });
}

struct Pack {
    std::vector<double> numbers;
    template <class Number>
    void number(const Number& value) {
        numbers.push_back(static_cast<double>(value) + 0.0); // -0 and 0 are the same
    }
    template <class List, class Each>
    void list(const List& values, const Each& each) {
        number(values.size());
        for (const auto& value : values)
            each(value);
    }
};

struct Unpack {
    const std::vector<double>& numbers;
    std::size_t at = 0;
    template <class Number>
    void number(Number& value) {
        value = static_cast<Number>(numbers.at(at++));
    }
    template <class List, class Each>
    void list(List& values, const Each& each) {
        std::size_t size = 0;
        number(size);
        values.resize(size);
        for (auto& value : values)
            each(value);
    }
};

} // namespace

std::vector<double> packed(const StudyData& study) {
    Pack pack;
    walk(study, pack);
    return std::move(pack.numbers);
}

StudyData unpacked(const std::vector<double>& numbers) {
    StudyData study;
    Unpack unpack{numbers};
    walk(study, unpack);
    study.content_hash = hash_of(study);
    return study;
}

std::string hash_of(const StudyData& study) {
    return hex(stable_hash(std::span<const double>(packed(study))));
}

} // namespace shearwake
