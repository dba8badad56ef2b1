// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/work_clock.hpp"
#include "problem/case/case.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::engines {

/// A kind of work of an engine, such as one step of one grid point, and its seconds per unit on one
/// core of a typical server of 2020. These are used until the machine has been measured.
struct WorkKind {
    const char* name; // name of the timed stage; ".cached" or ".memory" may follow
    double assumed_s;
};

/// The timed stage of a kind (base/work_clock.hpp).
constexpr std::string_view stage_of(std::string_view kind) {
    for (const std::string_view place : {".cached", ".memory"})
        if (kind.ends_with(place)) kind.remove_suffix(place.size());
    return kind;
}

/// One byte of memory that the operating system zeroes on first access; common to all engines.
inline constexpr WorkKind of_fresh_memory = {"memory.fresh", 0.5e-9};

/// Marks its own lifetime as the stage of a kind of work.
struct Timed : StageScope {
    explicit Timed(const WorkKind& kind) : StageScope(stage_of(kind.name)) {}
};

/// An amount of work in units of its kind.
struct Work {
    WorkKind kind;
    double amount = 0.0;
};

/// Measured seconds per unit, by the name of the kind.
using Rates = std::map<std::string, double>;

/// Estimated seconds of the work; kinds without a measured rate use the assumed one.
double time_s(const Work& work, const Rates& rates);
double time_s(const std::vector<Work>& work, const Rates& rates);

/// A case of about 0.1 s. Its time in the stage of the kind, less the time of other kinds in that
/// stage, gives the rate. Kinds without a timed stage share the remaining time of the case.
struct Calibration {
    std::string kind;
    Case physics;
};

/// Layers of a calibration case: Kelvin-Voigt, 1000 kg/m^3, c_p = 1500 m/s; a thickness of 0 stands
/// for a half-space.
struct CalibrationLayer {
    double thickness_m, c_s_m_s, viscosity_Pa_s;
};
/// A case for calibration, in which a Gaussian focus of this width scans along x at 5 m/s.
Case calibration_case(const std::vector<CalibrationLayer>& layers, double fwhm_m,
                      const Domain& domain, const TimeAxis& time);

/// The work in the stage of a kind and its measured seconds.
struct MeasuredWork {
    std::string kind;
    std::vector<Work> work;
    double seconds = 0.0;
};
/// Rates that explain the measured seconds of the stages, given the work in each. They are found by
/// Gauss-Seidel iteration, which converges because one kind dominates each stage. `known` contains
/// other rates. Each rate stays within a factor of 4 of the assumed rate times the median slowness
/// of this machine, so that kinds that a case cannot separate share its seconds. Throws Error if a
/// calibration case contains no work of its kind. Not collective.
Rates solve_rates(const std::vector<MeasuredWork>& measured, Rates known);

/// The share of work that is limited by memory rather than by caches if a rank repeatedly touches
/// `touched_B` bytes: logarithmic interpolation between the two calibrated sizes. The defaults are
/// within the second-level cache of most CPUs and beyond a rank's part of the third-level cache.
double share_from_memory(double touched_B, double in_cache_B = 2e6, double in_memory_B = 50e6);

} // namespace shearwake::engines
