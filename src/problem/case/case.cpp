// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/case.hpp"

#include "base/text.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/text_walk.hpp"
#include "problem/case/volume.hpp"

#include <fmt/format.h>

namespace shearwake {

std::string class_colours() {
    std::string text;
    for (const ReceptorClass& one : receptor_classes)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", one.name, one.colour);
    return text;
}

const char* meaning_of_afferent_file() {
    static const std::string text = [] {
        std::string rows;
        for (const ReceptorClass& one : receptor_classes)
            rows += fmt::format("{}0 to {} for {}",
                                rows.empty()                       ? ""
                                : &one == &receptor_classes.back() ? " and "
                                                                   : ", ",
                                one.neurons - 1, one.name);
        return "CSV file; its path is relative to the job file. It has the header "
               "`x_mm,y_mm,class,row` and one afferent per line, in the coordinates of the "
               "domain; the row is " +
               rows;
    }();
    return text.c_str();
}

bool wants_tangential(const Case& c) {
    return c.vibrometer && c.vibrometer->is_tilted();
}

std::vector<double> stress_depths_m(const Case& c) {
    std::vector<double> depths_m;
    if (c.afferents && uses_stress(c.afferents->input))
        for (const AfferentClass kind : all_classes) // ascending
            depths_m.push_back(properties(kind).depth_m);
    return depths_m;
}

std::string engine_name(const SolverOptions& solver) {
    return std::visit([](const auto& options) { return options.name; }, solver);
}

std::vector<std::string> engine_names() {
    return []<std::size_t... i>(std::index_sequence<i...>) {
        return std::vector{engine_name(std::variant_alternative_t<i, SolverOptions>{})...};
    }
    (std::make_index_sequence<std::variant_size_v<SolverOptions>>());
}

std::ptrdiff_t good_even_length(std::ptrdiff_t n) {
    for (std::ptrdiff_t length = n + n % 2;; length += 2) {
        std::ptrdiff_t rest = length;
        for (const std::ptrdiff_t prime : {2, 3, 5, 7})
            while (rest > 1 && rest % prime == 0)
                rest /= prime;
        if (rest <= 1) return length;
    }
}

std::string canonical_text(const Case& c) {
    TextWalk text;
    walk_fields(text, c);
    return text.take();
}

double hashed_numbers(const Case& c) {
    TextWalk text;
    walk_fields(text, c);
    return text.numbers();
}

std::string avoid_numeric_id(std::string id) {
    const auto digits = std::ranges::count_if(id, [](char c) { return c >= '0' && c <= '9'; });
    const bool is_number =
        digits == std::ssize(id) || (digits + 1 == std::ssize(id) && id.find('e') != id.npos);
    if (is_number && id.front() != 'e') id.front() = "abcdf"[(id.front() - '0') % 5];
    return id;
}

std::string case_id(const Case& c) {
    return avoid_numeric_id(hex(stable_hash(canonical_text(c))));
}

std::string settings_text(const std::vector<Setting>& settings) {
    std::string text;
    for (const auto& [key, value] : settings)
        text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key,
                            std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    return text;
}

std::string name_of(VolumeField field) {
    return name_in_text(field);
}

std::string units_of(VolumeField field) {
    switch (field) {
    case VolumeField::u:
        return "m";
    case VolumeField::strain:
        return "1";
    case VolumeField::stress:
        return "Pa";
    }
    return {};
}

std::vector<std::string> components_of(VolumeField field) {
    if (field == VolumeField::u) return {"x", "y", "z"};
    return {"xx", "yy", "zz", "yz", "xz", "xy"};
}

} // namespace shearwake
