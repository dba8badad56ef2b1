// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "engines/spectral/kernels/displacements.hpp"
#include "engines/spectral/stepping/stages.hpp"
#include "fft/run_transform.hpp"
#include "parallel/agree.hpp"
#include "problem/case/edges.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
namespace {

constexpr std::ptrdiff_t displacements = 3;
constexpr std::ptrdiff_t planes_at_once =
    9; // number of planes that are exchanged between ranks at once

/// The minimum of viscosity over density within the uppermost `depth_m` [m^2/s].
double least_diffusivity_m2_s(const Medium& medium, double depth_m) {
    double least = 1e300, top_m = 0.0;
    for (const Layer& layer : medium.layers) {
        if (top_m >= depth_m) break;
        least = std::min(least,
                         newtonian_viscosity_Pa_s(layer.loss).value_or(0.0) / layer.density_kg_m3);
        top_m += layer.thickness_m;
    }
    return least;
}

/// Impulses at intervals of T also emit waves of period T. Therefore T is limited to the time in
/// which waves cross a quarter of the sponge or the width of the focus, and to the value at which
/// waves of this period lose 87 % of their amplitude within the width of the sponge, omega^2 nu
/// W/(2 c^3) = 2. Without losses half of the focus width is sufficient: a sponge of 20 mm returns
/// 0.4 % of the energy of a pulse, as with shorter T, but 9 % with twice that T.
double interval_s(const Case& c, double speed_m_s) {
    const double width_m = c.domain.sponge_m;
    const double focus_s = fwhm_m(c.scene.load.footprint) / speed_m_s;
    const double nu = least_diffusivity_m2_s(c.scene.medium, width_m);
    const double dies_s = std::numbers::pi * std::sqrt(nu * width_m / std::pow(speed_m_s, 3));
    return std::min({0.25 * width_m / speed_m_s, focus_s, std::max(0.5 * focus_s, dies_s)});
}

} // namespace

SpongePlan sponge_plan(const Case& c, Lateral medium, double step_s) {
    const double width_m = c.domain.sponge_m;
    SpongePlan plan = {0, c.domain.nx, c.domain.ny};
    if (!(width_m > 0.0)) return plan;
    const double T = interval_s(c, edge_speed_m_s(c.scene.medium, width_m));
    plan.every = std::max<std::ptrdiff_t>(1, std::lround(std::floor(T / step_s + 1e-9)));
    if (medium == Lateral::varies) return plan;
    const double k_rad_m = bandwidth_rad_m(c.scene.load.footprint, 3e-2);
    const auto points = [&](double extent_m, std::ptrdiff_t all) {
        const double waves = std::ceil(k_rad_m * extent_m / two_pi);
        if (2.0 * waves + 2.0 >= static_cast<double>(all)) return all;
        return std::min(all, good_even_length(2 * std::lround(waves) + 2));
    };
    plan.nx = points(c.domain.extent_x_m(), c.domain.nx);
    plan.ny = points(c.domain.extent_y_m(), c.domain.ny);
    return plan;
}

namespace {

/// Absorbing margin of the domain. Every few steps the velocity in the margin is reduced by its
/// share b = 1 - e^{-gamma T}, with gamma of case/edges.hpp and the interval T. In nearly
/// incompressible tissue b v has a divergence, which a scheme whose step is independent of c_p
/// cannot propagate away. The loss is therefore applied as an impulse, -M b v, to which the
/// implicit operator responds.
///
/// Half of the loss of u - u- is subtracted from u and half is added to u-, so that their mean does
/// not change. Of the energy of the scheme,
///     v.(A - C/(2 dt) - K/4) v/2 + m.K m/2,   v = u - u-, m = (u + u-)/2,
/// the second term stays constant, and the first one decreases as the velocity does. The energy was
/// never observed to rise at any step. If the loss were applied to only one of u and u-, the
/// fastest modes would grow. Where steps iterate, the response to the impulse is that of the layers
/// without the body: the removed velocity is the same, and the following steps correct the strain
/// of a stiff body.
///
/// In a laterally uniform medium only the wave vectors of the load occur. Those above which the
/// spectrum of the footprint is below 3 % contain 1e-3 of the energy. The sponge then acts on the
/// lower wave vectors alone, on planes with only as many points as these need. The returned energy
/// of a pulse changes by less than 1 %.
class SpongeStage : public Sponge {
public:
    explicit SpongeStage(StepState& state);

