// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/warnings_text.hpp"

#include <nlohmann/json.hpp>

namespace shearwake::storage {

std::string warnings_text(const std::vector<Remark>& warnings) {
    using nlohmann::ordered_json;
    ordered_json all = ordered_json::array();
    for (const Remark& w : warnings)
        all.push_back({{"severity", w.severity == Severity::error ? "error" : "warning"},
                       {"key", w.key},
                       {"message", w.message}});
    return all.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
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
