// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/layered_engine.hpp"
#include "engines/layered/load/load_spectrum.hpp"
#include "engines/layered/load/time_step.hpp"
#include "engines/layered/open_domain.hpp"
#include "engines/layered/response/case_progress.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::layered {
namespace {

using namespace kinds;

/// Number of depths of the stress and of components of the tangential displacement.
double other_fields(const Case& c) {
    return static_cast<double>(stress_depths_m(c).size()) + (wants_tangential(c) ? 2.0 : 0.0);
}

using Complex = std::complex<double>;

/// Limit for the spectra of all frames of a rank. Above it, the time transforms are repeated for
/// each batch of frames.
constexpr double largest_batch_B = 200e6;

/// Number of frequencies at which the panels of H are fitted for an estimate.
constexpr std::ptrdiff_t tried_frequencies = 6;

double reach_m(const TransferKey& key) {
    return open_reach_m(key.nx, key.ny, key.spacing_m);
}

/// Of the interpolation of the loss: a hundredth of the imbalance that causes a warning, and above
/// the rounding of StackResponse::loss.
constexpr double tolerance_of_loss = 1e-8;

/// Time of an evaluation of the loss divided by that of H.
constexpr double time_of_loss = 5.0;

/// Number of evaluations of H for all frequencies. It depends on how finely its poles divide |k|. A
/// few frequencies are therefore fitted, which takes some milliseconds.
double evaluations(const TransferKey& key) {
    if (key.depths_m.empty()) return 0.0;
    const double k_max = std::numbers::pi / key.spacing_m * std::numbers::sqrt2;
    const std::ptrdiff_t frequencies = key.time.samples / 2 + 1;
    const std::ptrdiff_t tried = std::min(tried_frequencies, frequencies);
    const bool is_loss = key.quantity == StackQuantity::loss;
    double count = 0.0;
    for (std::ptrdiff_t i = 0; i < tried; ++i) {
        // Each frequency represents the middle of its share.
        // At rest H of a half-space is singular at k = 0.
        const std::ptrdiff_t m = std::max<std::ptrdiff_t>((2 * i + 1) * frequencies / (2 * tried),
                                                          key.time.decay_rad_s > 0.0 ? 0 : 1);
        const StackResponse response(key.medium, key.time.omega(m), key.depths_m, key.quantity);
        if (is_loss) {
            count += RadialInterpolant::order * 2.0 *
                     static_cast<double>(fit_loss(response, key.spacing_m, key.tolerance).panels());
            continue;
        }
        RadialInterpolant::fit(
            [&](double k, std::span<Complex> out) {
                count += 1.0;
                response.evaluate(k, out);
            },
            key.depths_m.size(), k_max, key.tolerance);
    }
    if (is_loss) count *= time_of_loss;
    const double nodes =
        key.edges == DomainEdges::open && !is_loss
            ? static_cast<double>(point_rule(key.spacing_m, reach_m(key)).k_rad_m.size())
            : 0.0;
    return (count / static_cast<double>(tried) + nodes) * static_cast<double>(frequencies);
}

/// Products of nodes and radii for the radial tables of an open plane. A Bessel function takes as
/// long as 600 products for a complex argument and as long as 150 for a real one.
double radial_products(const TransferKey& key) {
    if (key.edges != DomainEdges::open || key.depths_m.empty()) return 0.0;
    const bool is_loss = key.quantity == StackQuantity::loss;
    const double radii = radii_per_spacing * reach_m(key) / key.spacing_m;
    const double columns = std::floor(static_cast<double>(key.time.samples) / 2.0 + 1.0) *
                           static_cast<double>(key.depths_m.size());
    if (is_loss)
        return static_cast<double>(FixedPanels(key.spacing_m, reach_m(key)).nodes_rad_m().size()) *
               radii * (2.0 * columns + 150.0);
    return static_cast<double>(point_rule(key.spacing_m, reach_m(key)).k_rad_m.size()) * radii *
           (4.0 * columns + 600.0);
}

/// Memory in bytes of the Bessel functions that the table keeps for further media.
double kept_bessel_B(const TransferKey& key) {
    if (key.edges != DomainEdges::open || key.depths_m.empty()) return 0.0;
    const std::size_t radii = table_radii(key.spacing_m, reach_m(key));
    if (key.quantity == StackQuantity::loss)
        return BesselBlocks<double>::kept_B(
            FixedPanels(key.spacing_m, reach_m(key)).nodes_rad_m().size(), radii);
    return BesselBlocks<Complex>::kept_B(point_rule(key.spacing_m, reach_m(key)).k_rad_m.size(),
                                         radii);
}

/// Typical number of evaluations of H per frequency, until their time has been measured.
constexpr double typical_evaluations = 500.0;

/// A case with two layers, dermis and fat.
Case calibration_case(std::ptrdiff_t nx, std::ptrdiff_t ny, std::ptrdiff_t frames) {
    return engines::calibration_case({{2e-3, 3.65, 1.0}, {18e-3, 2.24, 1.0}}, 4e-3,
                                     {nx, ny, 1e-3, 0.0}, {frames, 100e-6});
}

} // namespace

