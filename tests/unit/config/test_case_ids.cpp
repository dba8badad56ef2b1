// SPDX-License-Identifier: BSD-3-Clause
// Ids are the names of results: those of the jobs in jobs/, and of jobs that between them use every
// key, must be those of the version that introduced them.
#include "config/job.hpp"
#include "problem/case/case.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace test_case_ids {

using namespace shearwake;
using namespace shearwake::config;

static std::string contents(const std::filesystem::path& path) {
    std::ifstream file(path);
    REQUIRE(file);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

static std::vector<std::string> ids_of(const std::filesystem::path& path) {
    const TextLoader load_text = [&](const std::string& name) {
        return contents(path.parent_path() / name);
    };
    std::vector<std::string> ids;
    for (const PlannedCase& c :
         read_job(contents(path), path.string(), {}, nullptr, load_text).plan.cases)
        ids.push_back(c.id);
    return ids;
}

TEST_CASE("the ids of existing jobs do not change", "[fields][case]") {
    const std::filesystem::path data = test::data_folder / "case_ids";
    std::map<std::string, std::vector<std::string>> expected;
    std::istringstream lines(contents(data / "ids.txt"));
    std::string job;
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("== "))
            expected[job = line.substr(3)];
        else
            expected[job].push_back(line);
    CHECK(expected.size() >= 42);
    for (const auto& [name, ids] : expected) {
        INFO(name);
        const auto file = std::filesystem::path(name).filename();
        CHECK(ids_of((name.starts_with("jobs/") ? test::jobs_folder : data) / file) == ids);
    }
}

} // namespace test_case_ids
