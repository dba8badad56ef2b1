// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_estimate.hpp"

#include "base/block.hpp"
#include "base/text.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/slab_bodies.hpp"
#include "engines/spectral/bodies/stress/endless_stress.hpp"
#include "engines/spectral/bodies/stress/lump_stress.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/lateral_sponge.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace shearwake::spectral {

namespace {

double up(double a, double b) {
    return std::ceil(a / b);
}

/// Rows of the spectrum of a plane on the rank with most of them.
double most_rows(double ny, int ranks) {
    return static_cast<double>(fft::most_rows(static_cast<std::ptrdiff_t>(ny), ranks));
}

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
double memory_of(const Case& c, const DepthMesh& mesh, const VariationEstimate& v,
                 const SpongePlan& sponge, int ranks) {
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double modes_y = static_cast<double>(c.domain.ny / 2 + 1);
    const double levels = static_cast<double>(mesh.levels() - 1), nodes = mesh.degree + 1.0;
    const double pencil_lanes = most_rows(ny, ranks) * up(nx / 2.0, lane_count);
    const double displacement_B = pencil_lanes * 3.0 * levels * parts * sizeof(Block);
    const double factors_B = pencil_lanes * factor_entries(mesh) * sizeof(Block);
    const double plane_B =
        2.0 * sizeof(double) * std::max(up(nx, ranks) * modes_y, nx * most_rows(ny, ranks));
    const double arrays = ((v.iterates ? 7.0 : 4.0) + (v.box ? 1.0 : 0.0)) * v.components + 3.0 +
                          (v.iterates ? v.components / 3.0 : 0.0); // implicit moduli
    const double sampled_B = v.points * up(nx, ranks) * ny * sizeof(Material);
    const double sponge_B = sponge_values_of(sponge, levels) * sizeof(double) /
                            std::min<double>(ranks, static_cast<double>(sponge.ny));
    const bool tensors = records_tensors(c.record);
    const double perceived = ReceptorStress::planes(c, mesh);
    // With a box, the next step is predicted.
    const double stepper_B = factors_B + (v.box ? 3.0 : 2.0) * displacement_B +
                             strain_planes_B(v, nx, ny, ranks) + box_B(v, ranks) + sponge_B +
                             arrays * v.fullest_cells * sizeof(double);
    return engines::program_B + map_bytes(c.scene().medium) + std::max(stepper_B, sampled_B) +
           (ranks > 1 ? 3.0 : 2.0) * plane_B +
           (tensors ? displacement_B + (24.0 + nodes) * plane_B : 0.0) +
           (perceived > 0.0 ? (2.0 + 2.0 * perceived) * plane_B : 0.0);
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
    if (v.iterates && !rigid)
        v.box = box_grid(
            c.domain, v.extent,
            {.planes = v.planes(), .factor_entries = factor_entries(mesh), .steps = steps});
    const SpongePlan sponge = sponge_plan(
        c,
        !section_bodies(c).empty() || !lump_bodies(c).empty() || v.points > 0.0 ? Lateral::varies
                                                                                : Lateral::uniform,
        step_s);
    double memory_B = memory_of(layers, mesh, v, sponge, ranks);
    if (rigid)
        memory_B += endless_memory_B(c, mesh, ranks) + slab_memory_B(c, mesh, ranks) +
                    lump_memory_B(c, mesh, ranks) + lump_stress_memory_B(c, mesh, ranks) +
                    endless_stress_memory_B(c, mesh, ranks);
    engines::Estimate e;
    e.useful_ranks = static_cast<int>(std::min(c.domain.nx, fft::below_nyquist(c.domain.ny)));
    e.memory_per_rank_B = memory_B;
    e.work = engines::parts_of(march_work(c, mesh, steps_per_frame));
    e.written_B = engines::volumes_B(c, static_cast<double>(mesh.clear_levels()));
    return e;
}

namespace {

/// The hash of what determines the number of iterations and the cells of a medium with bodies or a
/// map: medium, grid, options of the solver, and the time step within a factor of about 1.4.
std::string hash_of_bodies(const Case& c, double step_s) {
    Case alone;
    alone.scene().medium = c.scene().medium;
    alone.domain = c.domain;
    auto options = std::get<SpectralOptions>(c.solver);
    options.time_step_s.reset(); // which an estimate may specify
    alone.solver = options;
    const long step = std::lround(2.0 * std::log2(step_s));
    return fmt::format("#{:016x}", stable_hash(fmt::format("{} {}", canonical_text(alone), step)));
}

} // namespace

engines::MarchWork march_work(const Case& c, const DepthMesh& mesh,
                              std::ptrdiff_t steps_per_frame) {
    const auto points = static_cast<double>(c.domain.nx * c.domain.ny);
    const double frames = static_cast<double>(c.time.frames);
    const double steps = frames * static_cast<double>(steps_per_frame);
    const double given = static_cast<double>(c.measure.depths_m.size()) +
                         ReceptorStress::planes(without_rigid_bodies(c), mesh);
    engines::MarchWork work{.kind = "spectral",
                            .unknowns = points * (3.0 * static_cast<double>(mesh.levels() - 1) +
                                                  given / static_cast<double>(steps_per_frame)),
                            .steps = steps,
                            .snapshots = static_cast<double>(c.record.volumes_s.size())};
    if (!c.record.volumes_s.empty()) work.kind += " volumes";
    for (const VolumeField field : c.record.volume_fields) {
        if (field != VolumeField::u) work.kind += fmt::format(" {}", name_of(field));
        work.values +=
            points * static_cast<double>(mesh.clear_levels() * components_of(field).size());
    }
    if (c.domain.sponge_m > 0.0) work.kind += " sponge";
    if (!stress_depths_m(c).empty()) work.kind += " receptors";
    if (!c.scene().medium.bodies.empty() || c.scene().medium.map)
        work.kind += " bodies " +
                     hash_of_bodies(c, c.time.interval_s / static_cast<double>(steps_per_frame));
    return work;
}

} // namespace shearwake::spectral
