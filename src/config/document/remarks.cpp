// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/remarks.hpp"

#include "check/check.hpp"

#include <cctype>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

std::string without_numbers(const std::string& message) {
    std::string out;
    for (std::size_t i = 0; i < message.size(); ++i) {
        const bool digit = std::isdigit(static_cast<unsigned char>(message[i]));
        if (!digit) out += message[i];
        // Treats "0.5", "5" and "5e-05" each as one number.
        while (digit && i + 1 < message.size() &&
               (std::isalnum(static_cast<unsigned char>(message[i + 1])) ||
                (message[i + 1] == '.' && i + 2 < message.size() &&
                 std::isdigit(static_cast<unsigned char>(message[i + 2]))) ||
                (message[i + 1] == '-' && message[i] == 'e')))
            ++i;
        if (digit) out += '#';
    }
    return out;
}

} // namespace

void Remarks::add(const Case& c, const NodePtr& root) {
    for (Remark& remark : check(c)) {
        auto [found, is_new] = groups_.try_emplace(
            {remark.severity, remark.key, without_numbers(remark.message)}, Group{});
        Group& group = found->second;
        if (is_new) {
            group.at = place_of(root, split_path(remark.key).value_or(Path{}));
            group.first = std::move(remark);
            order_.push_back(&group);
        } else if (remark.message != group.first.message) {
            ++group.others;
        }
    }
}

void Remarks::report(DiagnosticList& diagnostics) const {
    for (const Group* group : order_) {
        std::string message = fmt::format("{}: {}", group->first.key, group->first.message);
        if (group->others > 0)
            message +=
                fmt::format(" (and {} more case{})", group->others, group->others > 1 ? "s" : "");
        if (group->first.severity == Severity::error)
            diagnostics.error(group->at, std::move(message));
        else
            diagnostics.warning(group->at, std::move(message));
    }
}

} // namespace shearwake::config
