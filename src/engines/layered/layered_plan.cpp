// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/layered/load/load_spectrum.hpp"
#include "engines/layered/load/time_step.hpp"
#include "engines/layered/response/case_progress.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::layered {
namespace {

/// Number of depths of the stress and of components of the tangential displacement.
double other_fields(const Case& c) {
    return static_cast<double>(stress_depths_m(c).size()) + (wants_tangential(c) ? 2.0 : 0.0);
}

using Complex = std::complex<double>;

/// Limit for the spectra of all frames of a rank. Above it, the time transforms are repeated for
/// each batch of frames.
constexpr double largest_batch_B = 200e6;

double reach_m(const TransferKey& key) {
    return open_reach_m(key.nx, key.ny, key.spacing_m);
}

/// Of the interpolation of the loss: a hundredth of the imbalance that causes a warning, and above
/// the rounding of StackResponse::loss.
constexpr double tolerance_of_loss = 1e-8;

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
double cached_bessel_B(const TransferKey& key) {
    if (key.edges != DomainEdges::open || key.depths_m.empty()) return 0.0;
    const std::size_t radii = table_radii(key.spacing_m, reach_m(key));
    if (key.quantity == StackQuantity::loss)
        return BesselBlocks<double>::cached_B(
            FixedPanels(key.spacing_m, reach_m(key)).nodes_rad_m().size(), radii);
    return BesselBlocks<Complex>::cached_B(point_rule(key.spacing_m, reach_m(key)).k_rad_m.size(),
                                           radii);
}

/// Time in ns of one core: of the evaluations of H per layer and frequency; of a product for the
/// radial tables; per point; and per point, time sample or frame, and depth. Measured on an AVX-512
/// processor.
constexpr double response_ns = 7e5, radial_ns = 1.1, expansion_ns = 13.0, open_expansion_ns = 30.0,
                 setup_ns = 2e3, sample_ns = 16.0, moving_sample_ns = 22.0, frame_ns = 24.0;

/// Where a Gaussian has fallen to 3e-8 of its peak, in widths (FWHM).
constexpr double gaussian_reach_fwhm = 2.5;
constexpr double fewest_samples = 4000.0; // of the path

/// The largest |x| and |y| of the load within the run.
Vec2 extent_of_load_m(const Case& c) {
    const Load& load = c.scene.load;
    const double end_s = std::min(c.time.duration_s(), off_time_s(load.modulation.trajectory));
    const double steps = std::max(fewest_samples, static_cast<double>(c.time.frames));
    Vec2 most;
    for (double n = 0.0; n <= steps; ++n)
        for (const Vec2 focus : foci(load.modulation, end_s * n / steps))
            most = {std::max(most.x, std::abs(focus.x)), std::max(most.y, std::abs(focus.y))};
    const double around =
        reach_m(load.footprint).value_or(gaussian_reach_fwhm * fwhm_m(load.footprint));
    return most + Vec2{around, around};
}

std::ptrdiff_t enlarged(std::ptrdiff_t points, double spacing_m, double load_m) {
    const double extent = static_cast<double>(points);
    const double eighths = std::ceil(8.0 + 16.0 * load_m / (spacing_m * extent) - 1e-9);
    return good_even_length(
        static_cast<std::ptrdiff_t>(std::ceil(extent * std::min(eighths, 16.0) / 8.0)));
}

/// Number of frames whose spectra are in memory at the same time, on a rank with ky_count rows.
std::ptrdiff_t frames_per_batch(const Case& c, std::ptrdiff_t ky_count) {
    const double frame_B =
        static_cast<double>(c.domain.nx) * static_cast<double>(ky_count) * sizeof(Complex);
    const auto fitting = static_cast<std::ptrdiff_t>(largest_batch_B / std::max(frame_B, 1.0));
    return std::clamp<std::ptrdiff_t>(fitting, 1, c.time.frames);
}

} // namespace

