// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/step_state.hpp"

#include "engines/spectral/bodies/lump_bodies.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// E >= 1/2 v.(A - K/4) v >= 0.02 (1/2 v.M v/dt^2) where the scheme is stable
/// (vertical_operator.hpp).
constexpr double most_kinetic_1 = 50.0;
constexpr const char* watch_advice =
    "a shorter solver.spectral.time_step_us, a smaller contrast_cap or a smaller residual may help";

} // namespace

StepState::StepState(RigidPlan plan, const DepthMesh& of_depth, const fft::SlabTransform& of_planes,
                     double dt_s, const Comm& ranks)
    : rigid(std::move(plan)), mesh(of_depth), slabs(of_planes), team(ranks),
      vectors(c.domain, slabs.share()), step_s(dt_s), kernels(simd::kernels<PencilKernels>()),
      field(lateral_variation(rigid.layers, mesh, slabs.share(), largest_k_rad_m(c.domain), step_s,
                              &team),
            c.domain.ny, slabs.share()),
      vertical(mesh, field.variation().background),
      transfer(mesh, field.variation().strain_points, field.variation().components()),
      load(c, vectors, step_s, {c.scene.load, c.time.duration_s() + 2.0 * step_s}),
      bodies(make_rigid_bodies(rigid, mesh, slabs, vectors, step_s, team)),
      planes(field.cells(), slabs, team, StrainPlanes::Corner{}),
      sponge(sponge_plan(c, is_uniform() ? Lateral::uniform : Lateral::varies, step_s)),
      // Checked at every step if steps iterate, because the failure of an iteration describes the
      // cause less well.
      energy{.kinetic = RowSums(c.domain.ny / 2 + 1),
             .work = RowSums(c.domain.ny / 2 + 1),
             .watch = {team,
                       step_s,
                       {.most_1 = most_kinetic_1,
                        .interval = field.variation().iterates ? 1 : 16,
                        .advice = watch_advice}}} {
    together(team, [&] { allocate(); });
    // The energy of the scheme must be positive for all motion that the bodies permit; only light
    // ones reduce it. If so, the same holds for the implicit operator, which follows.
    if (std::find(mesh.light.begin(), mesh.light.end(), true) != mesh.light.end())
        factorise(Operator::of_change);
    factorise(Operator::implicit);
}

void StepState::allocate() {
    factors_.resize(static_cast<std::size_t>(vectors.pencils() * vertical.factor_size()));
    now.assign(static_cast<std::size_t>(vectors.pencils() * size()), Block{});
    before = now;
    scratch.resize(static_cast<std::size_t>(size()));
    planes.assemble();
    for (Values* values : {&strain, &strain_before, &stress, &change})
        values->assign(field.size(), 0.0);
    if (!bodies->empty()) reaction_ = change;
}

void StepState::factorise(Operator which) {
    together(team, [&] {
        for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors.blocks(); ++block)
                vertical.factorise(which, vectors.waves(row, block).k, step_s,
                                   factors_.data() +
                                       pencil(row, block).at * vertical.factor_size());
    });
    bodies->assemble(vertical, [this](std::ptrdiff_t row, std::ptrdiff_t block, Block* force) {
        solve(pencil(row, block), force);
    });
}

void StepState::end_step() {
    std::swap(now, before);
    bodies->end_step();
    ++step;
    ++statistics.steps;
    statistics.transforms = planes.transforms();
}

void StepState::each_reaction(const Reaction& use) {
    Block* force = scratch.data();
    each_pencil(
        {.markers = false}, [&](std::ptrdiff_t row) { bodies->begin_forces(row); },
        [&](const Pencil& p) {
            std::fill(scratch.begin(), scratch.end(), Block{});
            bodies->add_force(p.row, p.block, force);
            solve(p, force);
            if (use) use(p, force);
            put_strain(p, force);
        });
}

void StepState::put_forces(const Pencil& p, const Block* u, const Block* previous, Block* force,
                           Block* pressure, const Block* needed) {
    std::fill_n(force, size(), Block{});
    load.put(p.row, p.block, pressure);
    std::copy_n(pressure, parts, force + parts); // unknown 1 is W at the surface
    vertical.add_internal_force(vectors.waves(p.row, p.block).k, 1.0 / step_s, u, previous, force,
                                needed);
    energy.kinetic.add(slabs.share().ky_start + p.row,
                       sum_of(vertical.twice_kinetic(1.0 / step_s, u, previous,
                                                     vectors.counted(p.row, p.block).part)));
}

void StepState::add_planes_force(const Pencil& p, Block* force) {
    transfer.add_force(planes.in_line(vectors.waves(p.row, p.block)), planes.line(p.row),
                       planes.stride(), per_point(), force);
}

void StepState::put_strain(const Pencil& p, const Block* displacement) {
    transfer.strain(planes.in_line(vectors.waves(p.row, p.block)), displacement, planes.line(p.row),
                    planes.stride());
}

template <class Motion>
double StepState::work_of(const Pencil& p, const Block* pressure, Motion motion) const {
    const Counted counted = vectors.counted(p.row, p.block);
    Block sum{};
    for (std::ptrdiff_t part = 0; part < parts; ++part)
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            sum[lane] += counted.part[part][lane] * pressure[part][lane] * motion(part, lane);
    return sum_of(sum);
}

void StepState::add_work(const Pencil& p, double weight, const Block* u, const Block* previous,
                         const Block* d, const Block* pressure) {
    energy.work.add(
        slabs.share().ky_start + p.row,
        work_of(p, pressure, [&](std::ptrdiff_t part, std::ptrdiff_t lane) { // (u+ - u-)/2
            return u[parts + part][lane] - previous[parts + part][lane] +
                   0.5 * weight * d[parts + part][lane];
        }));
}

double StepState::work_of_change(const Pencil& p, double weight, const Block* displacement,
                                 const Block* pressure) const {
    return work_of(p, pressure, [&](std::ptrdiff_t part, std::ptrdiff_t lane) {
        return 0.5 * weight * displacement[parts + part][lane];
    });
}

double StepState::add_to_next(const Pencil& p, const Block* displacement) {
    Block pressure[parts];
    load.put(p.row, p.block, pressure);
    kernels.add_scaled(size(), scale(), displacement, u_before(p));
    return work_of_change(p, scale(), displacement, pressure);
}

void StepState::find_stress() {
    field.stress(strain, strain_before, 1.0 / step_s, stress);
}

void StepState::add_planes(Values& values) {
    planes.get(reaction_);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += reaction_[i];
}

DistributedRows StepState::rows() const {
    return {.total = c.domain.ny / 2 + 1,
            .start = slabs.share().ky_start,
            .count = slabs.share().ky_count,
            .row_length = vectors.blocks() * size() * lane_count};
}

std::vector<engines::Allocation> StepState::arrays() const {
    return {{"factors", static_cast<double>(factors_.size() * sizeof(Block))},
            {"displacement", static_cast<double>((now.size() + before.size()) * sizeof(Block))}};
}

void StepState::save_displacement(StateWriter& state) const {
    state.put("now", rows(), scalars(now.data()));
    state.put("before", rows(), scalars(before.data()));
}

void StepState::restore_displacement(const StateReader& state) {
    state.get("now", rows(), scalars(now.data()));
    state.get("before", rows(), scalars(before.data()));
}

} // namespace shearwake::spectral
