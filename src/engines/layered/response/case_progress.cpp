// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/case_progress.hpp"

namespace shearwake::layered {

void CaseProgress::expect(Stage stage, double units, double work_ns) {
    Part& part = parts_.at(static_cast<std::size_t>(stage));
    part.units += units;
    part.work_ns += work_ns;
    expected_ns_ += work_ns;
}

void CaseProgress::record_completed(Stage stage, double units) {
    const Part& all = part(stage);
    if (!checkpoints_ || !(all.units > 0.0)) return;
    done_ns_ += all.work_ns * units / all.units;
    checkpoints_->progressed(done_ns_ / expected_ns_);
}

} // namespace shearwake::layered
