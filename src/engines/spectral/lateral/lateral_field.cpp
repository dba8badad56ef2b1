// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/lateral_field.hpp"

#include "simd/kernels.hpp"

#include <algorithm>
#include <array>

namespace shearwake::spectral {

namespace {

/// Adds the stress of a surface for an engineering strain times its modulus.
void add(const LateralVariation::Surface& surface, const std::array<double, 6>& scaled,
         double* stress, std::size_t cells) {
    const std::array<double, 6> more = stress_across(surface.normal, scaled);
    for (std::size_t c = 0; c < more.size(); ++c)
        stress[c * cells + surface.cell] += more[c];
}

} // namespace

LateralField::LateralField(LateralVariation variation, std::ptrdiff_t ny,
                           const fft::SlabShare& share)
    : kernels_(simd::kernels<StrainKernels>()), variation_(std::move(variation)),
      components_(static_cast<std::size_t>(variation_.components())), ny_(ny), share_(share) {}

void LateralField::stress(const Values& now, const Values& before, double rate, Values& out) const {
    for (std::size_t p = 0; p < variation_.points.size(); ++p) {
        const LateralVariation::Point& point = variation_.points[p];
        const std::size_t n = point.cells, at = point.first * components_;
        const double *e = now.data() + at, *b = before.data() + at;
        double* s = out.data() + at;
        kernels_.stress(static_cast<std::ptrdiff_t>(n), variation_.lambda.data() + point.first,
                        variation_.mu.data() + point.first,
                        variation_.viscosity.data() + point.first, rate, e, b, s);
        for (const LateralVariation::Surface& surface : variation_.surfaces[p]) {
            std::array<double, 6> scaled{};
            for (std::size_t c = 0; c < scaled.size(); ++c) {
                const double strain = e[c * n + surface.cell];
                scaled[c] = surface.mu * strain +
                            surface.viscosity * rate * (strain - b[c * n + surface.cell]);
            }
            add(surface, scaled, s, n);
        }
        std::fill(s + 6 * n, s + components_ * n, 0.0);
    }
}

void LateralField::implicit(std::size_t point, const Values& strain, Values& out) const {
    const std::size_t n = variation_.points[point].cells, first = variation_.points[point].first;
    const double* e = strain.data() + first * components_;
    double* s = out.data() + first * components_;
    kernels_.elastic(static_cast<std::ptrdiff_t>(n), variation_.implicit_lambda.data() + first,
                     variation_.implicit_mu.data() + first, e, s);
    for (const LateralVariation::Surface& surface : variation_.surfaces[point]) {
        std::array<double, 6> scaled{};
        for (std::size_t c = 0; c < scaled.size(); ++c)
            scaled[c] = surface.implicit_mu * e[c * n + surface.cell];
        add(surface, scaled, s, n);
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
    for (const fft::RowRun& run : at.runs) {
        const auto length = static_cast<std::size_t>(run.end - run.begin);
        double product = 0.0;
        for (std::size_t c = 0; c < components_; ++c) {
            const std::size_t first =
                at.first * components_ + c * at.cells + static_cast<std::size_t>(run.offset);
            product += kernels_.product(static_cast<std::ptrdiff_t>(length), a.data() + first,
                                        b.data() + first);
        }
        sums.add(share_.x_start + run.row, product);
    }
}

DistributedRows LateralField::rows(std::ptrdiff_t nx) const {
    return {.total = nx,
            .start = share_.x_start,
            .count = share_.x_count,
            .row_length =
                static_cast<std::ptrdiff_t>(variation_.points.size() * components_) * ny_};
}

std::vector<double> LateralField::to_rows(const Values& values) const {
    const DistributedRows all = rows(0);
    std::vector<double> out(static_cast<std::size_t>(all.count * all.row_length), 0.0);
    double* plane = out.data();
    for (const LateralVariation::Point& point : variation_.points)
        for (std::size_t c = 0; c < components_; ++c, plane += ny_)
            for (const fft::RowRun& run : point.runs)
                std::copy_n(values.data() + point.first * components_ + c * point.cells +
                                run.offset,
                            run.end - run.begin, plane + run.row * all.row_length + run.begin);
    return out;
}

void LateralField::read_rows(const std::vector<double>& in, Values& values) const {
    const DistributedRows all = rows(0);
    const double* plane = in.data();
    for (const LateralVariation::Point& point : variation_.points)
        for (std::size_t c = 0; c < components_; ++c, plane += ny_)
            for (const fft::RowRun& run : point.runs)
                std::copy_n(plane + run.row * all.row_length + run.begin, run.end - run.begin,
                            values.data() + point.first * components_ + c * point.cells +
                                run.offset);
}

} // namespace shearwake::spectral
