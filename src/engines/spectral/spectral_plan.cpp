// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_plan.hpp"

#include "base/block.hpp"
#include "base/text.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/lateral_variation.hpp"
#include "engines/spectral/stepping/receptor_stress.hpp"
#include "engines/spectral/stepping/stages.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numeric>

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

/// Lines over x of the ky of a coarse grid, on the ranks that have these ky of the domain.
double sponge_B(const SpongePlan& sponge, double levels, double rows) {
    if (sponge.every == 0) return 0.0;
    return 3.0 * levels * static_cast<double>(sponge.nx) *
           std::min(rows, static_cast<double>(sponge.ny / 2 + 1)) * 2.0 * sizeof(double);
}

/// The planes of strain on a grid of nx x ny points: lines over x, or a window of them and the
/// spectra of one ky.
double strain_planes_B(const VariationPlan& v, double nx, double ny, int ranks) {
    const double window = v.window(static_cast<std::ptrdiff_t>(nx));
    const double lines = most_rows(ny, ranks);
    return v.planes() * 2.0 * sizeof(double) *
           (window > 0.0 ? lines * window + nx : std::max(lines * nx, up(nx, ranks) * ny / 2.0));
}

/// The data of the planes that ranks exchange, in both directions.
double exchanged_B(const VariationPlan& v, double ny, int ranks) {
    const double of_point_B = v.components * sizeof(std::complex<double>) *
                              static_cast<double>(v.extent.x_end - v.extent.x_begin) *
                              (0.5 * ny + 1.0);
    return 2.0 * of_point_B * StrainPlanes::points_together(v.points, of_point_B) * (ranks - 1.0) /
           (ranks * ranks);
}

/// The matrices and planes of the box.
double box_B(const VariationPlan& v, int ranks) {
    if (!v.box) return 0.0;
    const double nx = static_cast<double>(v.box->nx), ny = static_cast<double>(v.box->ny);
    return up(nx / 2.0, lane_count) * most_rows(ny, ranks) * 0.5 * v.planes() * (v.planes() + 1.0) *
               sizeof(Block) +
           strain_planes_B(v, nx, ny, ranks);
}

using Arrays = std::vector<engines::Allocation>;

/// The arrays of the stepper. The samples of materials are released before the rest is allocated.
Arrays arrays_of_stepper(const Case& c, const DepthMesh& mesh, const VariationPlan& v,
                         const SpongePlan& sponge, int ranks) {
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double levels = static_cast<double>(mesh.levels() - 1);
    const double pencil_lanes = most_rows(ny, ranks) * up(nx / 2.0, lane_count);
    const double displacement_B = pencil_lanes * 3.0 * levels * parts * sizeof(Block);
    const double per_cell = ((v.iterates ? 8.0 : 4.0) + (v.box ? 1.0 : 0.0)) * v.components + 3.0 +
                            (v.iterates ? v.components / 3.0 : 0.0); // implicit moduli
    const double predicted_B = displacement_B * (1.0 + 1.0 / (3.0 * levels)) +
                               v.components * v.fullest_cells * sizeof(double);
    Arrays arrays = {{"factors", pencil_lanes * factor_entries(mesh) * sizeof(Block)},
                     {"displacement", 2.0 * displacement_B},
                     {"planes of strain", strain_planes_B(v, nx, ny, ranks)},
                     {"exchange of planes", exchanged_B(v, ny, ranks)},
                     {"box of elastic bodies", box_B(v, ranks)},
                     {"prediction of the next step", v.box ? predicted_B : 0.0},
                     {"sponge", sponge_B(sponge, levels, most_rows(ny, ranks))},
                     {"strain and moduli of cells", per_cell * v.fullest_cells * sizeof(double)},
                     {"surfaces of bodies", v.surfaces * v.fullest_cells / std::max(v.cells, 1.0) *
                                                sizeof(LateralVariation::Surface)}};
    double stepper_B = 0.0;
    for (const engines::Allocation& array : arrays)
        stepper_B += array.bytes;
    const double sampled_B = v.points * up(nx, ranks) * ny * sizeof(CellMaterial);
    arrays.push_back({"samples of materials at the start", std::max(0.0, sampled_B - stepper_B)});
    return arrays;
}

