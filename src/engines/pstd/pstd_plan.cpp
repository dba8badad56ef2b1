// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

double points_of(const Grid& grid) {
    return static_cast<double>(grid.points[0]) * static_cast<double>(grid.points[1]) *
           static_cast<double>(grid.points[2]);
}

} // namespace

double varying_coefficients(bool density, bool speeds, bool viscosity, Absorption absorption) {
    // Densities; mu of three shears, lambda and the P modulus; chi, chi + 2 eta, and eta of shears.
    return (density ? 3.0 : 0.0) + (density || speeds ? 5.0 : 0.0) +
           (viscosity && absorption != Absorption::none ? 5.0 : 0.0);
}

engines::MarchWork march_work(const Case& c, const PstdPlan& plan) {
    const bool lossy = plan.absorption != Absorption::none;
    const double columns = static_cast<double>(c.domain.nx * c.domain.ny);
    const double frames = static_cast<double>(c.time.frames);
    const double given = columns * static_cast<double>(c.measure.depths_m.size()) * frames;
    // Values that a step reads and writes per point: totals, parts, and transforms of gradients.
    const double per_point = 9.0 + 15.0 + (lossy ? 15.0 : 6.0);
    engines::MarchWork work{
        .kind = fmt::format("pstd {}{}{}",
                            plan.precision == Precision::single_precision ? "single" : "double",
                            lossy ? " lossy" : "", plan.uneven ? " uneven" : ""),
        .unknowns = per_point * points_of(plan.grid) + columns + given / plan.steps,
        .steps = plan.steps,
        .snapshots = static_cast<double>(c.record.volumes_s.size())};
    if (plan.levels == 0) return work;
    work.kind += ", displacements";
    work.values = 3.0 * columns * static_cast<double>(plan.levels);
    return work;
}

std::string note_of(const PstdPlan& plan) {
    const auto& [nx, ny, nz] = plan.grid.points;
    const auto& [x, y, z] = plan.pml.points;
    return fmt::format(
        "{} x {} x {} points in {} precision, with an absorbing layer of {}, {} and {} "
        "points along x, y and z; {}, with {}",
        nx, ny, nz, plan.precision == Precision::single_precision ? "single" : "double", x, y, z,
        plan.absorption == Absorption::none ? "lossless" : "viscous",
        plan.uneven ? "the material of each node" : "one material for each plane");
}

std::vector<engines::Array> arrays_of(const PstdPlan& plan, int ranks) {
    const Slabs slabs = slabs_of(plan.grid, ranks, ranks - 1); // with an edge in x
    const double value_B = plan.precision == Precision::single_precision ? 4.0 : 8.0;
    const auto all = static_cast<double>(slabs.reals());
    const double of_plane = static_cast<double>(slabs.ny() * slabs.pitch);
    double parts = 0.0, runs = 0.0;
    for (std::size_t f = 0; f < field_count; ++f) {
        const Parts of = parts_of(static_cast<Field>(f));
        const SplitSizes split = split_sizes(slabs, plan.pml, of);
        parts += split.values;
        runs += split.runs_B;
    }
    const bool lossy = plan.absorption != Absorption::none;
    // Derivatives along x and accelerations; a part of a field that travels to other ranks and
    // back.
    const auto exchanges = static_cast<double>(parts_of_exchange(all * value_B, ranks));
    const double transforms = (lossy ? 6.0 + 3.0 : 3.0) * all + (lossy ? 12.0 : 6.0) * of_plane +
                              2.0 * all / exchanges * (ranks - 1.0) / ranks;
    const double source_B =
        plan.source_nodes * sizeof(Node) + plan.source_nodes / ranks * PlacedSource<double>::node_B;
    // Materials, and a coefficient while it is computed, are released before the output is
    // allocated.
    const double materials_B = sizeof(NodeMaterial) * static_cast<double>((slabs.x_count() + 1) *
                                                                          slabs.ny() * slabs.nz()) +
                               all * value_B;
    const double output_B = sizeof(double) * static_cast<double>(slabs.rows()) *
                            static_cast<double>(plan.places.planes + 2 * plan.levels);
    return {{"velocity and stress", 9.0 * all * value_B},
            {"their parts in the absorbing layer", parts * value_B + runs},
            {"derivatives along x and accelerations", transforms * value_B},
            {"coefficients of nodes", plan.coefficients * all * value_B},
            {"sources", source_B},
            {"displacement of nodes", output_B},
            {"materials at the start", std::max(0.0, materials_B - output_B)}};
}

engines::Resources resources_of(const Case& c, const PstdPlan& plan, int ranks) {
    return {.arrays = arrays_of(plan, ranks),
            .work = engines::parts_of(march_work(c, plan)),
            .useful_ranks = static_cast<int>(std::min(plan.grid.points[0], plan.grid.points[1])),
            .written_B = engines::volumes_B(c, static_cast<double>(plan.levels))};
}

} // namespace shearwake::pstd
