// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/diagnostic.hpp"

#include "base/json.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace shearwake::config {

std::string text(const Diagnostic& diagnostic) {
    std::string where = diagnostic.file;
    if (diagnostic.line > 0) where += fmt::format(":{}:{}", diagnostic.line, diagnostic.column);
    const char* what = diagnostic.severity == Severity::error ? "error" : "warning";
    return fmt::format("{}: {}: {}", where, what, diagnostic.message);
}

Json json_of(const std::vector<Diagnostic>& diagnostics) {
    Json list = Json::array();
    for (const Diagnostic& d : diagnostics)
        list.push_back({{"severity", d.severity == Severity::error ? "error" : "warning"},
                        {"file", d.file},
                        {"line", d.line},
                        {"column", d.column},
                        {"message", d.message}});
    return list;
}

std::string excerpt(std::string_view text, std::size_t limit) {
    std::string out;
    for (const char c : text.substr(0, limit)) {
        const auto byte = static_cast<unsigned char>(c);
        out += byte < 0x20 || byte >= 0x7f ? '?' : c;
    }
    if (text.size() > limit) out += "...";
    return out;
}

void DiagnosticList::error(const Place& at, std::string message) {
    ++errors_;
    add(Severity::error, at, std::move(message));
}

void DiagnosticList::error_once(const Place& at, std::string message) {
    if (seen_.insert(message).second)
        error(at, std::move(message));
    else
        ++errors_;
}

void DiagnosticList::warning(const Place& at, std::string message) {
    add(Severity::warning, at, std::move(message));
}

void DiagnosticList::add(Severity severity, const Place& at, std::string message) {
    // Errors are always stored: a job with many warnings must not be accepted because of the limit.
    if (full() && !(severity == Severity::error && errors_ == 1)) return;
    Diagnostic diagnostic{severity, at.file ? *at.file : "", at.line, at.column,
                          std::move(message)};
    if (seen_.insert(text(diagnostic)).second) diagnostics_.push_back(std::move(diagnostic));
}

std::vector<Diagnostic> DiagnosticList::sorted() const {
    std::vector<Diagnostic> sorted = diagnostics_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Diagnostic& a, const Diagnostic& b) {
        return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    });
    return sorted;
}

} // namespace shearwake::config
