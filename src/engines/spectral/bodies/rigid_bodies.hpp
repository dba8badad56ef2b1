// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"
#include "base/vectors.hpp"
#include "engines/checkpoint.hpp"
#include "engines/engine.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "parallel/comm.hpp"
#include "parallel/state.hpp"
#include "problem/case/case.hpp"

#include <functional>
#include <vector>

namespace shearwake::spectral {

struct RigidPlan;

/// The displacement of a rigid body: of its centre, and a small rotation about it.
struct RigidMotion {
    Vec3 shift_m, turn;

    /// Displacement at an offset from the centre.
    Vec3 at(Vec3 r) const {
        return shift_m + Vec3{turn.y * r.z - turn.z * r.y, turn.z * r.x - turn.x * r.z,
                              turn.x * r.y - turn.y * r.x};
    }
};

/// Rigid bodies as a constraint on a step: forces F at markers on their surfaces and inside make
/// the markers move rigidly,
///     J u+ = R q+,   B d = rhs + J' F,   M (q+ - 2 q + q-)/dt^2 = -R' F,
/// with the displacement J u at the markers, the degrees of freedom q of all bodies, their motion R
/// at the markers and their mass M in excess of the background in their place. With G = J B^-1 J'
/// and the displacement v of the markers without the forces of this step,
///     G F = (R q+ - v)/scale,   (M/dt^2 + R' G^-1 R) a = R' G^-1 (v - R (2 q - q-))/scale,
/// q+ = 2 q - q- + scale a. The forces do no work, so the energy of the scheme, which then includes
/// that of M, changes as without bodies. v is that of the next displacement and not of its change;
/// rounding errors of the constraint are therefore corrected in the next step.
///
/// A step calls clear(); evaluate() for the pencils of a row and end_row(); advance() or respond();
/// and then begin_forces() for a row and add_force() for its pencils.
class RigidBodies {
public:
    /// B^-1 of a pencil.
    using Solve = std::function<void(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil)>;

    virtual ~RigidBodies() = default;
    RigidBodies(const RigidBodies&) = delete;
    RigidBodies& operator=(const RigidBodies&) = delete;

    bool empty() const { return bodies_.empty(); }
    /// Computes the systems with B, or with another operator for another state of the factors.
    /// Throws CaseFailure on all ranks together if a system is not positive definite. Collective.
    virtual void assemble(const VerticalOperator& op, const Solve& solve) = 0;

    // Not collective.
    virtual void clear() = 0;
    virtual void evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil) = 0;
    virtual void end_row(std::ptrdiff_t row) = 0;
    virtual void begin_forces(std::ptrdiff_t row) = 0;
    virtual void add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) = 0;
    /// What this rank has allocated, under its name in SpectralPlan::resources().
    virtual engines::Allocation array() const = 0;
    /// The displacements of all bodies, for output.
    virtual std::vector<RigidMotion> motions() const = 0;

    /// Determines the forces that correct the evaluated next displacement, and advances the bodies.
    /// Collective.
    void advance(double scale);
    /// Determines the forces and the acceleration with which the bodies respond to the evaluated
    /// change of the displacement. Collective.
    void respond();
    /// Adds `scale` times the acceleration to the next position, or to the current position and its
    /// negative to the previous one. Not collective.
    void add_to_next(double scale);
    void add_impulse();
    /// The next position becomes the current one. Not collective.
    void end_step() { now_.swap(before_); }

    /// Twice the energy per area of the mass in excess of the background [J/m^2]. Not collective.
    double twice_kinetic_J_m2() const;
    /// The degrees of freedom of all bodies, [body][freedom].
    const std::vector<double>& position() const { return now_; }

    /// Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

protected:
    RigidBodies(const RigidPlan& plan, std::size_t freedoms, double step_s, const Comm& team);

    const std::vector<Body>& bodies() const { return bodies_; }
    const Medium& medium() const { return medium_; }
    const Comm& team() const { return team_; }
    std::size_t free_count() const { return free_.size(); }
    /// Keeps some degrees of freedom of a body at zero; before set_mass().
    void constrain(std::size_t body, const std::vector<std::size_t>& freedoms);
    /// The degrees of freedom with a unit of the free one with this index.
    std::vector<double> unit(std::size_t free) const;
    /// Takes the mass of each body, [row][column] of its degrees of freedom, and the factor that
    /// turns it into mass per area of the domain.
    void set_mass(const std::vector<std::vector<double>>& masses, double per_area);
    /// Prepares move(): R and G^-1 R of the free degrees of freedom, [freedom][row]. Throws
    /// CaseFailure if the bodies are too light.
    void prepare(const std::vector<double>& motion, std::vector<double> forces);
    /// For the lack of displacement of the markers (R target - v)/scale and the forces G^-1 of it:
    /// determines the acceleration, and adds G^-1 R times the acceleration to the forces.
    void move(const double* lack, double* forces);
    /// The acceleration of all ranks is that of the root. Collective.
    void share_acceleration() { team_.broadcast(acceleration_); }
    /// Replaces the displacements of the markers by the forces that move them to `target`.
    /// Collective.
    virtual void solve(const std::vector<double>& target, double scale) = 0;

private:
    DistributedRows state_rows() const;

    std::vector<Body> bodies_;
    Medium medium_;
    Comm team_;
    double step_s_, per_area_ = 0.0;
    std::size_t freedoms_; // of one body
    std::vector<double> now_, before_, acceleration_;
    std::vector<std::size_t> free_; // degrees of freedom that are not fixed
    std::vector<double> mass_;      // of the free ones, [row][column]
    /// With K = M/dt^2 + R' G^-1 R: G^-1 R and K^-1 of the free degrees of freedom.
    std::vector<double> per_freedom_, mobility_;
};

} // namespace shearwake::spectral
