// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/rates.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace test_rates {

using namespace shearwake;
namespace fs = std::filesystem;

/// A cache of its own.
class Cache {
public:
    Cache() { ::setenv("SHEARWAKE_CACHE", (folder_ / "").c_str(), 1); }
    ~Cache() { ::unsetenv("SHEARWAKE_CACHE"); }
    Cache(const Cache&) = delete;
    Cache& operator=(const Cache&) = delete;
    fs::path file() const { return fs::directory_iterator(folder_ / "")->path(); }

private:
    test::TemporaryFolder folder_;
};

TEST_CASE("a machine has one rate per engine, the geometric mean of a run and the former rate",
          "[rates]") {
    const Cache cache;
    CHECK_FALSE(cost::recorded_rate_s("layered"));
    cost::record_rate_s("layered", 1e-9);
    cost::record_rate_s("pstd", 5e-9);
    CHECK(cost::recorded_rate_s("layered").value() == Approx(1e-9).epsilon(1e-12));
    cost::record_rate_s("layered", 4e-9);
    CHECK(cost::recorded_rate_s("layered").value() == Approx(2e-9).epsilon(1e-12));
    CHECK(cost::recorded_rate_s("pstd").value() == Approx(5e-9).epsilon(1e-12));
    CHECK_FALSE(cost::recorded_rate_s("spectral"));
}

TEST_CASE("rates of another program, or that make no sense, are not used", "[rates]") {
    const Cache cache;
    cost::record_rate_s("layered", 1e-9);
    std::ifstream in(cache.file());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const auto at = changed.find(from);
        REQUIRE(at != std::string::npos);
        return changed.replace(at, from.size(), to);
    };
    for (const std::string& wrong :
         {std::string(), text.substr(0, text.size() / 2),
          with("\"program\": \"", "\"program\": \"x"), with("1e-09", "-1e-09"), with("1e-09", "0"),
          with("1e-09", "\"fast\""), with("\"layered\"", "\"lacquered\""), with("rates", "rites"),
          std::string("[]"), with("{\n  \"layered\": 1e-09\n }", "[1]")}) {
        std::ofstream(cache.file()) << wrong;
        INFO(wrong);
        CHECK_FALSE(cost::recorded_rate_s("layered"));
        cost::record_rate_s("layered", 3e-9); // replaces the file
        CHECK(cost::recorded_rate_s("layered").value() == Approx(3e-9).epsilon(1e-12));
    }
}

TEST_CASE("without a cache no rate is recorded", "[rates]") {
    ::setenv("SHEARWAKE_CACHE", "off", 1);
    cost::record_rate_s("layered", 1e-9);
    CHECK_FALSE(cost::recorded_rate_s("layered"));
    ::unsetenv("SHEARWAKE_CACHE");
}

} // namespace test_rates
