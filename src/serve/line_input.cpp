// SPDX-License-Identifier: BSD-3-Clause
#include "serve/line_input.hpp"

#include <array>
#include <cerrno>
#include <poll.h>
#include <string_view>
#include <unistd.h>

namespace shearwake::serve {

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
