// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"

#include "support/cases.hpp"
#include "support/stop_at.hpp"

#include <catch2/catch.hpp>

namespace test_march {

using namespace shearwake;

/// A field without values.
class Counter : public engines::Marching {
public:
    explicit Counter(std::ptrdiff_t step) : step_(step) {}
    std::ptrdiff_t step() const override { return step_; }
    void advance() override { ++step_; }
    void emit(engines::Observer& /*observer*/) override {}
    void save(StateWriter& /*state*/) const override {}
    void restore(const StateReader& /*state*/) override {}

private:
    std::ptrdiff_t step_;
};

TEST_CASE("the share of complete steps is reported after each step") {
    test::FrameStore observer;
    Counter from_start(0), resumed(3);
    test::Shares shares, rest;
    CHECK(engines::march(from_start, 4, observer, &shares) == engines::MarchEnd::complete);
    CHECK(shares.all == std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0});
    CHECK(engines::march(resumed, 4, observer, &rest) == engines::MarchEnd::complete);
    CHECK(rest.all == std::vector<double>{0.75, 1.0});
}

} // namespace test_march
