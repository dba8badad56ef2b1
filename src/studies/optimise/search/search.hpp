// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/optimise_options.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// The quadratic forms of an envelope e, given by its values at the knots: the maximised measure is
/// eta = e' N e / e' D e, and the strength of the focus is (e' F e / S)^1/2, where S = 1' F 1 is
/// the form of the mean of u^2 over the focal disc for the unmodulated load on the path of the job.
/// All matrices are symmetric and positive semidefinite, in m^2.
/// `path`: for each point of the drawn path (samples_along_path()), the form of the mean of u^2
/// over time; empty if the uniformity is not constrained.
struct Forms {
    Eigen::MatrixXd numerator, denominator, focal;
    std::optional<double> reference = std::nullopt; // S, if the path is not that of the job
    std::vector<Eigen::MatrixXd> path = {};

    Eigen::Index knots() const { return numerator.rows(); }
    double reference_energy() const { return reference ? *reference : focal.sum(); }
};

/// A ratio of two quadratic forms, and its gradient in the values at the knots.
double eta(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// e' F e / S, the square of the strength, and its gradient.
double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope);
Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope);

/// The root of the form of each point of the path.
Eigen::VectorXd rms_along_path(const Forms& forms, const Eigen::VectorXd& envelope);
/// The smallest of these values divided by their mean, from 0 to 1; NaN if all are zero, and
/// without points.
double uniformity(const Eigen::VectorXd& rms);

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
/// envelope. `c`: the case without envelope; `with_path`: also those of the points of the path.
/// Throws FileFailure. Not collective.
Forms gram_forms(const Case& c, const Quotient& quotient, bool with_path,
                 const std::vector<std::filesystem::path>& knot_files);

/// A proof that no envelope between 0 and 1 with at least this strength reaches `eta`: tau, weights
/// w >= 0 and mu >= 0 for which, with M = F + mu (N - eta D), the matrix
///     tau    -w'/2
///     -w/2   diag(w) - M
/// is positive semidefinite and tau < strength^2 S. Its form for (1, e) shows that
///     e'Me <= tau - sum w e (1 - e) <= tau < strength^2 S,
/// but an envelope that reached eta with this strength would have e'Me >= e'Fe >= strength^2 S.
/// It holds for envelopes that are linear between the knots.
struct Certificate {
    double strength = 0.0;
    double eta = 0.0;
    double mu = 0.0;
    double tau = 0.0;        // m^2, as F
    Eigen::VectorXd weights; // m^2
};

/// Whether the certificate is valid. If the least eigenvalue of the matrix is negative, by
/// rounding, tau is increased by its amount times 1 + e'e, at most 1 plus the number of knots. Not
/// collective.
bool is_valid(const Forms& forms, const Certificate& certificate);

/// The smallest eta, to a relative 1e-4, for which there is such a certificate: bisection over eta,
/// and for each a semidefinite program that is solved with a logarithmic barrier. Not collective.
Certificate ceiling(const Forms& forms, double strength);

/// The envelope of the semidefinite program of a bound, from 0 to 1: near the best envelope where
/// the bound is tight, but it may be too weak. Not collective.
Eigen::VectorXd relaxed_envelope(const Forms& forms, const Certificate& certificate);

/// An envelope and its measures.
struct Envelope {
    Eigen::VectorXd values; // at the knots, from 0 to 1
    double eta = 0.0;
    double strength = 0.0; // focal rms divided by that of the unmodulated load
};

/// The measures of an envelope.
Envelope measured(const Forms& forms, Eigen::VectorXd values);
Envelope unmodulated(const Forms& forms);

/// What an envelope must reach, both from 0 to 1. A uniformity above 0 needs the forms of the path.
struct Required {
    double strength = 0.0, uniformity = 0.0;
    bool is_met_by(const Forms& forms, const Eigen::VectorXd& envelope) const;
};

/// Local search from one start for the largest eta with 0 <= e <= 1 that meets the requirements, by
/// sequential quadratic programming (SLSQP of NLopt), with one inequality per point of the path if
/// a uniformity is required. The result satisfies all constraints exactly and is at least as good
/// as the start. If none is found, which is possible only if the unmodulated load does not meet
/// them, its eta is 0. Not collective.
Envelope best_from(const Forms& forms, const Required& required, const Eigen::VectorXd& start);

/// `count` different starts: the unmodulated load, pseudo-random pauses of a full force, sines of
/// different frequencies and phases, and noise. The same for the same arguments.
std::vector<Eigen::VectorXd> starts(Eigen::Index knots, std::size_t count, std::uint64_t seed);

/// The best of the local searches from these starts. Not collective.
Envelope best_envelope(const Forms& forms, const Required& required,
                       const std::vector<Eigen::VectorXd>& starts);

/// False if the program was built without NLopt; the searches then throw.
extern const bool can_search;

/// Largest deviation of an oscillating speed that is searched, relative to the mean.
constexpr double largest_deviation = 0.6;

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

