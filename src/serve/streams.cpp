// SPDX-License-Identifier: BSD-3-Clause
#include "serve/streams.hpp"

#include "base/json.hpp"

#include <array>
#include <bit>
#include <cerrno>
#include <fmt/format.h>
#include <map>
#include <poll.h>
#include <string_view>
#include <unistd.h>

namespace shearwake::serve {
namespace {

static_assert(std::endian::native == std::endian::little, "the protocol is little-endian");

/// The number of values along each dimension of a group, from the coordinates of that name.
std::map<std::string, std::size_t> lengths_of(const VariableGroup& group) {
    std::map<std::string, std::size_t> lengths;
    for (const Variable& variable : group.variables)
        if (variable.dimensions.size() == 1)
            lengths[variable.dimensions.front()] = variable.values.size();
    return lengths;
}

Json described(const VariableGroup& group, const Variable& variable,
               const std::map<std::string, std::size_t>& lengths) {
    Json shape = Json::array();
    for (const std::string& dimension : variable.dimensions)
        shape.push_back(lengths.at(dimension));
    return {{"name", group.name.empty() ? variable.name : group.name + "/" + variable.name},
            {"type", "float64"},
            {"dimensions", variable.dimensions},
            {"shape", shape},
            {"units", variable.units},
            {"meaning", variable.long_name}};
}

} // namespace

void Output::message(const std::string& type, long request, const Json& members) {
    Json line = {{"type", type}};
    if (request >= 0) line["id"] = request;
    line.update(members);
    // A reader that has ended is no error here, see has_failed().
    std::fputs((line.text() + '\n').c_str(), stream_);
    std::fflush(stream_);
}

void Output::error(long request, const std::string& code, const std::string& text) {
    message("error", request, {{"code", code}, {"message", text}});
}

void Output::result(long request, Json members, const std::vector<VariableGroup>& groups,
                    const Frames& frames, const std::function<bool(const std::string&)>& wanted) {
    Json columns = Json::object(), arrays = Json::array();
    if (wanted("u_z"))
        arrays.push_back(
            {{"name", "u_z"},
             {"type", "float32"},
             {"dimensions", {"time", "x", "y"}},
             {"shape", {frames.count, frames.nx, frames.ny}},
             {"units", "m"},
             {"meaning", "normal displacement of the surface, positive into the tissue"}});
    std::size_t bytes = frames.u_z_m.size_bytes();
    std::vector<const std::vector<double>*> values;
    for (const VariableGroup& group : groups) {
        const auto lengths = lengths_of(group);
        for (const Variable& variable : group.variables)
            if (variable.dimensions.empty()) {
                columns[variable.name] = {{"value", variable.values.front()},
                                          {"units", variable.units},
                                          {"meaning", variable.long_name},
                                          {"note", variable.note}};
            } else if (Json array = described(group, variable, lengths);
                       wanted(array["name"].get<std::string>())) {
                arrays.push_back(std::move(array));
                values.push_back(&variable.values);
                bytes += variable.values.size() * sizeof(double);
            }
    }
    members["columns"] = std::move(columns);
    members["arrays"] = std::move(arrays);
    members["bytes"] = bytes + 1; // Open MPI 5 forwards output up to its last newline only
    message("result", request, members);
    std::fwrite(frames.u_z_m.data(), 1, frames.u_z_m.size_bytes(), stream_);
    for (const std::vector<double>* array : values)
        std::fwrite(array->data(), sizeof(double), array->size(), stream_);
    std::fputc('\n', stream_);
    std::fflush(stream_);
}

bool Output::has_failed() const {
    return std::ferror(stream_) != 0;
}

std::vector<Line> LineInput::read(int patience_ms) {
    std::vector<Line> lines;
    if (has_ended_) return lines;
    pollfd waiting{.fd = descriptor_, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, patience_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) return lines;
    std::array<char, 65536> block;
    const ssize_t count = ::read(descriptor_, block.data(), block.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return lines;
    has_ended_ = count <= 0;
    if (has_ended_) return lines;
    std::string_view rest(block.data(), static_cast<std::size_t>(count));
    while (!rest.empty()) {
        const std::size_t end = rest.find('\n');
        const std::string_view part = rest.substr(0, end);
        begun_.is_too_long = begun_.is_too_long || begun_.text.size() + part.size() > longest_;
        if (begun_.is_too_long)
            begun_.text.clear();
        else
            begun_.text += part;
        if (end == std::string_view::npos) break;
        lines.push_back(std::move(begun_));
        begun_ = {};
        rest.remove_prefix(end + 1);
    }
    return lines;
}

namespace {

constexpr double between_questions_s = 0.01; // a newer request waits about this long

} // namespace

Interrupt::Interrupt(const Comm& team, std::function<bool()> is_asked)
    : is_asked_(std::move(is_asked)), question_(team, between_questions_s) {}

bool Interrupt::stop_asked() {
    stops_ = stops_ || question_.ask(is_asked_);
    return stops_;
}

} // namespace shearwake::serve
