// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"

#include "base/field.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>

namespace shearwake {

namespace {

using Library = nlohmann::json; // single values only, whose destruction needs no memory
using InvalidText = Library::error_handler_t;

std::string string_text(const std::string& text, InvalidText invalid) {
    const auto is_plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
    if (std::ranges::all_of(text, is_plain)) return '"' + text + '"';
    return Library(text).dump(-1, ' ', false, invalid);
}

/// Builds a value from the events of the parser.
class Builder : public nlohmann::json_sax<Library> {
public:
    explicit Builder(std::size_t deepest) : deepest_(deepest) {}

    Json result;
    std::string error; // empty: none
    bool has_discarded = false;

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_array() override { return close(); }
    bool key(string_t& value) override {
        if (discarded_ == 0) open_.back().key = std::move(value);
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const Library::exception& what) override {
        error = what.what();
        return false;
    }

private:
    struct Open {
        Json value;
        std::string key; // of the next member
        std::map<std::string, std::size_t> places;
    };

    /// Of members with the same key, the first receives the value of the last.
    bool add(Json value) {
        if (discarded_ > 0 || open_.size() > deepest_) return true;
        if (open_.empty())
            result = std::move(value);
        else if (auto& [container, key, places] = open_.back(); container.is_array())
            container.push_back(std::move(value));
        else if (const auto [place, is_new] = places.try_emplace(key, container.size()); is_new)
            container.items().push_back({std::move(key), std::move(value)});
        else
            container.items()[place->second].value = std::move(value);
        return true;
    }
    bool open(Json container) {
        if (discarded_ > 0 || open_.size() > deepest_)
            has_discarded = ++discarded_ > 0;
        else
            open_.push_back({std::move(container), {}, {}});
        return true;
    }
    bool close() {
        if (discarded_ > 0) return discarded_-- > 0;
        Json closed = std::move(open_.back().value);
        open_.pop_back();
        return add(std::move(closed));
    }