/// The changes around one of them that a round of the search tries: each varied quantity increased
/// and decreased by `step`, or by a fraction of it.
std::vector<MotionChange> changes_around(const MotionChange& centre, double step,
                                         const OptimiseOptions& options);

/// Another tissue or speed, in which the robustness of an optimum is computed.
struct Difference {
    std::string name;
    double c_s = 1.0, viscosity = 1.0, speed = 1.0; // factors
};
/// c_s and viscosities increased and decreased by this relative change in all combinations, and the
/// speed increased and decreased.
std::vector<Difference> differences_by(double relative);

/// The case in the other tissue or at the other speed; none if it is not a valid case then.
std::optional<Case> with_difference(const Case& c, const Difference& difference);

/// The knots of an envelope, between which it is linear: at t = 0, interval, 2 interval, ..., in
/// the transient regime up to the instant of the measures and in the periodic regime over one
/// period.
struct Knots {
    Eigen::Index count = 0;
    double interval_s = 0.0;
    bool repeat = false;

    double at_s(Eigen::Index knot) const { return static_cast<double>(knot) * interval_s; }
};

/// The knots of a case, about `interval_s` apart.
Knots knots_of(const Case& c, double interval_s);

/// The reason why the case cannot be optimised; empty if it can.
std::string why_not(const Case& c, const OptimiseOptions& options);

/// The case with this envelope, given by its values at the knots.
Case with_envelope(Case c, const Knots& knots, const Eigen::VectorXd& values);

/// The case whose envelope is 1 at one knot and 0 at all others, which stores every frame of the
/// first depth and the trace of the spectral columns, and nothing else.
Case knot_case(const Case& c, const Knots& knots, Eigen::Index knot);

/// The window of the measures over periods [s].
double window_s(const Case& c);

/// An envelope as a display accepts it: levels of the sound pressure amplitude from 0 to 2^bits -
/// 1, at equal intervals. The force is proportional to the square of the level.
struct Waveform {
    double interval_s = 0.0;
    int bits = 0;
    bool repeat = false;
    std::vector<int> levels;

    int greatest_level() const { return (1 << bits) - 1; }
};

/// The envelope of the force at exactly this update rate, rounded to the nearest level; the last
/// update of a single pass is at or after its end. Throws UsageError if the period of the load is
/// not a whole number of updates, or for more updates than an envelope of a job may have.
Waveform waveform_of(const Knots& knots, const Eigen::VectorXd& values, double update_rate_Hz,
                     int bits);

/// The force of a waveform, linear between the updates.
SampledGain gain_of(const Waveform& waveform);

/// t_us, x_mm, y_mm, level, pressure and force (both relative to the greatest), one row per update.
/// `trajectory` is that of the focus.
std::string csv_text(const Waveform& waveform, const Trajectory& trajectory);
/// [[load.modulation.envelope]] of a job that reproduces the waveform.
std::string toml_text(const Waveform& waveform);

/// An envelope of AM-STM, 1 - depth/2 (1 + cos(2 pi f t + phase)) at the knots.
struct AmEnvelope {
    double frequency_Hz = 0.0, depth = 0.0, phase_rad = 0.0;
    Envelope envelope;
};

/// The frequencies of AM-STM that are searched: those of the options, or whole numbers of periods
/// in the window with at least six knots per period.
std::vector<double> am_frequencies_Hz(const Case& c, const Knots& knots,
                                      const OptimiseOptions& options);

/// The AM-STM with the largest eta that meets the requirements, over these frequencies and a fine
/// grid of depths and phases; the unmodulated load if none is better, with eta = 0 if it does not
/// meet them either.
AmEnvelope best_am(const Forms& forms, const Knots& knots, const Required& required,
                   const std::vector<double>& frequencies_Hz);

/// One SM-STM on the path of the case.
struct SmCase {
    double frequency_Hz = 0.0, deviation_m_s = 0.0, phase_rad = 0.0;
    Case physics;
    bool is_same(const SmCase& other) const { return physics == other.physics; }
};
/// Its motion, relative to that of the case; none if it has no whole number of periods in the
/// window of the measures.
std::optional<MotionChange> motion_of(const SmCase& sm, const Case& c);

/// The first SM-STM cases of the search for the best one: one to five periods in the window of the
/// measures, four phases, and a deviation of 0.45 times the speed, or the frequencies and
/// deviations of the options. None without a constant speed along a path; cases that cannot be
/// computed, for example because the path ends within the window, are left out.
std::vector<SmCase> sm_cases(const Case& c, const OptimiseOptions& options);

/// The next cases, around one of them: phases that differ by `step` times 45 degrees, and unless
/// the options fix it, deviations that differ by `step` times 0.15 times the speed, up to 0.6 times
/// it.
std::vector<SmCase> sm_around(const Case& c, const SmCase& centre, double step,
                              const OptimiseOptions& options);

} // namespace shearwake::optimise
