// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_estimate.hpp"

#include "base/block.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/slab_bodies.hpp"
#include "engines/spectral/bodies/stress/endless_stress.hpp"
#include "engines/spectral/bodies/stress/lump_stress.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/depth/work_kinds.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/lateral_sponge.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <vector>

namespace shearwake::spectral {

using namespace kinds;

namespace {

/// Sizes of the pencils that a step reads. Sequential access is fast up to large sizes.
constexpr double in_cache_B = 2e6, in_memory_B = 150e6;

double up(double a, double b) {
    return std::ceil(a / b);
}

/// Rows of the spectrum of a plane on the rank with most of them.
double most_rows(double ny, int ranks) {
    return static_cast<double>(fft::most_rows(static_cast<std::ptrdiff_t>(ny), ranks));
}

/// Memory in bytes on the rank that needs most.
struct Memory {
    double stepper_B = 0.0, all_B = 0.0;
    double iterated_B = 0.0; // memory that an iteration on the plane accesses
};

double map_bytes(const Medium& medium) {
    if (!medium.map) return 0.0;
    const MaterialMap& map = *medium.map;
    return static_cast<double>(map.c_s_m_s.size() + map.c_p_m_s.size() + map.density_kg_m3.size() +
                               map.viscosity_Pa_s.size()) *
           sizeof(double);
}

double sponge_values_of(const SpongePlan& sponge, double levels) {
    return sponge.every > 0 ? 3.0 * levels * static_cast<double>(sponge.nx * sponge.ny) : 0.0;
}

double factor_entries(const DepthMesh& mesh) {
    const auto moving = static_cast<std::ptrdiff_t>(mesh.levels() - 1);
    return static_cast<double>(SkylineMatrix(moving, mesh.degree, 2).entries() +
                               SkylineMatrix(moving, mesh.degree, 1).entries());
}

/// The planes of strain on a grid of nx x ny points: lines over x, or a window of them and the
/// spectra of one ky.
double strain_planes_B(const VariationEstimate& v, double nx, double ny, int ranks) {
    const double window = v.window(static_cast<std::ptrdiff_t>(nx));
    const double lines = most_rows(ny, ranks);
    return v.planes() * 2.0 * sizeof(double) *
           (window > 0.0 ? lines * window + nx : std::max(lines * nx, up(nx, ranks) * ny / 2.0));
}

/// The matrices and planes of the box.
double box_B(const VariationEstimate& v, int ranks) {
    if (!v.box) return 0.0;
    const double nx = static_cast<double>(v.box->nx), ny = static_cast<double>(v.box->ny);
    return up(nx / 2.0, lane_count) * most_rows(ny, ranks) * 0.5 * v.planes() * (v.planes() + 1.0) *
               sizeof(Block) +
           strain_planes_B(v, nx, ny, ranks);
}

/// The program, the pencils, the planes of strain and the data of cells, the planes of the
/// transform and of the engine. The material samples are released before the rest is allocated.
Memory memory_of(const Case& c, const DepthMesh& mesh, const VariationEstimate& v,
                 const SpongePlan& sponge, int ranks) {
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double modes_y = static_cast<double>(c.domain.ny / 2 + 1);
    const double levels = static_cast<double>(mesh.levels() - 1), nodes = mesh.degree + 1.0;
    const double pencil_lanes = most_rows(ny, ranks) * up(nx / 2.0, lane_count);
    const double displacement_B = pencil_lanes * 3.0 * levels * parts * sizeof(Block);
    const double factors_B = pencil_lanes * factor_entries(mesh) * sizeof(Block);
    const double plane_B =
        2.0 * sizeof(double) * std::max(up(nx, ranks) * modes_y, nx * most_rows(ny, ranks));
    const double arrays = ((v.iterations > 0.0 ? 7.0 : 4.0) + (v.box ? 1.0 : 0.0)) * v.components +
                          3.0 + (v.iterations > 0.0 ? v.components / 3.0 : 0.0); // implicit moduli
    const double sampled_B = v.points * up(nx, ranks) * ny * sizeof(Material);
    const double sponge_B = sponge_values_of(sponge, levels) * sizeof(double) /
                            std::min<double>(ranks, static_cast<double>(sponge.ny));
    const bool tensors = records_tensors(c.record);
    const double perceived = ReceptorStress::planes(c, mesh);
    Memory memory;
    memory.iterated_B = factors_B + strain_planes_B(v, nx, ny, ranks);
    // With a box, the next step is predicted.
    memory.stepper_B = factors_B + (v.box ? 3.0 : 2.0) * displacement_B +
                       strain_planes_B(v, nx, ny, ranks) + box_B(v, ranks) + sponge_B +
                       arrays * v.fullest_cells * sizeof(double);
    memory.all_B = engines::program_B + map_bytes(c.scene().medium) +
                   std::max(memory.stepper_B, sampled_B) + (ranks > 1 ? 3.0 : 2.0) * plane_B +
                   (tensors ? displacement_B + (24.0 + nodes) * plane_B : 0.0) +
                   (perceived > 0.0 ? (2.0 + 2.0 * perceived) * plane_B : 0.0);
    return memory;
}

/// Exchanges of data between the ranks during a run, and the data of all of them.
struct Exchanges {
    double count = 0.0, moved_B = 0.0;
};

/// Exchanges of the planes of strain on a grid: `passes` times, in each direction.
Exchanges exchanges_of_strain(const VariationEstimate& v, double ny, double passes) {
    const double rows = static_cast<double>(v.extent.x_end - v.extent.x_begin);
    const double of_point_B = v.components * sizeof(std::complex<double>) * rows * (ny / 2.0 + 1.0);
    return {2.0 * passes *
                std::ceil(v.points / StrainPlanes::points_together(v.points, of_point_B)),
            2.0 * passes * v.points * of_point_B};
}

struct Counts {
    double steps, frames, reactions; // reactions of rigid bodies per step
};

/// One exchange of the surface per frame and depth; those of the planes of strain for each product
/// on a box or iteration on the plane, and once per step with the motion; and those of the markers
/// of rigid lumps. The sponge and endless bodies exchange less, which is not counted.
Exchanges exchanges_of(const Case& c, const VariationEstimate& v, const LumpSizes& lumps,
                       const Counts& of) {
    const double ny = static_cast<double>(c.domain.ny);
    const double surfaces = of.frames * static_cast<double>(c.measure.depths_m.size());
    std::vector<Exchanges> all = {{surfaces, surfaces * static_cast<double>(c.domain.nx) *
                                                 (ny / 2.0 + 1.0) * sizeof(std::complex<double>)}};
    if (v.points > 0.0)
        all.push_back(exchanges_of_strain(
            v, ny, of.steps * (v.iterations > 0.0 && !v.box ? v.iterations + 1.5 : 1.0)));
    if (v.box)
        all.push_back(exchanges_of_strain(v, static_cast<double>(v.box->ny),
                                          of.steps * box_products(v.iterations)));
    if (lumps.depths > 0.0)
        all.push_back({2.0 * of.reactions * of.steps,
                       2.0 * of.reactions * of.steps * 3.0 * lumps.depths * lumps.points_x *
                           (ny / 2.0 + 1.0) * sizeof(std::complex<double>)});
    Exchanges sum;
    for (const Exchanges& one : all)
        sum = {sum.count + one.count, sum.moved_B + one.moved_B};
    return sum;
}

} // namespace

engines::Estimate estimate_spectral(const Case& c, const DepthMesh& mesh,
                                    std::ptrdiff_t steps_per_frame, int ranks) {
    const double step_s = c.time.interval_s / static_cast<double>(steps_per_frame);
    const Case layers = without_rigid_bodies(c);
    const bool rigid = layers != c;
    const double frames = static_cast<double>(c.time.frames);
    const double steps = frames * static_cast<double>(steps_per_frame);
    VariationEstimate v = estimate_variation(layers, mesh, step_s, ranks);
    if (v.iterations > 0.0 && !rigid)
        v.box = box_grid(
            c.domain, v.extent,
            {.planes = v.planes(), .factor_entries = factor_entries(mesh), .steps = steps});
    const SpongePlan sponge = sponge_plan(
        c,
        !section_bodies(c).empty() || !lump_bodies(c).empty() || v.points > 0.0 ? Lateral::varies
                                                                                : Lateral::uniform,
        step_s);
    Memory memory = memory_of(layers, mesh, v, sponge, ranks);
    if (rigid)
        memory.all_B += endless_memory_B(c, mesh, ranks) + slab_memory_B(c, mesh, ranks) +
                        lump_memory_B(c, mesh, ranks) + lump_stress_memory_B(c, mesh, ranks) +
                        endless_stress_memory_B(c, mesh, ranks);
    const double levels = static_cast<double>(mesh.levels() - 1);
    const LumpSizes lumps = lump_sizes(c, mesh);
    // Per step: one for the motion, those of the iterations, and one whenever the sponge acts.
    const double reactions =
        !rigid ? 0.0
               : 1.0 + (v.iterations > 0.0 ? v.iterations + 1.0 : 0.0) +
                     (sponge.every > 0 ? 1.0 / static_cast<double>(sponge.every) : 0.0);
    const auto share_of = [](double touched_B) {
        return engines::share_from_memory(touched_B, in_cache_B, in_memory_B);
    };
    engines::Estimate e;
    e.useful_ranks = static_cast<int>(std::min(c.domain.nx, fft::below_nyquist(c.domain.ny)));
    e.memory_per_rank_B = memory.all_B;
    add_work(c,
             {.variation = v,
              .nodes = mesh.degree + 1.0,
              .levels = levels,
              .steps = steps,
              .sponge_values = sponge_values_of(sponge, levels),
              .sponge_every = static_cast<double>(sponge.every),
              .perceived = ReceptorStress::planes(layers, mesh),
              .reactions = reactions,
              .lumps = lumps,
              .near_pairs = rigid ? lump_stress_pairs(c, mesh) : 0.0,
              .from_memory = share_of(memory.stepper_B),
              .iterated_from_memory = share_of(memory.iterated_B)},
             e);
    e.work.push_back({engines::of_fresh_memory, ranks * (memory.all_B - engines::program_B)});
    const Exchanges all = exchanges_of(c, v, lumps, {steps, frames, reactions});
    e.all_to_alls = all.count;
    e.all_to_all_B = all.count > 0.0 ? all.moved_B / all.count : 0.0;
    e.written_B = engines::volumes_B(c, static_cast<double>(mesh.clear_levels()));
    return e;
}

} // namespace shearwake::spectral

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
    add(of_receptor_planes, points * frames * m.perceived);
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
    Case displacement = calibration_case(96, 72, 1), tensor = displacement, perceived = one;
    for (Case* c : {&displacement, &tensor})
        c->record.volumes_s = {c->time.duration_s()};
    displacement.record.volume_fields = {VolumeField::u};
    tensor.record.volume_fields = {VolumeField::strain};
    perceived.time.frames = 6;
    perceived.measure.at_s = perceived.time.duration_s();
    perceived.afferents = AfferentOptions{.places = AfferentList{{{{}, AfferentClass::SA1, 0},
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
            {of_receptor_planes.name, perceived}};
}

} // namespace shearwake::spectral::kinds
