// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/afferents.hpp"
#include "problem/case/solver_options.hpp"
#include "problem/case/volume.hpp"
#include "problem/load/load.hpp"
#include "problem/medium/medium.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A medium and the load on its surface.
struct Scene {
    Medium medium;
    Load load;
    bool operator==(const Scene&) const = default;
};

/// The surface outside of the domain: copies of it, or an infinite plane that carries no load.
enum class DomainEdges { periodic, open };
constexpr auto names_of(std::type_identity<DomainEdges>) {
    return std::array{"periodic", "open"};
}

/// Rectangle centred on the origin with points x_i = (i - nx/2) spacing and y_j = (j -
/// ny/2) spacing. nx and ny are even products of 2, 3, 5 and 7 of at least extent / spacing.
struct Domain {
    std::ptrdiff_t nx = 0;
    std::ptrdiff_t ny = 0;
    double spacing_m = 0.0;
    double sponge_m = 0.0; // width of the margin on each side that is excluded from the measures
    DomainEdges edges = DomainEdges::periodic;
    bool operator==(const Domain&) const = default;

    double extent_x_m() const { return static_cast<double>(nx) * spacing_m; }
    double extent_y_m() const { return static_cast<double>(ny) * spacing_m; }
    double x_m(std::ptrdiff_t i) const { return static_cast<double>(i - nx / 2) * spacing_m; }
    double y_m(std::ptrdiff_t j) const { return static_cast<double>(j - ny / 2) * spacing_m; }
    bool contains(Vec2 at_m) const {
        return std::abs(at_m.x) <= 0.5 * extent_x_m() && std::abs(at_m.y) <= 0.5 * extent_y_m();
    }
};

/// The load begins at t = 0, when nothing has moved; or it has always repeated.
enum class Regime { transient, periodic };
constexpr auto names_of(std::type_identity<Regime>) {
    return std::array{"transient", "periodic"};
}

/// Frames are at t = interval, 2 interval, ..., frames interval. In the periodic regime they cover
/// one period, and the last one is also the one at t = 0.
struct TimeAxis {
    std::ptrdiff_t frames = 0;
    double interval_s = 0.0;
    Regime regime = Regime::transient;
    bool operator==(const TimeAxis&) const = default;

    double duration_s() const { return static_cast<double>(frames) * interval_s; }
    double frame_s(std::ptrdiff_t n) const { return static_cast<double>(n + 1) * interval_s; }
};

struct FrequencyBand {
    double low_Hz = 0.0, high_Hz = 0.0;
    bool operator==(const FrequencyBand&) const = default;
};

/// The weight of the frames in the `_period_` columns.
enum class PeriodWeight { whole_periods, sliding };
constexpr auto names_of(std::type_identity<PeriodWeight>) {
    return std::array{"whole-periods", "sliding"};
}

/// Whether the level of sensation is computed: in the periodic regime, always or never.
enum class Sensation { by_regime, on, off };
constexpr auto names_of(std::type_identity<Sensation>) {
    return std::array{"by-regime", "on", "off"};
}

/// Position and time of the measurements.
struct MeasureOptions {
    double at_s = 0.0; // the instant, and the end of the window of the `_period_` columns
    double settled_after_s = 0.0; // the window begins no earlier than this
    PeriodWeight window = PeriodWeight::whole_periods;
    double focal_radius_m = 0.0;
    std::vector<double> depths_m = {0.0};
    std::vector<FrequencyBand>
        bands;                  // each gives a column with its share of the energy at the centre
    std::vector<Vec2> region_m; // corners of the measured polygon; none: all inside the sponge
    Sensation sensation = Sensation::by_regime;
    bool operator==(const MeasureOptions&) const = default;
};

/// How the level of sensation is computed (measures/sensation.hpp).
struct SensationOptions {
    /// Centre [Hz] and threshold [m/s^2 rms] of consecutive third octaves; none: the built-in
    /// table.
    std::vector<Vec2> threshold;
    std::vector<Vec2>
        line_m; // start and end of the line on which maxima are counted; none: default
    bool operator==(const SensationOptions&) const = default;
};

/// A scanning laser Doppler vibrometer, which measures the velocity of points of the skin along its
/// line of sight, one point after the other.
struct VibrometerOptions {
    std::vector<Vec2> points_m;
    double tilt_rad = 0.0;                     // of the line of sight from the normal of the skin
    double azimuth_rad = 0.0;                  // direction of the tilt, from x towards y
    double offset_x_m = 0.0, offset_y_m = 0.0; // true minus nominal positions
    double spot_m = 0.0;                       // diameter over which the motion is averaged
    double rate_Hz = 0.0;                      // samples per second; 0: one per frame
    double high_pass_Hz = 0.0, low_pass_Hz = 0.0; // 0: none
    double noise_m_s_rtHz = 0.0;                  // one-sided density
    int averages = 1;
    double trigger_delay_s = 0.0; // from the start of the load to the first sample
    double missing_share = 0.0;   // of the points, without signal
    std::ptrdiff_t seed = 1;
    bool operator==(const VibrometerOptions&) const = default;

    /// The direction from the vibrometer to the skin; velocities along it are positive.
    Vec3 line_of_sight() const {
        return {std::sin(tilt_rad) * std::cos(azimuth_rad),
                std::sin(tilt_rad) * std::sin(azimuth_rad), std::cos(tilt_rad)};
    }
    bool is_tilted() const { return tilt_rad != 0.0; }
};

/// All parameters of one simulation in SI units, as a comparable value.
struct Case {
    Scene scene;
    Domain domain;
    TimeAxis time;
    MeasureOptions measure;
    RecordOptions record;
    SolverOptions solver;
    std::optional<AfferentOptions> afferents; // none: no afferents are simulated
    std::optional<VibrometerOptions> vibrometer = std::nullopt;
    std::optional<SensationOptions> sensation = std::nullopt; // none: the defaults
    bool operator==(const Case&) const = default;
};

/// Whether the level of sensation is computed.
inline bool computes_sensation(const Case& c) {
    return c.measure.sensation == Sensation::on ||
           (c.measure.sensation == Sensation::by_regime && c.time.regime == Regime::periodic);
}

/// The depths of the receptors at which a case requests the stress, ascending; empty if it does
/// not.
std::vector<double> stress_depths_m(const Case& c);

/// Whether a case requests the tangential displacement of the surface.
bool wants_tangential(const Case& c);

/// The engine's name in job files and tables.
std::string engine_name(const SolverOptions& solver);
/// The names of all engines, in the order of the variant.
std::vector<std::string> engine_names();

/// The smallest even product of 2, 3, 5 and 7 that is at least `n`, a length with fast FFTs.
std::ptrdiff_t good_even_length(std::ptrdiff_t n);

/// The complete case as TOML in SI units, with defaults, exact numbers and a fixed order of keys.
/// Two cases have the same text if and only if they are equal.
std::string canonical_text(const Case& c);

/// How many numbers of long lists the canonical text represents by hashes.
double hashed_numbers(const Case& c);

/// Sixteen hexadecimal digits: the hash of the canonical text.
std::string case_id(const Case& c);
/// The id, with another first digit if it consists of digits and at most one e, which programs that
/// read tables would take as a number.
std::string avoid_numeric_id(std::string id);

} // namespace shearwake
