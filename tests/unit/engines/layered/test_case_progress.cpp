// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/case_progress.hpp"
#include "support/stop_at.hpp"

#include <catch2/catch.hpp>
#include <vector>

namespace test_case_progress {

using namespace shearwake;
using Stage = layered::CaseProgress::Stage;

TEST_CASE("the share of a layered case is its complete work over its total work", "[layered]") {
    test::Shares listener;
    layered::CaseProgress progress(&listener);
    progress.expect(Stage::response, 4.0, 5.0);
    progress.expect(Stage::response, 6.0, 5.0);
    progress.expect(Stage::frames, 100.0, 90.0);
    CHECK(progress.work_ns(Stage::response) == 10.0);
    CHECK(progress.work_ns(Stage::samples) == 0.0);
    progress.record_completed(Stage::response);
    CHECK(listener.all.back() == Approx(0.01));
    progress.record_completed(Stage::response, 9.0);
    CHECK(listener.all.back() == Approx(0.1));
    progress.record_completed(Stage::frames, 50.0);
    CHECK(listener.all.back() == Approx(0.55));
    progress.record_completed(Stage::samples); // without expected work
    CHECK(listener.all.size() == 3);
    progress.record_completed(Stage::frames, 50.0);
    CHECK(listener.all.back() == Approx(1.0));
}

} // namespace test_case_progress
