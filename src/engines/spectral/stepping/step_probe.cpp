// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/step_probe.hpp"

#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
namespace {

/// kx up to where the spectrum of the footprint is 1e-2; ky = 0 and half of that.
constexpr std::ptrdiff_t probed_columns = 2 * lane_count, probed_rows = 2;
/// Longest part of a run that is advanced, in output intervals. Longer runs are extrapolated, so
/// that the effort does not grow with the number of frames.
constexpr double most_intervals = 2500.0;

Case with_few_wave_vectors(Case c, std::ptrdiff_t rows) {
    c.domain = {probed_columns, 2 * rows,
                std::numbers::pi / bandwidth_rad_m(c.scene().load.footprint, 1e-2), 0.0};
    return c;
}

/// The layers under a load at the first block of wave vectors of each row.
class Probe {
public:
    Probe(const Case& c, const VerticalOperator& vertical, const WaveVectors& vectors,
          double step_s)
        : kernels_(simd::kernels<PencilKernels>()), vertical_(vertical), vectors_(vectors),
          load_(c, vectors, step_s), step_s_(step_s) {
        factors_.resize(static_cast<std::size_t>(vectors.rows() * vertical.factor_size()));
        now_.assign(static_cast<std::size_t>(vectors.rows() * size()), Block{});
        before_ = now_;
        force_.resize(static_cast<std::size_t>(size()));
        for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row)
            vertical.factorise_implicit(vectors.waves(row, 0).k, step_s,
                                        factors_.data() + row * vertical.factor_size());
    }

    void advance() {
        const double scale = step_ == 0 ? 0.5 : 1.0; // starts from rest
        load_.sample(step_);
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
            const Block* u = now_.data() + row * size();
            Block *before = before_.data() + row * size(), *force = force_.data();
            std::fill(force_.begin(), force_.end(), Block{});
            load_.put(row, 0, force + parts); // unknown 1: W at the surface
            vertical_.add_internal_force(vectors_.waves(row, 0).k, 1.0 / step_s_, u, before, force);
            vertical_.solve_implicit(factors_.data() + row * vertical_.factor_size(), force);
            kernels_.advance(size(), scale, u, force, before);
        }
        std::swap(now_, before_);
        ++step_;
    }

    /// The four parts of W at the surface.
    const Block* surface(std::ptrdiff_t row) const { return now_.data() + row * size() + parts; }

private:
    std::ptrdiff_t size() const { return vertical_.unknowns() * parts; }

    const PencilKernels& kernels_;
    const VerticalOperator& vertical_;
    const WaveVectors& vectors_;
    MovingLoad load_;
    double step_s_;
    std::ptrdiff_t step_ = 0;
    fft::AlignedVector<Block> factors_, now_, before_, force_;
};

/// Sums over steps and wave vectors.
struct Deviation {
    double difference = 0.0, all = 0.0;

    /// Relative L2 error; 0 without a field, NaN if it is not finite.
    double relative() const { return all == 0.0 ? 0.0 : 4.0 / 3.0 * std::sqrt(difference / all); }
};

/// The error after `ratio` times the duration of `whole`, of which `half` is the first half. It
/// remains constant where losses end the memory of the field, and grows at most in proportion to
/// the time, as the phase error of a wave without losses.
double extrapolated(const Deviation& half, const Deviation& whole, double ratio) {
    if (ratio <= 1.0 || !(half.relative() > 0.0)) return whole.relative();
    const double power = std::clamp(std::log2(whole.relative() / half.relative()), 0.0, 1.0);
    return whole.relative() * std::pow(ratio, power);
}

} // namespace

double probed_error(const Case& c, const DepthMesh& mesh, double step_s) {
    const Case few = with_few_wave_vectors(c, probed_rows);
    fft::SlabShare share;
    share.ky_count = probed_rows; // without the Nyquist mode
    const WaveVectors vectors(few.domain, share);
    const VerticalOperator vertical(mesh, background_of(mesh, c.scene().medium));
    Probe whole(few, vertical, vectors, step_s), half(few, vertical, vectors, 0.5 * step_s);
    const PencilKernels& kernels = simd::kernels<PencilKernels>();
    const double probed_s = std::min(c.time.duration_s(), most_intervals * c.time.interval_s);
    const long steps = std::lround(probed_s / step_s);
    Deviation sums, half_sums;
    for (long n = 0; n < steps; ++n) {
        whole.advance();
        half.advance();
        half.advance();
        for (std::ptrdiff_t row = 0; row < probed_rows; ++row) {
            Counted counted = vectors.counted(row, 0);
            // The mean over the surface is pure compression, which no step resolves and which
            // hardly contributes to a complete field.
            if (row == 0)
                for (Block& part : counted.part)
                    part[0] = 0.0;
            Block apart[parts];
            kernels.difference(parts, 1.0, whole.surface(row), half.surface(row), apart);
            sums.difference += sum_of(kernels.product(parts, apart, apart, counted.part));
            sums.all +=
                sum_of(kernels.product(parts, half.surface(row), half.surface(row), counted.part));
        }
        if (n + 1 == steps / 2) half_sums = sums;
    }
    return extrapolated(half_sums, sums, c.time.duration_s() / probed_s);
}

