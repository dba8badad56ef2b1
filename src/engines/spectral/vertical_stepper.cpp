#include "engines/spectral/vertical_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
constexpr double two_pi = 2.0 * std::numbers::pi;

/// Blocks of lanes for kx = 0 ... nx/2 - 1: the Nyquist mode carries no load.
std::ptrdiff_t blocks_of(std::ptrdiff_t nx) {
    return (nx / 2 + lane_count - 1) / lane_count;
}

/// Times, in steps, whose loads enter a step, and their weights: f + (dt^2/12) f''. At the start
/// they lie on one side, and (dt/3) f' belongs to it as well, since u(dt) is half of the
/// difference.
struct Sample {
    std::ptrdiff_t step;
    double weight;
};
std::array<Sample, 3> samples_at(std::ptrdiff_t n) {
    if (n == 0) return {{{0, 7.0 / 12.0}, {1, 0.5}, {2, -1.0 / 12.0}}};
    return {{{n - 1, 1.0 / 12.0}, {n, 10.0 / 12.0}, {n + 1, 1.0 / 12.0}}};
}

/// Weights of an element's nodes at reference position x in [-1, 1] (Lagrange).
std::vector<double> weights_at(const GaussLobatto& rule, double x) {
    std::vector<double> weights(rule.nodes.size(), 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
        for (std::size_t j = 0; j < weights.size(); ++j)
            if (i != j) weights[i] *= (x - rule.nodes[j]) / (rule.nodes[i] - rule.nodes[j]);
    return weights;
}

} // namespace

VerticalStepper::VerticalStepper(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                                 double step_s)
    : case_(c), mesh_(mesh), share_(share), step_s_(step_s), operator_(mesh, c.medium),
      blocks_(blocks_of(c.domain.nx)), unknowns_(operator_.unknowns()) {
    const std::ptrdiff_t pencils = blocks_ * share.ky_count;
    const std::ptrdiff_t factor_size = unknowns_ * operator_.band();
    factors_.resize(static_cast<std::size_t>(pencils * factor_size * lane_count));
    now_.assign(static_cast<std::size_t>(pencils * unknowns_ * parts * lane_count), 0.0);
    before_ = now_;
    force_.resize(static_cast<std::size_t>(unknowns_ * parts * lane_count));
    for (std::ptrdiff_t ky = 0; ky < share.ky_count; ++ky) {
        for (std::ptrdiff_t block = 0; block < blocks_; ++block) {
            Lanes* matrix = lanes(factors_.data()) + pencil(ky, block) * factor_size;
            operator_.assemble(wavenumbers(ky, block), step_s, matrix);
            factorise(unknowns_, operator_.band(), matrix);
        }
    }
}

void VerticalStepper::advance() {
    sample_loads();
    const double scale = step_ == 0 ? 0.5 : 1.0;
    Lanes* force = lanes(force_.data());
    for (std::ptrdiff_t ky = 0; ky < share_.ky_count; ++ky) {
        if (is_nyquist(ky)) continue;
        for (std::ptrdiff_t block = 0; block < blocks_; ++block) {
            const std::ptrdiff_t at = pencil(ky, block);
            const Lanes* u = lanes(now_.data()) + at * unknowns_ * parts;
            Lanes* before = lanes(before_.data()) + at * unknowns_ * parts;
            std::fill(force_.begin(), force_.end(), 0.0);
            put_load(ky, block, force);
            operator_.add_internal_force(wavenumbers(ky, block), 1.0 / step_s_, u, before, force);
            solve(unknowns_, operator_.band(),
                  lanes(factors_.data()) + at * unknowns_ * operator_.band(), force);
            for (std::ptrdiff_t i = 0; i < unknowns_ * parts; ++i)
                before[i] = 2.0 * u[i] - before[i] + scale * force[i];
        }
    }
    std::swap(now_, before_);
    ++step_;
}

