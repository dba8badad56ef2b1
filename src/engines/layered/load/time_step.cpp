// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/time_step.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "engines/layered/load/jump_tail.hpp"
#include "engines/layered/load/time_nodes.hpp"
#include "engines/layered/response/gauss_rule.hpp"
#include "engines/layered/response/stack_response.hpp"
#include "problem/case/edges.hpp"
#include "problem/load/load.hpp"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <iterator>
#include <numbers>
#include <span>
#include <tuple>
#include <vector>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

constexpr int wavenumbers = 12;
constexpr std::size_t orders = 3; // jump, kink, bend
constexpr int instants = 33;      // a quarter of a step apart, around the break

/// The response at the focus: the sum over some wavenumbers of the footprint.
struct FocusResponse {
    Medium medium;
    std::vector<double> depths_m;
    std::array<double, wavenumbers> k_rad_m{}, weight{};
    bool operator==(const FocusResponse&) const = default;

    /// By depth.
    Eigen::VectorXcd evaluate(Complex omega_rad_s) const;
};

/// What the powers of TailFit leave out, as signals at instants after a jump, a kink and a bend:
/// [depth][instant].
using Remainders = std::array<Eigen::MatrixXd, orders>;

/// Estimated error of the field after jumps and kinks of the load, relative to the maximum of the
/// field, at the measured depth where it is largest. It is computed at the focus for a few
/// wavenumbers of the footprint, from the difference between H and the sum of powers of TailFit
/// above the highest frequency of the transform. No member function is collective.
class BreakError {
public:
    /// The breaks of breaks_of() for cells of `cell_s`.
    BreakError(const Case& c, std::span<const Break> breaks, double cell_s);
    /// The error for samples `step_s` apart; 0 for a load without breaks.
    double relative(double step_s) const;

private:
    void choose_wavenumbers(const Footprint& footprint);

    double cell_s_;
    std::array<double, orders> sizes_{}; // of the largest jump, kink and bend, over a cell
    Eigen::VectorXd typical_m_Pa_;       // magnitude of the field, by depth
    FocusResponse response_;
    double sigma_m_ = 0.0;
};

/// The spectrum of a footprint falls to this fraction at the end of its band.
constexpr double band_fraction = 1e-6;

/// Any even length: only the frequencies of the fit relative to the highest one matter.
constexpr std::ptrdiff_t probe_samples = 1024;

BreakError::BreakError(const Case& c, std::span<const Break> breaks, double cell_s)
    : cell_s_(cell_s), response_{.medium = c.scene.medium, .depths_m = c.measure.depths_m} {
    for (const Break& each : breaks) {
        sizes_[0] = std::max(sizes_[0], each.jump);
        sizes_[1] = std::max(sizes_[1], each.kink);
        sizes_[2] = std::max(sizes_[2], each.bend);
    }
    if (breaks.empty()) return;
    choose_wavenumbers(c.scene.load.footprint);
    // A frequency at which H has about the magnitude of the field.
    const double omega_rad_s =
        std::max(0.5 * std::numbers::pi / c.time.duration_s(),
                 0.5 * greatest_speed_m_s(c.scene.load.modulation.trajectory) / sigma_m_);
    typical_m_Pa_ = response_.evaluate({omega_rad_s, -0.1 * omega_rad_s}).cwiseAbs();
}

/// Gauss-Laguerre quadrature in (k sigma)^2 / 2 for a Gaussian of the same band, as if the spectrum
/// of the footprint were that along x in all directions.
void BreakError::choose_wavenumbers(const Footprint& footprint) {
    sigma_m_ =
        std::sqrt(-2.0 * std::log(band_fraction)) / bandwidth_rad_m(footprint, band_fraction);
    Eigen::VectorXd diagonal(wavenumbers), beside(wavenumbers - 1); // of the Jacobi matrix
    for (int i = 0; i < wavenumbers; ++i) {
        diagonal(i) = 2 * i + 1;
        if (i > 0) beside(i - 1) = i;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, beside);
    for (int i = 0; i < wavenumbers; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double u = solver.eigenvalues()(i);
        response_.k_rad_m[at] = std::sqrt(2.0 * u) / sigma_m_;
        const double gaussian_m2 = two_pi * sigma_m_ * sigma_m_ * std::exp(-u);
        response_.weight[at] = std::pow(solver.eigenvectors()(0, i), 2) *
                               spectrum(footprint, response_.k_rad_m[at], 0.0) / gaussian_m2;
    }
}

