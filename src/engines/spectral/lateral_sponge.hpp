#pragma once

#include "engines/spectral/moving_load.hpp"
#include "engines/spectral/vertical_operator.hpp"
#include "fft/run_transform.hpp"

#include <optional>
#include <vector>

namespace shearwake {

/// When the sponge acts, in steps, 0 without one, and the points of the planes that it acts on.
struct SpongePlan {
    std::ptrdiff_t every = 0, nx = 0, ny = 0;
};

/// `uniform`: nothing varies laterally.
SpongePlan sponge_plan(const Case& c, bool uniform, double step_s);

/// The absorbing margin of the domain: every few steps the velocity there loses the share
/// b = 1 - e^{-gamma T} of itself, gamma of model/edge_absorption, T the time between. In nearly
/// incompressible tissue b v has divergence, which no scheme whose step knows nothing of c_p could
/// carry off; so the loss is an impulse, -M b v, that the implicit operator answers to.
///
/// Over a laterally uniform medium the wave vectors of the load are all that there are, and above
/// those at which the footprint's spectrum has fallen to 3 % lies 1e-3 of the energy: there the
/// sponge takes from the lower ones alone, on planes of as few points as they need (the energy that
/// comes back of a pulse is the same to a hundredth).
class LateralSponge {
public:
    /// Its own transforms are planned as those of the case. Collective.
    LateralSponge(const Case& c, const WaveVectors& vectors, const SlabTransform& slabs,
                  bool uniform, double step_s, const Comm& team);

    /// Whether velocity is taken before step n. It depends on n alone, so that a run that goes on
    /// from a state does the same.
    bool acts_at(std::ptrdiff_t n) const { return every_ > 0 && n > 0 && n % every_ == 0; }
    /// Steps from one time to the next; 0 without a sponge.
    std::ptrdiff_t every() const { return every_; }

    /// Its planes, of all levels; none without a sponge.
    void assemble(std::ptrdiff_t levels);
    /// Puts b (now - before) into them, pencils of this rank, `blocks` to a row. Collective.
    void take_velocity(const VerticalOperator& op, std::ptrdiff_t blocks,
                       const AlignedVector<double>& now, const AlignedVector<double>& before);
    /// Then, row by row of ky: the impulse for half of the loss, -M/(2 dt^2) b (now - before), at
    /// the blocks that it acts on.
    bool acts_on(std::ptrdiff_t row, std::ptrdiff_t block) const {
        return row < vectors_.rows() && block < vectors_.blocks() && !vectors_.is_nyquist(row);
    }
    void begin_row(std::ptrdiff_t row);
    void impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                 Lanes* pencil);
    double memory_B() const {
        return static_cast<double>((planes_.size() + values_.size()) * sizeof(double));
    }

private:
    void put(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* now,
             const Lanes* before);
    void lose(std::ptrdiff_t planes);
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_->line_pitch(); }

    WaveVectors vectors_; // that it acts on
    double step_s_;
    std::optional<SlabTransform> slabs_;
    std::ptrdiff_t every_ = 0, count_ = 0;
    std::vector<double> kept_x_, kept_y_; // share of the velocity: b = 1 - kept_x kept_y
    AlignedVector<double> planes_;        // [level][component], lines of ky over x
    std::vector<double> values_;          // of a few planes
    std::optional<RunTransform> runs_;    // all of this rank's rows
};

} // namespace shearwake
