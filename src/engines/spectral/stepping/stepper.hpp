// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/energy_watch.hpp"
#include "engines/spectral/bodies/rigid_bodies.hpp"
#include "engines/spectral/bodies/slab_bodies.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/kernels/strains.hpp"
#include "engines/spectral/lateral/box_response.hpp"
#include "engines/spectral/lateral/lateral_field.hpp"
#include "engines/spectral/lateral/lateral_sponge.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "engines/spectral/lateral/strain_planes.hpp"
#include "engines/spectral/lateral/strain_solver.hpp"
#include "engines/spectral/lateral/strain_transfer.hpp"
#include "fft/slab_transform.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
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

/// The energy that the scheme preserves (stepper_energy.cpp), half a step before the current time,
/// and the work of the load so far.
struct EnergyBalance {
    double energy_J = 0.0, work_J = 0.0;
};

/// The displacement over depth at this rank's wave vectors, and the step that advances it:
///     [M/dt^2 + a_lambda K_lambda + a_mu K_mu + C/(2 dt)] d = f - K u - C (u - u-)/dt,
///     u+ = 2u - u- + d;   from rest, u(dt) = d / 2.
/// Second order in dt for compressional and viscous forces, fourth order for shear. Where the
/// medium varies laterally, the stress in addition to that of the layers is computed in (x, y)
/// space from strains that are advanced together with u. The operator is then either a background
/// at least as stiff as the medium (one solve per step) or the true operator, A = B + E^T S E. With
/// e = E d the latter becomes (1 + E B^-1 E^T S) e = E B^-1 rhs, which is solved by conjugate
/// gradients. This takes the same number of iterations as preconditioning A with B, but its vectors
/// cover only the cells where the medium varies. Rigid bodies are a constraint (RigidBodies):
/// every solve with B is followed by one for the forces at their markers.
class Stepper {
public:
    /// Throws CaseFailure on all ranks together. Collective.
    Stepper(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs, double step_s,
            const Comm& team);

    /// Advances from t = n dt to (n + 1) dt. Throws CaseFailure or FieldDiverges on all ranks
    /// together. Collective.
    void advance();
    /// Number of steps so far.
    std::ptrdiff_t step() const { return step_; }

    /// Save and restore everything that changes from step to step; the stepper must be of the same
    /// case. Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

    /// Energy and work, exact up to rounding and the residual of iterations. Costs about one step.
    /// Throws FieldDiverges on all ranks together if the field diverges. Collective.
    EnergyBalance energy();

    /// u_z [m] at a depth as rows of the transposed spectrum, in the layout of SlabTransform. Not
    /// collective.
    void plane_of_w(double depth_m, double* plane) const;

    /// A component of u (0: x, 1: y, 2: z) at a level, in the same layout as plane_of_w(). Not
    /// collective.
    void plane_of_u(std::size_t component, std::size_t level, double* plane) const;

    /// The pencils of the displacement at the current and the previous step, row by row.
    const fft::AlignedVector<Block>& now() const { return now_; }
    const fft::AlignedVector<Block>& before() const { return before_; }

