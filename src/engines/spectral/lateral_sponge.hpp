#pragma once

#include "engines/spectral/moving_load.hpp"
#include "engines/spectral/vertical_operator.hpp"
#include "fft/run_transform.hpp"

#include <optional>
#include <vector>

namespace shearwake {

/// The absorbing margin of the domain: every few steps the velocity there loses the share
/// b = 1 - e^{-gamma T} of itself, gamma of model/edge_absorption, T the time between. In nearly
/// incompressible tissue b v has divergence, which no scheme whose step knows nothing of c_p could
/// carry off; so the loss is an impulse, -M b v, that the implicit operator answers to.
///
/// One time costs as much as 1.7 steps (transforms 27 ms and solves 7 ms beside steps of 20 ms, 256
/// x 192 x 33, uniform, one rank; 2.4 on a busy machine) and comes every FWHM/c, 24 steps of 25 us
/// for 3 mm, 5 m/s and 1 Pa s: 7 to 10 % of them. Of longer steps it is more, and where viscosity
/// is too small to help it comes more often: every 12, 14 %.
class LateralSponge {
public:
    LateralSponge(const Case& c, const WaveVectors& vectors, const SlabTransform& slabs,
                  double step_s, const Comm& team);

    /// Whether velocity is taken before step n. It depends on n alone, so that a run that goes on
    /// from a state does the same.
    bool acts_at(std::ptrdiff_t n) const { return every_ > 0 && n > 0 && n % every_ == 0; }
    /// Steps from one time to the next; 0 without a sponge.
    std::ptrdiff_t every() const { return every_; }

    /// Its planes, of all levels; none without a sponge.
    void assemble(std::ptrdiff_t levels);
    /// Puts b (now - before) into them, pencils of this rank. Collective.
    void take_velocity(const VerticalOperator& op, const AlignedVector<double>& now,
                       const AlignedVector<double>& before);
    /// Then, row by row of ky: the impulse for half of the loss, -M/(2 dt^2) b (now - before).
    void begin_row(std::ptrdiff_t row);
    void impulse(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block,
                 Lanes* pencil);
    double memory_B() const {
        return static_cast<double>((planes_.size() + values_.size()) * sizeof(double));
    }

private:
    void put(const VerticalOperator& op, std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* now,
             const Lanes* before);
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_.line_pitch(); }

    const SlabTransform& slabs_;
    WaveVectors vectors_;
    Domain domain_;
    double step_s_;
    std::ptrdiff_t every_ = 0, count_ = 0;
    std::vector<double> kept_x_, kept_y_; // share of the velocity: b = 1 - kept_x kept_y
    AlignedVector<double> planes_;        // [level][component], lines of ky over x
    std::vector<double> values_;          // of one plane
    std::optional<RunTransform> runs_;    // all of this rank's rows
};

} // namespace shearwake
