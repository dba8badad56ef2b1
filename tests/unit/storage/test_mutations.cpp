// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "config/job.hpp"
#include "storage/files.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <random>
#include <string>

namespace test_mutations {

using namespace shearwake;

namespace {

/// A few changes of the kinds that damaged disks and hurried people make.
std::string mutated(std::string text, std::mt19937_64& chance) {
    const auto below = [&](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(chance);
    };
    for (std::size_t changes = 1 + below(8); changes > 0 && !text.empty(); --changes) {
        const std::size_t at = below(text.size());
        switch (below(5)) {
        case 0:
            text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
            break;
        case 1:
            text[at] = static_cast<char>(below(256));
            break;
        case 2:
            text.erase(at, 1 + below(64));
            break;
        case 3:
            text.insert(at, text.substr(below(text.size()), below(32)));
            break;
        default:
            text.replace(at, 8, 8, static_cast<char>(below(2) * 255));
            break;
        }
    }
    return text;
}

const std::filesystem::path corpus = std::filesystem::path(JOBS_DIRECTORY) / "../tests/fuzz/corpus";

} // namespace

// tests/fuzz looks further, guided by what is covered. Seeds are fixed: a failure comes back.
TEST_CASE("a thousand mutated job files are accepted or rejected without a crash", "[mutations]") {
    std::mt19937_64 chance(1);
    const std::string text = storage::read_file(corpus / "job/small.toml");
    int bad = 0;
    for (int i = 0; i < 1000; ++i) {
        try {
            config::read_job(mutated(text, chance), "mutated.toml");
        } catch (const UsageError&) {
            ++bad;
        }
    }
    CHECK(bad > 100);
    CHECK(bad < 1000); // many change only words and numbers
}

} // namespace test_mutations
