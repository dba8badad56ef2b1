// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/time_step.hpp"

#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "problem/load/load.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

namespace shearwake::spectral {
namespace {

/// kx up to where the spectrum of the footprint is 1e-2; ky = 0 and half of that.
constexpr std::ptrdiff_t probed_columns = 2 * lane_count, probed_rows = 2;
/// Longest part of a run that is advanced, in output intervals. Longer runs are extrapolated, so
/// that the effort does not grow with the number of frames.
constexpr double most_intervals = 2500.0;
/// Largest number of steps times elements for an error of the step alone: about 2 s.
constexpr double most_work = 1e5;

Case with_few_wave_vectors(Case c, std::ptrdiff_t rows) {
    c.domain = {probed_columns, 2 * rows,
                std::numbers::pi / bandwidth_rad_m(c.scene.load.footprint, 1e-2), 0.0};
    return c;
}

/// The layers under a load at the first block of wave vectors of each row.
class Probe {
public:
    Probe(const Case& c, const VerticalOperator& vertical, const WaveVectors& vectors,
          double step_s)
        : kernels_(simd::kernels<PencilKernels>()), vertical_(vertical), vectors_(vectors),
          load_(c, vectors, step_s, unsteered_pattern(c.scene.load)), step_s_(step_s) {
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

/// The error after `ratio` times the duration of `full`, of which `half` is the first half. It
/// remains constant where losses end the memory of the field, and grows at most in proportion to
/// the time, as the phase error of a wave without losses.
double extrapolated(const Deviation& half, const Deviation& full, double ratio) {
    if (ratio <= 1.0 + 1e-9 || !(half.relative() > 0.0)) return full.relative();
    const double power = std::clamp(std::log2(full.relative() / half.relative()), 0.0, 1.0);
    return full.relative() * std::pow(ratio, power);
}

/// The part of the cell of a sample of |kx| or |ky| that lies above a limit.
double share_above(double limit_rad_m, double sample_rad_m, double spacing_rad_m) {
    const double from = std::max(sample_rad_m - 0.5 * spacing_rad_m, 0.0);
    const double to = sample_rad_m + 0.5 * spacing_rad_m;
    return std::clamp((to - limit_rad_m) / (to - from), 0.0, 1.0);
}

/// Elements of half the length above the absorber.
DepthMesh with_halved_elements(const DepthMesh& mesh) {
    DepthMesh finer = mesh;
    finer.ends_m = {0.0};
    finer.layers.clear();
    finer.light.clear();
    const auto add = [&](std::size_t e, double end_m) {
        finer.ends_m.push_back(end_m);
        finer.layers.push_back(mesh.layers[e]);
        if (!mesh.light.empty()) finer.light.push_back(mesh.light[e]);
    };
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double middle_m = 0.5 * (mesh.ends_m[e] + mesh.ends_m[e + 1]);
        if (middle_m < mesh.clear_depth_m()) add(e, middle_m);
        add(e, mesh.ends_m[e + 1]);
    }
    return finer;
}

/// An absorber of twice the depth, with elements that are not longer.
DepthMesh with_deeper_absorber(const Case& c, SpectralOptions options, const DepthMesh& mesh,
                               double step_s) {
    double longest_m = 0.0;
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        longest_m = std::max(longest_m, mesh.length_m(e));
    options.absorbing_depth_m = 2.0 * mesh.bottom->depth_m;
    options.longest_element_m = longest_m;
    return choose_mesh(c, options, step_s);
}

/// The lowest wave vectors of a domain.
WaveVectors low_vectors(const Domain& domain) {
    constexpr std::ptrdiff_t rows = 4;
    fft::SlabShare share;
    share.ky_count = std::min(rows, (domain.ny + 1) / 2);
    return WaveVectors(domain, share).coarser(std::min(probed_columns, domain.nx), domain.ny);
}

WaveVectors few_vectors(const Domain& domain) {
    fft::SlabShare share;
    share.ky_count = probed_rows; // without the Nyquist mode
    return {domain, share};
}

using Counts = std::vector<Counted>;

Counts counts_of(const WaveVectors& vectors) {
    Counts all;
    for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row)
        all.push_back(vectors.counted(row, 0));
    return all;
}

/// Without the mean over the surface, which is pure compression, which no step resolves, and of
/// which each sample of the few would represent too much.
Counts without_mean(Counts all) {
    for (Block& part : all[0].part)
        part[0] = 0.0;
    return all;
}

/// Without the cells of the lowest wave vectors.
Counts without_low(Counts all, const WaveVectors& low, const WaveVectors& few) {
    const double low_kx = low.kx_rad_m(low.nx() / 2) - 0.5 * low.kx_rad_m(1);
    const double low_ky = low.ky_rad_m(low.rows()) - 0.5 * low.ky_rad_m(1);
    for (std::ptrdiff_t row = 0; row < few.rows(); ++row)
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
            const double below = (1.0 - share_above(low_ky, few.ky_rad_m(row), few.ky_rad_m(1))) *
                                 (1.0 - share_above(low_kx, few.kx_rad_m(lane), few.kx_rad_m(1)));
            for (Block& part : all[static_cast<std::size_t>(row)].part)
                part[lane] *= 1.0 - below;
        }
    return all;
}

/// Points on both axes through the focus, at which a field is evaluated.
std::vector<Vec2> points_near(Vec2 focus, double apart_m) {
    std::vector<Vec2> points = {focus};
    for (const int i : {-4, -3, -2, -1, 1, 2, 3, 4}) {
        points.push_back(focus + Vec2{i * apart_m, 0.0});
        points.push_back(focus + Vec2{0.0, i * apart_m});
    }
    return points;
}

/// The wave vectors of a probe, how often each counts, and the origin of their phases.
struct Waves {
    const WaveVectors& vectors;
    Vec2 origin_m;
    Counts counts;
};

/// The mean square over the surface, and the largest magnitude at some points.
struct Size {
    double square = 0.0, most = 0.0;
};

/// Of the difference of two fields, or of one field.
Size size_of(const Probe& a, const Probe* b, const Waves& waves, const std::vector<Vec2>& points) {
    using Complex = std::complex<double>;
    Size size;
    std::vector<double> at_points(points.size());
    for (std::ptrdiff_t row = 0; row < std::ssize(waves.counts); ++row) {
        const Counted& counted = waves.counts[static_cast<std::size_t>(row)];
        const Block *x = a.surface(row), *y = b ? b->surface(row) : nullptr;
        for (const auto& [re, im] : {std::pair(plus_re, plus_im), std::pair(minus_re, minus_im)})
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                const Complex w(x[re][lane] - (y ? y[re][lane] : 0.0),
                                x[im][lane] - (y ? y[im][lane] : 0.0));
                const double times = counted.part[re][lane];
                size.square += times * std::norm(w);
                const double kx = (re == plus_re ? 1.0 : -1.0) * waves.vectors.kx_rad_m(lane),
                             ky = waves.vectors.ky_rad_m(row);
                for (std::size_t p = 0; p < points.size(); ++p) {
                    const Vec2 from = points[p] - waves.origin_m;
                    at_points[p] += times * (w * std::polar(1.0, kx * from.x + ky * from.y)).real();
                }
            }
    }
    for (const double value : at_points)
        size.most = std::max(size.most, std::abs(value));
    return size;
}

