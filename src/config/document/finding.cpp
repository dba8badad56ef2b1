// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/finding.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace shearwake::config {

std::string text(const Finding& finding) {
    std::string where = finding.file;
    if (finding.line > 0) where += fmt::format(":{}:{}", finding.line, finding.column);
    const char* what = finding.severity == Severity::error ? "error" : "warning";
    return fmt::format("{}: {}: {}", where, what, finding.message);
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

void Diagnostics::error(const Place& at, std::string message) {
    ++errors_;
    add(Severity::error, at, std::move(message));
}

void Diagnostics::warning(const Place& at, std::string message) {
    add(Severity::warning, at, std::move(message));
}

void Diagnostics::add(Severity severity, const Place& at, std::string message) {
    // Errors are always stored: a job with many warnings must not be accepted because of the limit.
    if (full() && !(severity == Severity::error && errors_ == 1)) return;
    Finding finding{severity, at.file ? *at.file : "", at.line, at.column, std::move(message)};
    if (seen_.insert(text(finding)).second) findings_.push_back(std::move(finding));
}

std::vector<Finding> Diagnostics::sorted() const {
    std::vector<Finding> sorted = findings_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Finding& a, const Finding& b) {
        return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    });
    return sorted;
}

} // namespace shearwake::config
