// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/rates.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <thread>

namespace test_rates {

using namespace shearwake;
using cost::Origin;

namespace {

/// 2 ns per unit on one rank.
engines::TimedWork steps(double size, double seconds_per_unit = 2e-9) {
    return {{"spectral, steps", size, 10.0}, 10.0 * size * seconds_per_unit};
}

cost::Rates some_rates() {
    cost::Rates rates;
    rates.add(steps(1e6), 1, false);
    rates.add({{"layered frames", 1e5, 3.0}, 1e-3}, 2, true);
    return rates;
}

} // namespace

TEST_CASE("the rate of a part is that of the same kind, size and number of ranks", "[rates]") {
    const cost::Rates rates = some_rates();
    const auto found = rates.of({"spectral, steps", 1.1e6, 500.0}, 1);
    CHECK(found.core_s == Approx(2e-9));
    CHECK(found.origin == Origin::measured);
    const auto frames = rates.of({"layered frames", 1e5, 500.0}, 2);
    CHECK(frames.core_s == Approx(2.0 * 1e-3 / 3e5)); // two ranks
    CHECK(frames.origin == Origin::probed);
}

TEST_CASE("rates of other sizes, numbers of ranks and bodies are only similar", "[rates]") {
    cost::Rates rates = some_rates();
    rates.add(steps(8e6, 4e-9), 1, false);
    CHECK(rates.of({"spectral, steps", 2e6, 1.0}, 1).origin == Origin::similar);
    CHECK(rates.of({"spectral, steps", 2e6, 1.0}, 1).core_s == Approx(2e-9)); // the nearest
    CHECK(rates.of({"spectral, steps", 6e6, 1.0}, 2).core_s == Approx(4e-9));
    CHECK(rates.of({"spectral, steps", 8e6, 1.0}, 2).origin == Origin::similar);
    rates.add({{"spectral bodies #1, steps", 1e6, 1.0}, 1e-2}, 1, false);
    rates.add({{"spectral bodies #1, setup", 1e6, 1.0}, 1.0}, 1, false);
    const auto other = rates.of({"spectral bodies #2, steps", 1e6, 1.0}, 1);
    CHECK(other.origin == Origin::similar);
    CHECK(other.core_s == Approx(1e-8));
    CHECK(rates.of({"pstd double, steps", 1e6, 1.0}, 1).origin == Origin::unknown);
}

TEST_CASE("a complete case replaces a probe, and later cases are averaged", "[rates]") {
    cost::Rates rates;
    const auto now = [&] { return rates.of({"spectral, steps", 1e6, 1.0}, 1); };
    rates.add(steps(1e6, 1e-9), 1, true);
    CHECK(now().origin == Origin::probed);
    rates.add(steps(1e6, 2e-9), 1, false);
    CHECK(now().origin == Origin::measured);
    CHECK(now().core_s == Approx(2e-9));
    rates.add(steps(1e6, 9e-9), 1, true);
    CHECK(now().core_s == Approx(2e-9));
    rates.add(steps(1e6, 4e-9), 1, false);
    CHECK(now().core_s == Approx(3e-9));
    rates.add({{"spectral, steps", 0.0, 1.0}, 1.0}, 1, false); // no work, no rate
    CHECK(rates.all().size() == 1);
}

TEST_CASE("rates read back as they were written, and are added to those in the file", "[rates]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "rates.json";
    CHECK(cost::read_rates(file).all().empty());
    CHECK(cost::save_rates(some_rates(), file));
    CHECK(cost::read_rates(file).all() == some_rates().all());
    CHECK(cost::rates_of_root(some_rates(), Comm::world()).all() == some_rates().all());
    cost::Rates more;
    more.add({{"pstd double, steps", 1e6, 1.0}, 1e-2}, 1, false);
    cost::save_rates(more, file);
    CHECK(cost::read_rates(file).all().size() == 3);
}

TEST_CASE("rates of another program or processor, or that make no sense, are not used", "[rates]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "rates.json";
    cost::save_rates(some_rates(), file);
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const auto at = changed.find(from);
        REQUIRE(at != std::string::npos);
        return changed.replace(at, from.size(), to);
    };
    for (const std::string& wrong :
         {std::string(), text.substr(0, text.size() / 2),
          with("\"processor\": \"", "\"processor\": \"x"),
          with("\"program\": \"", "\"program\": \"x"), with("\"core_s\": ", "\"core_s\": -"),
          with("\"size\": ", "\"size\": -"), with("\"kind\"", "\"king\"")}) {
        std::ofstream(file) << wrong;
        INFO(wrong);
        CHECK(cost::read_rates(file).all().empty());
    }
}

TEST_CASE("the file keeps the newest rates", "[rates]") {
    cost::Rates rates;
    for (int n = 0; n < 600; ++n)
        rates.add({{std::to_string(n), 1.0, 1.0}, 1.0}, 1, false);
    CHECK(rates.all().size() == 500);
    CHECK(rates.of({"99", 1.0, 1.0}, 1).origin == Origin::unknown);
    CHECK(rates.of({"100", 1.0, 1.0}, 1).origin == Origin::measured);
}

TEST_CASE("whoever reads while others write finds complete rates", "[rates]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "rates.json";
    cost::save_rates(some_rates(), file);
    std::thread writer([&] {
        for (int n = 0; n < 50; ++n)
            cost::save_rates(some_rates(), file);
    });
    int damaged = 0;
    for (int n = 0; n < 50; ++n)
        damaged += cost::read_rates(file).all().size() == 2 ? 0 : 1;
    writer.join();
    CHECK(damaged == 0);
}

} // namespace test_rates