Eigen::VectorXcd FocusResponse::evaluate(Complex omega_rad_s) const {
    const StackResponse response(medium, omega_rad_s, depths_m);
    Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(std::ssize(depths_m)), h(std::ssize(depths_m));
    for (std::size_t i = 0; i < k_rad_m.size(); ++i) {
        response.evaluate(k_rad_m[i], {h.data(), depths_m.size()});
        sum += weight[i] * h;
    }
    return sum;
}

Remainders compute_remainders(const FocusResponse& focus, double step_s) {
    // Damped by 0.2 per step, which smooths the resonances between the few wavenumbers.
    const auto response = [&](double x) { return focus.evaluate(Complex(x, -0.2) / step_s); };
    const TailFit fit(probe_samples, StackQuantity::displacement);
    const Eigen::Index depths = std::ssize(focus.depths_m);
    Eigen::MatrixXd fitted(fit.matrix().cols(), depths);
    for (std::size_t v = 0; v < fit.frequencies().size(); ++v) {
        const Eigen::VectorXcd h =
            response(two_pi * static_cast<double>(fit.frequencies()[v]) / probe_samples);
        fitted.row(static_cast<Eigen::Index>(2 * v)) = h.real();
        fitted.row(static_cast<Eigen::Index>(2 * v + 1)) = h.imag();
    }
    const Eigen::MatrixXd powers = fit.matrix() * fitted; // [power][depth]
    Remainders left;
    left.fill(Eigen::MatrixXd::Zero(depths, instants));
    for (const auto& [from, to, nodes] : {std::tuple(0.8, 1.6, 12), std::tuple(1.6, 4.8, 28)})
        for (const auto& [node, weight] : gauss_nodes(nodes)) {
            const double half = 0.5 * (to - from) * std::numbers::pi;
            const double x = half * (1.0 + node) + from * std::numbers::pi;
            Eigen::VectorXcd h = response(x);
            for (Eigen::Index a = 0; a < powers.rows(); ++a)
                h -= std::pow(Complex(0.0, x), -static_cast<int>(a) - fit.lowest_power()) *
                     powers.row(a).transpose();
            h *= weight * half * (1.0 - roll_off(x / std::numbers::pi)) / std::numbers::pi;
            for (Eigen::MatrixXd& signal : left) {
                h /= Complex(0.0, x);
                for (int n = 0; n < instants; ++n)
                    signal.col(n) += (h * std::polar(1.0, 0.25 * x * (n - instants / 2))).real();
            }
        }
    return left;
}

/// The same, remembered for the last few steps and media: the cases of a sweep that differ in
/// their motion and envelope have them in common, and they take milliseconds.
const Remainders& remainders(const FocusResponse& focus, double step_s) {
    struct Known {
        double step_s;
        FocusResponse focus;
        Remainders left;
    };
    constexpr std::size_t most_known = 64;
    thread_local std::vector<Known> known;
    thread_local std::size_t oldest = 0;
    for (const Known& each : known)
        if (each.step_s == step_s && each.focus == focus) return each.left;
    Known added{step_s, focus, compute_remainders(focus, step_s)};
    if (known.size() < most_known) return known.emplace_back(std::move(added)).left;
    Known& replaced = known[oldest++ % most_known];
    replaced = std::move(added);
    return replaced.left;
}

