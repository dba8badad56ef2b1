#include "engines/spectral/lateral_field.hpp"

#include <algorithm>

namespace shearwake {

LateralField::LateralField(LateralVariation variation, std::ptrdiff_t ny, const SlabShare& share)
    : variation_(std::move(variation)),
      components_(static_cast<std::size_t>(variation_.components())), ny_(ny), share_(share) {}

void LateralField::stress(const Values& now, const Values& before, double rate, Values& out) const {
    for (const LateralVariation::Point& point : variation_.points) {
        const std::size_t n = point.cells, at = point.first * components_;
        const double *e = now.data() + at, *b = before.data() + at;
        const double* lambda = variation_.lambda.data() + point.first;
        const double* mu = variation_.mu.data() + point.first;
        const double* viscosity = variation_.viscosity.data() + point.first;
        double* s = out.data() + at;
        for (std::size_t i = 0; i < n; ++i) {
            const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
            for (std::size_t c = 0; c < 6; ++c) {
                const double strain = e[c * n + i];
                const double both = mu[i] * strain + viscosity[i] * rate * (strain - b[c * n + i]);
                s[c * n + i] = c < 3 ? dilation + 2.0 * both : both;
            }
        }
        std::fill(s + 6 * n, s + components_ * n, 0.0);
    }
}

void LateralField::implicit(std::size_t point, const Values& strain, Values& out) const {
    const std::size_t n = variation_.points[point].cells, first = variation_.points[point].first;
    const double* e = strain.data() + first * components_;
    const double* lambda = variation_.implicit_lambda.data() + first;
    const double* mu = variation_.implicit_mu.data() + first;
    double* s = out.data() + first * components_;
    for (std::size_t i = 0; i < n; ++i) {
        const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
        for (std::size_t c = 0; c < 6; ++c) {
            const double own = mu[i] * e[c * n + i];
            s[c * n + i] = c < 3 ? dilation + 2.0 * own : own;
        }
    }
    if (!variation_.density_varies) return;
    const double* mass = variation_.implicit_mass.data() + first;
    for (std::size_t c = 6; c < 9; ++c)
        for (std::size_t i = 0; i < n; ++i)
            s[c * n + i] = mass[i] * e[c * n + i];
}

void LateralField::add_product(std::size_t point, const Values& a, const Values& b,
                               RowSums& sums) const {
    const LateralVariation::Point& at = variation_.points[point];
    for (const RowRun& run : at.runs) {
        const auto length = static_cast<std::size_t>(run.end - run.begin);
        double product = 0.0;
        for (std::size_t c = 0; c < components_; ++c) {
            const std::size_t first =
                at.first * components_ + c * at.cells + static_cast<std::size_t>(run.offset);
            for (std::size_t i = first; i < first + length; ++i)
                product += a[i] * b[i];
        }
        sums.add(share_.x_start + run.row, product);
    }
}

StateRows LateralField::rows(std::ptrdiff_t nx) const {
    return {.total = nx,
            .start = share_.x_start,
            .count = share_.x_count,
            .row_length =
                static_cast<std::ptrdiff_t>(variation_.points.size() * components_) * ny_};
}

std::vector<double> LateralField::to_rows(const Values& values) const {
    const StateRows all = rows(0);
    std::vector<double> out(static_cast<std::size_t>(all.count * all.row_length), 0.0);
    double* plane = out.data();
    for (const LateralVariation::Point& point : variation_.points)
        for (std::size_t c = 0; c < components_; ++c, plane += ny_)
            for (const RowRun& run : point.runs)
                std::copy_n(values.data() + point.first * components_ + c * point.cells +
                                run.offset,
                            run.end - run.begin, plane + run.row * all.row_length + run.begin);
    return out;
}

void LateralField::from_rows(const std::vector<double>& in, Values& values) const {
    const StateRows all = rows(0);
    const double* plane = in.data();
    for (const LateralVariation::Point& point : variation_.points)
        for (std::size_t c = 0; c < components_; ++c, plane += ny_)
            for (const RowRun& run : point.runs)
                std::copy_n(plane + run.row * all.row_length + run.begin, run.end - run.begin,
                            values.data() + point.first * components_ + c * point.cells +
                                run.offset);
}

} // namespace shearwake