TransferKey key_of(const Case& c, const LayeredOptions& options) {
    std::vector<double> depths_m = c.measure.depths_m;
    if (c.time.regime == Regime::periodic && depths_m.front() > 0.0)
        depths_m.insert(depths_m.begin(), 0.0);
    return {.medium = c.scene().medium,
            .depths_m = depths_m,
            .nx = c.domain.nx,
            .ny = c.domain.ny,
            .spacing_m = c.domain.spacing_m,
            .time = time_transform(c, options),
            .tolerance = options.interpolation_tolerance,
            .edges = c.domain.edges};
}

TransferKey stress_key_of(const Case& c, const TransferKey& displacement) {
    TransferKey key = displacement;
    key.depths_m = stress_depths_m(c);
    key.quantity = StackQuantity::compression;
    return key;
}

TransferKey tangential_key_of(const Case& c, const TransferKey& displacement) {
    TransferKey key = displacement;
    key.depths_m = wants_tangential(c) ? std::vector{0.0} : std::vector<double>{};
    key.quantity = StackQuantity::tangential;
    return key;
}

TransferKey loss_key_of(const Case& c, const TransferKey& displacement) {
    TransferKey key = displacement;
    key.depths_m.clear();
    if (c.time.regime == Regime::periodic) key.depths_m.push_back(0.0);
    key.quantity = StackQuantity::loss;
    key.tolerance = tolerance_of_loss;
    return key;
}

std::ptrdiff_t frames_per_batch(const Case& c, std::ptrdiff_t ky_count) {
    const double frame_B =
        static_cast<double>(c.domain.nx) * static_cast<double>(ky_count) * sizeof(Complex);
    const auto fitting = static_cast<std::ptrdiff_t>(largest_batch_B / std::max(frame_B, 1.0));
    return std::clamp<std::ptrdiff_t>(fitting, 1, c.time.frames);
}

void expect_table(CaseProgress& progress, const TransferKey& key, std::ptrdiff_t ky_count,
                  int ranks) {
    using Stage = CaseProgress::Stage;
    if (key.depths_m.empty()) return;
    const bool is_open = key.edges == DomainEdges::open;
    const auto depths = static_cast<double>(key.depths_m.size());
    const double frequencies = std::floor(static_cast<double>(key.time.samples) / 2.0) + 1.0;
    // With open edges H is evaluated on the contour as well.
    const double fits = (is_open ? 2.0 : 1.0) * std::ceil(frequencies / ranks);
    const double layers = static_cast<double>(key.medium.layers.size());
    progress.expect(Stage::response, fits,
                    fits * typical_evaluations * layers * of_response.assumed_s);
    if (is_open)
        progress.expect(Stage::radial,
                        static_cast<double>(radial_blocks(key.spacing_m, reach_m(key))),
                        radial_products(key) * of_radial.assumed_s / ranks);
    if (!is_open &&
        TransferTable::expanded_bytes(key, ky_count) > TransferTable::largest_expansion_B)
        return;
    const double points = static_cast<double>(key.nx) * static_cast<double>(key.ny);
    progress.expect(Stage::expansion,
                    depths * (is_open ? frequencies : static_cast<double>(ky_count)),
                    depths * points * static_cast<double>(key.time.samples) *
                        (is_open ? of_open_expansion : of_expansion).assumed_s / ranks);
}

void expect_frames(CaseProgress& progress, const Case& c, const TransferKey& key,
                   std::ptrdiff_t ky_count, int ranks) {
    using Stage = CaseProgress::Stage;
    const double depths = static_cast<double>(c.measure.depths_m.size()) + other_fields(c);
    const auto frames = static_cast<double>(c.time.frames);
    const double batches = std::ceil(frames / static_cast<double>(frames_per_batch(c, ky_count)));
    const bool along_x = LoadSpectrum::keeps_y(c, key.time);
    const std::ptrdiff_t kept_nx = along_x ? c.domain.nx / 2 + 1 : c.domain.nx;
    const double lines = depths * batches * static_cast<double>(ky_count * kept_nx);
    const double sample_s = of_far_sample.assumed_s + (along_x ? 0.0 : of_load.assumed_s);
    progress.expect(Stage::samples, lines,
                    2.0 * lines * static_cast<double>(key.time.samples) * sample_s);
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    progress.expect(Stage::frames, depths * frames,
                    depths * frames * points * of_far_frame.assumed_s / ranks);
}

double LayeredEngine::evaluations_per_frequency(const TransferKey& key, const TransferKey& stress,
                                                const TransferKey& loss) const {
    TransferKey curves = key; // without the range of frequencies, on which the panels do not depend
    if (key.edges != DomainEdges::open) curves.nx = curves.ny = 0;
    curves.time = {};
    const double frequencies = std::floor(static_cast<double>(key.time.samples) / 2.0) + 1.0;
    if (!tried_ || !(tried_->curves == curves))
        tried_ = {curves,
                  (evaluations(key) + evaluations(stress) + evaluations(loss)) / frequencies};
    return tried_->evaluations;
}

