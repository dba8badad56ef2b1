// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/lateral_field.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "engines/spectral/lateral/strain_planes.hpp"
#include "engines/spectral/lateral/strain_transfer.hpp"
#include "fft/slab_transform.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace shearwake::spectral {

/// Effort of the steps so far.
struct StepStatistics {
    std::ptrdiff_t steps = 0;
    std::ptrdiff_t iterations = 0; // total number of conjugate-gradient iterations
    /// Plane transforms in both directions, since the start of this run.
    std::ptrdiff_t transforms = 0;
    int most_iterations = 0; // maximum in one step
};

/// Interval of the sponge in steps (0: no sponge) and the number of points of its planes.
struct SpongePlan {
    std::ptrdiff_t every = 0, nx = 0, ny = 0;
};
/// Whether the medium varies laterally.
enum class Lateral { uniform, varies };
/// The interval and the planes of the sponge of a case. Not collective.
SpongePlan sponge_plan(const Case& c, Lateral medium, double step_s);

/// The energy of a step.
struct StepEnergy {
    RowSums kinetic, work;  // per ky: twice the kinetic energy before the step, and its work
    double reference = 0.0; // the larger of both, sum over all ranks, if steps iterate
    engines::EnergyWatch watch;

    void clear() {
        kinetic.clear();
        work.clear();
    }
};

/// A pencil: the displacement over depth at a block of wave vectors of one ky.
struct Pencil {
    std::ptrdiff_t row, block, at; // `at`: index among all pencils of this rank
};

/// What the stages of a step share (stepper.hpp): the displacement u over depth at this rank's wave
/// vectors; the strain at the cells where the medium varies laterally; the operator B of the
/// background with its factors; and the two ways between pencils and cells: E^T of a stress in the
/// planes adds to the force of a pencil, and E of the displacement of a pencil adds to the strain
/// in the planes. Rigid bodies act alike, by forces at their markers.
class StepState {
public:
    using Values = LateralField::Values;
    /// Factorises B and assembles the rigid bodies with it. Throws CaseFailure on all ranks
    /// together. Collective.
    StepState(RigidPlan plan, const DepthMesh& mesh, const fft::SlabTransform& slabs, double step_s,
              const Comm& team);
    StepState(const StepState&) = delete;
    StepState& operator=(const StepState&) = delete;

    // Constant.
    const RigidPlan rigid;
    const Case& c = rigid.c;
    DepthMesh mesh;
    const fft::SlabTransform& slabs;
    Comm team;
    WaveVectors vectors;
    double step_s;
    const PencilKernels& kernels;

    LateralField field;
    VerticalOperator vertical;
    StrainTransfer transfer;
    MovingLoad load;
    std::unique_ptr<RigidBodies> bodies;
    StrainPlanes planes;
    const SpongePlan sponge;

    // What changes from step to step: u and the strain, each at the current and at the previous
    // step. The pencils of a step replace the previous ones by the next ones, which `before`
    // contains until the end of the step.
    std::ptrdiff_t step = 0;
    fft::AlignedVector<Block> now, before;
    Values strain, strain_before;

    // Of the current step.
    Values change; // strain of d, the next second difference of u
    Values stress; // work array
    StepEnergy energy;
    StepStatistics statistics;
    fft::AlignedVector<Block> scratch; // of one pencil

    /// Whether the sponge changes u before this step. This depends on the step alone, so that a
    /// resumed run does the same.
    bool sponge_acts_at(std::ptrdiff_t n) const {
        return sponge.every > 0 && n > 0 && n % sponge.every == 0;
    }
    /// The next displacement becomes the current one. Not collective.
    void end_step();