/// The planes of the transform and of the output.
Arrays arrays_of_output(const Case& c, const DepthMesh& mesh, const VariationPlan& v, int ranks) {
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double modes_y = static_cast<double>(c.domain.ny / 2 + 1), nodes = mesh.degree + 1.0;
    const double plane_B =
        2.0 * sizeof(double) * std::max(up(nx, ranks) * modes_y, nx * most_rows(ny, ranks));
    const double displacement_B = most_rows(ny, ranks) * up(nx / 2.0, lane_count) * 3.0 *
                                  static_cast<double>(mesh.levels() - 1) * parts * sizeof(Block);
    const double stress_planes = ReceptorStress::planes(c, mesh),
                 strains = v.surfaces > 0.0 ? double{strain_components} : 0.0;
    return {{"planes of the transform", (ranks > 1 ? 3.0 : 2.0) * plane_B},
            {"volumes of strain and stress",
             records_tensors(c.record) ? displacement_B + (24.0 + nodes) * plane_B : 0.0},
            {"stress at receptors",
             stress_planes > 0.0 ? (2.0 + stress_planes + strains) * plane_B : 0.0}};
}

} // namespace

double VariationPlan::window(std::ptrdiff_t nx) const {
    const std::ptrdiff_t count = extent.x_end - extent.x_begin;
    return LineWindow::pays(nx, count) ? static_cast<double>(count) : 0.0;
}

SpectralPlan::SpectralPlan(const Case& given, engines::ChoiceLimit limit)
    : rigid(rigid_plan(given)),
      time(choose_time_step(rigid.c, std::get<SpectralOptions>(given.solver), limit)),
      mesh(choose_mesh(rigid.c, std::get<SpectralOptions>(given.solver), time.step_s)) {}

SampledVariation SpectralPlan::sampled_variation() const {
    const Case& layers = rigid.layers;
    const Domain& domain = layers.domain;
    SampledVariation result;
    if (layers.scene.medium.bodies.empty() && !layers.scene.medium.map) return result;
    // In about half a second: a sample of a body takes 2 to 50 us, of a map 12 us.
    const double costs = static_cast<double>(layers.scene.medium.bodies.size()) +
                         (layers.scene.medium.map ? 6.0 : 0.0);
    const double most_samples = 2e5 / std::max(costs, 1.0);
    double nodes = 0.0;
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        if (varies_between(layers.scene.medium, mesh.ends_m[e], mesh.ends_m[e + 1]))
            nodes += mesh.degree + 1.0;
    std::ptrdiff_t stride = 1;
    while (nodes * static_cast<double>((domain.nx / stride) * (domain.ny / stride)) > most_samples)
        ++stride;
    Case sampled = layers;
    sampled.domain.nx /= stride;
    sampled.domain.ny /= stride;
    sampled.domain.spacing_m *= static_cast<double>(stride);
    fft::SlabShare rows;
    rows.x_count = sampled.domain.nx;
    const LateralVariation v =
        lateral_variation(sampled, mesh, rows, largest_k_rad_m(domain), time.step_s, nullptr);
    if (v.empty()) return result;
    result.stride = static_cast<double>(stride);
    std::vector<double>& before = result.cells_before;
    before.assign(static_cast<std::size_t>(rows.x_count) + 1, 0.0);
    for (const LateralVariation::Point& point : v.points)
        for (const fft::RowRun& run : point.runs)
            before[static_cast<std::size_t>(run.row) + 1] +=
                static_cast<double>((run.end - run.begin) * stride * stride);
    std::partial_sum(before.begin(), before.end(), before.begin());
    VariationPlan& sizes = result.sizes;
    sizes.cells = before.back();
    sizes.points = static_cast<double>(v.points.size());
    sizes.components = v.components();
    for (const auto& of_point : v.surfaces) // as many per length of an outline
        sizes.surfaces += static_cast<double>(of_point.size()) * result.stride;
    sizes.iterates = v.iterates;
    sizes.why = v.why;
    sizes.extent = PlaneCells{.points = v.points}.extent(nullptr);
    if (sizes.extent.is_complete(sampled.domain.nx, sampled.domain.ny))
        sizes.extent = {0, domain.nx, 0, domain.ny};
    else
        sizes.extent = extent_of(layers.scene.medium, domain);
    return result;
}