    const std::vector<std::string>& notes() const { return field_.variation().notes; }
    const StepStatistics& statistics() const { return statistics_; }
    /// Whether the iterations use the matrices of a box instead of complete planes.
    bool uses_box() const { return box_.has_value(); }
    const StepClock& clock() const { return clock_; }
    const StrainPlanes& planes() const { return *planes_; }
    const LateralField& field() const { return field_; }
    const RigidBodies& bodies() const { return *bodies_; }

private:
    void assemble();
    /// Factorises an operator for all pencils of this rank, and assembles the rigid bodies with it.
    /// Throws CaseFailure on all ranks together. Collective.
    void factorise(Operator which);
    /// What a step would be without the elastic bodies, computed in advance: the next second
    /// difference of the displacement, B^-1 (f - K u - C (u - u-)/dt), the load f of the pencils
    /// and the strain of the second difference at the cells.
    struct Prediction {
        bool valid = false; // for the current displacement
        fft::AlignedVector<Block> change, load;
        LateralField::Values strain;
    };
    /// Assembles the box of the elastic bodies if it accelerates the iterations. Collective.
    void assemble_box();
    /// Ends the rows of `planes` from `plane` on with the strain for a unit stress in this plane.
    /// Not collective.
    void respond_to_plane(std::ptrdiff_t plane, StrainPlanes& planes);
    /// Layout of now_ and before_ as rows of ky, which can be distributed over any number of ranks.
    DistributedRows state_rows() const;
    /// One pass over the pencils: forces, solve and update. Collective.
    void first_pass();
    /// A step whose iterations use the box. The stress of the bodies, implicit part included, is
    /// known before the pass over the pencils, which applies it and predicts the next step while
    /// the factors are in the cache. Collective.
    void advance_on_box();
    /// Predicts the change of all pencils. Collective.
    void predict_all();
    /// Predicts the change of a pencil and puts its strain into the planes; `scale` is the weight
    /// of the second difference. Prefetches the factor that is needed next.
    void predict(std::ptrdiff_t row, std::ptrdiff_t block, double scale, const Block* u,
                 const Block* before, const Block* needed);
    /// The pass over the pencils of advance_on_box(). Collective.
    void complete_and_predict();
    /// Sets `force` to the load and the background's forces, and `pressure` to the load alone. Adds
    /// the kinetic energy to kinetic_. Prefetches the factor that is needed next.
    void put_forces(std::ptrdiff_t row, std::ptrdiff_t block, const Block* u, const Block* before,
                    Block* force, Block* pressure, const Block* needed);
    /// Adds the work of the load on the motion (u+ - u-)/2 to work_.
    void add_work(std::ptrdiff_t row, std::ptrdiff_t block, double scale, const Block* u,
                  const Block* before, const Block* change, const Block* pressure);
    /// Weight of the second difference: from rest, the first step has half of it.
    double first_step_scale() const { return step_ == 0 ? 0.5 : 1.0; }
    /// A pass over the pencils with the response to the forces of the rigid bodies, after all
    /// pencils have been evaluated: use(row, block, pencil, displacement). Its strain is in the
    /// planes afterwards. Not collective.
    using Reaction = std::function<void(std::ptrdiff_t row, std::ptrdiff_t block,
                                        std::ptrdiff_t pencil, const Block* displacement)>;
    void each_reaction(const Reaction& use);
    /// Determines the forces of the rigid bodies and adds the response to the next displacement and
    /// its strain to change_. Collective.
    void constrain_step();
    /// Adds the planes to the values of the cells. Collective.
    void add_planes(LateralField::Values& values);
    /// Whether nothing varies laterally: no elastic body, and rigid ones only as complete layers.
    bool is_uniform() const { return field_.variation().empty() && bodies_->empty(); }
    /// Apply B^-1 E^T to a stress with the sign of a force: strain_of() computes the strain of the
    /// result, displace() adds the result to the next displacement.
    void strain_of(const LateralField::Values& stress, LateralField::Values& strain);
    void displace(const LateralField::Values& stress);
    /// Whether the strains that a pass over the pencils leaves in the lines are transformed.
    enum class Strains { needed, unused };
    /// Solves B for the force of the planes at every pencil and calls use(row, block, pencil,
    /// displacement), then determines the forces of the rigid bodies that this requires.
    template <class Use>
    void respond(const LateralField::Values& stress, Strains strains, Use use);
    /// Work of the load `pressure` on half of `scale` times a displacement of a pencil.
    double work_of_change(std::ptrdiff_t row, std::ptrdiff_t block, double scale,
                          const Block* displacement, const Block* pressure) const;
    /// Adds `scale` times a displacement to the next one of a pencil. Returns the work of the load
    /// `pressure`.
    double add_to_next(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil,
                       double scale, const Block* displacement, const Block* pressure);
    /// Calls use(row, block, pencil) for all blocks of all ky while the lines of their planes are
    /// spectra. `strains` states whether the planes are used afterwards.
    template <class Use>
    void each_pencil(Strains strains, Use use);
    void add_planes_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* force);
    /// B^-1 of a pencil, for the slabs; and with the slabs held, for the other bodies.
    RigidBodies::Solve background_solve() const;
    RigidBodies::Solve held_solve();
    void put_strain(std::ptrdiff_t row, std::ptrdiff_t block, const Block* displacement);
    const Block* factor(std::ptrdiff_t pencil) const;
    const Block* pencil(const fft::AlignedVector<Block>& of, std::ptrdiff_t row,
                        std::ptrdiff_t block) const {
        return of.data() + (row * vectors_.blocks() + block) * operator_.unknowns() * parts;
    }
    /// Work of the load on a motion of the surface, given by motion(part, lane).
    template <class Motion>
    static double work_of(const Counted& counted, const Block* pressure, Motion motion);
    /// Memory traffic in bytes: of one pencil in the planes; of the factors and `times` the
    /// displacement of one pencil; and of `times` an array of values where the medium varies.
    double block_bytes() const;
    double pencil_bytes(double times) const;
    double value_bytes(double times) const;
    /// On entry change_ is E B^-1 rhs, on return e = E d. Returns the number of iterations.
    /// Collective.
    int iterate();
    /// The response of the background to a stress, on the planes or on the box.
    StrainSolver::Responses on_plane();
    StrainSolver::Responses on_box();
    void advance_strains();
    /// Removes the sponge's share of the velocity. In a medium without bodies this is part of
    /// first_pass(), when the factors are in the cache. Collective.
    void begin_damping();
    void constrain_damping();
    void add_impulse(std::ptrdiff_t pencil, const Block* change);
    void damp(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil, Block* change);

    const Case& case_;
    Case layers_; // and elastic bodies
    DepthMesh mesh_;
    const fft::SlabTransform& slabs_;
    Comm team_;
    WaveVectors vectors_;
    double step_s_;
    double tolerance_;
    std::ptrdiff_t step_ = 0;
    StepClock clock_;
    LateralField field_;
    VerticalOperator operator_;
    StrainTransfer transfer_;
    MovingLoad load_;
    LateralSponge sponge_;
    std::unique_ptr<RigidBodies> bodies_;
    SlabBodies slab_bodies_;
    StepStatistics statistics_;
    engines::EnergyWatch watch_;
    RowSums kinetic_, work_; // per ky: twice the kinetic energy before a step, and its work
    double reference_ = 0.0; // the larger of both, sum over all ranks
    const PencilKernels& kernels_;
    const StrainKernels& strain_kernels_;
    fft::AlignedVector<Block> factors_, now_, before_, pencil_;
    std::optional<StrainPlanes> planes_;
    LateralField::Values strain_, strain_before_, stress_, change_, reaction_;
    std::optional<StrainSolver> solver_; // empty unless steps iterate
    std::optional<BoxResponse> box_;     // empty unless iterations use it
    Prediction predicted_;               // with a box
};

template <class Use>
void Stepper::each_pencil(Strains strains, Use use) {
    bodies_->clear();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        planes_->begin_row(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block)
            use(row, block, row * vectors_.blocks() + block);
        if (strains == Strains::needed)
            planes_->end_row(row,
                             is_nyquist ? StrainPlanes::Modes::emptied : StrainPlanes::Modes::kept);
        bodies_->end_row(row);
    }
}

} // namespace shearwake::spectral
