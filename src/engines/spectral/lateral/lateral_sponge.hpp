// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "fft/run_transform.hpp"

#include <optional>
#include <vector>

namespace shearwake::spectral {

/// Interval of the sponge in steps (0: no sponge) and the number of points of its planes.
struct SpongePlan {
    std::ptrdiff_t every = 0, nx = 0, ny = 0;
};

/// Whether the medium varies laterally.
enum class Lateral { uniform, varies };
/// The interval and the planes of the sponge of a case. Not collective.
SpongePlan sponge_plan(const Case& c, Lateral medium, double step_s);

/// Absorbing margin of the domain. Every few steps the velocity in the margin is reduced by its
/// share b = 1 - e^{-gamma T}, with gamma of case/edge_absorption and the interval T. In nearly
/// incompressible tissue b v has a divergence, which a scheme whose step is independent of c_p
/// cannot propagate away. The loss is therefore applied as an impulse, -M b v, to which the
/// implicit operator responds.
///
/// In a laterally uniform medium only the wave vectors of the load occur. Those above which the
/// spectrum of the footprint is below 3 % contain 1e-3 of the energy. The sponge then acts on the
/// lower wave vectors alone, on planes with only as many points as these need. The returned energy
/// of a pulse changes by less than 1 %.
class LateralSponge {
public:
    /// Plans its own transforms in the same way as those of the case. Collective.
    LateralSponge(const Case& c, const WaveVectors& vectors, const fft::SlabTransform& slabs,
                  Lateral medium, double step_s, const Comm& team);

    /// Whether velocity is removed before step n. This depends on n alone, so that a resumed run
    /// does the same.
    bool acts_at(std::ptrdiff_t n) const { return every_ > 0 && n > 0 && n % every_ == 0; }
    /// Number of steps between applications; 0 without a sponge.
    std::ptrdiff_t every() const { return every_; }

    /// Allocates the planes of all levels; nothing without a sponge.
    void assemble(std::ptrdiff_t levels);
    /// Computes b (now - before) for the pencils of this rank, `blocks` per row, and stores it in
    /// the planes. Collective.
    void take_velocity(const VerticalOperator& op, std::ptrdiff_t blocks,
                       const fft::AlignedVector<Block>& now,
                       const fft::AlignedVector<Block>& before);
    /// To be called afterwards for each row of ky: the impulse for half of the loss, -M/(2 dt^2) b
    /// (now - before), for the blocks on which the sponge acts. Not collective.
    bool acts_on(std::ptrdiff_t row, std::ptrdiff_t block) const {
        return row < vectors_.rows() && block < vectors_.blocks() && !vectors_.is_nyquist(row);
    }
    void begin_row(std::ptrdiff_t row);
    void impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                 Block* pencil);

private:
    void lose(std::ptrdiff_t planes);
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_->line_pitch(); }

    const SpongeKernels& kernels_;
    WaveVectors vectors_; // on which the sponge acts
    double step_s_;
    std::optional<fft::SlabTransform> slabs_;
    std::ptrdiff_t every_ = 0, count_ = 0;
    std::vector<double> kept_x_, kept_y_; // remaining share of the velocity: b = 1 - kept_x kept_y
    fft::AlignedVector<double> planes_;   // [level][component], lines of ky over x
    std::vector<double> values_;          // of a few planes
    std::vector<double> impulses_;        // factor of b (now - before) for each level
    std::optional<fft::RunTransform> runs_; // all of this rank's rows
};

} // namespace shearwake::spectral
