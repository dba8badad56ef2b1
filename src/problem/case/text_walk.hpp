// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "problem/case/afferents.hpp"
#include "problem/case/case_fields.hpp"
#include "problem/case/toml_text.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// A walk that writes all fields as TOML in SI units: the canonical text of a case.
class TextWalk {
public:
    template <class T>
    void operator()(const T& value, const Field& field) {
        if (field.applies && field.in_text) put(text_key(field), value, field);
    }

    template <class... T>
    void choice(const std::variant<T...>& value, const Field& field) {
        std::visit(
            [&](const auto& alternative) {
                const std::string name = alternative_name<std::decay_t<decltype(alternative)>>();
                if (*field.text && !name.empty()) text_.put(field.text, name);
                walk_fields(*this, alternative);
            },
            value);
    }

    template <class T>
    void each(const char* table, const std::vector<T>& list, const Field& field) {
        for (const T& element : list) {
            text_.element(table);
            if constexpr (requires { element.valueless_by_exception(); })
                choice(element, field);
            else
                walk_fields(*this, element);
        }
    }

    template <class T>
    void maybe(const char* table, const std::optional<T>& value) {
        if (!value) return;
        text_.table(table);
        walk_fields(*this, *value);
    }

    void section(const char* table) { text_.table(table); }
    void key(const Field&) {}
    void key(const auto&, const Field&) {}

    std::string take() { return text_.take(); }
    /// How many numbers are represented by hashes.
    double numbers() const { return numbers_; }

private:
    static std::string text_key(const Field& field) {
        return *field.text ? field.text : key_in_SI(field.key);
    }
    /// "traces_{}_m" for x or y.
    static std::string along(const std::string& key, char axis) {
        std::string name = key;
        return name.replace(name.find("{}"), 2, 1, axis);
    }

    void put(const std::string& key, double value, const Field& field) {
        text_.put(key, field.zero_in_text ? 0.0 : value);
    }
    void put(const std::string& key, const std::optional<double>& value, const Field&) {
        text_.put(key, value);
    }
    void put(const std::string& key, bool value, const Field&) { text_.put_flag(key, value); }
    void put(const std::string& key, std::integral auto value, const Field&) {
        text_.put(key, static_cast<std::ptrdiff_t>(value));
    }
    void put(const std::string& key, const std::string& word, const Field&) {
        text_.put(key, word);
    }
    template <Named E>
    void put(const std::string& key, E value, const Field& field) {
        if (field.flag_in_text)
            text_.put_flag(key, value != E{});
        else
            text_.put(key, name_in_text(value));
    }
    void put(const std::string& key, Switch value, const Field&) {
        text_.put_flag(key, value == Switch::on);
    }
    void put(const std::string& key, Vec2 value, const Field&) { text_.put(key, value); }
    void put(const std::string& key, Vec3 value, const Field&) { text_.put(key, value); }
    void put(const std::string& key, const std::optional<Vec2>& value, const Field&) {
        if (value) text_.put(key, *value);
    }
    void put(const std::string& key, const std::vector<double>& values, const Field& field) {
        if (values.size() <= field.most_in_text) return text_.put(key, values);
        std::string all;
        for (const double value : values)
            all += exact(value) + "\n";
        numbers_ += static_cast<double>(values.size());
        text_.put(key + "_count", std::ssize(values));
        text_.put(key + "_hash", hex(stable_hash(all)));
    }
    void put(const std::string& key, const std::vector<std::ptrdiff_t>& values, const Field&) {
        text_.put(key, std::vector<double>(values.begin(), values.end()));
    }
    template <Named E>
    void put(const std::string& key, const std::vector<E>& values, const Field&) {
        std::vector<std::string> names;
        for (const E value : values)
            names.emplace_back(name_in_text(value));
        text_.put(key, names);
    }
    void put(const std::string& key, const std::vector<FrequencyBand>& bands, const Field&) {
        std::vector<double> edges_Hz;
        for (const FrequencyBand& band : bands)
            edges_Hz.insert(edges_Hz.end(), {band.low_Hz, band.high_Hz});
        text_.put(key, edges_Hz);
    }
    void put(const std::string& key, const std::vector<Vec2>& points, const Field& field) {
        if (points.size() > field.most_in_text) return put_hash(key, points);
        std::vector<double> xs, ys;
        for (const Vec2& p : points) {
            xs.push_back(p.x);
            ys.push_back(p.y);
        }
        text_.put(along(key, 'x'), xs);
        text_.put(along(key, 'y'), ys);
    }
    void put_hash(const std::string& key, const std::vector<Vec2>& points) {
        // Most cases of a sweep have the same points.
        struct Known {
            std::vector<Vec2> points;
            std::string hash;
        };
        thread_local std::map<std::string, Known> last;
        Known& known = last[key];
        numbers_ += 2.0 * static_cast<double>(points.size());
        const auto same = [](const Vec2& a, const Vec2& b) { // also of -0 and 0
            return a.x == b.x && a.y == b.y;
        };
        if (known.hash.empty() || !std::ranges::equal(points, known.points, same)) {
            std::string all;
            for (const Vec2& p : points) // -0 and 0 are the same position
                all += exact(p.x + 0.0) + " " + exact(p.y + 0.0) + "\n";
            known = {points, hex(stable_hash(all))};
        }
        const std::string stem = key.substr(0, key.find("_{}"));
        text_.put(stem, std::ssize(points));
        text_.put(stem + "_hash", known.hash);
    }
    void put(const std::string&, const std::vector<ListedAfferent>& all, const Field&) {
        std::vector<double> xs, ys;
        std::vector<std::string> neurons;
        for (const ListedAfferent& one : all) {
            xs.push_back(one.at_m.x);
            ys.push_back(one.at_m.y);
            neurons.push_back(name_of(one.kind) + " " + std::to_string(one.row));
        }
        text_.put("x_m", xs);
        text_.put("y_m", ys);
        text_.put("neurons", neurons);
    }
    /// A file is represented by the hash of its content, independent of its name.
    template <class T>
    void put(const std::string& key, const std::shared_ptr<const T>& file, const Field&) {
        if (file) text_.put(key, file->content_hash);
    }

    TomlText text_;
    double numbers_ = 0.0;
};

} // namespace shearwake