/// Sums over the times of a field, and maxima.
struct Series {
    double square = 0.0, most = 0.0;
    std::ptrdiff_t count = 0;
    void add(const Size& now) {
        square += now.square;
        most = std::max(most, now.most);
        ++count;
    }
    double mean_square() const { return count == 0 ? 0.0 : square / static_cast<double>(count); }
};

} // namespace

long steps_to_probe(const Case& c, double step_s) {
    return std::lround(std::min(c.time.duration_s(), most_intervals * c.time.interval_s) / step_s);
}

double probed_error(const Case& c, const DepthMesh& mesh, double step_s,
                    engines::ChoiceLimit limit) {
    const Case few = with_few_wave_vectors(c, probed_rows);
    const WaveVectors vectors = few_vectors(few.domain);
    const VerticalOperator vertical(mesh, background_of(mesh, c.scene.medium));
    Probe full(few, vertical, vectors, step_s), half(few, vertical, vectors, 0.5 * step_s);
    const Waves waves{vectors, {}, without_mean(counts_of(vectors))};
    const long all = steps_to_probe(c, step_s);
    long steps = std::min(all, std::lround(most_work / static_cast<double>(mesh.elements())));
    Deviation sums, half_sums;
    for (long n = 0; n < steps; ++n) {
        limit.check();
        full.advance();
        half.advance();
        half.advance();
        sums.difference += size_of(full, &half, waves, {}).square;
        sums.all += size_of(half, nullptr, waves, {}).square;
        if (n + 1 == steps / 2) half_sums = sums;
        if (n + 1 == steps && half_sums.all == 0.0) steps = all; // the load begins later
    }
    return extrapolated(half_sums, sums,
                        c.time.duration_s() / (static_cast<double>(steps) * step_s));
}