    std::size_t deepest_, discarded_ = 0; // containers that are open and discarded
    std::vector<Open> open_;
};

} // namespace

Json::Json() noexcept = default;
Json::Json(bool value) : value_(value) {}
Json::Json(std::int64_t value) : value_(value) {}
Json::Json(std::uint64_t value) : value_(value) {
    if (std::in_range<std::int64_t>(value)) value_ = static_cast<std::int64_t>(value);
}
Json::Json(double value) : value_(value) {}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(const std::vector<std::string>& texts) : value_(Array(texts.begin(), texts.end())) {}
Json::Json(const std::vector<double>& numbers) : value_(Array(numbers.begin(), numbers.end())) {}
// The copy constructor of std::variant in libstdc++ 12 destroys a value that does not exist if the
// copy needs memory and gets none; assignment does not.
Json::Json(const Json& other) {
    std::visit([this](const auto& value) { value_ = value; }, other.value_);
}
Json::Json(Json&& other) noexcept = default;
Json::~Json() = default;

Json& Json::operator=(Json other) noexcept {
    value_.swap(other.value_);
    return *this;
}

Json::Json(std::initializer_list<Json> values) : value_(Object()) {
    const auto is_member = [](const Json& value) {
        return value.is_array() && value.size() == 2 && value.at(0).is_string();
    };
    if (!std::ranges::all_of(values, is_member))
        value_ = Array(values);
    else
        for (const Json& member : values)
            (*this)[member.at(0).get<std::string>()] = member.at(1);
}

Json Json::array(std::initializer_list<Json> values) {
    Json made;
    made.value_ = Array(values);
    return made;
}

Json Json::parse(std::string_view text) {
    Builder builder(most_nested);
    if (!Library::sax_parse(text, &builder)) throw JsonError(builder.error);
    if (builder.has_discarded) throw JsonError("too many values are nested");
    return std::move(builder.result);
}

Json Json::parse_or_null(std::string_view text, std::size_t deepest) {
    Builder builder(deepest);
    return Library::sax_parse(text, &builder) ? std::move(builder.result) : Json();
}

struct Json::Layout {
    int indent;
    InvalidText invalid;
};

void Json::write(std::string& out, const Layout& layout, std::size_t level) const {
    const auto begin_line = [&](std::size_t levels) {
        if (layout.indent < 0) return;
        out.append(1, '\n').append(levels * static_cast<std::size_t>(layout.indent), ' ');
    };
    const auto list = [&](const auto& values, std::string_view brackets, const auto& write_one) {
        out += brackets[0];
        for (const auto& value : values) {
            if (&value != values.data()) out += ',';
            begin_line(level + 1);
            write_one(value);
        }
        if (!values.empty()) begin_line(level);
        out += brackets[1];
    };
    const auto write_value = overloaded{
        [&](std::monostate) { out += "null"; },
        [&](bool value) { out += value ? "true" : "false"; },
        [&](double value) { out += Library(value).dump(); },
        [&](const std::string& value) { out += string_text(value, layout.invalid); },
        [&](const Array& values) {
            list(values, "[]", [&](const Json& value) { value.write(out, layout, level + 1); });
        },
        [&](const Object& members) {
            list(members, "{}", [&](const Member& member) {
                out += string_text(member.key, layout.invalid);
                out += layout.indent < 0 ? ":" : ": ";
                member.value.write(out, layout, level + 1);
            });
        },
        [&](auto integer) { out += std::to_string(integer); },
    };
    std::visit(write_value, value_);
}

std::string Json::dump(int indent) const {
    std::string out;
    write(out, {indent, InvalidText::strict}, 0);
    return out;
}

std::string Json::text(int indent) const {
    std::string out;
    write(out, {indent, InvalidText::replace}, 0);
    return out;
}

bool Json::operator==(const Json& other) const {
    if (is_number() && other.is_number() && is_float() != other.is_float())
        return get<double>() == other.get<double>();
    return value_ == other.value_;
}

template <class T>
T Json::get() const {
    if constexpr (!std::is_arithmetic_v<T> && !std::same_as<T, std::string>) {
        T all;
        for (const Json& element : *this)
            all.push_back(element.get<typename T::value_type>());
        return all;
    } else
        return std::visit(
            []<class Value>(const Value& value) -> T {
                if constexpr (std::same_as<T, Value>)
                    return value;
                else if constexpr (std::is_arithmetic_v<Value> && std::is_arithmetic_v<T> &&
                                   !std::same_as<T, bool> && !std::same_as<Value, bool>)
                    return static_cast<T>(value);
                else
                    throw JsonError("a JSON value has another type than expected");
            },
            value_);
}
template bool Json::get() const;
template int Json::get() const;
template std::int64_t Json::get() const;
template std::uint64_t Json::get() const;
template double Json::get() const;
template std::string Json::get() const;
template std::vector<std::string> Json::get() const;
template std::vector<double> Json::get() const;

const Json::Array& Json::elements() const {
    if (!is_array()) throw JsonError("a JSON value is not an array");
    return std::get<Array>(value_);
}

const Json& Json::at(std::size_t index) const {
    if (index >= elements().size()) throw JsonError("an array in JSON is too short");
    return elements()[index];
}

void Json::push_back(Json value) {
    if (is_null()) value_ = Array();
    elements().push_back(std::move(value));
}

const Json::Object& Json::items() const {
    if (!is_object()) throw JsonError("a JSON value is not an object");
    return std::get<Object>(value_);
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) value_ = Object();
    if (!contains(key)) items().push_back({std::string(key), {}});
    return at(key);
}

const Json& Json::at(std::string_view key) const {
    const Json* found = items().empty() ? nullptr : find(key);
    if (!found) throw JsonError(fmt::format("an object in JSON has no member \"{}\"", key));
    return *found;
}

const Json* Json::find(std::string_view key) const {
    if (!is_object()) return nullptr;
    const auto found = std::ranges::find(items(), key, &Member::key);
    return found == items().end() ? nullptr : &found->value;
}

void Json::erase(std::string_view key) {
    std::erase_if(items(), [&](const Member& member) { return member.key == key; });
}

void Json::update(const Json& members) {
    for (const auto& [key, value] : members.items())
        (*this)[key] = value;
}

std::size_t Json::size() const {
    if (is_structured()) return is_array() ? elements().size() : items().size();
    return is_null() ? 0 : 1;
}

std::string json_document(std::string_view command, const Json& members) {
    Json document = {{"schema", json_schema_version}, {"command", command}};
    document.update(members);
    return document.text(1) + '\n';
}

} // namespace shearwake
