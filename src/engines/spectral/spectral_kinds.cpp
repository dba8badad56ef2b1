// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_kinds.hpp"

#include "engines/spectral/depth/work_kinds.hpp"

#include "base/block.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace shearwake::spectral::kinds {
namespace {

/// Sizes of the planes of strain, which are read and written line by line.
constexpr double planes_in_cache_B = 6e6, planes_in_memory_B = 25e6;
// Share of the x transforms in a transfer; those in y are proportional to the rows with cells.
constexpr double share_of_modes = 0.65;
/// Time of a solve whose factors were just read, relative to one that reads them. Fitted to steps
/// of `bench spectral` at a contrast of 4, which take 2.4 to 2.9 times as long as uniform ones.
constexpr double second_solve = 0.7;
/// Time of the solves for a column of the matrices of a box, relative to those of an iteration on
/// the plane (box_response.cpp).
constexpr double column_cost = 2.0 / 3.0;
/// Time for the stress of one force at one point, relative to that of a point of a volume.
constexpr double pair_cost = 1.0;
/// Points of a window whose sums take as long as the other work on a line.
constexpr double window_overhead = 24.0;

Case calibration_case(std::ptrdiff_t nx, std::ptrdiff_t ny, std::ptrdiff_t steps) {
    Case c = engines::calibration_case({{16e-3, 5.0, 1.0}}, 6e-3, {nx, ny, 2e-3, 0.0},
                                       {1, static_cast<double>(steps) * 50e-6});
    c.solver = SpectralOptions{.time_step_s = 50e-6, .longest_element_m = 4e-3};
    return c;
}

/// A case of one frame of N steps with a body in the middle.
Case with_body(Case c, double c_s_m_s, SpectralMethod method) {
    c.scene().medium.bodies.push_back({.name = "body",
                                       .shape = Box{{6e-2, 6e-2, 6e-3}},
                                       .centre_m = {0.0, 0.0, 8e-3},
                                       .c_s_m_s = c_s_m_s});
    std::get<SpectralOptions>(c.solver).method = method;
    return c;
}

} // namespace

namespace {

using Add = std::function<void(const engines::WorkKind& kind, double amount)>;

/// Adds work that is limited by memory in this share and otherwise by caches.
void add_divided(const engines::WorkKind& near, const engines::WorkKind& far, double amount,
                 double share, const Add& add) {
    add(near, amount * (1.0 - share));
    add(far, amount * share);
}

/// Products with matrices of `entries` numbers of this size, the entries of all products together
/// being `amount`.
void add_products(double entries, double size_B, double amount, const Add& add) {
    add_divided(of_box, of_far_box, amount, engines::share_from_memory(entries * size_B), add);
}

/// Planes on a grid, and the points of the window of a line that is transformed; 0 for FFTs.
struct Planes {
    double count, window;
};

/// Transfers of `planes` planes to and from a grid of nx x ny points.
void add_transfers(const Planes& stored, double nx, double ny, double planes, double rows_share,
                   const Add& add) {
    const double window = stored.window;
    if (window > 0.0)
        return add(of_window, planes * nx * (ny / 2.0 + 1.0) * (window + window_overhead));
    // In y only rows with cells are transformed.
    const double moved = planes * nx * ny * (share_of_modes + (1.0 - share_of_modes) * rows_share);
    const double far = engines::share_from_memory(stored.count * nx * ny * 2.0 * sizeof(double),
                                                  planes_in_cache_B, planes_in_memory_B);
    add_divided(of_transfer, of_far_transfer, moved, far, add);
}

Planes planes_of(const VariationEstimate& v, double nx) {
    return {v.planes(), v.window(static_cast<std::ptrdiff_t>(nx))};
}

/// The planes and the matrix of rigid lumps in every step, and their setup: each plane takes one
/// solve, and the inversion of the matrix a third of a product per entry and row.
void add_lumps(const Case& c, const Measures& m, double modes, const Add& add) {
    const double unknowns = 3.0 * m.lumps.markers, planes = 3.0 * m.lumps.depths;
    if (!(planes > 0.0)) return;
    const bool window =
        LineWindow::pays(c.domain.nx, static_cast<std::ptrdiff_t>(m.lumps.points_x));
    add_transfers({planes, window ? m.lumps.points_x : 0.0}, static_cast<double>(c.domain.nx),
                  static_cast<double>(c.domain.ny),
                  planes * (m.reactions * m.steps + 0.25 * planes),
                  m.lumps.points_x / static_cast<double>(c.domain.nx), add);
    add_divided(of_iteration, of_far_iteration, modes * m.levels * m.nodes * planes,
                m.iterated_from_memory, add);
    add_products(unknowns * unknowns, sizeof(double), unknowns * unknowns * m.reactions * m.steps,
                 add);
    add(of_box, std::pow(unknowns, 3) / 3.0);
}

/// Iterations on a box, and its setup: each plane of strain is a column of the matrices, which are
/// symmetric.
void add_box(const Case& c, const Measures& m, double modes, double rows_share, const Add& add) {
    const VariationEstimate& v = m.variation;
    const double rounded = rounded_iterations(v.iterations); // these take half as long
    const double planes = v.planes(), products = box_products(v.iterations) * m.steps;
    const double entries = box_values(*v.box, planes), of_rounded = rounded * m.steps;
    add_products(entries, 2.0 * sizeof(float), entries * (products - of_rounded), add);
    add_products(entries, sizeof(float), entries * 0.5 * of_rounded, add);
    add_transfers(planes_of(v, static_cast<double>(v.box->nx)), static_cast<double>(v.box->nx),
                  static_cast<double>(v.box->ny), planes * products, rows_share, add);
    add_divided(of_iteration, of_far_iteration, column_cost * modes * m.levels * m.nodes * planes,
                m.iterated_from_memory, add);
    add_transfers(planes_of(v, static_cast<double>(c.domain.nx)), static_cast<double>(c.domain.nx),
                  static_cast<double>(c.domain.ny), 0.25 * planes * planes, rows_share, add);
}

} // namespace

