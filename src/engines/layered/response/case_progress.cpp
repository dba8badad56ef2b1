// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/case_progress.hpp"

#include <algorithm>
#include <chrono>

namespace shearwake::layered {
namespace {

/// A stage that has taken this time has a measured rate.
constexpr double measurable_s = 0.05;

} // namespace

Clock_s steady_clock_s() {
    return [] {
        const auto now = std::chrono::steady_clock::now().time_since_epoch();
        return std::chrono::duration<double>(now).count();
    };
}

CaseProgress::CaseProgress(engines::Checkpoints* checkpoints, Clock_s clock)
    : checkpoints_(checkpoints), clock_(std::move(clock)), began_s_(clock_()), last_s_(began_s_) {
    if (checkpoints_) checkpoints_->progressed(0.0);
}

void CaseProgress::expect(Stage stage, double units, double seconds) {
    Part& part = parts_.at(static_cast<std::size_t>(stage));
    part.units += units;
    part.expected_s += seconds;
}

bool CaseProgress::Part::is_measured() const {
    return done > 0.0 && measured_s >= measurable_s;
}

double CaseProgress::Part::left_s(double slowness) const {
    if (done >= units) return 0.0;
    const double unit_s = is_measured() ? measured_s / done : slowness * expected_s / units;
    return (units - done) * unit_s;
}

double CaseProgress::slowness() const {
    double measured_s = 0.0, expected_s = 0.0;
    for (const Stage stage : {Stage::radial, Stage::expansion, Stage::samples, Stage::frames}) {
        const Part& part = parts_.at(static_cast<std::size_t>(stage));
        if (!part.is_measured() || part.units <= 0.0) continue;
        measured_s += part.measured_s;
        expected_s += part.expected_s * std::min(1.0, part.done / part.units);
    }
    return expected_s > 0.0 ? measured_s / expected_s : 1.0;
}

void CaseProgress::did(Stage stage, double units) {
    if (!checkpoints_) return;
    Part& part = parts_.at(static_cast<std::size_t>(stage));
    const double now_s = clock_();
    part.measured_s += now_s - last_s_;
    part.done += units;
    last_s_ = now_s;
    double left_s = 0.0;
    const double slow = slowness();
    for (const Part& each : parts_)
        left_s += each.left_s(slow);
    const double elapsed_s = now_s - began_s_;
    if (elapsed_s > 0.0) share_ = std::max(share_, elapsed_s / (elapsed_s + left_s));
    checkpoints_->progressed(share_);
}

void CaseProgress::report_times(const std::array<engines::Work, stages>& work) const {
    if (!checkpoints_) return;
    for (std::size_t i = 0; i < stages; ++i)
        if (const Part& part = parts_.at(i); part.units > 0.0 && part.done >= part.units)
            checkpoints_->timed({work.at(i), part.measured_s});
}

} // namespace shearwake::layered