ProbedErrors probed_errors(const Case& c, const SpectralOptions& options, double step_s) {
    const DepthMesh mesh = choose_mesh(c, options, step_s), finer_mesh = with_halved_elements(mesh),
                    deeper_mesh =
                        mesh.bottom ? with_deeper_absorber(c, options, mesh, step_s) : mesh;
    const Medium& medium = c.scene.medium;
    const VerticalOperator vertical(mesh, background_of(mesh, medium)),
        finer(finer_mesh, background_of(finer_mesh, medium)),
        deeper(deeper_mesh, background_of(deeper_mesh, medium));
    // The error of the step and of the elements at samples of the spectrum of the footprint, that
    // of the absorber where it returns the most.
    const Case sampled = with_few_wave_vectors(c, probed_rows);
    const WaveVectors few = few_vectors(sampled.domain), low = low_vectors(c.domain);
    const double coarse_s = 2.0 * step_s; // suffices for a difference of two absorbers
    Probe full(sampled, vertical, few, step_s), half(sampled, finer, few, 0.5 * step_s);
    Probe here(c, vertical, low, coarse_s), deep(c, deeper, low, coarse_s);
    const auto origin_m = [](const Domain& d) { return Vec2{d.x_m(0), d.y_m(0)}; };
    const Waves each{few, origin_m(sampled.domain), without_mean(counts_of(few))},
        above{few, each.origin_m, without_low(each.counts, low, few)},
        lowest{low, origin_m(c.domain), counts_of(low)};

    const std::ptrdiff_t steps = steps_to_probe(c, step_s),
                         per_frame = std::lround(c.time.interval_s / step_s);
    const double apart_m = 0.5 * fwhm_m(c.scene.load.footprint);
    Series by_step, by_absorber, high_field, low_field;
    Deviation half_way;
    for (std::ptrdiff_t n = 1; n <= steps; ++n) {
        full.advance();
        half.advance();
        half.advance();
        std::vector<Vec2> points; // for maxima, at a frame or the step after it
        if (n % per_frame < 2)
            points = points_near(focus_m(c.scene.load, static_cast<double>(n) * step_s), apart_m);
        if (n % per_frame == 0) { // what lies between two frames is not part of the field
            by_step.add(size_of(full, &half, each, points));
            high_field.add(size_of(half, nullptr, above, points));
        }
        if (n == steps / 2) half_way = {by_step.square, high_field.square};
        if (n % 2 == 0) {
            here.advance();
            low_field.add(size_of(here, nullptr, lowest, points));
            if (!mesh.bottom) continue;
            deep.advance();
            by_absorber.add(size_of(here, &deep, lowest, points));
        }
    }
    const Deviation all{by_step.square, high_field.square};
    const double later = extrapolated(half_way, all,
                                      c.time.duration_s() / (static_cast<double>(steps) * step_s)) /
                         std::sqrt(all.difference / all.all); // contains the 4/3
    const double per_sample = sampled.domain.extent_x_m() * sampled.domain.extent_y_m() /
                              (c.domain.extent_x_m() * c.domain.extent_y_m());
    const double field = per_sample * high_field.mean_square() + low_field.mean_square();
    if (all.difference == 0.0 || field == 0.0) return {}; // no load
    const double step = later * std::sqrt(per_sample * by_step.mean_square() / field),
                 absorber = std::sqrt(by_absorber.mean_square() / field);
    return {.norm = std::hypot(step, absorber),
            .maximum =
                (later * by_step.most + by_absorber.most) / (high_field.most + low_field.most),
            .absorber = absorber};
}

} // namespace shearwake::spectral