    void advance() override {
        if (!s_.sponge_acts_at(s_.step)) return;
        read_velocity();
        if (!acts_in_pass()) damp();
    }
    void damp_in_pass(const Pencil& p) override {
        if (p.block == 0) begin_row(p.row);
        if (acts_on(p.row, p.block)) damp(p);
    }
    std::vector<engines::Allocation> arrays() const override {
        return {{"sponge", static_cast<double>(planes_.size() * sizeof(double))}};
    }
    // Whether it acts follows from the step.
    void save(StateWriter& /*state*/) const override {}
    void restore(const StateReader& /*state*/) override {}

private:
    double* line(std::ptrdiff_t row) { return planes_.data() + 2 * row * slabs_->line_pitch(); }
    bool acts_on(std::ptrdiff_t row, std::ptrdiff_t block) const {
        return row < vectors_.rows() && block < vectors_.blocks() && !vectors_.is_nyquist(row);
    }

    void damp() {
        s_.each_pencil(
            {}, [&](std::ptrdiff_t row) { begin_row(row); },
            [&](const Pencil& p) {
                damp(p);
                s_.put_strain(p, s_.scratch.data());
                if (!s_.bodies->empty()) s_.bodies->evaluate(p.row, p.block, s_.scratch.data());
            });
        s_.planes.get(s_.change);
        constrain();
        for (std::size_t i = 0; i < s_.change.size(); ++i) {
            s_.strain[i] += s_.change[i];
            s_.strain_before[i] -= s_.change[i];
        }
    }

    /// Replaces u and u- of a pencil after the impulse for half of the loss, -M/(2 dt^2) b (u -
    /// u-).
    void damp(const Pencil& p) {
        Block* change = s_.scratch.data();
        std::fill_n(change, s_.size(), Block{});
        kernels_.add_force(arrays(impulse_depths_), vectors_.waves(p.row, p.block), line(p.row),
                           runs_->lines_reals(), 1.0, change);
        s_.solve(p, change);
        add_impulse(p, change);
    }

    /// The impulse on rigid bodies is that of the velocity removed from the material in their
    /// place; the mass in excess of it follows.
    void constrain() {
        if (s_.bodies->empty()) return;
        s_.bodies->respond();
        s_.bodies->add_impulse();
        s_.each_reaction([&](const Pencil& p, const Block* change) { add_impulse(p, change); });
        s_.add_planes(s_.change);
    }

    void add_impulse(const Pencil& p, const Block* change) {
        s_.kernels.add_scaled(s_.size(), 1.0, change, s_.now.data() + p.at * s_.size());
        s_.kernels.add_scaled(s_.size(), -1.0, change, s_.u_before(p));
    }

    /// Computes b (u - u-) for the pencils of this rank and stores it in the planes. Collective.
    void read_velocity() {
        const std::ptrdiff_t stride = runs_->lines_reals(), nx = vectors_.nx();
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
            const bool is_nyquist = vectors_.is_nyquist(row);
            for (std::ptrdiff_t block = 0; acts_on(row, block); ++block) {
                const Pencil p = s_.pencil(row, block);
                s_.kernels.difference(s_.size(), 1.0, s_.u(p), s_.u_before(p), s_.scratch.data());
                kernels_.displacement(arrays(depths_), vectors_.waves(row, block),
                                      s_.scratch.data(), line(row), stride);
            }
            for (std::ptrdiff_t plane = 0; plane < count_; ++plane) {
                double* modes = line(row) + plane * stride;
                if (is_nyquist) {
                    std::fill_n(modes, 2 * nx, 0.0);
                    continue;
                }
                modes[nx] = modes[nx + 1] = 0.0; // kx = nx/2
                slabs_->line_to_physical(modes);
            }
        }
        const auto cells = static_cast<std::size_t>(slabs_->share().x_count * vectors_.ny());
        for (std::ptrdiff_t first = 0; first < count_; first += planes_at_once) {
            double* plane = planes_.data() + first * stride;
            const std::ptrdiff_t planes = std::min(planes_at_once, count_ - first);
            runs_->to_values(plane, planes, values_.data(), cells);
            damp_velocity(planes);
            runs_->to_lines(values_.data(), cells, planes, plane);
        }
    }