VariationPlan SpectralPlan::variation(const SampledVariation& sampled, int ranks) const {
    VariationPlan plan = sampled.sizes;
    if (sampled.cells_before.empty()) return plan;
    const double rank_rows = up(static_cast<double>(rigid.c.domain.nx), ranks) / sampled.stride;
    const auto cells_before = [&](double row) {
        const auto last = static_cast<double>(sampled.cells_before.size() - 1);
        const auto full_rows = static_cast<std::size_t>(std::min(row, last));
        const double part = std::min(row, last) - static_cast<double>(full_rows);
        const double first = sampled.cells_before[full_rows];
        return part > 0.0 ? first + part * (sampled.cells_before[full_rows + 1] - first) : first;
    };
    for (int rank = 0; rank < ranks; ++rank)
        plan.fullest_cells = std::max(plan.fullest_cells, cells_before((rank + 1) * rank_rows) -
                                                              cells_before(rank * rank_rows));
    if (plan.iterates) plan.box = box_grid(rigid.c, mesh, plan.extent, time.step_s);
    return plan;
}

SpongePlan SpectralPlan::sponge(const VariationPlan& varying) const {
    const bool varies = rigid.treatment != RigidTreatment::none || varying.points > 0.0;
    return sponge_plan(rigid.c, varies ? Lateral::varies : Lateral::uniform, time.step_s);
}

namespace {

/// Time in ns of one core: of an unknown of a solve, of a strain and its transform, and of a
/// product of two planes of a box.
constexpr double unknown_ns = 18.0, strain_ns = 40.0, product_ns = 0.3;
/// Mean iterations of a step that iterates, and solves before the first step.
constexpr double iterations = 2.0, first_solves = 12.0;

/// A step solves once, or twice with bodies. Each plane of a box takes a solve before the first
/// step, and its iterations take products; other iterations solve on the complete plane.
double work_of(const SpectralPlan& plan, const VariationPlan& v) {
    const Domain& domain = plan.rigid.c.domain;
    const double points = static_cast<double>(domain.nx * domain.ny),
                 solve_ns = 3.0 * static_cast<double>(plan.mesh.levels() - 1) * points * unknown_ns,
                 strain = v.planes() * points * strain_ns;
    const bool varies = v.points > 0.0 || plan.rigid.treatment != RigidTreatment::none;
    double step_ns = (varies ? 2.0 : 1.0) * solve_ns, first_ns = first_solves * solve_ns;
    if (v.box) {
        step_ns += iterations * product_ns * v.planes() * v.planes() *
                   static_cast<double>(v.box->nx * v.box->ny);
        first_ns += v.planes() * solve_ns;
    } else {
        step_ns += strain + (v.iterates ? iterations * (solve_ns + strain) : 0.0);
    }
    return first_ns + static_cast<double>(plan.steps()) * step_ns;
}

} // namespace

engines::Resources SpectralPlan::resources(const SampledVariation& sampled, int ranks) const {
    const Case& c = rigid.c;
    const VariationPlan v = variation(sampled, ranks);
    engines::Resources all;
    all.arrays = arrays_of_stepper(rigid.layers, mesh, v, sponge(v), ranks);
    for (const engines::Allocation& array : arrays_of_output(rigid.layers, mesh, v, ranks))
        all.arrays.push_back(array);
    all.arrays.push_back({"material map", map_bytes(c.scene.medium)});
    if (rigid.treatment == RigidTreatment::endless)
        all.arrays.push_back({"endless rigid bodies", endless_memory_B(rigid, mesh, ranks)});
    if (rigid.treatment == RigidTreatment::lumps)
        all.arrays.push_back({"rigid lumps", lump_memory_B(rigid, mesh, ranks)});
    all.work = work_of(*this, v);
    all.useful_ranks = static_cast<int>(std::min(c.domain.nx, fft::below_nyquist(c.domain.ny)));
    all.written_B = engines::volumes_B(c, static_cast<double>(mesh.clear_levels()));
    return all;
}

namespace {

/// What determines the cells of a medium with bodies or a map, without the time step.
Case varying_part(const Case& c) {
    Case alone;
    alone.scene.medium = c.scene.medium;
    alone.domain = c.domain;
    alone.solver = c.solver;
    return alone;
}

} // namespace

std::string SpectralPlan::key_of_variation() const {
    const Case& c = rigid.c;
    Case alone = varying_part(c);
    alone.scene.load.footprint = c.scene.load.footprint;
    alone.afferents = c.afferents; // see has_laminates()
    return fmt::format("{} {:.17g}", canonical_text(alone), time.step_s);
}

} // namespace shearwake::spectral
