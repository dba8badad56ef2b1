// SPDX-License-Identifier: BSD-3-Clause
#include "serve/inbox.hpp"

#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::serve {
namespace {

using Received = nlohmann::json;

constexpr auto between_looks = std::chrono::milliseconds(3);
constexpr std::int64_t largest_id = (std::int64_t{1} << 53) - 1; // exact in every JSON parser
constexpr int deepest = 4; // of a request; deeper values are discarded while they are read

const char* const bad_request = "bad_request";

/// The id of a request; -1 if there is no valid one.
long id_of(const Received& message) {
    const auto id = message.find("id");
    if (id == message.end() || !id->is_number_integer()) return -1;
    const auto value = id->get<std::int64_t>();
    return value >= 0 && value <= largest_id ? value : -1;
}

std::string text_of(const Received& message, const char* key) {
    const auto found = message.find(key);
    return found != message.end() && found->is_string() ? found->get<std::string>() : "";
}

} // namespace

std::optional<Request> Inbox::wait() {
    while (!newest_ && !input_.has_ended() && !output_.has_failed())
        listen(-1);
    std::optional<Request> next;
    if (!input_.has_ended() && !output_.has_failed()) std::swap(next, newest_);
    reason_.clear();
    return next;
}

bool Inbox::interrupts() {
    const auto now = std::chrono::steady_clock::now();
    if (now - listened_ >= between_looks) {
        listened_ = now;
        listen(0);
        if (newest_) reason_ = "a newer request has arrived";
        if (input_.has_ended() || output_.has_failed()) reason_ = "the input has ended";
    }
    return !reason_.empty();
}

void Inbox::listen(int patience_ms) {
    for (const Line& line : input_.read(patience_ms))
        handle(line);
}

void Inbox::handle(const Line& line) {
    if (line.is_too_long) {
        output_.error(-1, bad_request,
                      fmt::format("the request has more than {} bytes", longest_request_B));
        return;
    }
    if (line.text.find_first_not_of(" \t\r") == std::string::npos) return;
    const Received message = Received::parse(
        line.text,
        [](int depth, Received::parse_event_t, const Received&) { return depth <= deepest; },
        false);
    if (!message.is_object()) {
        output_.error(-1, bad_request, "the request is not a JSON object on one line");
        return;
    }
    const long id = id_of(message);
    const std::string type = text_of(message, "type");
    if (type == "cancel") {
        if (newest_) output_.message("cancelled", newest_->id, {{"reason", "it was cancelled"}});
        newest_.reset();
        reason_ = "it was cancelled";
        return;
    }
    std::string problem;
    if (id < 0) problem = "the request needs an \"id\", an integer from 0 to 2^53 - 1";
    if (type != "compute") problem = "the \"type\" of a request must be \"compute\" or \"cancel\"";
    Request request{id, text_of(message, "job")};
    if (problem.empty() && request.job.empty())
        problem = "the request needs a \"job\", a text in the format of job files";
    if (!problem.empty()) {
        output_.error(id, bad_request, problem);
        return;
    }
    if (newest_)
        output_.message("cancelled", newest_->id, {{"reason", "a newer request has arrived"}});
    newest_ = std::move(request);
}

} // namespace shearwake::serve
