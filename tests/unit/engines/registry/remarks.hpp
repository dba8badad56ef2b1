// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"

#include <catch2/catch.hpp>
#include <string_view>
#include <vector>

namespace shearwake::test {

/// There is one remark, with this severity and key (empty: any), whose message contains the texts.
inline void check_remark(const std::vector<Remark>& remarks, Severity severity,
                         std::string_view key, const std::vector<std::string_view>& texts) {
    for (const Remark& remark : remarks)
        UNSCOPED_INFO(remark.key << ": " << remark.message);
    CAPTURE(key, texts);
    REQUIRE(remarks.size() == 1);
    CHECK(remarks[0].severity == severity);
    if (!key.empty()) CHECK(remarks[0].key == key);
    for (const std::string_view text : texts)
        CHECK(remarks[0].message.find(text) != std::string::npos);
}

} // namespace shearwake::test
