// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/json.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace shearwake::config {

/// An error or a warning about a job, and its location. Line 0: no particular location.
struct Diagnostic {
    Severity severity = Severity::error;
    std::string file;
    int line = 0;
    int column = 0;
    std::string message;
    bool operator==(const Diagnostic&) const = default;
};

/// "job.toml:31:5: error: ..."
std::string text(const Diagnostic& diagnostic);

/// The diagnostics as a JSON array, for json_document().
Json json_of(const std::vector<Diagnostic>& diagnostics);

/// A location in a job file or in an override.
struct Place {
    std::shared_ptr<const std::string> file;
    int line = 0;
    int column = 0;
};

/// `text` for quotation in a message: unprintable characters replaced, truncated to `limit`
/// characters.
std::string excerpt(std::string_view text, std::size_t limit = 60);

/// Collects diagnostics. A diagnostic that recurs in other cases of a sweep is stored once.
class DiagnosticList {
public:
    void error(const Place& at, std::string message);
    /// An error that is stored once, even if its message recurs at other places.
    void error_once(const Place& at, std::string message);
    void warning(const Place& at, std::string message);

    /// Number of errors reported so far, including repeated ones: it increases with every error.
    std::size_t errors() const { return errors_; }
    /// Whether the limit is reached: further diagnostics are only counted, so expensive messages
    /// can be skipped.
    bool full() const { return diagnostics_.size() >= most; }
    /// In the order of the file.
    std::vector<Diagnostic> sorted() const;

private:
    static constexpr std::size_t most = 1000;
    void add(Severity severity, const Place& at, std::string message);

    std::vector<Diagnostic> diagnostics_;
    std::unordered_set<std::string> seen_;
    std::size_t errors_ = 0;
};

} // namespace shearwake::config