void add_work(const Case& c, const Measures& m, engines::Estimate& e) {
    const VariationEstimate& v = m.variation;
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double points = nx * ny, rows_ky = std::floor(ny / 2.0) + 1.0;
    const double modes = 2.0 * lane_count * std::ceil(nx / (2.0 * lane_count)) * rows_ky;
    const double more = v.iterations > 0.0 ? v.iterations + 1.0 : 0.0;
    const double solves = modes * m.levels * m.nodes * m.steps;
    const Add add = [&](const engines::WorkKind& kind, double amount) {
        if (amount > 0.0) e.work.push_back({kind, amount});
    };
    add_divided(of_solve, of_far_solve, solves, m.from_memory, add);
    // With a box there is one more solve, whose factors were just read.
    add_divided(of_iteration, of_far_iteration, solves * (v.box ? second_solve : more),
                m.iterated_from_memory, add);
    add_divided(of_reaction, of_far_reaction, solves * m.reactions, m.from_memory, add);
    add(of_factors, modes * m.levels * m.nodes * m.nodes);
    add(of_materials, v.points * points);
    // The square root overestimates the rows with cells for a bar along x and never underestimates
    // them.
    const double rows =
        v.points > 0.0 ? std::sqrt(std::min(1.0, v.cells / (v.points * points))) : 0.0;
    // Without a box, stresses are transformed once more for the displacement; its strain is known.
    const double passes = more > 0.0 && !v.box ? v.iterations + 1.5 : 1.0;
    add_transfers(planes_of(v, nx), nx, ny, v.planes() * passes * m.steps, rows, add);
    if (v.box) add_box(c, m, modes, rows, add);
    add_lumps(c, m, modes, add);
    add(of_cell, v.cells * v.components * (1.0 + more) * m.steps);
    if (m.sponge_every > 0.0) add(of_sponge, m.sponge_values * m.steps / m.sponge_every);
    const double frames = static_cast<double>(c.time.frames);
    add(of_frame, points * frames * static_cast<double>(c.measure.depths_m.size()));
    const double snapshots = static_cast<double>(c.record.volumes_s.size());
    for (const VolumeField field : c.record.volume_fields)
        add(field == VolumeField::u ? of_displacement : of_tensor, snapshots * m.levels * points);
    add(of_tensor, pair_cost * snapshots * m.near_pairs);
    add(of_felt, points * frames * m.felt);
}

