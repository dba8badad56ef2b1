// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scheme/placed_source.hpp"
#include "engines/pstd/scheme/split_axis.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

double points_of(const Grid& grid) {
    return static_cast<double>(grid.points[0]) * static_cast<double>(grid.points[1]) *
           static_cast<double>(grid.points[2]);
}

} // namespace

double varying_coefficients(const Variations& vary, Absorption absorption) {
    // Densities; mu of three shears, lambda and the P modulus; chi, chi + 2 eta, and eta of shears.
    return (vary.density ? 3.0 : 0.0) + (vary.density || vary.speeds ? 5.0 : 0.0) +
           (vary.viscosity && absorption != Absorption::none ? 5.0 : 0.0);
}

namespace {

/// Time in ns of one core for each value that a step reads or writes, by precision.
constexpr double single_ns = 10.0, double_ns = 14.0;
/// The setup, in steps.
constexpr double first_steps = 12.0;

/// The work of the steps. Each step also adds to the displacements of the columns of the domain.
double work_of(const Case& c, const PstdPlan& plan) {
    const double columns = static_cast<double>(c.domain.nx * c.domain.ny);
    // Per point: totals, parts, and transforms of gradients.
    const double per_point = 9.0 + 15.0 + (plan.absorption != Absorption::none ? 15.0 : 6.0);
    const double value_ns = plan.precision == Precision::single_precision ? single_ns : double_ns;
    return value_ns * (plan.steps + first_steps) * (per_point * points_of(plan.grid) + columns);
}

} // namespace

std::string note_of(const PstdPlan& plan) {
    const double value_B = plan.precision == Precision::single_precision ? 4.0 : 8.0;
    const double device_B =
        device_memory_B({.grid = plan.grid, .pml = plan.pml, .absorption = plan.absorption},
                        value_B, plan.coefficients, plan.source_nodes);
    const auto& [nx, ny, nz] = plan.grid.points;
    const auto& [x, y, z] = plan.pml.points;
    return fmt::format(
        "{} x {} x {} points in {} precision, with an absorbing layer of {}, {} and {} "
        "points along x, y and z; {}, with {}{}",
        nx, ny, nz, plan.precision == Precision::single_precision ? "single" : "double", x, y, z,
        plan.absorption == Absorption::none ? "lossless" : "viscous",
        plan.uneven ? "the material of each node" : "one material for each plane",
        plan.device.device == PstdDevice::gpu
            ? fmt::format("; on a GPU, in {:.3g} GB of its memory", 1e-9 * device_B)
            : "");
}

/// What a host has in its memory while a device computes.
static std::vector<engines::Allocation> host_arrays_of(const PstdPlan& plan) {
    const Slabs slabs = slabs_of(plan.grid, 1, 0);
    const double value_B = plan.precision == Precision::single_precision ? 4.0 : 8.0;
    const auto all = static_cast<double>(slabs.reals());
    double runs = 0.0;
    for (std::size_t f = 0; f < field_count; ++f)
        runs += split_sizes(slabs, plan.pml, parts_of(static_cast<Field>(f))).runs_B;
    const double output_B = sizeof(double) * static_cast<double>(slabs.rows()) *
                            static_cast<double>(plan.places.planes + 2 * plan.levels);
    // One field at a time travels for a checkpoint, in double precision as well.
    const double start_B =
        all * (sizeof(NodeMaterial) + value_B) + (plan.coefficients + 1.0) * all * value_B + runs;
    return {{"sources", plan.source_nodes * (sizeof(Node) + PlacedSource<double>::node_B)},
            {"displacement of nodes", output_B},
            {"materials at the start, fields of checkpoints",
             std::max(start_B, all * (3.0 * value_B + sizeof(double)))}};
}

std::vector<engines::Allocation> arrays_of(const PstdPlan& plan, int ranks) {
    if (plan.device.device == PstdDevice::gpu) return host_arrays_of(plan);
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
            .work = work_of(c, plan),
            .useful_ranks =
                plan.device.device == PstdDevice::gpu
                    ? 1
                    : static_cast<int>(std::min(plan.grid.points[0], plan.grid.points[1])),
            .written_B = engines::volumes_B(c, static_cast<double>(plan.levels))};
}

} // namespace shearwake::pstd
