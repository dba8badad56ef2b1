// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The quadratic forms of an envelope e, given by its values at the knots: the maximised measure is
/// eta = e' N e / e' D e, and the mean of u^2 over the focal disc is e' F e.
/// All matrices are symmetric and positive semidefinite, in m^2.
/// `path`: for each point of the drawn path (samples_along_path()), the form of the mean of u^2
/// over time; empty if the uniformity is not constrained.
struct Forms {
    Eigen::MatrixXd numerator, denominator, focal;
    std::vector<Eigen::MatrixXd> path = {};
};

/// A column of the table that is a quotient of two quadratic forms of the displacement.
struct Quotient {
    enum class Kind {
        efficiency, // eta_period_1
        sharpness,  // sharpness_1
        share,      // share_{low}_{high}_1, of the trace at trace_m()
        velocity_share
    };
    Kind kind = Kind::efficiency;
    FrequencyBand band; // of a share
};

/// The quotients that the table of a case contains, as names of columns.
std::vector<std::string> quotients_of(const Case& c);

/// The quotient with this name; none if it is not one of quotients_of().
std::optional<Quotient> find_quotient(const Case& c, const std::string& column);

/// The trace of the spectral columns: that of the centre, or the first one.
Vec2 trace_m(const Case& c);

/// A sample of the surface and its weight in a bilinear interpolation.
struct WeightedSample {
    std::ptrdiff_t i = 0, j = 0;
    double weight = 0.0;
};
/// The four samples around each point of the drawn path, at most a grid spacing apart, that are
/// interpolated to it. None if the focus rests.
std::vector<std::array<WeightedSample, 4>> samples_along_path(const Case& c);

/// The uniformity of a computed case: the smallest rms of u over time along the path divided by the
/// mean along the path, from the time mean of u^2 in its file. NaN if the focus rests. Throws
/// FileFailure. Not collective.
double uniformity_of(const Case& c, const std::filesystem::path& file);

/// The quadratic forms of a quotient from the case files of all knots (knot_case()), which store
/// every frame: sums with the weights of the measures. Exact, since the field is linear in the
/// envelope. `c`: the case without envelope; `path`: whether also those of the points of the path.
/// Throws FileFailure. Not collective.
enum class PathForms { omitted, included };
Forms gram_forms(const Case& c, const Quotient& quotient, PathForms path,
                 const std::vector<std::filesystem::path>& knot_files);

/// Whether the case is valid, its window of the measures fits, and in the periodic regime its
/// period is that of its load.
bool can_be_computed(const Case& c);

/// Whether the focus moves along a path at constant speed without rests, and this speed.
bool has_speed(const Case& c);
double speed_m_s(const Case& c);

/// The same load with an oscillating speed, SM-STM. Only for a case with has_speed().
Case with_oscillating_speed(Case c, double frequency_Hz, double deviation_m_s, double phase_rad);

/// A change of the motion of the focus along its path, relative to the job. The speed is
///     v (1 + sine sin(2 pi f t) + cosine cos(2 pi f t)), v the changed mean.
struct MotionChange {
    double size = 1.0, speed = 1.0;  // factors
    int periods = 0;                 // of the speed profile in the window of the measures
    double sine = 0.0, cosine = 0.0; // of the speed profile
    bool operator==(const MotionChange&) const = default;
};

/// The case with a changed motion. Its times, among them the window of the measures and those of an
/// envelope of samples, are scaled with the duration of a pass. None if it is not a valid case
/// then, for example because the path leaves the domain. Only for a case with has_speed().
std::optional<Case> with_motion(const Case& c, const MotionChange& change);

/// Another tissue or speed, in which the robustness of an optimum is computed.
struct Difference {
    double c_s = 1.0, viscosity = 1.0, speed = 1.0; // factors
};

/// The case in the other tissue or at the other speed; none if it is not a valid case then.
std::optional<Case> with_difference(const Case& c, const Difference& difference);

/// The knots of an envelope, between which it is linear: at t = 0, interval, 2 interval, ..., in
/// the transient regime up to the instant of the measures and in the periodic regime over one
/// period.
struct Knots {
    std::ptrdiff_t count = 0;
    double interval_s = 0.0;
    bool repeat = false;
};

/// The knots of a case, about `interval_s` apart.
Knots knots_of(const Case& c, double interval_s);

/// The forms of a case as JSON with its checksum. Numbers are read back exactly.
std::string forms_text(const std::string& id, const Knots& knots, const Forms& forms);

/// Throws UsageError (bad_job) if a case with these knots cannot be optimised.
void require_optimisable(const Case& c, const std::string& id, const Knots& knots,
                         const OptimiseOptions& options);

/// The case whose envelope is 1 at one knot and 0 at all others, which stores every frame of the
/// first depth and the trace of the spectral columns, and nothing else.
Case knot_case(const Case& c, const Knots& knots, std::ptrdiff_t knot);

/// The case that stores only what the maximised measure and the strength need.
Case without_record(Case c);

/// The window of the measures over periods [s].
double window_s(const Case& c);

} // namespace shearwake::optimise
