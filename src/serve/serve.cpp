// SPDX-License-Identifier: BSD-3-Clause
#include "serve/serve.hpp"

#include "base/units.hpp"
#include "config/job.hpp"
#include "parallel/session.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "serve/inbox.hpp"
#include "serve/solver.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unistd.h>

namespace shearwake::serve {
namespace {

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

/// Computes a request and answers it. `inbox` is null on all ranks but the root. Collective.
void answer_request(const Request& request, Solver& solver, const Limits& limits, Inbox* inbox,
                    Output& output, const Comm& world) {
    const auto began = Clock::now();
    const auto seconds = [&] { return seconds_since(began); };
    Interrupt interrupt(world, [&] { return inbox->interrupts() || seconds() > limits.time_s; });
    Answer answer;
    std::string code, text;
    nlohmann::ordered_json diagnostics = nlohmann::ordered_json::array();
    bool is_complete = false;
    try {
        is_complete = solver.compute(request.job, interrupt, answer);
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
    else if (is_complete)
        output.result(request.id, std::move(answer.members), answer.groups, answer.frames);
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
    Solver solver(limits, world);
    Output output;
    std::optional<Inbox> inbox;
    if (world.is_root()) {
        inbox.emplace(STDIN_FILENO, output);
        greet(output, limits, world.size());
    }
    for (;;) {
        std::optional<Request> request;
        if (inbox) request = inbox->wait();
        sleeping_barrier(world); // a request may be hours away
        if (!world.broadcast(request.has_value())) return ExitCode::done;
        Request shared = request.value_or(Request{});
        shared.job = world.broadcast(std::move(shared.job));
        answer_request(shared, solver, limits, inbox ? &*inbox : nullptr, output, world);
    }
}

} // namespace shearwake::serve
