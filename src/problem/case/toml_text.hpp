// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/text.hpp"
#include "base/vectors.hpp"

#include <cstddef>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Lines of TOML. Infinity and nan never occur in a valid case.
class TomlText {
public:
    void table(std::string_view name) { text_ += fmt::format("\n[{}]\n", name); }
    void element(std::string_view name) { text_ += fmt::format("\n[[{}]]\n", name); }
    void put(std::string_view key, std::string_view value) {
        text_ += fmt::format("{} = \"{}\"\n", key, escaped(value));
    }
    void put(std::string_view key, const char* value) { put(key, std::string_view(value)); }
    void put(std::string_view key, double value) {
        text_ += fmt::format("{} = {}\n", key, number(value));
    }
    void put(std::string_view key, std::ptrdiff_t value) {
        text_ += fmt::format("{} = {}\n", key, value);
    }
    void put_flag(std::string_view key, bool value) {
        text_ += fmt::format("{} = {}\n", key, value);
    }
    void put(std::string_view key, const std::vector<double>& values) {
        text_ += fmt::format("{} = [", key);
        for (std::size_t i = 0; i < values.size(); ++i)
            text_ += (i ? ", " : "") + number(values[i]);
        text_ += "]\n";
    }
    void put(std::string_view key, const std::vector<std::string>& words) {
        text_ += fmt::format("{} = [", key);
        for (std::size_t i = 0; i < words.size(); ++i)
            text_ += fmt::format("{}\"{}\"", i ? ", " : "", escaped(words[i]));
        text_ += "]\n";
    }
    void put(std::string_view key, Vec2 v) { put(key, std::vector<double>{v.x, v.y}); }
    void put(std::string_view key, Vec3 v) { put(key, std::vector<double>{v.x, v.y, v.z}); }
    void put(std::string_view key, const std::optional<double>& value) {
        if (value) put(key, *value);
    }
    std::string take() { return std::move(text_); }

private:
    static std::string number(double value) {
        std::string text = exact(value + 0.0); // -0 and 0 are the same case
        if (text == "-0") text = "0";
        if (text.find_first_of(".e") == std::string::npos) text += ".0"; // a TOML float
        return text;
    }
    static std::string escaped(std::string_view value) {
        std::string out;
        for (const char c : value) {
            if (c == '"' || c == '\\') out += '\\';
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
                out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
            else
                out += c;
        }
        return out;
    }
    std::string text_;
};

} // namespace shearwake