std::vector<engines::Calibration> calibrations() {
    const Case near = calibration_case(32, 16, 40), far = calibration_case(192, 144, 5);
    const Case one = calibration_case(64, 48, 1);
    Case few = calibration_case(64, 48, 16);
    std::get<SpectralOptions>(few.solver).longest_element_m = 8e-3;
    Case factors = calibration_case(96, 72, 1);
    Case materials = with_body(one, 6.0, SpectralMethod::one_solve);
    // Bodies across the domain require FFTs, small ones sums over a window.
    Case transfer = with_body(few, 6.0, SpectralMethod::one_solve);
    transfer.scene().medium.bodies[0].shape = Box{{1.0, 2e-3, 12e-3}};
    Case window = transfer;
    window.scene().medium.bodies[0].shape = Box{{6e-2, 2e-3, 12e-3}}; // 31 of 64 points
    Case far_transfer = with_body(calibration_case(192, 144, 4), 6.0, SpectralMethod::one_solve);
    far_transfer.scene().medium.bodies[0].shape = Box{{1.0, 2e-2, 16e-3}};
    Case cell = with_body(few, 6.0, SpectralMethod::one_solve);
    cell.scene().medium.bodies[0].shape = Box{{1.0, 1.0, 12e-3}};
    // Each step takes one iteration with a body and a residual like these.
    const auto with_one_iteration = [](const Case& c) {
        Case soft = with_body(c, 5.1, SpectralMethod::iterative);
        std::get<SpectralOptions>(soft.solver).residual = 2e-5;
        return soft;
    };
    Case iteration = with_one_iteration(few); // too large for a box
    iteration.scene().medium.bodies[0].shape = Box{{1.0, 6e-2, 4e-3}};
    Case far_iteration = with_one_iteration(calibration_case(192, 144, 5));
    far_iteration.scene().medium.bodies[0].shape = Box{{1.0, 2e-1, 4e-3}};
    Case box = with_one_iteration(few);
    box.scene().medium.bodies[0].shape = Box{{2e-2, 2e-2, 4e-3}};
    box.time.interval_s = 100.0 * 50e-6;
    box.measure.at_s = box.time.interval_s;
    Case far_box = with_one_iteration(calibration_case(96, 72, 100));
    far_box.scene().medium.bodies[0].shape = Box{{3.4e-2, 3.4e-2, 7e-3}};
    Case reaction = few, far_reaction = far;
    for (Case* c : {&reaction, &far_reaction})
        c->scene().medium.bodies = {{.name = "bone",
                                     .shape = Cylinder{.radius_m = 4e-3, .azimuth_deg = 90.0},
                                     .centre_m = {0.0, 0.0, 8e-3},
                                     .rigid = true}};
    Case sponge = calibration_case(64, 48, 40);
    sponge.domain.sponge_m = 2e-2;
    Case frame = one;
    frame.time.frames = 8;
    frame.measure.at_s = frame.time.duration_s();
    std::get<SpectralOptions>(frame.solver).longest_element_m = 16e-3;
    for (int depth = 1; depth < 40; ++depth)
        frame.measure.depths_m.push_back(4e-4 * depth);
    Case displacement = calibration_case(96, 72, 1), tensor = displacement, felt = one;
    for (Case* c : {&displacement, &tensor})
        c->record.volumes_s = {c->time.duration_s()};
    displacement.record.volume_fields = {VolumeField::u};
    tensor.record.volume_fields = {VolumeField::strain};
    felt.time.frames = 6;
    felt.measure.at_s = felt.time.duration_s();
    felt.afferents = AfferentOptions{.places = AfferentList{{{{}, AfferentClass::SA1, 0},
                                                             {{}, AfferentClass::RA, 0},
                                                             {{}, AfferentClass::PC, 0}}},
                                     .input = StressInput{}};
    return {{of_solve.name, near},
            {of_far_solve.name, far},
            {of_iteration.name, iteration},
            {of_far_iteration.name, far_iteration},
            {of_reaction.name, reaction},
            {of_far_reaction.name, far_reaction},
            {of_factors.name, factors},
            {of_materials.name, materials},
            {of_transfer.name, transfer},
            {of_far_transfer.name, far_transfer},
            {of_window.name, window},
            {of_box.name, box},
            {of_far_box.name, far_box},
            {of_cell.name, cell},
            {of_sponge.name, sponge},
            {of_frame.name, frame},
            {of_displacement.name, displacement},
            {of_tensor.name, tensor},
            {of_felt.name, felt}};
}

} // namespace shearwake::spectral::kinds
