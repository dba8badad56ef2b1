// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "serve/line_input.hpp"
#include "serve/output.hpp"

#include <chrono>
#include <optional>
#include <string>

namespace shearwake::serve {

/// A request to compute the first case of a job.
struct Request {
    long id = 0;
    std::string job; // TOML
};

/// Longest line of a request. It limits the memory of a job and of its reading.
inline constexpr std::size_t longest_request_B = 1'000'000;

/// Reads requests and keeps the newest. Requests that it replaces, and lines that are not valid,
/// are answered at once. Not collective: rank 0 owns it.
class Inbox {
public:
    Inbox(int descriptor, Output& output)
        : input_(descriptor, longest_request_B), output_(output) {}

    /// Waits for a request; nothing if the input has ended.
    std::optional<Request> wait();
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
    std::optional<Request> newest_;
    std::string reason_; // to end the active request; empty: none
    std::chrono::steady_clock::time_point listened_;
};

} // namespace shearwake::serve
