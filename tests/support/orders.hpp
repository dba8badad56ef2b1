// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/places.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <string>

namespace shearwake::test {

/// The measured order of convergence is at least the claimed one less the tolerance, and has a row
/// in docs/explanation/verification.md. If the environment variable SHEARWAKE_WRITE_ORDERS is set,
/// the row is written.
inline void check_order(const std::string& scheme, double claimed, double measured,
                        double tolerance) {
    CHECK(measured > claimed - tolerance);
    const std::filesystem::path path =
        jobs_folder.parent_path() / "docs/explanation/verification.md";
    const std::string name =
        fmt::format("| {} | {} |", scheme, Catch::getResultCapture().getCurrentTestName());
    const std::string row =
        fmt::format("{} {} | {:.2f} | {} |\n", name, claimed, measured, tolerance);
    std::stringstream file;
    file << std::ifstream(path).rdbuf();
    std::string page = file.str();
    if (std::getenv("SHEARWAKE_WRITE_ORDERS")) {
        const std::size_t at = std::min(page.find(name), page.size());
        page.replace(at, page.find('\n', at) - at + 1, row);
        std::ofstream(path) << page;
    }
    INFO(row);
    CHECK(page.find(row) != std::string::npos);
}

} // namespace shearwake::test
