#include "engines/spectral/step_probe.hpp"

#include "engines/spectral/moving_load.hpp"
#include "engines/spectral/vertical_operator.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

/// kx to where the footprint's spectrum is 1e-2; of ky, 0 and half of that.
constexpr std::ptrdiff_t columns = 2 * lane_count, rows = 2;

Case with_few_wave_vectors(Case c) {
    c.domain = {columns, 2 * rows, std::numbers::pi / bandwidth_rad_m(c.load.footprint, 1e-2), 0.0};
    return c;
}

/// The layers under a load at a few wave vectors.
class Probe {
public:
    Probe(const Case& c, const VerticalOperator& vertical, const WaveVectors& vectors,
          double step_s)
        : vertical_(vertical), vectors_(vectors), load_(c, vectors, step_s), step_s_(step_s) {
        factors_.resize(static_cast<std::size_t>(rows * vertical.factor_size() * lane_count));
        now_.assign(static_cast<std::size_t>(rows * size() * lane_count), 0.0);
        before_ = now_;
        force_.resize(static_cast<std::size_t>(size() * lane_count));
        for (std::ptrdiff_t row = 0; row < rows; ++row)
            vertical.factorise_implicit(vectors.k(row, 0), step_s,
                                        lanes(factors_.data()) + row * vertical.factor_size());
    }

    void advance() {
        const double scale = step_ == 0 ? 0.5 : 1.0; // from rest
        load_.sample(step_);
        for (std::ptrdiff_t row = 0; row < rows; ++row) {
            const Lanes* u = lanes(now_.data()) + row * size();
            Lanes* before = lanes(before_.data()) + row * size();
            Lanes* force = lanes(force_.data());
            std::fill(force_.begin(), force_.end(), 0.0);
            load_.put(row, 0, force + parts); // unknown 1: W at the surface
            vertical_.add_internal_force(vectors_.k(row, 0), 1.0 / step_s_, u, before, force);
            vertical_.solve_implicit(lanes(factors_.data()) + row * vertical_.factor_size(), force);
            for (std::ptrdiff_t i = 0; i < size(); ++i)
                before[i] = 2.0 * u[i] - before[i] + scale * force[i];
        }
        std::swap(now_, before_);
        ++step_;
    }

    /// The four parts of W.
    const Lanes* surface(std::ptrdiff_t row) const {
        return lanes(now_.data()) + row * size() + parts;
    }

private:
    std::ptrdiff_t size() const { return vertical_.unknowns() * parts; }

    const VerticalOperator& vertical_;
    const WaveVectors& vectors_;
    MovingLoad load_;
    double step_s_;
    std::ptrdiff_t step_ = 0;
    AlignedVector<double> factors_, now_, before_, force_;
};

} // namespace

double probed_error(const Case& c, const DepthMesh& mesh, double step_s) {
    const Case few = with_few_wave_vectors(c);
    SlabShare share;
    share.ky_count = rows; // without the Nyquist mode
    const WaveVectors vectors(few.domain, share);
    const VerticalOperator vertical(mesh, background_of(mesh, c.medium));
    Probe whole(few, vertical, vectors, step_s), half(few, vertical, vectors, 0.5 * step_s);
    const long steps = std::lround(c.time.duration_s() / step_s);
    Lanes difference{}, all{};
    for (long n = 0; n < steps; ++n) {
        whole.advance();
        half.advance();
        half.advance();
        for (std::ptrdiff_t row = 0; row < rows; ++row) {
            Counted counted = vectors.counted(row, 0);
            // The mean is compression alone, which no step follows and a whole field hardly has.
            if (row == 0)
                for (Lanes& part : counted.part)
                    part[0] = 0.0;
            const Lanes *coarse = whole.surface(row), *fine = half.surface(row);
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Lanes apart = coarse[p] - fine[p];
                difference += counted.part[p] * apart * apart;
                all += counted.part[p] * fine[p] * fine[p];
            }
        }
    }
    return 4.0 / 3.0 * std::sqrt(sum_of(difference) / sum_of(all));
}

} // namespace shearwake