void VerticalStepper::plane_of_w(double depth_m, double* plane) const {
    const auto above = std::upper_bound(mesh_.ends_m.begin(), mesh_.ends_m.end() - 1, depth_m);
    const auto element = static_cast<std::size_t>(above - mesh_.ends_m.begin()) - 1;
    const std::vector<double> weights = weights_at(
        mesh_.rule, 2.0 * (depth_m - mesh_.ends_m[element]) / mesh_.length_m(element) - 1.0);
    const auto first = static_cast<std::ptrdiff_t>(element) * mesh_.degree;
    const std::ptrdiff_t nx = case_.domain.nx;
    auto* out = reinterpret_cast<Complex*>(plane);
    for (std::ptrdiff_t ky = 0; ky < share_.ky_count; ++ky) {
        std::fill_n(out + ky * nx, nx, Complex(0.0));
        if (is_nyquist(ky)) continue;
        for (std::ptrdiff_t block = 0; block < blocks_; ++block) {
            const Lanes* u = lanes(now_.data()) + pencil(ky, block) * unknowns_ * parts;
            Lanes w[parts] = {};
            for (std::ptrdiff_t i = 0; i <= mesh_.degree; ++i) {
                const std::ptrdiff_t row = 2 * (first + i) + 1;
                if (row >= unknowns_) continue; // the base rests
                for (std::ptrdiff_t part = 0; part < parts; ++part)
                    w[part] += weights[static_cast<std::size_t>(i)] * u[row * parts + part];
            }
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                const std::ptrdiff_t kx = block * lane_count + lane;
                if (2 * kx >= nx) continue;
                out[ky * nx + kx] = {w[plus_re][lane], w[plus_im][lane]};
                if (kx > 0) out[ky * nx + nx - kx] = {w[minus_re][lane], w[minus_im][lane]};
            }
        }
    }
}

void VerticalStepper::sample_loads() {
    const Trajectory& trajectory = case_.load.modulation.trajectory;
    const double off_s = off_time_s(trajectory);
    const double area_m2 = case_.domain.extent_x_m() * case_.domain.extent_y_m();
    const auto samples = samples_at(step_);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const double t_s = static_cast<double>(samples[s].step) * step_s_;
        SampledLoad& load = loads_[s];
        // At a path's end the load is a step down: half of it counts at the very time.
        const double on = t_s < off_s - 0.5 * step_s_   ? 1.0
                          : t_s < off_s + 0.5 * step_s_ ? 0.5
                                                        : 0.0;
        load.amplitude_Pa =
            on * samples[s].weight * case_.load.peak_Pa * amplitude(case_.load, t_s) / area_m2;
        const Vec2 focus =
            position(trajectory, t_s) - Vec2{case_.domain.x_m(0), case_.domain.y_m(0)};
        load.x.resize(static_cast<std::size_t>(blocks_ * lane_count));
        load.y.resize(static_cast<std::size_t>(share_.ky_count));
        for (std::size_t i = 0; i < load.x.size(); ++i)
            load.x[i] = std::polar(1.0, -kx_rad_m(static_cast<std::ptrdiff_t>(i)) * focus.x);
        for (std::size_t j = 0; j < load.y.size(); ++j)
            load.y[j] = std::polar(1.0, -ky_rad_m(static_cast<std::ptrdiff_t>(j)) * focus.y);
    }
}

void VerticalStepper::put_load(std::ptrdiff_t ky, std::ptrdiff_t block, Lanes* force) const {
    Lanes* surface = force + parts; // unknown 1: W at the surface
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const std::ptrdiff_t kx = block * lane_count + lane;
        if (2 * kx >= case_.domain.nx) continue;
        Complex plus = 0.0, minus = 0.0;
        for (const SampledLoad& load : loads_) {
            const Complex x = load.x[static_cast<std::size_t>(kx)];
            const Complex y = load.amplitude_Pa * load.y[static_cast<std::size_t>(ky)];
            plus += x * y;
            minus += std::conj(x) * y;
        }
        const double g = spectrum(case_.load.footprint, kx_rad_m(kx), ky_rad_m(ky));
        surface[plus_re][lane] = g * plus.real();
        surface[plus_im][lane] = g * plus.imag();
        surface[minus_re][lane] = g * minus.real();
        surface[minus_im][lane] = g * minus.imag();
    }
}

double VerticalStepper::kx_rad_m(std::ptrdiff_t i) const {
    return two_pi / case_.domain.extent_x_m() * static_cast<double>(i);
}

double VerticalStepper::ky_rad_m(std::ptrdiff_t local) const {
    return two_pi / case_.domain.extent_y_m() * static_cast<double>(share_.ky_start + local);
}

Lanes VerticalStepper::wavenumbers(std::ptrdiff_t ky, std::ptrdiff_t block) const {
    Lanes k{};
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        k[lane] = std::hypot(kx_rad_m(block * lane_count + lane), ky_rad_m(ky));
    return k;
}

} // namespace shearwake