namespace {

/// The part of the cell of a sample of |kx| or |ky| that lies above a limit.
double share_above(double limit_rad_m, double sample_rad_m, double spacing_rad_m) {
    const double from = std::max(sample_rad_m - 0.5 * spacing_rad_m, 0.0);
    const double to = sample_rad_m + 0.5 * spacing_rad_m;
    return std::clamp((to - limit_rad_m) / (to - from), 0.0, 1.0);
}

} // namespace

double probed_return(const Case& c, const SpectralOptions& options, double step_s) {
    const double coarse_s = 2.0 * step_s; // suffices for a difference of two absorbers
    // Where the absorber returns the most: the lowest wave vectors of the domain, exactly.
    constexpr std::ptrdiff_t low_rows = 4, high_rows = 4;
    fft::SlabShare low_share, high_share;
    low_share.ky_count = std::min(low_rows, (c.domain.ny + 1) / 2);
    high_share.ky_count = high_rows;
    const WaveVectors low = WaveVectors(c.domain, low_share)
                                .coarser(std::min(probed_columns, c.domain.nx), c.domain.ny);
    // Samples of the spectrum of the footprint, for the size of the complete field.
    const Case few = with_few_wave_vectors(c, high_rows);
    const WaveVectors high(few.domain, high_share);

    const DepthMesh mesh = choose_mesh(c, options, step_s);
    SpectralOptions deeper = options;
    deeper.absorbing_depth_m = 2.0 * mesh.bottom->depth_m;
    const DepthMesh deeper_mesh = choose_mesh(c, deeper, step_s);
    const VerticalOperator vertical(mesh, background_of(mesh, c.scene().medium));
    const VerticalOperator reference(deeper_mesh, background_of(deeper_mesh, c.scene().medium));
    Probe here(c, vertical, low, coarse_s), deep(c, reference, low, coarse_s);
    Probe all(few, vertical, high, coarse_s);

    const PencilKernels& kernels = simd::kernels<PencilKernels>();
    const double low_kx = low.kx_rad_m(low.nx() / 2) - 0.5 * low.kx_rad_m(1);
    const double low_ky = low.ky_rad_m(low.rows()) - 0.5 * low.ky_rad_m(1);
    const double per_sample = few.domain.extent_x_m() * few.domain.extent_y_m() /
                              (c.domain.extent_x_m() * c.domain.extent_y_m());
    const auto square = [&](const Block* w, const Counted& counted) {
        return sum_of(kernels.product(parts, w, w, counted.part));
    };
    Deviation sums;
    const double probed_s = std::min(c.time.duration_s(), most_intervals * c.time.interval_s);
    for (long n = std::lround(probed_s / coarse_s); n > 0; --n) {
        for (Probe* probe : {&here, &deep, &all})
            probe->advance();
        for (std::ptrdiff_t row = 0; row < low.rows(); ++row) {
            Block apart[parts];
            kernels.difference(parts, 1.0, here.surface(row), deep.surface(row), apart);
            sums.difference += square(apart, low.counted(row, 0));
            sums.all += square(here.surface(row), low.counted(row, 0));
        }
        for (std::ptrdiff_t row = 0; row < high_rows; ++row) {
            Counted counted = high.counted(row, 0);
            const double below_y = 1.0 - share_above(low_ky, high.ky_rad_m(row), high.ky_rad_m(1));
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                const double below_x =
                    1.0 - share_above(low_kx, high.kx_rad_m(lane), high.kx_rad_m(1));
                const bool is_mean = row == 0 && lane == 0;
                for (Block& part : counted.part)
                    part[lane] *= is_mean ? 0.0 : per_sample * (1.0 - below_x * below_y);
            }
            sums.all += square(all.surface(row), counted);
        }
    }
    return sums.all > 0.0 ? std::sqrt(sums.difference / sums.all) : 0.0;
}

} // namespace shearwake::spectral
