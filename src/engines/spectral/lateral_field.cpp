#include "engines/spectral/lateral_field.hpp"

#include <algorithm>

namespace shearwake {

LateralField::LateralField(LateralVariation variation, std::ptrdiff_t ny, const SlabShare& share)
    : variation_(std::move(variation)),
      components_(static_cast<std::size_t>(variation_.components())), ny_(ny), share_(share) {}

/// f(first value of the point's component 0, cells of the point, first cell).
template <class F>
void LateralField::each_cell(F f) const {
    for (const LateralVariation::Point& point : variation_.points)
        f(point.first * components_, point.cells, point.first);
}

void LateralField::stress(const Values& now, const Values& before, double rate, Values& out) const {
    std::fill(out.begin(), out.end(), 0.0);
    each_cell([&](std::size_t at, std::size_t n, std::size_t first) {
        const double *e = now.data() + at, *b = before.data() + at;
        const double* lambda = variation_.lambda.data() + first;
        const double* mu = variation_.mu.data() + first;
        const double* viscosity = variation_.viscosity.data() + first;
        double* s = out.data() + at;
        for (std::size_t i = 0; i < n; ++i) {
            const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
            for (std::size_t c = 0; c < 6; ++c) {
                const double strain = e[c * n + i];
                const double both = mu[i] * strain + viscosity[i] * rate * (strain - b[c * n + i]);
                s[c * n + i] = c < 3 ? dilation + 2.0 * both : both;
            }
        }
    });
}

void LateralField::implicit(const Values& strain, Values& out) const {
    each_cell([&](std::size_t at, std::size_t n, std::size_t first) {
        const double* e = strain.data() + at;
        const double* lambda = variation_.implicit_lambda.data() + first;
        const double* mu = variation_.implicit_mu.data() + first;
        double* s = out.data() + at;
        for (std::size_t i = 0; i < n; ++i) {
            const double dilation = lambda[i] * (e[i] + e[n + i] + e[2 * n + i]);
            for (std::size_t c = 0; c < 3; ++c)
                s[c * n + i] = dilation + 2.0 * mu[i] * e[c * n + i];
            for (std::size_t c = 3; c < 6; ++c)
                s[c * n + i] = mu[i] * e[c * n + i];
        }
        if (!variation_.density_varies) return;
        const double* mass = variation_.implicit_mass.data() + first;
        for (std::size_t c = 6; c < 9; ++c)
            for (std::size_t i = 0; i < n; ++i)
                s[c * n + i] = mass[i] * e[c * n + i];
    });
}

double LateralField::inner(const Values& a, const Values& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += a[i] * b[i];
    return sum;
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
            for (const CellRun& run : point.runs)
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
            for (const CellRun& run : point.runs)
                std::copy_n(plane + run.row * all.row_length + run.begin, run.end - run.begin,
                            values.data() + point.first * components_ + c * point.cells +
                                run.offset);
}

void LateralField::to_spectra(const Values& values, const SlabTransform& slabs,
                              double* planes) const {
    for (const LateralVariation::Point& point : variation_.points) {
        for (std::size_t c = 0; c < components_; ++c, planes += share_.reals) {
            std::fill(planes + point.rows.begin * share_.padded_ny,
                      planes + point.rows.end * share_.padded_ny, 0.0);
            const double* from = values.data() + point.first * components_ + c * point.cells;
            for (const CellRun& run : point.runs)
                std::copy_n(from + run.offset, run.end - run.begin,
                            planes + run.row * share_.padded_ny + run.begin);
            slabs.to_spectral(planes, point.rows);
        }
    }
}

void LateralField::from_spectra(double* planes, const SlabTransform& slabs, Values& values) const {
    for (const LateralVariation::Point& point : variation_.points) {
        for (std::size_t c = 0; c < components_; ++c, planes += share_.reals) {
            slabs.to_physical(planes, point.rows);
            double* to = values.data() + point.first * components_ + c * point.cells;
            for (const CellRun& run : point.runs)
                std::copy_n(planes + run.row * share_.padded_ny + run.begin, run.end - run.begin,
                            to + run.offset);
        }
    }
}

} // namespace shearwake
