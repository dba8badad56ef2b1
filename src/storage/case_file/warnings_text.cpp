// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/warnings_text.hpp"

#include "base/json_line.hpp"

#include <nlohmann/json.hpp>

namespace shearwake::storage {

std::string warnings_text(const std::vector<Remark>& warnings) {
    std::vector<std::string> elements;
    for (const Remark& w : warnings)
        elements.push_back(JsonLine()
                               .add("severity", w.severity == Severity::error ? "error" : "warning")
                               .add("key", w.key)
                               .add("message", w.message)
                               .text());
    return json_array(elements);
}

std::vector<Remark> warnings_in(const std::string& text) {
    std::vector<Remark> warnings;
    try {
        for (const auto& entry : nlohmann::json::parse(text))
            warnings.push_back(
                {entry.at("severity") == "error" ? Severity::error : Severity::warning,
                 entry.at("key").get<std::string>(), entry.at("message").get<std::string>()});
    } catch (const nlohmann::json::exception&) {
        return {};
    }
    return warnings;
}

} // namespace shearwake::storage