double BreakError::relative(double step_s) const {
    if (typical_m_Pa_.size() == 0) return 0.0;
    const Remainders& left = remainders(response_, step_s);
    Eigen::MatrixXd error = Eigen::MatrixXd::Zero(typical_m_Pa_.size(), instants);
    for (std::size_t b = 0; b < orders; ++b)
        error += sizes_[b] * std::pow(step_s / cell_s_, b) * left[b].cwiseAbs();
    return error.rowwise().maxCoeff().cwiseQuotient(typical_m_Pa_).maxCoeff();
}

/// No shorter step is chosen. It resolves 40 kHz.
constexpr double shortest_step_s = 5e-6;

/// A step is at most this part of the time in which a shear wave crosses a standard deviation of
/// the footprint, if the load has breaks: H resonates at higher frequencies for the wavenumbers of
/// the footprint, and is not yet a sum of powers there, which BreakError underestimates.
constexpr double longest_share_of_crossing = 0.35;

/// The highest frequency of smooth gains.
double smooth_frequency_Hz(const Envelope& envelope) {
    Envelope smooth;
    std::ranges::copy_if(envelope.gains, std::back_inserter(smooth.gains), is_smooth);
    return greatest_envelope_frequency_Hz(smooth);
}

/// The error of samples that are hardly shorter than the edges, whose breaks BreakError finds only
/// if they are several cells apart. Measured for edges of 40 to 150 us on tissue with 5 m/s and a
/// focus of 4 mm: at most 3e-5 for half an edge, 4e-4 for two thirds, and 0.06 for two edges.
double edge_error(const Envelope& envelope, double step_s) {
    constexpr double half_edge_error = 4e-5;
    double sum = 0.0;
    for (const Gain& gain : envelope.gains)
        if (const auto [duration_s, size] = edge_of(gain); duration_s > 0.0)
            sum += size * half_edge_error * std::pow(2.0 * step_s / duration_s, 7);
    return std::min(sum, 1.0);
}

/// A smooth gain needs four times the samples of its frequency: it begins with a break, and
/// JumpTail requires the derivatives there to decrease.
double band_Hz(const Load& load) {
    const double scan = bandwidth_rad_m(load.footprint, band_fraction) *
                        greatest_speed_m_s(load.modulation.trajectory) / two_pi;
    // A focus that is updated at the rate of the array moves in jumps, which have content slightly
    // above that rate.
    const double update = scan > 0.0 ? update_rate_Hz(load.footprint) : 0.0;
    return std::max(scan + greatest_envelope_frequency_Hz(load.modulation.envelope) +
                        carrier_frequency_Hz(load.carrier) + update,
                    4.0 * smooth_frequency_Hz(load.modulation.envelope));
}

/// The longest step that resolves the load, or the step that the options specify.
double longest_step_s(const Case& c, const LayeredOptions& options) {
    if (options.time_step_s) return *options.time_step_s;
    return 1.0 / (2.5 * std::max(band_Hz(c.scene.load), 1.0));
}

/// Of a Gaussian of the same width.
double standard_deviation_m(const Load& load) {
    return fwhm_m(load.footprint) / (2.0 * std::sqrt(2.0 * std::log(2.0)));
}

/// The error at frames within four steps before and after a break counts, hence also that of a
/// break at the last frame, such as the end of a path, or shortly after it.
BreakError break_error(const Case& c, double cell_s) {
    const bool is_periodic = c.time.regime == Regime::periodic;
    const double from_s = is_periodic ? c.time.interval_s : 0.0;
    const double after_s = is_periodic ? 0.0 : 4.0 * cell_s;
    return {c, breaks_of(c.scene.load, from_s, from_s + c.time.duration_s() + after_s, cell_s),
            cell_s};
}

