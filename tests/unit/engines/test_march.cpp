// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"

#include "support/cases.hpp"
#include "support/stop_at.hpp"

#include <catch2/catch.hpp>

namespace test_march {

using namespace shearwake;

namespace {

/// A field without values.
class Counter : public engines::Marching {
public:
    explicit Counter(std::ptrdiff_t step, std::ptrdiff_t snapshot = -1)
        : step_(step), snapshot_(snapshot) {}
    std::ptrdiff_t step() const override { return step_; }
    void advance() override { ++step_; }
    void emit(engines::Observer& observer) override {
        if (step_ == snapshot_) observer.volume({});
    }
    void save(StateWriter& /*state*/) const override {}
    void restore(const StateReader& /*state*/) override {}

private:
    std::ptrdiff_t step_, snapshot_;
};

/// Records the reported shares; nothing is saved.
class Shares : public test::NoCheckpoints {
public:
    void progressed(double share) override { all.push_back(share); }
    void timed(const engines::TimedWork& part) override { parts.push_back(part); }

    std::vector<double> all;
    std::vector<engines::TimedWork> parts;
};

const engines::MarchWork work{
    .kind = "counter", .unknowns = 10.0, .steps = 4.0, .values = 3.0, .snapshots = 1.0};

} // namespace

TEST_CASE("the share of complete steps is reported after each step") {
    test::FrameStore observer;
    Counter from_start(0), resumed(3);
    Shares shares, rest;
    CHECK(engines::march(from_start, 4, observer, &shares, work, Clock::now()) ==
          engines::MarchEnd::complete);
    CHECK(shares.all == std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0});
    CHECK(engines::march(resumed, 4, observer, &rest, work, Clock::now()) ==
          engines::MarchEnd::complete);
    CHECK(rest.all == std::vector<double>{0.75, 1.0});
}

TEST_CASE("the setup with the first step, the other steps and the snapshots are timed") {
    test::FrameStore observer;
    Counter field(0, 3);
    Shares shares;
    engines::march(field, 4, observer, &shares, work, Clock::now() - std::chrono::seconds(5));
    REQUIRE(shares.parts.size() == 3);
    CHECK(shares.parts[0].work.kind == "counter, setup");
    CHECK(shares.parts[0].seconds >= 5.0);
    CHECK(shares.parts[0].work.amount() == 10.0);
    CHECK(shares.parts[1].work.kind == "counter, steps");
    CHECK(shares.parts[1].work.amount() == 3.0 * 10.0);
    CHECK(shares.parts[1].seconds > 0.0);
    CHECK(shares.parts[2].work.kind == "counter, volumes");
    CHECK(shares.parts[2].work.amount() == 3.0);
    // An estimate is of the same parts.
    const std::vector<engines::Work> planned = engines::parts_of(work);
    REQUIRE(planned.size() == 3);
    for (std::size_t i = 0; i < planned.size(); ++i) {
        CHECK(planned[i].kind == shares.parts[i].work.kind);
        CHECK(planned[i].amount() == shares.parts[i].work.amount());
    }
}

TEST_CASE("a march that is resumed has no setup") {
    test::FrameStore observer;
    Counter field(0);
    struct : Shares {
        bool restore(const std::function<void(const StateReader&)>& /*read*/) override {
            return true;
        }
    } shares;
    engines::march(field, 4, observer, &shares, work, Clock::now());
    REQUIRE(shares.parts.size() == 1);
    CHECK(shares.parts[0].work.kind == "counter, steps");
}

} // namespace test_march
