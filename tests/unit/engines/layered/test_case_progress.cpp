// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/case_progress.hpp"
#include "support/stop_at.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

namespace test_case_progress {

using namespace shearwake;
using Stage = layered::CaseProgress::Stage;

namespace {

/// Keeps the shares that it receives.
class Listener : public test::NoCheckpoints {
public:
    void progressed(double share) override { shares.push_back(share); }

    std::vector<double> shares;
};

} // namespace

TEST_CASE("the share of a layered case is its elapsed time over its total time", "[layered]") {
    Listener listener;
    double now_s = 0.0;
    layered::CaseProgress progress(&listener, [&] { return now_s; });
    // Expected: 10 s and 90 s. The first stage takes 30 s.
    progress.expect(Stage::response, 10.0, 10.0);
    progress.expect(Stage::frames, 100.0, 90.0);
    const auto work = [&](Stage stage, int units, double unit_s) {
        for (int n = 0; n < units; ++n) {
            now_s += unit_s;
            progress.did(stage);
        }
    };
    work(Stage::response, 1, 3.0);
    CHECK(listener.shares.back() == Approx(3.0 / 120.0)); // the other 9 will take 27 s
    work(Stage::response, 9, 3.0);
    CHECK(listener.shares.back() == Approx(30.0 / 120.0));
    work(Stage::frames, 50, 0.9);
    CHECK(listener.shares.back() == Approx(75.0 / 120.0));
    work(Stage::frames, 50, 0.9);
    CHECK(listener.shares.back() == 1.0);
    CHECK(std::ranges::is_sorted(listener.shares));
}

TEST_CASE("stages that have not begun are expected to be as slow as the stages before them",
          "[layered]") {
    Listener listener;
    double now_s = 0.0;
    layered::CaseProgress progress(&listener, [&] { return now_s; });
    progress.expect(Stage::radial, 10.0, 10.0);
    progress.expect(Stage::samples, 10.0, 30.0);
    now_s = 4.0;
    progress.did(Stage::radial, 2.0);
    CHECK(listener.shares.back() == Approx(4.0 / (20.0 + 60.0))); // all take twice as long
    now_s = 20.0;
    progress.did(Stage::radial, 8.0);
    CHECK(listener.shares.back() == Approx(20.0 / (20.0 + 60.0)));
    now_s = 26.0;
    progress.did(Stage::samples, 5.0); // whose own rate counts
    CHECK(listener.shares.back() == Approx(26.0 / 32.0));
}

TEST_CASE("the share of a layered case does not decrease when a stage becomes slower",
          "[layered]") {
    Listener listener;
    double now_s = 0.0;
    layered::CaseProgress progress(&listener, [&] { return now_s; });
    progress.expect(Stage::samples, 10.0, 1.0);
    progress.expect(Stage::frames, 10.0, 1.0);
    for (int n = 0; n < 10; ++n) {
        now_s += n < 5 ? 0.1 : 10.0;
        progress.did(Stage::samples);
    }
    CHECK(std::ranges::is_sorted(listener.shares));
    CHECK(listener.shares.front() == 0.0);
    CHECK(listener.shares.back() < 1.0);
}

TEST_CASE("without checkpoints, progress is not measured", "[layered]") {
    int looks = 0;
    layered::CaseProgress progress(nullptr, [&] { return static_cast<double>(++looks); });
    const int before = looks;
    progress.did(Stage::frames);
    CHECK(looks == before);
}

} // namespace test_case_progress
