#include "engines/spectral/stepper.hpp"

#include <algorithm>

namespace shearwake {
void Stepper::plane_of_u(std::size_t component, std::size_t level, double* plane) const {
    const auto at_level = static_cast<std::ptrdiff_t>(level);
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const double ky = vectors_.ky_rad_m(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Lanes* u = lanes(now_.data()) +
                             (row * vectors_.blocks() + block) * operator_.unknowns() * parts;
            const Lanes kx = vectors_.kx(block), k = vectors_.k(row, block);
            Lanes value[parts] = {};
            if (at_level < operator_.levels()) {
                const Lanes* uw = u + 2 * at_level * parts;
                const Lanes* v = u + (operator_.psv() + at_level) * parts;
                for (std::ptrdiff_t p = 0; p < parts; ++p) {
                    // u_x = i (c U - s V), u_y = i (s U + c V)
                    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                        const double sign = p < minus_re ? 1.0 : -1.0;
                        const double c = k[lane] > 0.0 ? sign * kx[lane] / k[lane] : 1.0;
                        const double s = k[lane] > 0.0 ? ky / k[lane] : 0.0;
                        value[p][lane] = component == 0   ? c * uw[p][lane] - s * v[p][lane]
                                         : component == 1 ? s * uw[p][lane] + c * v[p][lane]
                                                          : uw[parts + p][lane];
                    }
                }
            }
            if (component < 2) {
                const Lanes plus = value[plus_re], minus = value[minus_re];
                value[plus_re] = -value[plus_im];
                value[plus_im] = plus;
                value[minus_re] = -value[minus_im];
                value[minus_im] = minus;
            }
            StrainTransfer::put(vectors_, block, plane + 2 * row * vectors_.nx(), value);
        }
    }
    vectors_.clear_nyquist(plane);
}

void Stepper::plane_of_w(double depth_m, double* plane) const {
    const auto above = std::upper_bound(mesh_.ends_m.begin(), mesh_.ends_m.end() - 1, depth_m);
    const auto element = static_cast<std::size_t>(above - mesh_.ends_m.begin()) - 1;
    const std::vector<double> weights = interpolation_weights(
        mesh_.rule, 2.0 * (depth_m - mesh_.ends_m[element]) / mesh_.length_m(element) - 1.0);
    const auto first = static_cast<std::ptrdiff_t>(element) * mesh_.degree;
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Lanes* u = lanes(now_.data()) +
                             (row * vectors_.blocks() + block) * operator_.unknowns() * parts;
            Lanes w[parts] = {};
            for (std::ptrdiff_t i = 0; i <= mesh_.degree; ++i) {
                const std::ptrdiff_t unknown = 2 * (first + i) + 1;
                if (unknown >= operator_.psv()) continue; // the base rests
                for (std::ptrdiff_t part = 0; part < parts; ++part)
                    w[part] += weights[static_cast<std::size_t>(i)] * u[unknown * parts + part];
            }
            StrainTransfer::put(vectors_, block, plane + 2 * row * vectors_.nx(), w);
        }
    }
    vectors_.clear_nyquist(plane);
}

} // namespace shearwake
