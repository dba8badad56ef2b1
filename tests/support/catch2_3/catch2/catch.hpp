// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The header of Catch2 2, which the tests include, for builds with Catch2 3: its names that version
// 3 has renamed. tests/CMakeLists.txt adds this folder to the search path of headers.

#include <catch2/catch_all.hpp>

#include <string>

using Catch::Approx;

namespace Catch {

using TestEventListenerBase = EventListenerBase;
using TestCase = TestCaseHandle;

inline auto Contains(const std::string& part) {
    return Matchers::ContainsSubstring(part);
}

} // namespace Catch