TransferKey key_of(const Case& c, const LayeredOptions& options) {
    std::vector<double> depths_m = c.measure.depths_m;
    if (c.time.regime == Regime::periodic && depths_m.front() > 0.0)
        depths_m.insert(depths_m.begin(), 0.0);
    return {.medium = c.scene.medium,
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

void expect_table(CaseProgress& progress, const TransferKey& key, std::ptrdiff_t ky_count,
                  int ranks) {
    using Stage = CaseProgress::Stage;
    if (key.depths_m.empty()) return;
    const bool is_open = key.edges == DomainEdges::open;
    const auto depths = static_cast<double>(key.depths_m.size());
    const double frequencies = std::floor(static_cast<double>(key.time.samples) / 2.0) + 1.0;
    // With open edges H is evaluated on the contour as well.
    const double fits = (is_open ? 2.0 : 1.0) * std::ceil(frequencies / ranks);
    progress.expect(Stage::response, fits,
                    fits * static_cast<double>(key.medium.layers.size()) * response_ns);
    if (is_open)
        progress.expect(Stage::radial,
                        static_cast<double>(radial_blocks(key.spacing_m, reach_m(key))),
                        radial_products(key) * radial_ns / ranks);
    if (!is_open &&
        TransferTable::expanded_bytes(key, ky_count) > TransferTable::largest_expansion_B)
        return;
    const double points = static_cast<double>(key.nx) * static_cast<double>(key.ny);
    progress.expect(Stage::expansion,
                    depths * (is_open ? frequencies : static_cast<double>(ky_count)),
                    depths * points * static_cast<double>(key.time.samples) *
                        (is_open ? open_expansion_ns : expansion_ns) / ranks);
}

void expect_frames(CaseProgress& progress, const LayeredPlan& plan, std::ptrdiff_t ky_count) {
    using Stage = CaseProgress::Stage;
    const Case& c = plan.c;
    const double depths = static_cast<double>(c.measure.depths_m.size()) + other_fields(c);
    const auto frames = static_cast<double>(c.time.frames);
    const double batches = std::ceil(frames / static_cast<double>(plan.frames_together));
    const std::ptrdiff_t stored_nx = plan.moves_along_x ? c.domain.nx / 2 + 1 : c.domain.nx;
    const double lines = depths * batches * static_cast<double>(ky_count * stored_nx);
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    progress.expect(Stage::setup, 1.0, points * setup_ns / plan.ranks); // transforms and memory
    // A line of ky stands for two lines of points.
    progress.expect(Stage::samples, lines,
                    2.0 * lines * static_cast<double>(plan.keys[displacement_table].time.samples) *
                        (plan.moves_along_x ? sample_ns : moving_sample_ns));
    progress.expect(Stage::frames, depths * frames,
                    depths * frames * points * frame_ns / plan.ranks);
}

LayeredPlan::LayeredPlan(const Case& given, int team)
    : c(solved_case(given)), ranks(team), ky_count(fft::most_rows(c.domain.ny, team)),
      frames_together(frames_per_batch(c, ky_count)) {
    const TransferKey key = key_of(c, std::get<LayeredOptions>(c.solver));
    keys = {key, stress_key_of(c, key), tangential_key_of(c, key), loss_key_of(c, key)};
    moves_along_x = LoadSpectrum::moves_along_x(c, key.time);
}

bool LayeredPlan::is_stored(const TransferKey& table) const {
    return table.edges == DomainEdges::open ||
           TransferTable::expanded_bytes(table, ky_count) <= TransferTable::largest_expansion_B;
}

std::vector<engines::Allocation> LayeredPlan::arrays() const {
    const double points = static_cast<double>(c.domain.nx) * static_cast<double>(c.domain.ny);
    const std::ptrdiff_t stored_nx = moves_along_x ? c.domain.nx / 2 + 1 : c.domain.nx;
    std::vector<engines::Allocation> all = {
        {"spectra of frames",
         static_cast<double>(frames_together * ky_count * stored_nx) * sizeof(Complex)}};
    constexpr std::array names = {"transfer function of the displacement",
                                  "transfer function of the stress",
                                  "transfer function of the tangential displacement", "losses"};
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (!keys[i].depths_m.empty())
            all.push_back({names[i], is_stored(keys[i])
                                         ? TransferTable::expanded_bytes(keys[i], ky_count)
                                         : 0.0});
    all.push_back({"a row of the transfer function",
                   static_cast<double>(c.domain.nx * keys[displacement_table].time.samples) *
                       sizeof(Complex)});
    all.push_back({"load", LoadSpectrum::memory_B(c, keys[displacement_table].time, ky_count)});
    all.push_back({"Bessel functions",
                   cached_bessel_B(keys[displacement_table]) + cached_bessel_B(keys[loss_table])});
    all.push_back({"plane of the transform", points * sizeof(double) / ranks});
    return all;
}

std::vector<std::string> LayeredPlan::notes() const {
    const double step_s = keys[displacement_table].time.step_s, error = step_error(c, step_s);
    // One text for all cases that reach the accuracy, since a run prints each text once.
    const std::string quality =
        error < largest_estimate
            ? fmt::format("estimated error {} {:.0e} of the maximum of the field",
                          error <= step_accuracy ? "below" : "about",
                          std::max(error, step_accuracy))
            : "which does not resolve the load";
    std::vector<std::string> all = {fmt::format("time step {:.4g} us, {}", 1e6 * step_s, quality)};
    if (keys[displacement_table].edges == DomainEdges::open)
        all.push_back(fmt::format(
            "open edges: convolution with the response of the infinite plane on {} x {} points, "
            "which the path and the footprint require",
            c.domain.nx, c.domain.ny));
    if (moves_along_x)
        all.emplace_back(
            "the load does not move along y: wave vectors with opposite kx share its spectrum");
    return all;
}

namespace {

/// Everything that the tables depend on.
std::string name_of_tables(const LayeredPlan& plan) {
    Case tables;
    tables.scene.medium = plan.c.scene.medium;
    tables.domain = plan.c.domain;
    tables.time = plan.c.time;
    tables.measure.depths_m = plan.c.measure.depths_m;
    tables.solver = plan.c.solver;
    const TransferKey& key = plan.keys[displacement_table];
    const std::string text =
        fmt::format("{} {:.17g} {:.17g} {}", canonical_text(tables), key.time.step_s,
                    fmt::join(plan.keys[stress_table].depths_m, " "),
                    plan.keys[tangential_table].depths_m.size());
    return fmt::format("{:016x}", stable_hash(text));
}

} // namespace

engines::Resources LayeredEngine::resources(const Case& given, int ranks) const {
    using Stage = CaseProgress::Stage;
    const LayeredPlan plan(given, ranks);
    const Domain& domain = plan.c.domain;
    CaseProgress rank_progress(nullptr);
    expect_frames(rank_progress, plan, plan.ky_count);
    for (const TransferKey& key : plan.keys)
        expect_table(rank_progress, key, plan.ky_count, ranks);
    const auto work = [&](std::initializer_list<Stage> stages) {
        double sum = 0.0;
        for (const Stage stage : stages)
            sum += ranks * rank_progress.work_ns(stage);
        return sum;
    };
    return {.arrays = plan.arrays(),
            .work = work({Stage::setup, Stage::samples, Stage::frames}),
            .shared_work = work({Stage::response, Stage::radial, Stage::expansion}),
            .shared = name_of_tables(plan),
            .useful_ranks = static_cast<int>(std::min(domain.nx, fft::below_nyquist(domain.ny)))};
}

Domain solved_domain(const Case& c) {
    Domain solved = c.domain;
    if (c.domain.edges != DomainEdges::open) return solved;
    const Vec2 load_m = extent_of_load_m(c);
    solved.nx = enlarged(c.domain.nx, c.domain.spacing_m, load_m.x);
    solved.ny = enlarged(c.domain.ny, c.domain.spacing_m, load_m.y);
    return solved;
}

Case solved_case(const Case& c) {
    Case solved = c;
    solved.domain = solved_domain(c);
    return solved;
}

InnerRows inner_rows(const Domain& domain, const Domain& solved, const fft::SlabShare& share) {
    const std::ptrdiff_t below_x = (solved.nx - domain.nx) / 2,
                         below_y = (solved.ny - domain.ny) / 2;
    const auto row = [&](std::ptrdiff_t solved_row) {
        return std::clamp<std::ptrdiff_t>(solved_row - below_x, 0, domain.nx);
    };
    const std::ptrdiff_t first = row(share.x_start), end = row(share.x_start + share.x_count);
    if (end <= first) return {.x_start = first, .x_count = 0, .offset = 0};
    return {.x_start = first,
            .x_count = end - first,
            .offset = (first + below_x - share.x_start) * share.padded_ny + below_y};
}

} // namespace shearwake::layered