/// The number of samples per frame, from `least` on, for which BreakError is small enough.
std::ptrdiff_t samples_for_breaks(const Case& c, std::ptrdiff_t least) {
    const double sigma_m = standard_deviation_m(c.scene.load);
    const double longest_s =
        longest_share_of_crossing * sigma_m / edge_speed_m_s(c.scene.medium, sigma_m);
    auto count = std::max(least, static_cast<std::ptrdiff_t>(
                                     std::ceil(c.time.interval_s / longest_s * (1.0 - 1e-9))));
    // Finding the breaks takes as long as there are cells in the run.
    if (count == least && c.time.interval_s <= shortest_step_s * static_cast<double>(count))
        return least;
    const BreakError error = break_error(c, c.time.interval_s / static_cast<double>(least));
    if (error.relative(c.time.interval_s) == 0.0) return least;
    // In a period of fewer steps, the windows around a break and its repetition overlap.
    if (c.time.regime == Regime::periodic)
        count =
            std::max(count, static_cast<std::ptrdiff_t>(std::ceil(
                                2.0 * break_window_steps / static_cast<double>(c.time.frames))));
    while (c.time.interval_s > shortest_step_s * static_cast<double>(count) &&
           error.relative(c.time.interval_s / static_cast<double>(count)) > step_accuracy)
        count += std::max<std::ptrdiff_t>(1, count / 4);
    return count;
}

} // namespace

double least_samples(const Case& c, const LayeredOptions& options) {
    const double window = c.time.regime == Regime::periodic ? 1.0 : options.window_factor;
    return window * static_cast<double>(c.time.frames) *
           std::max(1.0, c.time.interval_s / longest_step_s(c, options));
}

TimeTransform time_transform(const Case& c, const LayeredOptions& options) {
    const double ratio = c.time.interval_s / longest_step_s(c, options);
    auto per_frame =
        std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9)));
    if (!options.time_step_s) per_frame = std::max(per_frame, samples_for_breaks(c, per_frame));
    const double window = c.time.regime == Regime::periodic ? 1.0 : options.window_factor;
    const double samples =
        window * static_cast<double>(c.time.frames) * static_cast<double>(per_frame);
    if (!options.time_step_s && samples > most_samples)
        throw UsageError(
            fmt::format("the jumps and kinks of the load require {:.3g} samples in time, {} per "
                        "frame, but at most {:.0e} are supported: use a shorter run, smooth gains "
                        "or solver.layered.time_step_us",
                        samples, per_frame, most_samples),
            ExitCode::bad_job);
    TimeTransform time;
    if (c.time.regime == Regime::periodic) {
        time.samples = c.time.frames * per_frame;
        time.step_s = c.time.interval_s / static_cast<double>(per_frame);
        time.first_s = c.time.interval_s;
        return time;
    }
    const std::ptrdiff_t coarse = good_even_length(static_cast<std::ptrdiff_t>(
        std::ceil(options.window_factor * static_cast<double>(c.time.frames))));
    time.samples = coarse * per_frame;
    time.step_s = c.time.interval_s / static_cast<double>(per_frame);
    time.decay_rad_s =
        std::log(options.wrap_suppression) / (static_cast<double>(time.samples) * time.step_s);
    return time;
}

double step_error(const Case& c, double step_s) {
    const Load& load = c.scene.load;
    const double resolved_rad_s = 0.8 * std::numbers::pi / step_s;
    const double speed_m_s = greatest_speed_m_s(load.modulation.trajectory);
    const double sigma_m = standard_deviation_m(load);
    double unresolved = 0.0;
    if (speed_m_s > 0.0)
        unresolved = std::erfc(resolved_rad_s * sigma_m / (std::sqrt(2.0) * speed_m_s));
    // 1e-9: the step chosen for a sine may be at this limit.
    if (two_pi * smooth_frequency_Hz(load.modulation.envelope) > (1.0 + 1e-9) * resolved_rad_s)
        unresolved = 1.0;
    return unresolved + edge_error(load.modulation.envelope, step_s) +
           break_error(c, step_s).relative(step_s);
}

std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time) {
    return static_cast<std::ptrdiff_t>(std::llround(c.time.interval_s / time.step_s));
}

} // namespace shearwake::layered