    bool varies() const { return !field.variation().empty(); }
    /// Whether nothing varies laterally: no body.
    bool is_uniform() const { return !varies() && bodies->empty(); }
    /// Weight of the second difference: from rest, the first step has half of it.
    double scale() const { return step == 0 ? 0.5 : 1.0; }
    double per_point() const { return 1.0 / static_cast<double>(c.domain.nx * c.domain.ny); }
    Pencil pencil(std::ptrdiff_t row, std::ptrdiff_t block) const {
        return {row, block, row * vectors.blocks() + block};
    }
    /// Number of Blocks of a pencil, and the places of its displacement and of its factor.
    std::ptrdiff_t size() const { return vertical.unknowns() * parts; }
    const Block* u(const Pencil& p) const { return now.data() + p.at * size(); }
    Block* u_before(const Pencil& p) { return before.data() + p.at * size(); }
    const Block* factor(std::ptrdiff_t at) const {
        return factors_.data() + at * vertical.factor_size();
    }

    // Passes over the pencils. Not collective.

    /// What remains of the displacements of a pass: their strain in the planes, and their values at
    /// the markers of the rigid bodies.
    struct Reads {
        bool strain = true, markers = true;
    };
    /// Calls begin(row) and then use(pencil) for all pencils of each ky.
    template <class Begin, class Use>
    void each_pencil(Reads reads, Begin begin, Use use);
    /// The same while the lines of the planes are spectra, for forces from them.
    template <class Use>
    void each_pencil(Reads reads, Use use) {
        each_pencil(
            reads, [this](std::ptrdiff_t row) { planes.begin_row(row); }, use);
    }
    /// The response to the forces of the rigid bodies, use(pencil, displacement). Its strain is in
    /// the planes afterwards.
    using Reaction = std::function<void(const Pencil&, const Block* displacement)>;
    void each_reaction(const Reaction& use);

    /// The factors and u. Not collective.
    std::vector<engines::Allocation> arrays() const;
    /// Save and restore u. Collective.
    void save_displacement(StateWriter& state) const;
    void restore_displacement(const StateReader& state);

    // A pencil. Not collective.

    /// Sets `force` to the load and the background's forces, f - K u - C (u - u-)/dt, and
    /// `pressure` to the load alone. Adds the kinetic energy to `energy`. Prefetches the factor
    /// that is needed next.
    void put_forces(const Pencil& p, const Block* u, const Block* before, Block* force,
                    Block* pressure, const Block* needed);
    /// E^T of the planes.
    void add_planes_force(const Pencil& p, Block* force);
    /// E of a displacement.
    void put_strain(const Pencil& p, const Block* displacement);
    /// B^-1.
    void solve(const Pencil& p, Block* force) const {
        vertical.solve_implicit(factor(p.at), force);
    }
    /// Adds the work of the load on the motion (u+ - u-)/2 to `energy`.
    void add_work(const Pencil& p, double scale, const Block* u, const Block* before,
                  const Block* change, const Block* pressure);
    /// Work of the load `pressure` on half of `scale` times a displacement.
    double work_of_change(const Pencil& p, double scale, const Block* displacement,
                          const Block* pressure) const;
    /// Adds scale() times a displacement to the next one. Returns the work of the load.
    double add_to_next(const Pencil& p, const Block* displacement);

    // Values of the cells.

    /// Sets `stress` to the explicit one, in addition to that of the layers. Not collective.
    void find_stress();
    /// Adds the planes to the values. Collective.
    void add_planes(Values& values);

private:
    void allocate();
    void factorise(Operator which);
    /// Layout of `now` and `before` as rows of ky, which any number of ranks can share.
    DistributedRows rows() const;
    /// Work of the load on a motion of the surface, given by motion(part, lane).
    template <class Motion>
    double work_of(const Pencil& p, const Block* pressure, Motion motion) const;

    fft::AlignedVector<Block> factors_;
    Values reaction_;
};

template <class Begin, class Use>
void StepState::each_pencil(Reads reads, Begin begin, Use use) {
    if (reads.markers) bodies->clear();
    for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row) {
        const bool is_nyquist = vectors.is_nyquist(row);
        begin(row);
        for (std::ptrdiff_t block = 0; block < vectors.blocks() && !is_nyquist; ++block)
            use(pencil(row, block));
        if (reads.strain)
            planes.end_row(row, is_nyquist ? StrainPlanes::Modes::emptied
                                           : StrainPlanes::Modes::retained);
        if (reads.markers) bodies->end_row(row);
    }
}

} // namespace shearwake::spectral
