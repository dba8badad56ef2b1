// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "config/job.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/guard.hpp"
#include "support/cases.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
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

// The program reads only files that match their checksum; the guard is that of files of users.
TEST_CASE("mutated case files are accepted or rejected without a crash", "[mutations][slow]") {
    const auto summary_of = [](const std::filesystem::path& path) {
        storage::try_in_child(path, [&] { storage::read_unverified_summary(path); });
        return storage::read_unverified_summary(path);
    };
    const test::TemporaryFolder folder;
    std::mt19937_64 chance(2);
    const std::string bytes = storage::read_file(corpus / "case/whole.h5");
    storage::write_file(folder / "mutated.h5", bytes);
    CHECK(summary_of(folder / "mutated.h5").texts.at("status") == "complete");
    // Found by fuzzing; under some allocators HDF5 frees what it has never had.
    CHECK_THROWS_AS(summary_of(corpus / "case/breaks-hdf5.h5"), Error);
    // Each is read in a process of its own first.
    const int count = test::is_long_form() ? 1000 : 100;
    int bad = 0;
    for (int i = 0; i < count; ++i) {
        std::string mutant = mutated(bytes, chance);
        if (i % 10 == 0)
            mutant.resize(mutant.size() * static_cast<std::size_t>(i) /
                          static_cast<std::size_t>(count));
        std::ofstream(folder / "mutated.h5", std::ios::binary) << mutant; // nothing is flushed
        try {
            summary_of(folder / "mutated.h5");
        } catch (const Error&) {
            ++bad;
        }
    }
    CHECK(bad > count / 10);
    CHECK(bad < count);
}

} // namespace test_mutations
