// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/lateral/lateral_field.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake::spectral {

/// Iterations with the full response before the rounded one takes over, which needs one more full
/// response in the end. That takes as long as some four rounded ones save.
constexpr int full_iterations = 8;

/// Conjugate gradients for the strain e of a step where the medium varies laterally:
///     (1 + G S) e = b,   G = E B^-1 E^T,
/// self-adjoint in the product (a, S b), where S is the stiffness in addition to that of the
/// background B. The iteration starts from zero. An extrapolated initial guess was tried; it
/// contains residuals of previous steps, which cost more iterations than the guess saved.
class StrainSolver {
public:
    using Values = LateralField::Values;

    /// Applies G to a stress. The result in `strain` has the sign of a force (minus). Collective.
    using Response = std::function<void(const Values& stress, Values& strain)>;
    /// G, and optionally a faster rounded one, which must be symmetric as well.
    struct Responses {
        Response full, rounded;
    };

    /// `rows` is the total number of rows of x.
    StrainSolver(const LateralField& field, std::ptrdiff_t rows, const Comm& team);

    struct Outcome {
        int iterations = 0;
        bool converged = false; // false if a value is not a number
    };
    /// On entry `residual` is b, on return the final residual b - G S e. The iteration ends when
    /// sqrt((r, S r)) is below `tolerance` times the square root of `reference`, which measures the
    /// motion. The error of the displacement in the energy norm of the operator is at most the
    /// residual's error in that of S. A mode that is too weak to affect the residual may grow until
    /// it does; therefore the sums are independent of the number of ranks, and all results have the
    /// same bits on any number of ranks.
    /// After some iterations with the full response the rounded one takes over. The residual is
    /// then recomputed with the full response, so that e and the residual are consistent up to
    /// rounding errors of double precision. Collective.
    Outcome solve(Values& residual, double reference, double tolerance, const Responses& respond);

    /// Numbers of all arrays.
    std::size_t values() const {
        return given_.size() + strain_.size() + direction_.size() + stress_.size() + image_.size();
    }
    const Values& strain() const { return strain_; } // e
    /// S e.
    const Values& stress();

private:
    double curvature();
    double sum_over_team();
    /// Sets the direction to the residual and returns the norm of the latter.
    double restart(const Values& residual);
    /// Computes the residual b - (1 + G S) e from b.
    void refresh(Values& residual, const Response& respond);
    double step_along(double alpha, Values& residual);
    void turn(double beta, const Values& residual);

    const StrainKernels& kernels_;
    const LateralField& field_;
    Comm team_;
    RowSums sums_;
    Values given_;                               // b
    Values strain_, direction_, stress_, image_; // stress_ is S direction
};

} // namespace shearwake::spectral
