// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_estimate.hpp"

#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/slab_bodies.hpp"
#include "engines/spectral/bodies/stress/endless_stress.hpp"
#include "engines/spectral/bodies/stress/lump_stress.hpp"
#include "engines/spectral/depth/skyline_matrix.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/lateral_sponge.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "engines/spectral/spectral_kinds.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
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
    const double felt = ReceptorStress::planes(c, mesh);
    Memory memory;
    memory.iterated_B = factors_B + strain_planes_B(v, nx, ny, ranks);
    // With a box, the next step is predicted.
    memory.stepper_B = factors_B + (v.box ? 3.0 : 2.0) * displacement_B +
                       strain_planes_B(v, nx, ny, ranks) + box_B(v, ranks) + sponge_B +
                       arrays * v.fullest_cells * sizeof(double);
    memory.all_B = engines::program_B + map_bytes(c.scene().medium) +
                   std::max(memory.stepper_B, sampled_B) + (ranks > 1 ? 3.0 : 2.0) * plane_B +
                   (tensors ? displacement_B + (24.0 + nodes) * plane_B : 0.0) +
                   (felt > 0.0 ? (2.0 + 2.0 * felt) * plane_B : 0.0);
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
              .felt = ReceptorStress::planes(layers, mesh),
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
