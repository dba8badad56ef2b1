// SPDX-License-Identifier: BSD-3-Clause
#include "serve/serve.hpp"

#include "base/json.hpp"
#include "base/units.hpp"
#include "config/job.hpp"
#include "parallel/session.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "serve/streams.hpp"
#include "serve/solver.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <string>

namespace shearwake::serve {
namespace {

/// Longest line of a request. It limits the memory of a job and of its reading.
constexpr std::size_t longest_request_B = 1'000'000;

/// Reads requests and keeps the newest. Requests that it replaces, and lines that are not valid,
/// are answered at once. Not collective: rank 0 owns it.
class Inbox {
public:
    Inbox(int descriptor, Output& output)
        : input_(descriptor, longest_request_B), output_(output) {}

    /// Waits for the line of a valid request; nothing if the input has ended.
    std::optional<std::string> wait();
    /// Reads without waiting, a few hundred times per second at most, and returns whether the
    /// active request must end: because of a newer one, of a message `cancel`, or of the end of the
    /// input.
    bool interrupts();
    /// Why it must end, for its answer.
    const std::string& reason() const { return reason_; }

private:
    void listen(int patience_ms);
    void handle(const Line& line);

    LineInput input_;
    Output& output_;
    struct Waiting {
        long id = 0;
        std::string line;
    };
    std::optional<Waiting> newest_;
    std::string reason_; // to end the active request; empty: none
    std::chrono::steady_clock::time_point listened_;
};

constexpr auto between_looks = std::chrono::milliseconds(3);
constexpr std::int64_t largest_id = (std::int64_t{1} << 53) - 1; // exact in every JSON parser
constexpr int deepest = 4; // of a request; deeper values are discarded while they are read

const char* const bad_request = "bad_request";

/// The id of a request; -1 if there is no valid one.
long id_of(const Json& message) {
    const Json* id = message.find("id");
    if (!id || !id->is_integer()) return -1;
    const auto value = id->get<double>();
    return value >= 0.0 && value <= largest_id ? id->get<long>() : -1;
}

std::string text_of(const Json& message, const char* key) {
    const Json* found = message.find(key);
    return found && found->is_string() ? found->get<std::string>() : "";
}

/// Not an object if the line is not one.
Json message_in(const std::string& line) {
    return Json::parse_or_null(line, deepest);
}

/// What is wrong with a request; empty: nothing. Reads it into `request`.
std::string problem_of(const Json& message, Request& request) {
    const std::string type = text_of(message, "type");
    request.id = id_of(message);
    request.job = text_of(message, "job");
    request.describes = type == "describe";
    if (type != "compute" && !request.describes)
        return "the \"type\" of a request must be \"compute\", \"describe\" or \"cancel\"";
    if (request.id < 0) return "the request needs an \"id\", an integer from 0 to 2^53 - 1";
    if (request.job.empty())
        return "the request needs a \"job\", a text in the format of job files";
    try {
        if (message.contains("overrides"))
            for (const Json& pair : message.at("overrides"))
                request.overrides.push_back(
                    {pair.at(0).get<std::string>(), pair.at(1).get<std::string>()});
        if (message.contains("arrays"))
            request.arrays = message.at("arrays").get<std::vector<std::string>>();
    } catch (const JsonError&) {
        return "\"overrides\" must be a list of pairs of texts [KEY, VALUE], and \"arrays\" a list "
               "of names";
    }
    return {};
}

std::optional<std::string> Inbox::wait() {
    while (!newest_ && !input_.has_ended() && !output_.has_failed())
        listen(-1);
    std::optional<std::string> next;
    if (newest_ && !input_.has_ended() && !output_.has_failed()) next = std::move(newest_->line);
    if (next) newest_.reset();
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
    const Json message = message_in(line.text);
    if (!message.is_object()) {
        output_.error(-1, bad_request, "the request is not a JSON object on one line");
        return;
    }
    if (text_of(message, "type") == "cancel") {
        if (newest_) output_.message("cancelled", newest_->id, {{"reason", "it was cancelled"}});
        newest_.reset();
        reason_ = "it was cancelled";
        return;
    }
    Request request;
    const std::string problem = problem_of(message, request);
    if (!problem.empty()) {
        output_.error(request.id, bad_request, problem);
        return;
    }
    if (newest_)
        output_.message("cancelled", newest_->id, {{"reason", "a newer request has arrived"}});
    newest_ = Waiting{request.id, line.text};
}

void greet(Output& output, const Limits& limits, int ranks) {
    output.message("hello", -1,
                   {{"protocol", protocol_version},
                    {"version", pipeline::program_version()},
                    {"git_id", pipeline::program_git_id()},
                    {"ranks", ranks},
                    {"limits",
                     {{"request_B", longest_request_B},
                      {"values", limits.values},
                      {"memory_per_rank_B", limits.memory_per_rank_B},
                      {"seconds", limits.time_s}}}});
}

/// Executes a request and answers it. `inbox` is null on all ranks but the root. Collective.
void answer_request(const Request& request, Solver& solver, const Limits& limits, Inbox* inbox,
                    Output& output, const Comm& world) {
    const auto began = Clock::now();
    const auto seconds = [&] { return seconds_since(began); };
    Interrupt interrupt(world, [&] { return inbox->interrupts() || seconds() > limits.time_s; });
    Answer answer;
    std::string code, text;
    Json diagnostics = Json::array();
    bool is_complete = false;
    try {
        if (request.describes)
            answer.members = describe(request, solver.files());
        else
            is_complete = solver.compute(request, interrupt, answer);
    } catch (const config::BadJob& bad) {
        code = "bad_job";
        text = bad.what();
        diagnostics = config::json_of(bad.diagnostics());
    } catch (const UsageError& refused) {
        code = refused.code() == ExitCode::bad_job ? "bad_job" : "refused";
        text = refused.what();
    } catch (const CaseFailure& failure) {
        code = "failed";
        text = failure.what();
    }
    if (!inbox) return;
    if (!code.empty())
        output.message("error", request.id,
                       {{"code", code}, {"message", text}, {"diagnostics", diagnostics}});
    else if (request.describes)
        output.message("description", request.id, answer.members);
    else if (is_complete)
        output.result(request.id, std::move(answer.members), answer.groups, answer.frames,
                      [&](const std::string& name) { return request.wants(name); });
    else if (inbox->reason().empty())
        output.error(request.id, "time_limit",
                     fmt::format("the case was ended after {:.3g} s, the limit of --time-limit",
                                 limits.time_s));
    else
        output.message("cancelled", request.id, {{"reason", inbox->reason()}});
}

} // namespace

ExitCode serve_command(const ServeArguments& arguments, const Comm& world) {
    Limits limits;
    limits.memory_per_rank_B =
        std::min(1e6 * arguments.memory_MB, pipeline::memory_per_rank_B(world));
    limits.time_s = arguments.time_limit_s;
    Solver solver(limits, arguments.files, world);
    Output output(arguments.output);
    std::optional<Inbox> inbox;
    if (world.is_root()) {
        inbox.emplace(arguments.input, output);
        greet(output, limits, world.size());
    }
    for (;;) {
        std::optional<std::string> line;
        if (inbox) line = inbox->wait();
        sleeping_barrier(world); // a request may be hours away
        if (!world.broadcast(line.has_value())) return ExitCode::done;
        Request request;
        problem_of(message_in(world.broadcast(line.value_or(""))), request);
        answer_request(request, solver, limits, inbox ? &*inbox : nullptr, output, world);
    }
}

} // namespace shearwake::serve