    void damp_velocity(std::ptrdiff_t planes) {
        double* v = values_.data();
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            for (std::ptrdiff_t i = 0; i < slabs_->share().x_count; ++i) {
                const double share_x =
                    share_x_[static_cast<std::size_t>(slabs_->share().x_start + i)];
                for (const double share_y : share_y_)
                    *v++ *= 1.0 - share_x * share_y;
            }
    }

    void begin_row(std::ptrdiff_t row) {
        if (!acts_on(row, 0)) return;
        for (std::ptrdiff_t p = 0; p < count_; ++p)
            slabs_->line_to_spectral(line(row) + p * runs_->lines_reals());
    }

    /// All levels, each at its own depth.
    DisplacementArrays arrays(const std::vector<DisplacementDepth>& depths) const {
        return {.nodes = 1,
                .levels = s_.vertical.levels(),
                .depths = s_.vertical.levels(),
                .depth = depths.data()};
    }

    const DisplacementKernels& kernels_;
    WaveVectors vectors_; // on which the sponge acts
    std::optional<fft::SlabTransform> slabs_;
    std::ptrdiff_t count_ = 0;
    std::vector<double> share_x_,
        share_y_;                       // remaining share of the velocity: b = 1 - share_x share_y
    fft::AlignedVector<double> planes_; // [level][component], lines of ky over x
    std::vector<double> values_;        // of a few planes
    std::vector<double> impulses_;      // factor of b (u - u-) for each level
    std::vector<DisplacementDepth> depths_, impulse_depths_; // weights 1, and those of impulses_
    std::optional<fft::RunTransform> runs_;                  // all of this rank's rows
};

SpongeStage::SpongeStage(StepState& state)
    : Sponge(state), kernels_(simd::kernels<DisplacementKernels>()), vectors_(s_.vectors) {
    const auto [every, nx, ny] = s_.sponge;
    if (every == 0) return;
    vectors_ = s_.vectors.coarser(nx, ny);
    slabs_.emplace(nx, ny, s_.team, s_.slabs.planning());
    std::vector<fft::RowRun> all;
    for (std::ptrdiff_t i = 0; i < slabs_->share().x_count; ++i)
        all.push_back({i, 0, ny, static_cast<std::size_t>(i * ny)});
    runs_.emplace(*slabs_, s_.team, std::move(all),
                  fft::RunTransform::Lines{vectors_.share().ky_start, vectors_.share().ky_count});
    const Domain& domain = s_.c.domain;
    const double width_m = domain.sponge_m, speed_m_s = edge_speed_m_s(s_.c.scene.medium, width_m);
    const double time_s = static_cast<double>(every) * s_.step_s;
    const auto remaining = [&](std::ptrdiff_t count, double extent_m) {
        std::vector<double> shares;
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            const double place_m = static_cast<double>(i) * extent_m / static_cast<double>(count);
            const double from_edge_m = std::min(place_m, extent_m - place_m);
            shares.push_back(std::exp(-time_s * edge_drag_Hz(from_edge_m, width_m, speed_m_s)));
        }
        return shares;
    };
    share_x_ = remaining(nx, domain.extent_x_m());
    share_y_ = remaining(ny, domain.extent_y_m());
    for (std::ptrdiff_t level = 0; level < s_.vertical.levels(); ++level)
        impulses_.push_back(-0.5 * s_.vertical.mass_kg_m2(level) /
                            (static_cast<double>(nx * ny) * s_.step_s * s_.step_s));
    static constexpr double unit = 1.0;
    for (std::ptrdiff_t level = 0; level < s_.vertical.levels(); ++level) {
        depths_.push_back({level, &unit});
        impulse_depths_.push_back({level, &impulses_[static_cast<std::size_t>(level)]});
    }
    count_ = displacements * s_.vertical.levels();
    together(s_.team, [&] {
        planes_.assign(static_cast<std::size_t>(count_ * runs_->lines_reals()), 0.0);
        values_.assign(
            static_cast<std::size_t>(planes_at_once * slabs_->share().x_count * vectors_.ny()),
            0.0);
    });
}

} // namespace

std::unique_ptr<Sponge> make_sponge(StepState& state) {
    return std::make_unique<SpongeStage>(state);
}

} // namespace shearwake::spectral
