// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/sweep_remarks.hpp"

#include "base/text.hpp"
#include "engines/registry/check.hpp"

#include <cctype>
#include <fmt/format.h>
#include <sstream>
#include <string_view>
#include <utility>

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

/// The area in mm2 of the domain that a remark recommends ("a domain of 80 x 60 mm"); 0 if it does
/// not recommend one.
double recommended_mm2(const Remark& remark) {
    constexpr std::string_view words = "a domain of ";
    const std::size_t at = remark.message.find(words);
    if (at == std::string::npos) return 0.0;
    double x_mm = 0.0, y_mm = 0.0;
    std::string by;
    std::istringstream sizes(remark.message.substr(at + words.size()));
    return sizes >> x_mm >> by >> y_mm ? x_mm * y_mm : 0.0;
}

} // namespace

void SweepRemarks::add(const Case& c, const NodePtr& root) {
    ++added_;
    for (Remark& remark : check(c)) {
        auto [found, is_new] = groups_.try_emplace(
            {remark.severity, remark.key, without_numbers(remark.message)}, Group{});
        Group& group = found->second;
        if (is_new) order_.push_back(&group);
        if (group.last_case != added_) ++group.cases;
        group.last_case = added_;
        if (is_new || recommended_mm2(remark) > recommended_mm2(group.reported)) {
            group.at = place_of(root, split_path(remark.key).value_or(Path{}));
            group.reported = std::move(remark);
        }
    }
}

void SweepRemarks::report(DiagnosticList& diagnostics) const {
    for (const Group* group : order_) {
        std::string message = fmt::format("{}: {}", group->reported.key, group->reported.message);
        if (group->cases > 1)
            message += fmt::format(" (and {})", counted(group->cases - 1, "more case"));
        if (group->reported.severity == Severity::error)
            diagnostics.error(group->at, std::move(message));
        else
            diagnostics.warning(group->at, std::move(message));
    }
}

} // namespace shearwake::config
