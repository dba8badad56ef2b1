// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/displacements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace shearwake::pstd {

Displacement::Displacement(Field velocity, const Slabs& slabs, std::ptrdiff_t first_z,
                           std::ptrdiff_t planes)
    : velocity_(velocity), slabs_(slabs), first_z_(first_z), planes_(planes),
      values_m_(static_cast<std::size_t>(slabs.rows() * planes), 0.0) {}

template <class Real>
void Displacement::add(const Stepper<Real>& stepper) {
    const Real* u = stepper.total(velocity_).data() + first_z_;
    double* sums = values_m_.data();
    const double dt_s = slabs_.grid.dt_s;
    for (std::ptrdiff_t row = 0; row < slabs_.rows(); ++row, u += slabs_.pitch, sums += planes_)
        for (std::ptrdiff_t z = 0; z < planes_; ++z)
            sums[z] += dt_s * static_cast<double>(u[z]);
}
template void Displacement::add(const Stepper<double>&);
template void Displacement::add(const Stepper<float>&);

void Displacement::sum(std::span<const double> weights, std::span<double> plane_m,
                       std::ptrdiff_t from_plane) const {
    for (std::size_t row = 0; row < plane_m.size(); ++row) {
        const double* values = values_m_.data() + static_cast<std::ptrdiff_t>(row) * planes_;
        double sum = 0.0;
        for (std::size_t k = 0; k < weights.size(); ++k)
            sum += weights[k] * values[from_plane + static_cast<std::ptrdiff_t>(k)];
        plane_m[row] = sum;
    }
}

double Displacement::largest_m(const Comm& team) const {
    double largest = 0.0;
    for (const double value : values_m_)
        largest = std::isfinite(value) ? std::max(largest, std::abs(value))
                                       : std::numeric_limits<double>::infinity();
    return team.max(largest);
}

DistributedRows Displacement::rows() const {
    return {.total = slabs_.nx(),
            .start = slabs_.x_start(),
            .count = slabs_.x_count(),
            .row_length = slabs_.ny() * planes_};
}

void Displacement::save(StateWriter& state, const std::string& name) const {
    state.put(name, rows(), values_m_.data());
}

void Displacement::restore(const StateReader& state, const std::string& name) {
    state.get(name, rows(), values_m_.data());
}

std::vector<double> depth_weights(double depth_m, double spacing_m, SurfacePlane surface) {
    constexpr std::array fitted = {0.8903, 1.2843, -3.1877, 3.0748, -1.0473};
    const double at = depth_m / spacing_m, low = std::floor(at + 1e-9);
    const double share = std::max(at - low, 0.0);
    std::vector<double> weights(static_cast<std::size_t>(low) + 2, 0.0);
    weights[weights.size() - 2] = 1.0 - share;
    weights.back() = share;
    if (share < 1e-9) weights.pop_back();
    if (surface != SurfacePlane::rings || weights.front() == 0.0) return weights;
    const double of_surface = weights.front();
    weights.front() = 0.0;
    weights.resize(std::max(weights.size(), fitted.size()), 0.0);
    for (std::size_t k = 0; k < fitted.size(); ++k)
        weights[k] += of_surface * fitted[k];
    return weights;
}

} // namespace shearwake::pstd