engines::Estimate LayeredEngine::estimate(const Case& given, int ranks) const {
    const Case c = solved_case(given);
    const auto& options = std::get<LayeredOptions>(c.solver);
    const TransferKey key = key_of(c, options);
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    const double stresses = other_fields(c);
    const double depths = static_cast<double>(c.measure.depths_m.size()) + stresses;
    const double samples = static_cast<double>(key.time.samples);
    const double frames = static_cast<double>(c.time.frames);
    const std::ptrdiff_t modes = c.domain.ny / 2 + 1;
    const std::ptrdiff_t ky_count = fft::most_rows(c.domain.ny, ranks);
    const std::ptrdiff_t in_batch = frames_per_batch(c, ky_count);
    const double batches = std::ceil(frames / static_cast<double>(in_batch));
    const bool along_x = LoadSpectrum::keeps_y(c, key.time); // kx < 0 mirrors kx > 0
    const std::ptrdiff_t kept_nx = along_x ? c.domain.nx / 2 + 1 : c.domain.nx;
    const double batch_B = static_cast<double>(in_batch * ky_count * kept_nx) * sizeof(Complex);
    const TransferKey stress = stress_key_of(c, key), loss = loss_key_of(c, key);
    const double own_B = TransferTable::expanded_bytes(key, ky_count);
    const double stress_B = TransferTable::expanded_bytes(stress, ky_count) +
                            TransferTable::expanded_bytes(tangential_key_of(c, key), ky_count);
    const double loss_B = TransferTable::expanded_bytes(loss, ky_count);
    const bool is_open = c.domain.edges == DomainEdges::open;
    const auto is_kept = [&](double table_B) {
        return is_open || table_B <= TransferTable::largest_expansion_B;
    };
    const auto kept = [&](double table_B) { return is_kept(table_B) ? table_B : 0.0; };
    const double kept_B = kept(own_B) + kept(stress_B) + loss_B;
    engines::Estimate e;
    // The program, the spectra, H, the phases of the load, the transformed plane, and Bessel
    // functions.
    e.memory_per_rank_B = engines::program_B + batch_B + kept_B + points * sizeof(double) / ranks +
                          static_cast<double>(c.domain.nx * key.time.samples) * sizeof(Complex) +
                          LoadSpectrum::memory_B(c, key.time, ky_count) + kept_bessel_B(key) +
                          kept_bessel_B(loss);
    const double far = engines::share_from_memory(batch_B + kept(own_B) / (depths - stresses));
    const double all_samples = batches * depths * samples * static_cast<double>(kept_nx) *
                               static_cast<double>(c.domain.ny);
    e.work = {{of_sample, all_samples * (1.0 - far)},
              {of_far_sample, all_samples * far},
              {of_frame, depths * points * frames * (1.0 - far)},
              {of_far_frame, depths * points * frames * far}};
    if (!along_x) e.work.push_back({of_load, all_samples});
    const double frequencies = std::floor(samples / 2.0) + 1.0;
    e.shared = {{of_response, frequencies * evaluations_per_frequency(key, stress, loss) *
                                  static_cast<double>(c.scene().medium.layers.size())},
                {of_radial, radial_products(key) + radial_products(stress) + radial_products(loss)},
                {engines::of_fresh_memory, ranks * (batch_B + kept_B)}};
    const auto expand = [&](double table_B, double table_depths) {
        const double amount = table_depths * points * samples;
        if (is_kept(table_B))
            e.shared.push_back({is_open ? of_open_expansion : of_expansion, amount});
        else
            e.work.push_back({of_expansion, batches * amount});
    };
    expand(own_B, depths - stresses);
    if (stresses > 0.0) expand(stress_B, stresses);
    if (loss_B > 0.0) expand(loss_B, 1.0);
    e.useful_ranks = static_cast<int>(std::min(c.domain.nx, fft::below_nyquist(c.domain.ny)));
    e.all_to_alls = depths * frames;
    e.all_to_all_B = sizeof(Complex) * static_cast<double>(c.domain.nx * modes);
    return e;
}

std::vector<engines::Calibration> LayeredEngine::calibrations() const {
    const Case near = calibration_case(48, 36, 100), far = calibration_case(256, 192, 220),
               response = calibration_case(64, 48, 60);
    Case expansion = calibration_case(192, 144, 16), load = near, radial = response;
    radial.domain.edges = DomainEdges::open;
    Case open_expansion = calibration_case(96, 72, 60);
    open_expansion.domain.edges = DomainEdges::open;
    std::get<Travel>(load.scene().load.modulation.trajectory.parts[0]).path = {{-1e-2, 0.0},
                                                                               {1.0, 0.1}};
    expansion.measure.depths_m = {0.0, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3};
    return {{of_frame.name, near},
            {of_far_frame.name, far},
            {of_sample.name, near},
            {of_far_sample.name, far},
            {of_load.name, load},
            {of_response.name, response},
            {of_radial.name, radial},
            {of_expansion.name, expansion},
            {of_open_expansion.name, open_expansion}};
}

} // namespace shearwake::layered
