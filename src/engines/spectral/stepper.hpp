#pragma once

#include "engines/checkpoint.hpp"
#include "engines/spectral/energy_watch.hpp"
#include "engines/spectral/lateral_field.hpp"
#include "engines/spectral/lateral_sponge.hpp"
#include "engines/spectral/moving_load.hpp"
#include "engines/spectral/strain_solver.hpp"
#include "engines/spectral/strain_planes.hpp"
#include "engines/spectral/strain_transfer.hpp"
#include "engines/spectral/vertical_operator.hpp"
#include "fft/slab_transform.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// How hard the steps were.
struct StepStatistics {
    std::ptrdiff_t steps = 0;
    std::ptrdiff_t iterations = 0; // of conjugate gradients, in all
    std::ptrdiff_t transforms = 0; // of planes of strain, there or back, on this run
    int most_iterations = 0;       // in one step
};

/// What the scheme keeps (energy_watch.hpp) half a step before now, and the load's work so far.
struct EnergyBalance {
    double energy_J = 0.0, work_J = 0.0;
};

/// The displacement at this rank's wave vectors over depth, and the step that advances it:
///     [M/dt^2 + a_lambda K_lambda + a_mu K_mu + C/(2 dt)] d = f - K u - C (u - u-)/dt,
///     u+ = 2u - u- + d;   from rest, u(dt) = d / 2.
/// Second order in dt for compressional and viscous forces, fourth for shear. Where the medium
/// varies laterally, its stress beyond the layers' is found in (x, y) space from strains that are
/// advanced with u, and the operator is either a background at least as stiff as the medium (one
/// solve) or the true one, A = B + E^T S E: with e = E d it is (1 + E B^-1 E^T S) e = E B^-1 rhs,
/// solved by conjugate gradients; as many iterations as preconditioning A with B would need, on
/// vectors that live where the medium varies.
class Stepper {
public:
    /// Collective. Throws CaseFailure on all ranks together.
    Stepper(const Case& c, const DepthMesh& mesh, const SlabTransform& slabs, double step_s,
            const Comm& team);

    /// From t = n dt to (n + 1) dt. Collective.
    void advance();
    /// Steps so far.
    std::ptrdiff_t step() const { return step_; }

    /// All that changes from step to step; restored into a stepper of the same case. Collective.
    void save(StateWriter& state) const;
    void restore(StateReader& state);

    /// Exact to rounding and, with iterations, their residual. Costs about a step. Collective;
    /// throws FieldDiverges on all ranks together when the field has.
    EnergyBalance energy();

    /// u_z at a depth as rows of the transposed spectrum, ready for SlabTransform. Not collective.
    void plane_of_w(double depth_m, double* plane) const;

    /// A component of u (0 x, 1 y, 2 z) at a level, likewise.
    void plane_of_u(std::size_t component, std::size_t level, double* plane) const;

    /// The pencils of the displacement at this step and a step before, row by row.
    const AlignedVector<double>& now() const { return now_; }
    const AlignedVector<double>& before() const { return before_; }

    const std::vector<std::string>& notes() const { return field_.variation().notes; }
    const StepStatistics& statistics() const { return statistics_; }
    const StepClock& clock() const { return clock_; }
    /// Of this rank's arrays.
    double memory_B() const;
    const StrainPlanes& planes() const { return *planes_; }
    const LateralField& field() const { return field_; }

private:
    void assemble();
    /// now_ and before_ as rows of ky, which any number of ranks shares out as it likes.
    StateRows state_rows() const;
    /// One pass over the pencils: forces, solve, and what comes of it. Collective.
    void first_pass();
    /// Of B^-1 E^T applied to a stress, with the sign that forces have: its strain; and itself,
    /// added to the displacement to come.
    void strain_of(const LateralField::Values& stress, LateralField::Values& strain);
    void displace(const LateralField::Values& stress);
    /// Solves B for the force of the planes at every pencil: use(row, block, pencil, displacement).
    template <class Use>
    void respond(const LateralField::Values& stress, Use use);
    /// use(row, block, pencil) for all blocks of all ky, their planes' lines being spectra then.
    template <class Use>
    void each_pencil(Use use);
    void add_planes_force(std::ptrdiff_t row, std::ptrdiff_t block, Lanes* force);
    void put_strain(std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* displacement);
    const Lanes* factor(std::ptrdiff_t pencil) const;
    /// The load's work on a motion of the surface, given by its parts.
    template <class Motion>
    Lanes work_of(std::ptrdiff_t row, std::ptrdiff_t block, Motion motion) const;
    /// Bytes: of what one pencil touches in the planes; of its factors and, `times` over, its
    /// displacement; and `times` an array of values where the medium varies.
    double block_bytes() const;
    double pencil_bytes(double times) const;
    double value_bytes(double times) const;
    void iterate();
    void advance_strains();
    /// Takes the sponge's share of the velocity, where nothing varies laterally only in first_pass:
    /// there the factors are in the cache. Collective.
    void begin_damping();
    void damp(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil, Lanes* change);

    const Case& case_;
    DepthMesh mesh_;
    const SlabTransform& slabs_;
    Comm team_;
    WaveVectors vectors_;
    double step_s_;
    double tolerance_;
    std::ptrdiff_t step_ = 0;
    LateralField field_;
    VerticalOperator operator_;
    StrainTransfer transfer_;
    MovingLoad load_;
    LateralSponge sponge_;
    StepStatistics statistics_;
    EnergyWatch watch_;
    RowSums kinetic_, work_; // by ky: twice the kinetic energy before a step, its work
    double reference_ = 0.0; // the greater one, of all ranks
    // Lanes by eights: a vector of a vector type would lose the type's alignment.
    AlignedVector<double> factors_, now_, before_, pencil_;
    StepClock clock_;
    std::optional<StrainPlanes> planes_;
    LateralField::Values strain_, strain_before_, stress_, change_;
    std::optional<StrainSolver> solver_; // where it iterates
};

} // namespace shearwake
