#pragma once

#include "model/afferents.hpp"
#include "model/grid_study.hpp"
#include "model/load.hpp"
#include "model/medium.hpp"
#include "model/volume.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// Periodic rectangle centred on the origin, and its points x_i = (i - nx/2) spacing, likewise y.
/// nx, ny are even products of 2, 3, 5 and 7, at least extent / spacing.
struct Domain {
    std::ptrdiff_t nx = 0;
    std::ptrdiff_t ny = 0;
    double spacing_m = 0.0;
    double sponge_m = 0.0; // width of the margin on each side that is not measured
    bool operator==(const Domain&) const = default;

    double extent_x_m() const { return static_cast<double>(nx) * spacing_m; }
    double extent_y_m() const { return static_cast<double>(ny) * spacing_m; }
    double x_m(std::ptrdiff_t i) const { return static_cast<double>(i - nx / 2) * spacing_m; }
    double y_m(std::ptrdiff_t j) const { return static_cast<double>(j - ny / 2) * spacing_m; }
    bool holds(Vec2 at_m) const {
        return std::abs(at_m.x) <= 0.5 * extent_x_m() && std::abs(at_m.y) <= 0.5 * extent_y_m();
    }
};

/// Frames stand at t = interval, 2 interval, ..., frames interval; at t = 0 nothing has moved.
struct TimeAxis {
    std::ptrdiff_t frames = 0;
    double interval_s = 0.0;
    bool operator==(const TimeAxis&) const = default;

    double duration_s() const { return static_cast<double>(frames) * interval_s; }
    double frame_s(std::ptrdiff_t n) const { return static_cast<double>(n + 1) * interval_s; }
};

struct FrequencyBand {
    double low_Hz = 0.0, high_Hz = 0.0;
    bool operator==(const FrequencyBand&) const = default;
};

/// What is measured, where and when.
struct MeasureOptions {
    double at_s = 0.0;            // the instant, and the end of the period reading
    double settled_after_s = 0.0; // the period reading begins after this
    double focal_radius_m = 0.0;
    std::vector<double> depths_m = {0.0};
    std::vector<FrequencyBand> bands; // whose share of the centre's energy is a column
    bool operator==(const MeasureOptions&) const = default;
};

/// What is kept besides the measures.
struct RecordOptions {
    std::vector<Vec2> traces_m;
    std::vector<double> snapshots_s;
    bool frames = false;
    std::vector<double> volumes_s;          // ascending, each a frame's time
    std::vector<VolumeField> volume_fields; // each once; empty without volumes
    bool operator==(const RecordOptions&) const = default;
};

/// Engine `layered`: exact for stratified media.
struct LayeredOptions {
    std::optional<double> time_step_s;     // of the load; none: chosen from the load's bandwidth
    double window_factor = 2.0;            // period of the time transform over the duration
    double wrap_suppression = 1e6;         // what wraps around in time is divided by this
    double interpolation_tolerance = 1e-9; // of H in |k|, relative to H nearby
    bool operator==(const LayeredOptions&) const = default;
};
/// How engine `spectral` treats what varies laterally.
enum class SpectralMethod { automatic, one_solve, iterative };
/// Engine `spectral`: Fourier in x and y, spectral elements in z, implicit in time.
struct SpectralOptions {
    std::optional<double> time_step_s; // none: chosen from the accuracy
    int degree = 8;
    double longest_element_m = 0.0; // 0: chosen from the load and the layers
    double absorbing_depth_m = 0.0; // below a half-space; 0: chosen from the load and the layer
    SpectralMethod method = SpectralMethod::automatic;
    double residual = 1e-3;       // of the iterations, its energy norm over that of what moves
    double contrast_cap = 1000.0; // stiffer bodies are held to this many times the layer's mu
    double accuracy = 1e-3; // of the surface field, its relative L2 error; decides the time step
    bool operator==(const SpectralOptions&) const = default;
};
/// What lies above the surface z = 0 for engine `pstd`: nothing, the uppermost layer again without
/// end, or a fluid.
enum class PstdTop { nothing, continued, fluid };
/// What `pstd` does with the load: it presses, or the skin under it is moved (PstdOptions).
enum class PstdLoad { traction, displacement };
enum class Precision { single_precision, double_precision };
/// Engine `pstd`: k-Wave's staggered pseudospectral scheme, explicit in time.
struct PstdOptions {
    std::optional<double> time_step_s; // none: chosen from the stability rule
    double c_p_over_c_s = 10.0;        // faster compressional waves are slowed down to this
    PstdTop top = PstdTop::nothing;
    double fluid_density_kg_m3 = 1000.0, fluid_c_p_m_s = 1500.0; // of PstdTop::fluid
    PstdLoad load = PstdLoad::traction;
    double displacement_m = 0.0;     // of PstdLoad::displacement: u_z under the full load
    double depth_m = 0.0;            // clear below the surface; 0: chosen
    int absorbing_points = 16;       // thickness of the layer around the grid
    double absorbing_strength = 1.0; // Np a point at its outer edge
    bool absorbing_edges = false;    // a layer around x and y too; else periodic, or the sponge
    Precision precision = Precision::double_precision;
    SharedStudy study; // instead of all this but the precision, and of the case's medium and load
    bool operator==(const PstdOptions&) const = default;
};
using SolverOptions = std::variant<LayeredOptions, SpectralOptions, PstdOptions>;

/// Everything one simulation needs, in SI units: one comparable value.
struct Case {
    Medium medium;
    Load load;
    Domain domain;
    TimeAxis time;
    MeasureOptions measure;
    RecordOptions record;
    SolverOptions solver;
    std::optional<AfferentOptions> afferents; // none: what is felt is not asked for
    bool operator==(const Case&) const = default;
};

/// The depths of the receptors at which a case asks for the stress, ascending; none: it does not.
std::vector<double> stress_depths_m(const Case& c);

/// The engine's name in job files and tables.
std::string engine_name(const SolverOptions& solver);
/// The names of all engines, in the order of the variant.
std::vector<std::string> engine_names();

/// The smallest even product of 2, 3, 5 and 7 that is at least `n`: a length FFTs like.
std::ptrdiff_t good_even_length(std::ptrdiff_t n);

/// The whole case as TOML in SI units, defaults included, numbers exact, keys in fixed order.
/// Equal cases give equal text and unequal ones do not.
std::string canonical_text(const Case& c);

/// Sixteen hexadecimal digits: the hash of the canonical text.
std::string case_id(const Case& c);

} // namespace shearwake
