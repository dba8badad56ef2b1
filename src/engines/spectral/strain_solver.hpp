#pragma once

#include "engines/spectral/lateral_field.hpp"
#include "engines/spectral/step_clock.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// Conjugate gradients for the strain e of a step where the medium varies laterally:
///     (1 + G S) e = b,   G = E B^-1 E^T,
/// self-adjoint in the product (a, S b); S is the stiffness beyond the background's, B. From zero:
/// an extrapolated guess was tried, and what it carries of the last steps' residuals cost more
/// iterations than it saved.
class StrainSolver {
public:
    using Values = LateralField::Values;

    /// G applied to a stress, written to `strain` with the sign that forces have: minus.
    /// Collective.
    using Response = std::function<void(const Values& stress, Values& strain)>;

    /// `rows`: all rows of x.
    StrainSolver(const LateralField& field, std::ptrdiff_t rows, const Comm& team,
                 StepClock& clock);

    struct Outcome {
        int iterations = 0;
        bool converged = false; // not where a value is not a number
    };
    /// `residual` is b and becomes b - G S e, what is left; `reference` the square of what
    /// moves, of which sqrt((r, S r)) shall be less than `tolerance`. The error of the displacement
    /// in the energy norm of the operator is at most the residual's in that of S. A mode too weak
    /// to be noticed may grow until it is: so the sums, and with them all results, have the same
    /// bits on any number of ranks. Collective.
    Outcome solve(Values& residual, double reference, double tolerance, const Response& respond);

    const Values& strain() const { return strain_; } // e
    /// S e.
    const Values& stress();
    double memory_B() const { return static_cast<double>(4 * strain_.size() * sizeof(double)); }

private:
    double curvature();
    double sum_over_team();
    double bytes(double times) const { return times * 0.25 * memory_B(); }
    double step_along(double alpha, Values& residual);
    void turn(double beta, const Values& residual);

    const LateralField& field_;
    Comm team_;
    StepClock& clock_;
    RowSums sums_;
    Values strain_, direction_, stress_, image_; // stress: S direction
};

} // namespace shearwake
